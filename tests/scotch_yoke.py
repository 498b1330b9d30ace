"""A second mechanism, which ncgear itself has not: a Scotch yoke, whose slider a pin moves in a slot across its line.

The displacement is r (1 - cos phi2).  ``MECHANISMS["scotch_yoke"] = SCOTCH_YOKE`` is the one line that makes it known.
"""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass
from math import pi
from typing import ClassVar, Self

import numpy as np
from pydantic import Field

from ncgear.design.keys.base import Length, Model
from ncgear.design.mechanisms import Entry
from ncgear.mechanisms.forces import JointForces, Pace, crank_forces, moving_force
from ncgear.mechanisms.masses import Masses
from ncgear.mechanisms.mechanism import Link, Mechanism, MovingMass, Shape
from ncgear.numerics import jet
from ncgear.numerics.arrays import Array, Mask
from ncgear.numerics.jet import Jet
from ncgear.numerics.plane import Term, Vector


class YokeKeys(Model):
    """The Scotch yoke that the driven gear turns."""

    radius_mm: Length | None = Field(default=None, description="from the crank's axis to its pin in mm")
    bar_mm: Length = Field(default=500.0, description="from the slot to the slider in mm, for pictures")


@dataclass(frozen=True)
class ScotchYoke(Mechanism):
    """One yoke, or many whose lengths have shape (n,)."""

    NAME: ClassVar[str] = "a Scotch yoke"
    STROKE_KEY: ClassVar[str] = "radius_mm"
    JOINTS: ClassVar[Mapping[str, str]] = {"pin": "crank pin"}
    PINS: ClassVar[Mapping[str, str]] = {"crank-pin": "block"}

    radius_mm: float
    bar_mm: float = 500.0

    @classmethod
    def of_stroke(cls, stroke_mm: float, **lengths: float) -> Self:
        return cls(stroke_mm / 2.0, **lengths)

    @property
    def crank_mm(self) -> float:
        return self.radius_mm

    @property
    def stroke_mm(self) -> float:
        return 2.0 * self.radius_mm

    @property
    def nearest_mm(self) -> float:
        return self.bar_mm - self.radius_mm

    @property
    def working_angle_rad(self) -> float:
        return pi + 0.0 * self.radius_mm

    def displacement(self, crank_angle: Jet) -> Jet:
        half_sine, _ = jet.sin_cos(crank_angle * 0.5)
        return 2.0 * self.radius_mm * (half_sine * half_sine)

    def working_angle(self, displacement: Jet, root_displaced: Jet, root_remaining: Jet) -> Jet:
        return 2.0 * jet.arctan2(root_displaced, root_remaining)

    def crank_angle(self, displacement_mm: Array, returning: Mask) -> Array:
        working = 2.0 * np.arctan2(np.sqrt(displacement_mm), np.sqrt(self.stroke_mm - displacement_mm))
        return np.where(returning, 2.0 * pi - working, working)

    def links(self, crank_angle: Jet) -> Mapping[str, Link]:
        still = 0.0 * crank_angle
        pin = self.crank_body(crank_angle, 0.0).pin
        slider = Vector(self.displacement(crank_angle) + self.nearest_mm, still)
        return {"slider": Link(slider, still), "crank": self.crank_link(crank_angle), "block": Link(pin, still)}

    def shapes(self) -> Mapping[str, Shape]:
        top, foot = (-self.bar_mm, 1.2 * self.radius_mm), (-self.bar_mm, -1.2 * self.radius_mm)
        return {
            "slider": Shape((((-self.bar_mm, 0.0), (0.0, 0.0)), (foot, top))),
            "block": Shape((), ((0.0, 0.0),)),
        }

    def moving_masses(self, crank_angle: Jet, masses: Masses) -> tuple[MovingMass, ...]:
        slider = self.links(crank_angle)["slider"]
        return (MovingMass(masses.slider_kg, slider.origin, slider.angle),)

    def joint_forces(self, crank_angle: Jet, masses: Masses, pace: Pace, resistance_n: Term) -> JointForces:
        slider = moving_force(masses, pace, masses.slider_kg, self.links(crank_angle)["slider"].origin)
        pin = Vector(slider.x + resistance_n, 0.0 * slider.x)
        crank = self.crank_body(crank_angle, masses.crank_center_mm)
        crank_axis, torque = crank_forces(crank, masses, pace, pin)
        return JointForces({"pin": pin}, crank_axis, slider.y, torque)


SCOTCH_YOKE = Entry(lambda: ScotchYoke, YokeKeys)
