"""The Scotch yoke: the crank pin moves the slider by a slot that lies across the slider's line.

The displacement is r (1 - cos phi2).  ``mechanisms.mechanism`` describes frame and pose.
"""

from __future__ import annotations

from collections.abc import Mapping
from math import pi
from typing import ClassVar, Self

import numpy as np

from ncgear.frozen import dataclass
from ncgear.mechanisms.forces import JointForces, Masses, Pace, crank_forces, moving_force
from ncgear.mechanisms.mechanism import Link, LinkShape, Mechanism, MovingMass, Point
from ncgear.numerics import jet
from ncgear.numerics.arrays import Array, Mask
from ncgear.numerics.jet import Jet
from ncgear.numerics.plane import Term, Vector

SLOT_REACH, BAR = 1.2, 2.7
"""Half the length of the slot, and the distance from it to the slider, in cranks, for drawings: no key gives them."""


@dataclass(frozen=True)
class ScotchYoke(Mechanism):
    """One yoke, or many, with cranks of shape (n,).  The block between pin and slot has no mass of its own."""

    NAME: ClassVar[str] = "a Scotch yoke"
    JOINTS: ClassVar[Mapping[str, str]] = {"pin": "crank pin"}
    PINS: ClassVar[Mapping[str, str]] = {"crank-pin": "block"}

    crank_mm: float

    @classmethod
    def of_stroke(cls, stroke_mm: float, **lengths: float) -> Self:
        """The yoke whose crank is half the stroke."""
        return cls(stroke_mm / 2.0)

    @property
    def stroke_mm(self) -> float:
        """Twice the crank."""
        return 2.0 * self.crank_mm

    @property
    def nearest_mm(self) -> float:
        """Place of the retracted slider, which is drawn beyond the crank."""
        return (BAR - 1.0) * self.crank_mm

    @property
    def working_angle_rad(self) -> float:
        """Half a turn."""
        return pi + 0.0 * self.crank_mm

    def displacement(self, crank_angle: Jet) -> Jet:
        """r (1 - cos(phi2))."""
        return self.crank_mm * jet.sine_versine(crank_angle)[1]

    def working_angle(self, displacement_mm: Array, remaining_mm: Array) -> Array:
        """tan^2(phi2/2) = x / (2 r - x)."""
        return 2.0 * np.arctan2(np.sqrt(displacement_mm), np.sqrt(remaining_mm))

    def regular_slope(self, displacement: Jet, root: Jet) -> Jet:
        """1, from x (2 r - x) = r^2 sin^2(phi2)."""
        return 0.0 * displacement + 1.0

    def crank_angle(self, displacement_mm: Array, returning: Mask) -> Array:
        """Crank angle in rad, 0 to 2 pi, at displacements in [0, stroke], both of shape (n,)."""
        working = self.working_angle(displacement_mm, self.stroke_mm - displacement_mm)
        return np.where(returning, 2.0 * pi - working, working)

    def links(self, crank_angle: Jet) -> Mapping[str, Link]:
        """Slider with its yoke, crank, and the block about the crank's pin."""
        still = 0.0 * crank_angle
        pin = self.crank_body(crank_angle, 0.0).pin
        slider = Vector(self.displacement(crank_angle) + self.nearest_mm, still)
        return {"slider": Link(slider, still), "crank": self.crank_link(crank_angle), "block": Link(pin, still)}

    @property
    def rod_lines_mm(self) -> Mapping[str, tuple[tuple[Point, Point], ...]]:
        """The slider's slot over the pin's travel, and its bar with its drawn length."""
        bar, reach = BAR * self.crank_mm, self.crank_mm
        return {"slider": (((-bar, -reach), (-bar, reach)), ((-bar, 0.0), (0.0, 0.0)))}

    def shapes(self) -> Mapping[str, LinkShape]:
        """The yoke with its slot and the bar to the slider."""
        bar, reach = BAR * self.crank_mm, SLOT_REACH * self.crank_mm
        return {
            "slider": LinkShape((((-bar, 0.0), (0.0, 0.0)),), slots=(((-bar, -reach), (-bar, reach)),)),
            "block": LinkShape(eyes=((0.0, 0.0),)),
        }

    def moving_masses(self, crank_angle: Jet, masses: Masses) -> tuple[MovingMass, ...]:
        """The only mass is the slider."""
        slider = self.links(crank_angle)["slider"]
        return (MovingMass(masses.slider_kg, slider.origin, slider.angle),)

    def joint_forces(self, crank_angle: Jet, masses: Masses, pace: Pace, resistance_n: Term) -> JointForces:
        """Forces: the slot pushes the slider along its line only; the guide carries its weight across it."""
        slider = moving_force(masses, pace, masses.slider_kg, self.links(crank_angle)["slider"].origin)
        pin = Vector(slider.x + resistance_n, 0.0 * slider.x)
        crank = self.crank_body(crank_angle, masses.crank_center_mm)
        crank_axis, torque = crank_forces(crank, masses, pace, pin)
        return JointForces({"pin": pin}, crank_axis, slider.y, torque)
