"""The slider's motion at the operating speed: samples for tables and plots, and exact derivatives for peaks."""

from __future__ import annotations

from dataclasses import dataclass
from functools import cached_property
from math import pi

import numpy as np

from ncgear.machine.linkage import CrankSlider
from ncgear.machine.resistance import Resistance
from ncgear.numerics.arrays import Array, Mask
from ncgear.numerics.bracketed import zeros_between
from ncgear.numerics.jet import Jet
from ncgear.numerics.units import RAD_S_PER_RPM
from ncgear.ratio.transmission import CLOSED, Transmission


@dataclass(frozen=True, eq=False)
class SliderMotion:
    """Samples over the driving angle, all of shape (n,); force and power act in the working stroke only."""

    phi1_rad: Array
    phi2_rad: Array
    ratio: Array
    displacement_mm: Array
    velocity_mm_s: Array
    acceleration_mm_s2: Array
    force_n: Array
    power_w: Array

    def __repr__(self) -> str:
        last = float(np.degrees(self.phi1_rad[-1]))
        return f"SliderMotion({self.phi1_rad.size} driving angles up to {last:.4g} deg)"


@dataclass(frozen=True, eq=False)
class Machine:
    """A transmission that drives a crank-slider against a resistance at constant driving speed."""

    transmission: Transmission
    linkage: CrankSlider
    resistance: Resistance
    speed_rad_s: float

    def __repr__(self) -> str:
        return f"Machine({self.speed_rad_s / RAD_S_PER_RPM:.4g} r/min, {self.linkage!r},\n  {self.transmission!r})"

    def displacement(self, phi1: Array, order: int) -> Jet:
        """Slider displacement in mm, with derivatives by the driving angle."""
        return self.linkage.displacement(self.transmission.driven_angle(phi1, order))

    @cached_property
    def extended_rad(self) -> float:
        """Driving angle in the first cycle at which the slider is at its extended dead centre."""
        target = self.linkage.working_angle_rad

        def excess(phi1: Array) -> Array:
            return self.transmission.driven_angle(phi1).value - target

        last = self.transmission.cycle_rad * (1.0 - 1e-12)
        return float(zeros_between(excess, np.array([0.0]), np.array([last]))[0])

    def working(self, phi2: Array) -> Mask:
        """Whether the slider is in its working stroke, at driven angles of shape (n,); at a dead centre, in the next.

        A dead centre that the law misses by no more than its own closure may is taken as reached.
        """
        return np.mod(phi2 + CLOSED, 2.0 * pi) < self.linkage.working_angle_rad

    def motion(self, phi1: Array) -> SliderMotion:
        """The motion at driving angles in rad, shape (n,)."""
        driven = self.transmission.driven_angle(phi1, 2)
        displacement = self.linkage.displacement(driven)
        velocity = displacement.derivative(1) * self.speed_rad_s
        force = np.where(self.working(driven.value), self.resistance.force_n(displacement.value), 0.0)
        return SliderMotion(
            phi1_rad=phi1,
            phi2_rad=driven.value,
            ratio=1.0 / driven.derivative(1),
            displacement_mm=displacement.value,
            velocity_mm_s=velocity,
            acceleration_mm_s2=displacement.derivative(2) * self.speed_rad_s**2,
            force_n=force,
            power_w=force * velocity / 1000.0,
        )


def sample_angles(transmission: Transmission, least: int = 2001) -> Array:
    """Even driving angles over one cycle and at least one turn of the driving gear, both ends included."""
    end = max(2.0 * pi, transmission.cycle_rad)
    count = int(np.ceil((least - 1) * end / (2.0 * pi))) + 1
    return np.linspace(0.0, end, count)
