"""A task under demands on one grid: the programmes of its motions, and whether any motion keeps the demands."""

from __future__ import annotations

from dataclasses import replace
from functools import cached_property
from math import inf, sqrt
from typing import Any

from ncgear.frozen import dataclass
from ncgear.optimum.certified.cycle import CrankCycle
from ncgear.optimum.certified.demands import Demands, NearMotion, Ranges
from ncgear.optimum.certified.motion import MotionProgramme, motion_programme
from ncgear.optimum.certified.proof import least
from ncgear.optimum.task import Task


@dataclass(frozen=True, eq=False)
class LimitProblem:
    """A task under demands, on the grid of a cycle."""

    task: Task
    asked: Demands
    on: CrankCycle

    def programme(
        self, curve: Ranges | NearMotion | None = None, *, closed: bool = True, with_peak: bool = False
    ) -> MotionProgramme:
        """The conic programme of the motions."""
        return motion_programme(self.task, self.on, self.asked, curve, closed=closed, with_peak=with_peak)

    @cached_property
    def closing(self) -> float:
        """Least driving angle of a cycle that keeps all other demands, over what it has; infinite where none does."""
        made = self.programme(closed=False)
        return least(made.programme, made.angle).value

    @property
    def excess(self) -> float:
        """By how much the least driving angle is over what the cycle has, as a share of that; zero or less: none."""
        return self.closing - 1.0

    @property
    def is_open(self) -> bool:
        """False only where certainly no law keeps the demands."""
        return self.excess <= 0.0

    def least_peak(self, name: str) -> float:
        """The least value of a demand, by its name in ``Demands``; zero or less where no single programme gives it."""
        free = self.under(**{name: inf})
        made = free.programme(with_peak=True)
        if name == "acceleration_mm_s2":
            return least(made.programme, made.acceleration).value * made.acceleration_unit_mm_s2
        if name == "power_w" and self.task.masses is None:
            return sqrt(max(least(made.programme, made.power_squared).value, 0.0)) * made.power_unit_w
        return 0.0

    def least_time(self, start_rad: float, end_rad: float) -> float:
        """The least driving angle in rad that a stretch of crank angles takes."""
        made, cells = self.programme(), self.on.cells_within(start_rad, end_rad)
        return least(made.programme, (made.time[cells] * self.on.step_rad[cells]).total()).value

    def eased(self, factor: float) -> LimitProblem:
        """The problem with higher peaks and steepness."""
        names = ("acceleration_mm_s2", "power_w", "braking_w", "fluctuation_n_mm", "torque_n_mm", "steepness")
        return self.under(**{name: factor * getattr(self.asked, name) for name in names})

    def under(self, **demands: Any) -> LimitProblem:
        """The problem with other values of some demands."""
        return replace(self, asked=replace(self.asked, **demands))
