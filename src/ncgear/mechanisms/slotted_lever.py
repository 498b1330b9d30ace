"""The slotted lever: a block on the crank's pin slides along a swinging lever, whose far pin drives a ram (a shaper).

It is the oscillating form of Whitworth's quick return, in its simplest form: the lever's far pin engages a slot of the
ram across the ram's line, so that the ram has the lever pin's place along the line, without a link between them.

Frame and pose: the crank's axis O is at the origin and the crank turns clockwise; the lever's axis P is at (0, -d), and
the ram moves along +x above.  The lever swings by psi = asin(r/d) to both sides.  Its way out is the slow one: the
crank turns by pi + 2 asin(r/d), and by pi - 2 asin(r/d) on the way back (e.g.  R. L. Norton, "Design of Machinery", 5th
edition, 2012, section 3.6).

With chi the lever's angle from the retracted dead centre and l = sqrt(d^2 - r^2),

    tan(chi) = r (1 - cos(phi2)) / (l + r sin(phi2)),    x = L (sin(chi - psi) + sin(psi))
"""

from __future__ import annotations

from collections.abc import Mapping
from math import asin, cos, log, pi
from typing import Any, ClassVar, Self

import numpy as np

from ncgear.errors import WrongInput
from ncgear.frozen import dataclass
from ncgear.mechanisms.forces import JointForces, Masses, Pace, crank_forces, moving_force, place
from ncgear.mechanisms.mechanism import Link, LinkShape, Mechanism, Mechanisms, MovingMass, Output, Point
from ncgear.numerics import jet
from ncgear.numerics.arrays import Array, Mask, Number
from ncgear.numerics.jet import Jet
from ncgear.numerics.plane import Term, Vector
from ncgear.numerics.units import N_PER_KG_MM_S2

BAR = 1.35
"""Distance of the ram's origin from its slot in strokes, for drawings: its guide begins beyond the lever."""

PLAY = 0.2
"""Length of the slots beyond the travel of their pins, in lengths of the crank, for drawings."""


@dataclass(frozen=True)
class LeverMasses(Masses):
    """The masses of a slotted lever: the block on the crank pin, a point mass, and the lever.

    The lever's centre of mass lies ``lever_center_mm`` from its axis towards its pin; its inertia is about the axis.
    """

    block_kg: float = 0.0
    lever_kg: float = 0.0
    lever_center_mm: float = 0.0
    lever_inertia_kg_mm2: float = 0.0


