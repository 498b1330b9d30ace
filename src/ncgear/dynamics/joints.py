"""From derivatives by an angle to accelerations: at constant driving speed, or as the crank happens to turn.

Forces in the joints of the linkage, by the equations of Newton and Euler for slider, rod and crank.

From the slider to the crank each body's equations give the forces on it one after the other; no system is solved
(e.g. J. J. Uicker, G. R. Pennock, J. E. Shigley, "Theory of Machines and Mechanisms", 4th edition, 2011, chapter 15).
"""

from __future__ import annotations

from dataclasses import dataclass
from typing import Protocol

from ncgear.mechanisms.bodies import Bodies
from ncgear.mechanisms.masses import Masses
from ncgear.numerics.arrays import Array
from ncgear.numerics.jet import Jet
from ncgear.numerics.plane import Term, Vector
from ncgear.numerics.units import N_PER_KG_MM_S2


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


@dataclass(frozen=True, eq=False)
class JointForces:
    """What the joints bear, in N, of the kind that the pace gives (arrays of shape (n,) or jets).

    ``wrist`` acts on the slider, ``pin`` on the rod, ``crank_axis`` on the crank, as far as the linkage asks it of the
    bearings.  ``guide_n`` is the guide's force on the slider across its line; ``torque_n_mm`` is asked of the crank
    shaft, in the sense in which the crank turns.
    """

    wrist: Vector
    pin: Vector
    crank_axis: Vector
    guide_n: Term
    torque_n_mm: Term


def joint_forces(at: Bodies, masses: Masses, pace: Pace, resistance_n: Term) -> JointForces:
    """Forces that a motion needs against a resistance in N on the slider along -x, and against its weight."""
    rod_center, crank_center = at.on_rod(masses.rod_center_mm), at.on_crank(masses.crank_center_mm)
    slider = _moved(masses, pace, masses.slider_kg, at.wrist)
    rod = _moved(masses, pace, masses.rod_kg, rod_center)
    crank = _moved(masses, pace, masses.crank_kg, crank_center)
    along = slider.x + resistance_n
    # Moments about the crank pin; the wrist's force on the rod is minus the one on the slider
    arm = place(pace, at.wrist - at.pin)
    turned = pace.second(at.rod_angle) * (N_PER_KG_MM_S2 * masses.rod_inertia_kg_mm2)
    turned = turned + place(pace, rod_center - at.pin).cross(rod)
    wrist = Vector(along, (arm.y * along - turned) / arm.x)
    pin = rod + wrist
    # Counter-clockwise moments are against the crank's turning
    weight = place(pace, crank_center).cross(_weight(masses, masses.crank_kg))
    shaft = pace.second(at.crank_angle) * (N_PER_KG_MM_S2 * masses.crank_shaft_kg_mm2)
    torque = shaft + weight - place(pace, at.pin).cross(pin)
    return JointForces(wrist, pin, crank + pin, slider.y - wrist.y, torque)


def _moved(masses: Masses, pace: Pace, mass_kg: float, center: Vector) -> Vector:
    """The force in N that moves a mass so, besides its weight."""
    return acceleration(pace, center) * (N_PER_KG_MM_S2 * mass_kg) - _weight(masses, mass_kg)


def _weight(masses: Masses, mass_kg: float) -> Vector:
    x, y = masses.gravity_m_s2
    return Vector(mass_kg * x, mass_kg * y)
