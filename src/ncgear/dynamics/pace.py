"""From derivatives by an angle to accelerations: at constant driving speed, or as the crank happens to turn."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Protocol

from ncgear.numerics.arrays import Array
from ncgear.numerics.jet import Jet
from ncgear.numerics.vector import Term, Vector


class Pace(Protocol):
    """How places and angles, which are jets, pass in time."""

    def now(self, quantity: Jet) -> Term:
        """The quantity itself."""

    def second(self, quantity: Jet) -> Term:
        """Its second derivative by time, in its unit per s^2, of the kind that ``now`` gives."""


@dataclass(frozen=True)
class EvenPace:
    """Jets by the driving angle, which grows at a constant speed in rad/s; gives jets of two orders less."""

    speed_rad_s: float

    def now(self, quantity: Jet) -> Jet:
        """The jet at the order of ``second``."""
        return quantity.truncated(quantity.order - 2)

    def second(self, quantity: Jet) -> Jet:
        """w^2 d2/dphi1^2."""
        return quantity.differentiated().differentiated() * self.speed_rad_s**2


@dataclass(frozen=True, eq=False)
class CrankPace:
    """Jets of order 2 or more by the crank's angle, whose speed and acceleration have shape (n,); gives arrays."""

    speed_rad_s: Array
    acceleration_rad_s2: Array

    def now(self, quantity: Jet) -> Array:
        """The values."""
        return quantity.value

    def second(self, quantity: Jet) -> Array:
        """q'^2 d2/dq^2 + q'' d/dq."""
        return quantity.derivative(2) * self.speed_rad_s**2 + quantity.derivative(1) * self.acceleration_rad_s2


def place(pace: Pace, point: Vector) -> Vector:
    """A point in mm."""
    return Vector(pace.now(point.x), pace.now(point.y))


def acceleration(pace: Pace, point: Vector) -> Vector:
    """Acceleration of a point in mm/s^2."""
    return Vector(pace.second(point.x), pace.second(point.y))