@dataclass(frozen=True, eq=False)
class SlottedLevers(Mechanisms[Number]):
    """Quantities that follow from the lengths of one slotted lever, or of n of them where lengths have shape (n,)."""

    crank_mm: Number
    pivot_mm: Number
    lever_mm: Number

    @property
    def turns_fully(self) -> Mask:
        """True if the crank is shorter than the distance of the axes and the lever reaches beyond the block's way."""
        return np.asarray((self.crank_mm < self.pivot_mm) & (self.crank_mm + self.pivot_mm < self.lever_mm))

    @property
    def stroke_mm(self) -> Number:
        """2 L sin(psi)."""
        return 2.0 * self.lever_mm * self.crank_mm / self.pivot_mm

    @property
    def nearest_mm(self) -> Number:
        """Place of the retracted ram, which is drawn beyond the lever."""
        return (BAR - 0.5) * self.stroke_mm

    @property
    def working_angle_rad(self) -> Number:
        """pi + 2 psi."""
        return pi + 2.0 * self._swing_rad

    @property
    def _swing_rad(self) -> Number:
        """Angle psi of the lever's swing to either side."""
        return np.arcsin(self.crank_mm / self.pivot_mm)

    @property
    def _foot_mm(self) -> Number:
        """Distance l of the block from the lever's axis at the dead centres."""
        return np.sqrt((self.pivot_mm - self.crank_mm) * (self.pivot_mm + self.crank_mm))

    def _block(self, crank_angle: Jet) -> tuple[Jet, Jet, Jet]:
        """The block's distance from the lever's axis, and its products with the sine and the versine of chi, in mm.

        The product with the versine, distance less l + r sin(phi2), is computed in a form that does not cancel.
        """
        sine, versine = jet.sine_versine(crank_angle)
        across, along = versine * self.crank_mm, sine * self.crank_mm + self._foot_mm
        _, beside = jet.sin_cos((crank_angle - (0.5 * pi + self._swing_rad)) * 0.5)
        distance = jet.sqrt(
            beside * beside * (4.0 * self.crank_mm * self.pivot_mm) + (self.pivot_mm - self.crank_mm) ** 2
        )
        ahead = along.value >= 0.0
        rise = Jet(np.where(ahead, (across * across).coefficients, (distance - along).coefficients))
        one = 0.0 * across + 1.0
        run = Jet(np.where(ahead, (distance + along).coefficients, one.coefficients))
        return distance, across, rise / run

    def displacement(self, crank_angle: Jet) -> Jet:
        """The ram's displacement in mm, with derivatives, at a crank angle in rad; relatively accurate near both zeros.

        x = L (cos(psi) sin(chi) + sin(psi) (1 - cos(chi))), where no term is negative.
        """
        distance, sine, versine = self._block(crank_angle)
        foot, crank = self._foot_mm, self.crank_mm
        return (sine * foot + versine * crank) * (self.lever_mm / self.pivot_mm) / distance

    def working_angle(self, displacement_mm: Array, remaining_mm: Array) -> Array:
        """Crank angle in rad in the working stroke, at displacements and at (stroke - x), both of shape (n,).

        At the block, lever and crank make the angle pi - eta, and d sin(lever's angle) = r sin(eta); the crank has
        turned by chi + eta + pi/2, and tan^2((eta + pi/2)/2) = x/(stroke - x).
        """
        at_block = 2.0 * np.arctan2(np.sqrt(displacement_mm), np.sqrt(remaining_mm))
        return at_block + self._lever_angle(displacement_mm)

    def regular_slope(self, displacement: Jet, root: Jet) -> Jet:
        """1 + root/(l cos(lever's angle)) with l the lever's length: d chi/dx is the inverse of that product."""
        return root / (jet.sqrt(self._square_cosine(displacement)) * self.lever_mm) + 1.0

    def _square_cosine(self, displacement: Array | Jet) -> Any:
        """1 - sin^2 of the lever's angle, whose sine is x/l - r/d."""
        gone, share = displacement * (1.0 / self.lever_mm), self.crank_mm / self.pivot_mm
        return (1.0 + share - gone) * (gone + (1.0 - share))

    def _lever_angle(self, displacement_mm: Array) -> Array:
        """chi in rad at a displacement: tan(chi/2) = (sin + sin(psi))/(cos + cos(psi)) of the lever's angle."""
        cosine = np.sqrt(self._square_cosine(displacement_mm))
        return 2.0 * np.arctan(displacement_mm / self.lever_mm / (cosine + self._foot_mm / self.pivot_mm))


