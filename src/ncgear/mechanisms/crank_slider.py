"""The crank-slider: a crank, a connecting rod, and a slider that moves along a line, in line with the crank or offset.

With an offset the two strokes take different angles: a positive offset makes the working stroke (retracted to
extended) take more than pi.  ``mechanisms.mechanism`` describes frame and pose.
"""

from __future__ import annotations

from collections.abc import Mapping
from math import acosh, asin, pi, sqrt
from typing import ClassVar, Self

import numpy as np

from ncgear.errors import WrongInput
from ncgear.frozen import dataclass
from ncgear.mechanisms.forces import JointForces, Masses, Pace, RodMasses, crank_forces, moving_force, place
from ncgear.mechanisms.mechanism import Link, LinkShape, Mechanisms, MovingMass, Point, Rod, RodMechanism
from ncgear.numerics import jet
from ncgear.numerics.arrays import Array, Mask, Number
from ncgear.numerics.bounds import shown_above
from ncgear.numerics.jet import Jet
from ncgear.numerics.plane import Term, Vector
from ncgear.numerics.units import N_PER_KG_MM_S2


@dataclass(frozen=True, eq=False)
class CrankSliders(Mechanisms[Number]):
    """Quantities that follow from the lengths of one crank-slider, or of n of them where lengths have shape (n,)."""

    crank_mm: Number
    rod_mm: Number
    offset_mm: Number

    @property
    def turns_fully(self) -> Mask:
        """True where rod - crank > |offset|."""
        return self.rod_mm - self.crank_mm > np.abs(self.offset_mm)

    @property
    def nearest_mm(self) -> Number:
        """Distance along the slider's line from the crank axis to the retracted slider."""
        return _leg(self.rod_mm - self.crank_mm, self.offset_mm)

    @property
    def farthest_mm(self) -> Number:
        """Distance along the slider's line from the crank axis to the extended slider."""
        return _leg(self.rod_mm + self.crank_mm, self.offset_mm)

    @property
    def stroke_mm(self) -> Number:
        """Distance between the dead centres, (far^2 - near^2) / (far + near): this form is free of cancellation."""
        return 4.0 * self.crank_mm * self.rod_mm / (self.farthest_mm + self.nearest_mm)

    @property
    def working_angle_rad(self) -> Number:
        """Crank angle from the retracted to the extended dead centre; pi without offset."""
        tilt: Number = np.arcsin(self.offset_mm / (self.rod_mm + self.crank_mm))
        return pi + self._retracted_tilt_rad - tilt

    @property
    def _retracted_tilt_rad(self) -> Number:
        """Angle at the crank axis between the slider's line and the retracted slider."""
        return np.arcsin(self.offset_mm / (self.rod_mm - self.crank_mm))

    def displacement(self, crank_angle: Jet) -> Jet:
        """Slider displacement in mm, with derivatives, at a crank angle in rad; relatively accurate near both zeros.

        The vector loop gives x = pin advance + rod gain, which cancel to second order at the dead centre.  Multiplying
        out (rod gain)(rod gain + 2 rod start) gives x y = 2 l2 (l3 - l2) (1 - cos phi2), where y = rod now + rod start
        - pin advance and rod lengths are the rod's projections on the slider's line.  The larger of x and y is free of
        cancellation; y is the larger, except where the rod is hardly longer than the crank.
        """
        sine, versine = jet.sine_versine(crank_angle)
        reach = self.rod_mm - self.crank_mm
        along = self.crank_mm * self.nearest_mm / reach
        across = self.crank_mm * self.offset_mm / reach
        pin_advance, lateral = along * versine, along * sine
        if np.any(self.offset_mm):
            pin_advance = pin_advance - across * sine
            lateral = lateral + across * versine - self.rod_mm * self.offset_mm / reach
        rod_start = self.rod_mm * self.nearest_mm / reach
        rod_now = jet.sqrt(self.rod_mm**2 - lateral * lateral)
        product = 2.0 * self.crank_mm * reach * versine / (rod_now + rod_start - pin_advance)
        larger = pin_advance.value > rod_start
        if not larger.any():
            return product
        direct = rod_now - rod_start + pin_advance
        return Jet(np.where(larger, direct.coefficients, product.coefficients))

    def working_angle(self, displacement_mm: Array, remaining_mm: Array) -> Array:
        """Crank angle in rad in the working stroke, at displacements and at (stroke - x), both of shape (n,).

        In line, tan^2(phi2/2) = x (x + 2 l3) / ((H - x)(x + 2 (l3 - l2))); with an offset the triangle of crank, rod
        and the distance from crank axis to slider takes the place of the line.
        """
        position = displacement_mm + self.nearest_mm
        distance = np.hypot(position, self.offset_mm)
        ratio = (position + self.nearest_mm) / (position + self.farthest_mm)
        stretch = (distance + (self.rod_mm + self.crank_mm)) / (distance + (self.rod_mm - self.crank_mm))
        tilt = np.arctan(displacement_mm * self.offset_mm / (position * self.nearest_mm + self.offset_mm**2))
        return 2.0 * np.arctan2(np.sqrt(displacement_mm * ratio) * stretch, np.sqrt(remaining_mm)) + tilt

    def regular_slope(self, displacement: Jet, root: Jet) -> Jet:
        """p (d^2 + l3^2 - l2^2)/(d^2 ((p + near)(p + far))^(1/2)) + e root/d^2, with p the place and d^2 = p^2 + e^2.

        The first term is from the law of cosines in the triangle of crank, rod and d, whose area has the root in it;
        the second one is from the turning of d.
        """
        position, longer = displacement + self.nearest_mm, self.rod_mm**2 - self.crank_mm**2
        square = position * position
        ends = jet.sqrt((position + self.nearest_mm) * (position + self.farthest_mm))
        if not np.any(self.offset_mm):
            return (square + longer) / (position * ends)
        square = square + self.offset_mm**2
        return (position * (square + longer) / ends + root * self.offset_mm) / square


