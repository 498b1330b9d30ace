"""What a mechanism has to do, the limits that it must keep, and the figures of a law for it."""

from __future__ import annotations

from dataclasses import dataclass, field
from math import degrees, inf, isfinite, pi, tan

import numpy as np

from ncgear.errors import WrongInput
from ncgear.kinematics.check import kinematic_check, peak_driving_power_w
from ncgear.kinematics.motion import Machine
from ncgear.mechanisms.mechanism import Mechanism
from ncgear.mechanisms.resistance import Resistance
from ncgear.pitch.pair import sized_pair
from ncgear.pitch.shape import Gear
from ncgear.ratio.transmission import Lobes, Train


@dataclass(frozen=True)
class Task:
    """One turn of the crank against a resistance in one period of a driving gear that turns evenly.

    Raises WrongInput for a speed that is not positive and for a driven gear of several lobes.
    """

    linkage: Mechanism
    resistance: Resistance
    speed_rad_s: float
    lobes: Lobes = field(default_factory=Lobes)

    def __post_init__(self) -> None:
        self.lobes.require_one_cycle()
        if not 0.0 < self.speed_rad_s < inf:
            problem = f"{self.speed_rad_s:g} rad/s is no driving speed; a positive one is needed"
            raise WrongInput(problem, key="operation.speed_rpm")

    @property
    def cycle_rad(self) -> float:
        """Driving angle of one cycle of the slider."""
        return self.lobes.driving_period_rad

    @property
    def cycle_s(self) -> float:
        """Time of one cycle of the slider."""
        return self.cycle_rad / self.speed_rad_s

    @property
    def work_n_mm(self) -> float:
        """Work of the resistance over one working stroke; negative where a kept negative force drives the slider."""
        stroke = self.linkage.stroke_mm
        return float(self.resistance.work_n_mm(np.array([stroke]), stroke)[0])


@dataclass(frozen=True)
class Limits:
    """Bounds on every position of the cycle; None for a quantity that is free.

    ``ratio_min`` and ``ratio_max`` bound i12 = dphi1/dphi2; ``working_rad`` is the driving angle of the working stroke;
    ``pressure_angle_rad`` bounds the tangent angle of the pitch curves, |atan(r1'/r1)|, not counting the rack's own;
    ``rack_angle_rad`` is the rack's own, which the limit in a design file and messages include;
    ``mass_kg`` moves with the slider and takes power.  Raises WrongInput for a value that bounds nothing, with its key
    in the design file.
    """

    ratio_min: float
    ratio_max: float
    peak_power_w: float | None = None
    peak_acceleration_mm_s2: float | None = None
    working_rad: float | None = None
    pressure_angle_rad: float | None = None
    rack_angle_rad: float = 0.0
    mass_kg: float = 0.0

    def __post_init__(self) -> None:
        if not 0.0 < self.ratio_min < inf:
            raise _wrong("limits.ratio_min", self.ratio_min, "a positive ratio is needed")
        if not self.ratio_min < self.ratio_max < inf:
            raise _wrong("limits.ratio_max", self.ratio_max, f"a ratio over ratio_min = {self.ratio_min:g} is needed")
        positive = {
            "limits.peak_power_w": self.peak_power_w,
            "limits.peak_acceleration_mm_s2": self.peak_acceleration_mm_s2,
            "limits.working_angle_rad": self.working_rad,
        }
        for key, value in positive.items():
            if value is not None and not 0.0 < value < inf:
                raise _wrong(key, value, "a positive number is needed")
        tangent = self.pressure_angle_rad
        if tangent is not None and not 0.0 < tangent < pi / 2.0:
            said = "deg without the rack's own given; over 0 and under 90 is right"
            raise WrongInput(f"{degrees(tangent):g} {said}", key="optimize.limits.pressure_angle_deg")
        if not (self.mass_kg >= 0.0 and isfinite(self.mass_kg)):
            raise WrongInput(f"{self.mass_kg:g} given; 0 or a positive number is needed", key="masses.slider_kg")

    @property
    def steepness(self) -> float:
        """Largest |d ln(1 + s)/dphi2| with s = dphi2/dphi1; infinite where the pressure angle is free.

        r1 = a s / (1 + s) gives r1'/r1 = (ds/dphi2) / (1 + s), the prime by phi1.
        """
        return inf if self.pressure_angle_rad is None else tan(self.pressure_angle_rad)


TEETH = 100
"""Teeth per lobe of the pair whose curves are measured; the figures are ratios, so any size does."""


@dataclass(frozen=True, eq=False)
class Figures:
    """Peaks at the operating speed, ratio range, and the shape of the pitch curves.

    ``curvature_turns`` is the largest curvature of any curve, bulge or dent, times the length its pair rolls in one
    cycle.  With several pairs the ratios are the whole train's, and ``convex`` means that all curves are.
    """

    peak_power_w: float
    peak_acceleration_mm_s2: float
    peak_speed_mm_s: float
    ratio_min: float
    ratio_max: float
    working_rad: float
    tangent_rad: float
    convex: bool
    curvature_turns: float


def figures(task: Task, train: Train, mass_kg: float = 0.0) -> Figures:
    """The figures of a law on a machine; raises NoSuchMechanism for curves too sharp to be computed.

    The power is that of the resistance and of ``mass_kg``, which moves with the slider.
    """
    machine = Machine(train.whole, task.linkage, task.resistance, task.speed_rad_s)
    check = kinematic_check(machine)
    pairs = [sized_pair(one.transmission, TEETH * task.lobes.driving, 1.0, None) for one in train.pairs]
    lowest, highest = train.whole.ratio_range
    return Figures(
        peak_power_w=peak_driving_power_w(machine, mass_kg).value if mass_kg else check.peak_power_w.value,
        peak_acceleration_mm_s2=check.peak_acceleration_cycle_mm_s2.value,
        peak_speed_mm_s=check.peak_speed_mm_s.value,
        ratio_min=lowest.value,
        ratio_max=highest.value,
        working_rad=machine.extended_rad,
        tangent_rad=max(pair.largest_tangent_angle_rad.value for pair in pairs),
        convex=all(pair.convex(gear) for pair in pairs for gear in Gear),
        curvature_turns=max(abs(end.value) for pair in pairs for gear in Gear for end in pair.curvature_range[gear])
        * TEETH
        * pi,
    )


def _wrong(key: str, value: float, needed: str) -> WrongInput:
    return WrongInput(f"{value:g} given; {needed}", key=f"optimize.{key}")
