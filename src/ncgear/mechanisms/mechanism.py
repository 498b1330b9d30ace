"""The contract of a mechanism on the driven shaft: everything that the rest of ncgear asks of it.

A crank turns with the driven gear and moves a slider to and fro along a line.  Frame and pose: the crank's axis is at
the origin, the crank turns clockwise, the slider moves along +x at y = ``offset_mm``.  The crank angle is counted from
the retracted dead centre in the direction of turning, the displacement from the retracted end.  One turn of the crank
is one working stroke (retracted to extended) and one return.

A mechanism is a frozen dataclass whose fields are its lengths, named like their keys under ``linkage`` in design
files.  Its formulas (``Mechanisms``) hold for one mechanism and for many at once.  A new mechanism is a class in a
module of its own, models of its keys and masses, one line in ``ncgear.design.mechanisms`` and one in
``ncgear.formulas.linkages``; ``mechanisms.scotch_yoke`` is the shortest.
"""

from __future__ import annotations

from abc import ABC, abstractmethod
from collections.abc import Mapping
from math import degrees, pi
from typing import TYPE_CHECKING, Any, ClassVar, Generic, NamedTuple, Self

import numpy as np

from ncgear.errors import WrongInput
from ncgear.frozen import dataclass
from ncgear.mechanisms.forces import CrankBody, JointForces, Masses, Pace, RodMasses
from ncgear.numerics import jet
from ncgear.numerics.arrays import Array, Mask, Number
from ncgear.numerics.jet import Jet
from ncgear.numerics.plane import Term, Vector
from ncgear.numerics.units import N_M_PER_N_MM

Point = tuple[float, float]


class Unit(NamedTuple):
    """A unit in which people read a quantity: the end of its keys, its text, and its number per unit of the code."""

    ending: str
    text: str
    factor: float = 1.0


@dataclass(frozen=True)
class Output:
    """The output of a mechanism: its name in messages and tables, and whether it turns.

    A sliding output has places in mm, loads in N and masses in kg.  A turning output has places in rad, loads in N mm
    and moments of inertia in kg mm^2.  Formulas are the same for both: load times speed over 1000 is the power in W.
    Names of the contract end in the units of a sliding output.
    """

    name: str
    angular: bool = False

    @property
    def place(self) -> Unit:
        """The unit of places and distances: mm, or deg."""
        return Unit("deg", "deg", degrees(1.0)) if self.angular else Unit("mm", "mm")

    @property
    def speed(self) -> Unit:
        """The unit of speeds: mm/s, or rad/s."""
        return Unit("rad_s", "rad/s") if self.angular else Unit("mm_s", "mm/s")

    @property
    def acceleration(self) -> Unit:
        """The unit of accelerations: mm/s2, or rad/s2."""
        return Unit("rad_s2", "rad/s2") if self.angular else Unit("mm_s2", "mm/s2")

    @property
    def load(self) -> Unit:
        """The unit of loads: N, or N m."""
        return Unit("n_m", "N m", N_M_PER_N_MM) if self.angular else Unit("n", "N")

    @property
    def load_name(self) -> str:
        """The name of the load: force or torque."""
        return "torque" if self.angular else "force"


SLIDER = Output("slider")


@dataclass(frozen=True, eq=False)
class Link:
    """The pose of a rigid body at n crank angles: the origin of its own frame in mm, and its angle in rad."""

    origin: Vector
    angle: Jet


@dataclass(frozen=True, eq=False)
class MovingMass:
    """A body with mass at n crank angles: its centre in mm and its angle in rad, as jets; inertia about the centre."""

    mass_kg: float
    center: Vector
    angle: Jet
    inertia_kg_mm2: float = 0.0


@dataclass(frozen=True)
class LinkShape:
    """How a link is drawn in its own frame, in mm.

    Each bar lies along a line from point to point; eyes are about pins.  A block slides along each slot, which also is
    a line from point to point, with walls around it.  ``areas`` are closed outlines.
    """

    bars: tuple[tuple[Point, Point], ...] = ()
    eyes: tuple[Point, ...] = ()
    slots: tuple[tuple[Point, Point], ...] = ()
    areas: tuple[tuple[Point, ...], ...] = ()