@dataclass(frozen=True)
class SlottedLever(SlottedLevers[float], Mechanism):
    """A slotted lever; raises WrongInput for lengths that are not positive or do not let the lever swing."""

    NAME: ClassVar[str] = "a slotted lever"
    OUTPUT: ClassVar[Output] = Output("ram")
    POINTS: ClassVar[tuple[str, ...]] = ("slider", "block")
    RODS: ClassVar[tuple[str, ...]] = ("lever",)
    MASSES: ClassVar[type[Masses]] = LeverMasses
    JOINTS: ClassVar[Mapping[str, str]] = {
        "ram_pin": "ram pin",
        "lever_bearing": "lever's bearing",
        "slot": "lever slot",
        "pin": "crank pin",
    }
    PINS: ClassVar[Mapping[str, str]] = {"crank-pin": "block", "ram-pin": "lever"}

    crank_mm: float
    pivot_mm: float
    lever_mm: float

    def __post_init__(self) -> None:
        for name in ("crank_mm", "pivot_mm", "lever_mm"):
            if not getattr(self, name) > 0.0:
                problem = f"{getattr(self, name):g} is not a length; a positive one is needed"
                raise WrongInput(problem, key=f"linkage.{name}")
        if not self.crank_mm < self.pivot_mm:
            raise WrongInput(
                f"the lever would turn round instead of swinging: its axis is {self.pivot_mm:g} mm from the crank's, "
                f"which must be over the crank's {self.crank_mm:g} mm",
                key="linkage.pivot_mm",
            )
        if not self.turns_fully:
            raise WrongInput(
                f"the block slides along the lever up to {self.crank_mm + self.pivot_mm:g} mm from its axis, and the "
                f"pin of the ram is {self.lever_mm:g} mm from it; a longer lever is needed",
                key="linkage.lever_mm",
            )

    @classmethod
    def many(cls, **lengths: Array) -> SlottedLevers[Array]:
        """Many slotted levers; ``turns_fully`` tells which of them are possible."""
        return SlottedLevers(**lengths)

    @classmethod
    def of_stroke(cls, stroke_mm: float, **lengths: float) -> Self:
        """The slotted lever with the crank stroke d / (2 L); raises WrongInput where the lever cannot swing."""
        crank = stroke_mm * lengths["pivot_mm"] / (2.0 * lengths["lever_mm"])
        if not 0.0 < crank < min(lengths["pivot_mm"], lengths["lever_mm"] - lengths["pivot_mm"]):
            raise WrongInput(
                f"a lever of {lengths['lever_mm']:g} mm cannot give the stroke of {stroke_mm:.6g} mm that follows from "
                "the law; a longer one can",
                key="linkage.lever_mm",
            )
        return cls(crank, **lengths)

    @property
    def offset_mm(self) -> float:  # type: ignore[override]
        """Height of the ram's line: it goes through the highest place of the lever's pin."""
        return self.lever_mm - self.pivot_mm

    def crank_angle(self, displacement_mm: Array, returning: Mask) -> Array:
        """Crank angle in rad, 0 to 2 pi, at displacements in [0, stroke], both of shape (n,)."""
        working = self.working_angle(displacement_mm, self.stroke_mm - displacement_mm)
        return np.where(returning, 2.0 * (pi + self._lever_angle(displacement_mm)) - working, working)

    @property
    def corners(self) -> tuple[tuple[float, float], ...]:
        """Crank angle with the block nearest to the lever's axis; the block is on the axis i ln(d/r) from there."""
        return ((1.5 * pi + self._swing_rad, log(self.pivot_mm / self.crank_mm)),)

    @property
    def crank_start_rad(self) -> float:
        """Direction of the crank across the lever."""
        return pi + asin(self.crank_mm / self.pivot_mm)

    def transmission_rad(self, crank_rad: Array) -> Array:
        """Angle between the path of the lever's pin and the ram's slot: the more the lever leans, the smaller it is."""
        return 0.5 * pi - np.abs(self._angle(Jet(crank_rad[None, :])).value - 0.5 * pi)

    @property
    def rod_lines_mm(self) -> Mapping[str, tuple[tuple[Point, Point], ...]]:
        """The lever from its far pin to its axis; the ram's slot over the travel of that pin, and its bar as drawn."""
        bar, sinks = -BAR * self.stroke_mm, self.lever_mm * (1.0 - cos(self._swing_rad))
        ram = ((bar, -sinks), (bar, 0.0)), ((bar, 0.0), (0.0, 0.0))
        return {"lever": (((0.0, 0.0), (self.lever_mm, 0.0)),), "ram": ram}

    @property
    def pivots_mm(self) -> Mapping[str, Point]:
        """The axis of the lever."""
        return {"lever": (0.0, -self.pivot_mm)}

    def links(self, crank_angle: Jet) -> Mapping[str, Link]:
        """Ram, crank, lever, and the block on the crank's pin, which turns with the lever.

        The lever's own frame has its origin at its far pin and its axis on +x.
        """
        pin = self.crank_body(crank_angle, 0.0).pin
        still, angle = 0.0 * crank_angle, self._angle(crank_angle)
        ram = Vector(self.displacement(crank_angle) + self.nearest_mm, still + self.offset_mm)
        return {
            "ram": Link(ram, still),
            "crank": self.crank_link(crank_angle),
            "lever": Link(self._on_lever(angle, self.lever_mm), angle + pi),
            "block": Link(pin, angle),
        }

    def _angle(self, crank_angle: Jet) -> Jet:
        """Direction of the lever from its axis, counter-clockwise from +x."""
        distance, sine, versine = self._block(crank_angle)
        # tan(chi/2) = sin(chi)/(1 + cos(chi)); the lever swings by less than half a turn
        chi = 2.0 * jet.arctan(sine / (2.0 * distance - versine))
        return (0.5 * pi + self._swing_rad) - chi

    def _on_lever(self, angle: Jet, distance_mm: float) -> Vector:
        """The point of the lever, by its direction, at a distance from its axis."""
        sine, cosine = jet.sin_cos(angle)
        return Vector(distance_mm * cosine, distance_mm * sine - self.pivot_mm)

    def shapes(self) -> Mapping[str, LinkShape]:
        """The ram with its slot and the bar to its guide; the lever with the slot of the block."""
        bar, play = -BAR * self.stroke_mm, PLAY * self.crank_mm
        sinks = self.lever_mm * (1.0 - cos(self._swing_rad)) + play
        away = self.lever_mm - (self.pivot_mm + self.crank_mm)
        slot = (max(away - play, 0.6 * away), 0.0), (self.lever_mm - (self.pivot_mm - self.crank_mm) + play, 0.0)
        return {
            "ram": LinkShape((((bar, 0.0), (0.0, 0.0)),), slots=(((bar, -sinks), (bar, play)),)),
            "lever": LinkShape(
                (((0.0, 0.0), slot[0]), (slot[1], (self.lever_mm, 0.0))), ((0.0, 0.0), (self.lever_mm, 0.0)), (slot,)
            ),
            "block": LinkShape(eyes=((0.0, 0.0),)),
        }

    def moving_masses(self, crank_angle: Jet, masses: Masses) -> tuple[MovingMass, ...]:
        """Ram, lever and block."""
        assert isinstance(masses, LeverMasses)
        links = self.links(crank_angle)
        angle = links["block"].angle
        own = masses.lever_inertia_kg_mm2 - masses.lever_kg * masses.lever_center_mm**2
        return (
            MovingMass(masses.slider_kg, links["ram"].origin, links["ram"].angle),
            MovingMass(masses.lever_kg, self._on_lever(angle, masses.lever_center_mm), angle, own),
            MovingMass(masses.block_kg, links["block"].origin, angle),
        )

    def joint_forces(self, crank_angle: Jet, masses: Masses, pace: Pace, resistance_n: Term) -> JointForces:
        """Forces from the equations of ram, lever, block and crank, one after the other.

        The force at the ram's pin acts on the ram along its line.  The forces of bearing and slot act on the lever, the
        slot's across it.  The force at the crank pin acts on the block.
        """
        assert isinstance(masses, LeverMasses)
        ram, lever, block = self.moving_masses(crank_angle, masses)
        crank = self.crank_body(crank_angle, masses.crank_center_mm)
        still = 0.0 * crank_angle
        axis = Vector(still, still - self.pivot_mm)
        slides, swings, moves = (moving_force(masses, pace, body.mass_kg, body.center) for body in (ram, lever, block))
        ram_pin = Vector(slides.x + resistance_n, 0.0 * slides.x)
        sine, cosine = (pace.now(component) for component in jet.sin_cos(lever.angle))
        turned = pace.second(lever.angle) * (N_PER_KG_MM_S2 * lever.inertia_kg_mm2)
        turned = turned + place(pace, lever.center - axis).cross(swings)
        turned = turned + place(pace, self._on_lever(lever.angle, self.lever_mm) - axis).cross(ram_pin)
        push = turned * (1.0 / pace.now(self._block(crank_angle)[0]))
        slot = Vector(0.0 - push * sine, push * cosine)
        pin = moves + slot
        crank_axis, torque = crank_forces(crank, masses, pace, pin)
        joints = {"ram_pin": ram_pin, "lever_bearing": swings + ram_pin - slot, "slot": slot, "pin": pin}
        return JointForces(joints, crank_axis, slides.y, torque)
