"""Forces in the joints of a mechanism for a given motion: the equations of Newton and Euler that all mechanisms share.

From the slider to the crank, the equations of each body give the forces on it, one body after the other; no system is
solved (e.g.  J. J. Uicker, G. R. Pennock, J. E. Shigley, "Theory of Machines and Mechanisms", 4th edition, 2011,
chapter 15).  A mechanism states the equations of its own bodies.  This module has the rest: how places become
accelerations (``Pace``), the force that moves a mass, the equations of the crank, and the masses that turn with crank
and driving shaft.

Masses are in kg, lengths in mm, moments of inertia in kg mm^2. Every mechanism has a crank and two gears, and most have
a slider.  A mechanism's module has the class of its own masses.  The masses of a connecting rod, ``RodMasses``, are
here: several mechanisms may have a rod.
"""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from typing import Protocol

from ncgear.frozen import dataclass
from ncgear.numerics.arrays import Array
from ncgear.numerics.jet import Jet
from ncgear.numerics.plane import Term, Vector
from ncgear.numerics.units import N_PER_KG_MM_S2


@dataclass(frozen=True)
class SliderMass:
    """The mass of the slider, with everything that moves with it."""

    slider_kg: float = 0.0


@dataclass(frozen=True)
class RodMass:
    """The connecting rod.

    Its centre of mass lies ``rod_center_mm`` from the crank pin towards the slider; its moment of inertia is about this
    centre.
    """

    rod_kg: float = 0.0
    rod_center_mm: float = 0.0
    rod_inertia_kg_mm2: float = 0.0


@dataclass(frozen=True)
class ShaftMasses:
    """The masses that turn with the crank and with the driving shaft, and gravity.

    The crank's centre of mass lies ``crank_center_mm`` from its axis towards the pin.  ``crank_inertia_kg_mm2`` is
    about the axis and includes everything that turns with the crank except the driven gear.  ``gravity_m_s2`` has its
    components along and across the slider's line, in the frame of the mechanism.  ``between_inertia_kg_mm2`` are
    the inertias of the shafts between pairs of gears in series, with their gears, from the driving shaft on.
    """

    crank_kg: float = 0.0
    crank_center_mm: float = 0.0
    crank_inertia_kg_mm2: float = 0.0
    driven_inertia_kg_mm2: float = 0.0
    driving_inertia_kg_mm2: float = 0.0
    flywheel_inertia_kg_mm2: float = 0.0
    gravity_m_s2: tuple[float, float] = (0.0, 0.0)
    between_inertia_kg_mm2: tuple[float, ...] = ()

    @property
    def crank_shaft_kg_mm2(self) -> float:
        """Moment of inertia of everything that turns with the crank, about its axis."""
        return self.crank_inertia_kg_mm2 + self.driven_inertia_kg_mm2

    @property
    def driving_shaft_kg_mm2(self) -> float:
        """Moment of inertia of everything that turns with the driving gear, about its axis."""
        return self.driving_inertia_kg_mm2 + self.flywheel_inertia_kg_mm2


@dataclass(frozen=True)
class Masses(ShaftMasses, SliderMass):
    """The masses that every mechanism has; the slider's mass is 0 where the output turns."""


# Fields come from the last base to the first, so the rod's fields stand between the slider's and the crank's.
@dataclass(frozen=True)
class RodMasses(Masses, RodMass, SliderMass):
    """The masses of a mechanism with a slider that a connecting rod moves."""


class Pace(Protocol):
    """How places and angles, given as jets, change with time."""

    def now(self, quantity: Jet) -> Term:
        """The quantity itself."""

    def second(self, quantity: Jet) -> Term:
        """Its second derivative by time, in its unit per s^2, of the kind that ``now`` gives."""


@dataclass(frozen=True)
class EvenPace:
    """Jets by the driving angle, which grows at a constant speed in rad/s; the results have two orders less."""

    speed_rad_s: float

    def now(self, quantity: Jet) -> Jet:
        """The jet at the order of ``second``."""
        return quantity.truncated(quantity.order - 2)

    def second(self, quantity: Jet) -> Jet:
        """w^2 d2/dphi1^2."""
        return quantity.differentiated().differentiated() * self.speed_rad_s**2