class Mechanisms(ABC, Generic[Number]):
    """Quantities that follow from the lengths of one mechanism, or of n of a kind where lengths have shape (n,)."""

    if TYPE_CHECKING:

        @property
        def crank_mm(self) -> Number:
            """Distance from the crank's axis to its pin."""

    @property
    def turns_fully(self) -> Mask:
        """Whether the crank can turn fully; without a full turn there is no mechanism."""
        return np.asarray(self.crank_mm > 0.0)

    @property
    @abstractmethod
    def stroke_mm(self) -> Number:
        """Distance between the dead centres."""

    @property
    @abstractmethod
    def nearest_mm(self) -> Number:
        """Place of the retracted slider along its line, from the crank axis."""

    @property
    def farthest_mm(self) -> Number:
        """Place of the extended slider along its line, from the crank axis."""
        return self.nearest_mm + self.stroke_mm

    @property
    @abstractmethod
    def working_angle_rad(self) -> Number:
        """Crank angle from the retracted to the extended dead centre."""

    @abstractmethod
    def displacement(self, crank_angle: Jet) -> Jet:
        """Slider displacement in mm, with derivatives, at a crank angle in rad; relatively accurate near both zeros."""

    @property
    def half_way(self) -> Number:
        """A size in mm or rad, about half the stroke; optimization programmes count the output's travel in it."""
        return self.crank_mm

    @abstractmethod
    def working_angle(self, displacement_mm: Array, remaining_mm: Array) -> Array:
        """Crank angle in rad in the working stroke, at displacements x and at (stroke - x), both of shape (n,)."""

    @abstractmethod
    def regular_slope(self, displacement: Jet, root: Jet) -> Jet:
        """The slope of the crank angle by the displacement x, times a smooth root of x (stroke - x), with derivatives.

        The product is regular up to and including both dead centres.  There x (stroke - x) has double zeros, but its
        root is a smooth function of the driving angle, of either sign.
        """


class Mechanism(Mechanisms[float]):
    """One mechanism: its motion there and back, its bodies, and the forces between them."""

    NAME: ClassVar[str]
    """Its name in messages, with the article: "a crank-slider"."""

    OUTPUT: ClassVar[Output] = SLIDER
    """Its output."""

    RETURNS: ClassVar[bool] = True
    """Whether the output comes back by itself as the driven shaft turns on.

    Where it does not, all of its travel is its working stroke, and it has no dead centres."""

    UNIFORM: ClassVar[str] = "uniform crank"
    """Name of the mechanism where its driven shaft turns evenly."""

    CRANK: ClassVar[str] = "crank"
    """The body on the driven shaft, in the names of bearings and moments of inertia."""

    HAS_CRANK: ClassVar[bool] = True
    """Whether the driven shaft carries a body beside the gear whose mass and centre a design file gives."""

    GUIDED: ClassVar[bool] = True
    """Whether a guide carries its output."""

    STROKE_KEY: ClassVar[str] = "crank_mm"
    """The key of the length that follows where a law gives the stroke."""

    POINTS: ClassVar[tuple[str, ...]] = ("slider",)
    """Bodies that do not turn and whose masses a design file gives by ``masses.NAME_kg``."""

    RODS: ClassVar[tuple[str, ...]] = ()
    """Bodies that turn, except the crank, and whose masses a design file gives, by their keys under ``masses``."""

    MASSES: ClassVar[type[Masses]] = Masses
    """The class of its masses."""

    JOINTS: ClassVar[Mapping[str, str]]
    """Its joints from the slider to the crank: the names in tables, with the words for pictures and figures."""

    PINS: ClassVar[Mapping[str, str]] = {}
    """Pins that are drawn: the name of each, and the link with its origin at the pin."""

    PISTON: ClassVar[bool] = True
    """Whether the output is drawn as a piston in a guide along its line, with the material that it works against."""

    offset_mm: float = 0.0
    """Distance of the slider's line from the crank's axis."""

    @classmethod
    def many(cls, **lengths: Array) -> Mechanisms[Array]:
        """Many mechanisms of this kind, whether or not their cranks turn fully; lengths of shape (n,)."""
        made: Any = cls
        return made(**lengths)

    @classmethod
    @abstractmethod
    def of_stroke(cls, stroke_mm: float, **lengths: float) -> Self:
        """The mechanism whose dead centres are a stroke apart; ``lengths`` are all lengths except ``STROKE_KEY``.

        Raises WrongInput where no crank gives that stroke.
        """

    @property
    def corners(self) -> tuple[tuple[float, float], ...]:
        """Crank angles, 0 to 2 pi, at which the displacement bends sharply, and the width of each bend.

        The width is the distance in crank angle to the nearest singularity in the complex plane.
        """
        return ()

    @abstractmethod
    def crank_angle(self, displacement_mm: Array, returning: Mask) -> Array:
        """Crank angles in rad, 0 to 2 pi, at displacements in [0, stroke], both of shape (n,)."""

    @property
    def crank_start_rad(self) -> float:
        """Direction from the crank's axis to its pin at the retracted dead centre, counter-clockwise from +x."""
        return pi

    def crank_body(self, crank_angle: Jet, center_mm: float) -> CrankBody:
        """The crank with its centre of mass ``center_mm`` from its axis towards the pin."""
        sine, cosine = jet.sin_cos(self.crank_start_rad - crank_angle)
        pin = Vector(self.crank_mm * cosine, self.crank_mm * sine)
        return CrankBody(crank_angle, pin, pin * (center_mm / self.crank_mm))

    def crank_link(self, crank_angle: Jet) -> Link:
        """The crank; its own frame has the crank's axis at the origin and the pin on +x."""
        still = 0.0 * crank_angle
        return Link(Vector(still, still), self.crank_start_rad - crank_angle)

    @abstractmethod
    def links(self, crank_angle: Jet) -> Mapping[str, Link]:
        """All bodies at crank angles in rad: the output by its name, ``crank`` next, the others from back to front.

        The frame of a sliding output does not turn; at the retracted dead centre its origin is at ``nearest_mm``.
        """

    def shapes(self) -> Mapping[str, LinkShape]:
        """How the links are drawn, except a plain crank, and except a sliding output that is a plain piston."""
        return {}

    def transmission_rad(self, crank_rad: Array) -> Array:
        """Transmission angles, 0 to pi/2, at crank angles in rad (n,), between pushing link and normal of the path.

        They are least at a dead centre or at one of the ``corners``, and pi/2 where the push is along the output's
        path.
        """
        return np.full_like(crank_rad, 0.5 * pi)

    def least_transmission(self, end_rad: float = 2.0 * pi) -> tuple[float, float]:
        """The least transmission angle in rad from crank angle 0 to an end in rad, and its crank angle."""
        places = [0.0, self.working_angle_rad, *(place for place, _ in self.corners), end_rad]
        crank = np.array([place for place in places if place <= end_rad])
        angles = self.transmission_rad(crank)
        least = int(np.argmin(angles))
        return float(angles[least]), float(crank[least])

    @property
    def rod_lines_mm(self) -> Mapping[str, tuple[tuple[Point, Point], ...]]:
        """The middle lines of each link that moves beside the gears, by its name, in its frame: from joint to joint."""
        return {}

    @property
    def discs_mm(self) -> Mapping[str, float]:
        """Radii of round bodies that turn about the crank's axis beside the gears, by their names."""
        return {}

    @property
    def pivots_mm(self) -> Mapping[str, Point]:
        """Fixed axes except the crank's, by the names of the links that turn about them."""
        return {}

    @property
    def guides_mm(self) -> tuple[tuple[Point, Point], ...]:
        """Straight fixed guides except a piston's, each from point to point with the frame on its left."""
        return ()

    @abstractmethod
    def moving_masses(self, crank_angle: Jet, masses: Masses) -> tuple[MovingMass, ...]:
        """All masses but the crank's at crank angles in rad, with as many derivatives; ``masses`` are of ``MASSES``."""

    @abstractmethod
    def joint_forces(self, crank_angle: Jet, masses: Masses, pace: Pace, resistance_n: Term) -> JointForces:
        """Forces that a motion needs against the weights and a resistance in N that acts on the slider along -x.

        On a turning output, the resistance is a torque in N mm towards the retracted dead centre.  ``masses`` are of
        ``MASSES``.
        """


