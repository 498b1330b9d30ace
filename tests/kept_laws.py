"""Every law ever found or written: each judges every limit, for no limit is above what a law has.

Laws are read from design files: those of ``designs/`` and ``tests/cases/``, those that searches have found since
(``tests/laws/``), and the best ones of machines that are no balers (``benchmarks/foreign/``).  A file that is added to
any of these folders is judged by itself.
"""

from __future__ import annotations

from dataclasses import dataclass, replace
from functools import cache
from math import inf, pi, tan
from pathlib import Path

import numpy as np

from ncgear.design.reading.design_file import load
from ncgear.kinematics.crank_stretches import CrankStretch
from ncgear.kinematics.motion import Machine
from ncgear.optimum.certified.demands import Demands, WishDemand
from ncgear.optimum.certified.limit import Motion
from ncgear.optimum.task import Figures, Task, figures
from ncgear.project.law import law_of
from ncgear.project.law_task import inertia_as_given, task_of
from ncgear.ratio.transmission import PairsInSeries
from ncgear.wishes.requirements import EvenSpeed, SpeedWithin, TimeWithin

ROOT = Path(__file__).parents[1]
FOLDERS = ("designs", "benchmarks/foreign", "tests/laws", "tests/cases")
FILES = {f"{folder}/{path.stem}": path for folder in FOLDERS for path in sorted((ROOT / folder).glob("*.yaml"))}

ROUNDING = 1.0 + 1e-9
"""What exact figures are beside the law's own, and more than that."""

STRETCHES = ((0.9, 2.1), (4.0, 5.5), (1.5, 1.5))
"""Crank angles in rad between which a law's own speeds are asked of it; the last is one place."""

SAMPLES = 20_001
"""Samples of a stretch: speeds between them are off by less than the square of their distance, 6e-5 rad."""

SAMPLED = 1.0 + 1e-7

ROOM = 1e-3
"""Ratios nearer to one than that leave nothing to choose."""


@dataclass(frozen=True, eq=False)
class KeptLaw:
    """A law on its machine, and what it has."""

    task: Task
    train: PairsInSeries
    figures: Figures

    @property
    def machine(self) -> Machine:
        """The machine that follows the law."""
        return Machine(self.train.whole, self.task.linkage, self.task.load, self.task.speed_rad_s)

    @property
    def motion(self) -> Motion:
        """How the crank turns at even driving angles."""
        turned = self.train.whole.driven_angle(np.linspace(0.0, self.task.cycle_rad, 400, endpoint=False), 1)
        return Motion(turned.value, turned.derivative(1))

    def without_masses(self) -> KeptLaw:
        """The law where the load alone is felt."""
        task = replace(self.task, masses=None)
        return KeptLaw(task, self.train, figures(task, self.train))

    def with_masses(self) -> KeptLaw:
        """The law with masses that take about as much power as the load does; with its own where it has any."""
        if self.task.masses is not None:
            return self
        found = self.figures
        felt_kg = 1e6 * max(found.peak_power_w, 1.0) / (found.peak_acceleration_mm_s2 * found.peak_speed_mm_s)
        crank_mm = self.task.linkage.stroke_mm / 2.0
        masses = self.task.linkage.MASSES(
            slider_kg=felt_kg,
            crank_kg=felt_kg,
            crank_center_mm=crank_mm / 3.0,
            driven_inertia_kg_mm2=felt_kg * crank_mm,
        )
        task = replace(self.task, masses=masses)
        return KeptLaw(task, self.train, figures(task, self.train))

    def demands(self) -> Demands:
        """Everything that a limit knows, as tight as the law keeps it."""
        found, task = self.figures, self.task
        one_pair = len(self.train.pairs) == 1
        extended, cycle = task.linkage.working_angle_rad, task.cycle_rad
        flywheel = inf if found.flywheel_kg_mm2 is None else found.flywheel_kg_mm2
        return Demands(
            ratio_min=min(found.ratio_min / ROUNDING, 1.0 - ROOM),
            ratio_max=max(found.ratio_max * ROUNDING, 1.0 + ROOM),
            steepness=tan(found.tangent_rad) * ROUNDING if one_pair and found.tangent_rad else inf,
            convex=found.convex and one_pair,
            acceleration_mm_s2=found.peak_acceleration_mm_s2 * ROUNDING,
            power_w=found.peak_power_w * ROUNDING or inf,
            braking_w=_cap(found.braking_power_w),
            torque_n_mm=1000.0 * _cap(found.rms_torque_n_m),
            fluctuation_n_mm=flywheel * ROUNDING * task.speed_rad_s**2 * task.speed_fluctuation / 1000.0,
            wishes=(
                *(
                    WishDemand(key, TimeWithin(stretch, most_rad=most * ROUNDING))
                    for key, stretch, most in (
                        ("out", CrankStretch(0.0, extended), found.working_rad),
                        ("back", CrankStretch(extended, 2.0 * pi), cycle - found.working_rad),
                    )
                ),
                *(
                    WishDemand("speed", SpeedWithin(CrankStretch(*stretch), least / SAMPLED, most * SAMPLED))
                    for stretch in STRETCHES
                    for least, most in [self.speeds_mm_s(*stretch)]
                ),
                *(
                    WishDemand("spread", EvenSpeed(CrankStretch(*stretch), most / least * SAMPLED))
                    for stretch in STRETCHES[:2]
                    for least, most in [self.speeds_mm_s(*stretch)]
                ),
            ),
        )

    def speeds_mm_s(self, start_rad: float, end_rad: float) -> tuple[float, float]:
        """Least and greatest speed of the slider between two crank angles."""
        start, end = self.machine.driving_angles(np.array([start_rad, end_rad])).tolist()
        speed = np.abs(self.machine.motion(np.linspace(start, end, SAMPLES)).velocity)
        return float(speed.min()), float(speed.max())


def _cap(value: float | None) -> float:
    return inf if value is None else value * ROUNDING


@cache
def kept(name: str) -> KeptLaw:
    """The law of a file; raises DesignError where the file's law cannot be made or is no cycle of a slider."""
    design = load(FILES[name]).design
    task, train = task_of(design, inertia_as_given(design)), law_of(design).train
    return KeptLaw(task, train, figures(task, train))