@dataclass(frozen=True, eq=False)
class CrankPace:
    """Jets of order 2 or more by the crank's angle, with its speed and acceleration of shape (n,); gives arrays."""

    speed_rad_s: Array
    acceleration_rad_s2: Array

    def now(self, quantity: Jet) -> Array:
        """The values."""
        return quantity.value

    def second(self, quantity: Jet) -> Array:
        """q'^2 d2/dq^2 + q'' d/dq."""
        return quantity.derivative(2) * self.speed_rad_s**2 + quantity.derivative(1) * self.acceleration_rad_s2


@dataclass(frozen=True, eq=False)
class JointForces:
    """The forces in the joints in N, as arrays of shape (n,) or jets, depending on the pace.

    ``joints`` maps the mechanism's names of its joints to the forces in them, each on the body nearer to the slider.
    ``crank_axis`` is the force that bearings and driven gear together exert on the crank.  ``guide_n`` is the guide's
    force on the slider across its line; ``torque_n_mm`` is the torque that the crank shaft needs, positive in the
    direction in which the crank turns.
    """

    joints: Mapping[str, Vector]
    crank_axis: Vector
    guide_n: Term
    torque_n_mm: Term


def place(pace: Pace, point: Vector) -> Vector:
    """A point in mm, as arrays or jets, depending on the pace."""
    return Vector(pace.now(point.x), pace.now(point.y))


def moving_force(masses: Masses, pace: Pace, mass_kg: float, center: Vector) -> Vector:
    """The force in N that a mass needs, besides its weight, to move along the path of its centre."""
    acceleration = Vector(pace.second(center.x), pace.second(center.y))
    return acceleration * (N_PER_KG_MM_S2 * mass_kg) - _weight(masses, mass_kg)


def _weight(masses: Masses, mass_kg: float) -> Vector:
    x, y = masses.gravity_m_s2
    return Vector(mass_kg * x, mass_kg * y)


@dataclass(frozen=True, eq=False)
class CrankBody:
    """The crank at n angles: its angle, its pin and its centre of mass, as jets; lengths in mm."""

    angle: Jet
    pin: Vector
    center: Vector


def crank_forces(crank: CrankBody, masses: Masses, pace: Pace, pin: Vector) -> tuple[Vector, Term]:
    """The bearings' force on the crank in N and the torque on its shaft in N mm; ``pin`` is the force on its pin."""
    moving = moving_force(masses, pace, masses.crank_kg, crank.center)
    # Counter-clockwise moments are against the crank's turning
    weight = place(pace, crank.center).cross(_weight(masses, masses.crank_kg))
    shaft = pace.second(crank.angle) * (N_PER_KG_MM_S2 * masses.crank_shaft_kg_mm2)
    return moving + pin, shaft + weight - place(pace, crank.pin).cross(pin)


class Mass(Protocol):
    """A mass in kg whose centre's coordinates in mm are jets."""

    @property
    def mass_kg(self) -> float:
        """The mass in kg."""

    @property
    def center(self) -> Vector:
        """The place of the centre of mass."""


def shaking_force(moving: Sequence[Mass], crank: CrankBody, masses: Masses, pace: Pace) -> Vector:
    """The force in N of moving masses on the frame, -d/dt sum m v; weights and resistance do not contribute.

    ``moving`` are all masses except the crank's.  J. J. Uicker, G. R. Pennock, J. E. Shigley, "Theory of Machines and
    Mechanisms", 4th edition, 2011, chapter 17.
    """
    along, across = crank.center.x * masses.crank_kg, crank.center.y * masses.crank_kg
    for body in moving:
        along, across = along + body.center.x * body.mass_kg, across + body.center.y * body.mass_kg
    return Vector(pace.second(along), pace.second(across)) * -N_PER_KG_MM_S2