@dataclass(frozen=True, eq=False)
class Rod:
    """A connecting rod at n crank angles; its places in mm and its angle in rad are jets, as the crank's angle is.

    ``pin`` and ``wrist`` are its ends on the crank and on the slider; ``angle`` is counted from +x counter-clockwise.
    """

    length_mm: float
    pin: Vector
    wrist: Vector
    angle: Jet

    def at(self, distance_mm: float) -> Vector:
        """The point of the rod that lies ``distance_mm`` from the crank pin towards the slider."""
        return self.pin + (self.wrist - self.pin) * (distance_mm / self.length_mm)


class RodMechanism(Mechanism):
    """A mechanism with one rod from the crank's pin to its slider; the theory of balance holds for these only."""

    MASSES: ClassVar[type[Masses]] = RodMasses

    if TYPE_CHECKING:

        @property
        def rod_mm(self) -> float:
            """Distance from the crank pin to the wrist."""

    @abstractmethod
    def rod(self, crank_angle: Jet) -> Rod:
        """The rod at crank angles in rad, with as many derivatives."""


def require_rod(mechanism: Mechanism, what: str, key: str) -> RodMechanism:
    """The mechanism, if it has a rod; raises WrongInput for ``key`` where it has none."""
    if not isinstance(mechanism, RodMechanism):
        raise WrongInput(
            f"{mechanism.NAME}, and {what} is computed only where one rod moves the slider, as in a crank-slider",
            key=key,
        )
    return mechanism