@dataclass(frozen=True)
class CrankSlider(CrankSliders[float], RodMechanism):
    """An in-line (``offset_mm`` = 0) or offset crank-slider whose crank can turn fully: rod - crank > |offset|.

    Raises WrongInput for lengths that are not positive or whose crank cannot turn fully.
    """

    NAME: ClassVar[str] = "a crank-slider"
    RODS: ClassVar[tuple[str, ...]] = ("rod",)
    JOINTS: ClassVar[Mapping[str, str]] = {"wrist": "wrist", "pin": "crank pin"}
    PINS: ClassVar[Mapping[str, str]] = {"crank-pin": "rod", "slider-pin": "slider"}

    crank_mm: float
    rod_mm: float
    offset_mm: float = 0.0

    def __post_init__(self) -> None:
        if not self.crank_mm > 0.0:
            raise WrongInput(f"{self.crank_mm:g} is not a length; a positive one is needed", key="linkage.crank_mm")
        if not self.turns_fully:
            raise WrongInput(
                f"the crank cannot turn fully: rod - crank = {self.rod_mm - self.crank_mm:g} mm, and it must exceed "
                f"the offset of {abs(self.offset_mm):g} mm; a rod over "
                f"{shown_above(self.crank_mm + abs(self.offset_mm))} mm works",
                key="linkage.rod_mm",
            )

    @classmethod
    def many(cls, **lengths: Array) -> CrankSliders[Array]:
        """Many crank-sliders; ``turns_fully`` tells which of them are possible."""
        return CrankSliders(**lengths)

    @classmethod
    def of_stroke(cls, stroke_mm: float, **lengths: float) -> Self:
        """The crank-slider with given rod and offset whose dead centres are a stroke apart.

        From far - near = H, far^2 - near^2 = 4 l2 l3 and far^2 + near^2 = 2 (l2^2 + l3^2 - e^2), with near and far the
        slider's distances at the dead centres.  Raises WrongInput where the rod is too short.
        """
        rod, offset = lengths["rod_mm"], lengths["offset_mm"]
        longest = (rod - abs(offset)) * (1.0 - 1e-9)
        if not 0.0 < stroke_mm < cls(longest, rod, offset).stroke_mm:
            raise WrongInput(
                f"a rod of {rod:g} mm cannot give the stroke of {stroke_mm:.6g} mm that follows from the law",
                key="linkage.rod_mm",
            )
        square = stroke_mm**2
        crank = stroke_mm / 2.0 * sqrt((4.0 * (rod**2 - offset**2) - square) / (4.0 * rod**2 - square))
        return cls(crank, rod, offset)

    def crank_angle(self, displacement_mm: Array, returning: Mask) -> Array:
        """Crank angle in rad, 0 to 2 pi, at displacements in [0, stroke], both of shape (n,)."""
        working = self.working_angle(displacement_mm, self.stroke_mm - displacement_mm)
        position = displacement_mm + self.nearest_mm
        tilt = np.arctan(displacement_mm * self.offset_mm / (position * self.nearest_mm + self.offset_mm**2))
        return np.where(returning, 2.0 * pi - working + 2.0 * tilt, working)

    @property
    def corners(self) -> tuple[tuple[float, float], ...]:
        """Crank angles, 0 to 2 pi, at which the rod is steepest, and the width of the bend of the displacement there.

        The rod's projection has zeros where crank sin(theta) = offset +- rod, that is at theta = +-pi/2 + i y with cosh
        y = (rod +- offset)/crank.  The displacement is analytic up to these zeros, so it has no feature narrower than
        y.
        """
        square = 1.5 * pi + self._retracted_tilt_rad, 0.5 * pi + self._retracted_tilt_rad
        reach = self.rod_mm - self.offset_mm, self.rod_mm + self.offset_mm
        return tuple(
            (float(angle % (2.0 * pi)), acosh(length / self.crank_mm))
            for angle, length in zip(square, reach, strict=True)
        )

    @property
    def crank_start_rad(self) -> float:
        """Direction opposite to the direction of the retracted slider."""
        return pi + asin(self.offset_mm / (self.rod_mm - self.crank_mm))

    def rod(self, crank_angle: Jet) -> Rod:
        """The rod at crank angles in rad, with as many derivatives."""
        pin = self.crank_body(crank_angle, 0.0).pin
        wrist = Vector(self.displacement(crank_angle) + self.nearest_mm, 0.0 * crank_angle + self.offset_mm)
        along = wrist - pin
        # The rod is never perpendicular to the slider's line: it is longer than the crank and the offset together.
        return Rod(self.rod_mm, pin, wrist, jet.arctan(along.y / along.x))

    def links(self, crank_angle: Jet) -> Mapping[str, Link]:
        """Slider, crank and rod; the rod's own frame has the crank pin at its origin and the slider on +x."""
        rod = self.rod(crank_angle)
        return {
            "slider": Link(rod.wrist, 0.0 * crank_angle),
            "crank": self.crank_link(crank_angle),
            "rod": Link(rod.pin, rod.angle),
        }

    def transmission_rad(self, crank_rad: Array) -> Array:
        """Angle between the rod and the direction across the slider's line."""
        return 0.5 * pi - np.abs(self.rod(Jet(crank_rad[None, :])).angle.value)

    @property
    def rod_lines_mm(self) -> Mapping[str, tuple[tuple[Point, Point], ...]]:
        """The rod's line from the crank pin to the wrist."""
        return {"rod": (((0.0, 0.0), (self.rod_mm, 0.0)),)}

    def shapes(self) -> Mapping[str, LinkShape]:
        """The rod with an eye at each end."""
        bars = self.rod_lines_mm["rod"]
        return {"rod": LinkShape(bars, bars[0])}

    def moving_masses(self, crank_angle: Jet, masses: Masses) -> tuple[MovingMass, ...]:
        """Slider and rod."""
        assert isinstance(masses, RodMasses)
        rod = self.rod(crank_angle)
        return (
            MovingMass(masses.slider_kg, rod.wrist, 0.0 * crank_angle),
            MovingMass(masses.rod_kg, rod.at(masses.rod_center_mm), rod.angle, masses.rod_inertia_kg_mm2),
        )

    def joint_forces(self, crank_angle: Jet, masses: Masses, pace: Pace, resistance_n: Term) -> JointForces:
        """Forces at wrist and crank pin from the equations of slider, rod and crank, one after the other.

        The force at the wrist acts on the slider, the force at the pin on the rod.
        """
        assert isinstance(masses, RodMasses)
        crank, at = self.crank_body(crank_angle, masses.crank_center_mm), self.rod(crank_angle)
        center = at.at(masses.rod_center_mm)
        slider = moving_force(masses, pace, masses.slider_kg, at.wrist)
        rod = moving_force(masses, pace, masses.rod_kg, center)
        along = slider.x + resistance_n
        # Moments about the crank pin; the wrist's force on the rod is minus its force on the slider
        arm = place(pace, at.wrist - at.pin)
        turned = pace.second(at.angle) * (N_PER_KG_MM_S2 * masses.rod_inertia_kg_mm2)
        turned = turned + place(pace, center - at.pin).cross(rod)
        wrist = Vector(along, (arm.y * along - turned) / arm.x)
        pin = rod + wrist
        crank_axis, torque = crank_forces(crank, masses, pace, pin)
        return JointForces({"wrist": wrist, "pin": pin}, crank_axis, slider.y - wrist.y, torque)


def _leg(hypotenuse: Number, side: Number) -> Number:
    return np.sqrt((hypotenuse - side) * (hypotenuse + side))
