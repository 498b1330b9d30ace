"""A task under demands on a grid: the programmes of its motions, and whether any motion keeps the demands."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import replace
from functools import cached_property
from math import inf, isinf, sqrt
from typing import Any

from ncgear.frozen import dataclass
from ncgear.optimum.certified import rows
from ncgear.optimum.certified.cycle import CrankCycle
from ncgear.optimum.certified.demands import PEAKS, Demands, NearMotion, Priced, Ranges
from ncgear.optimum.certified.motion import MotionProgramme
from ncgear.optimum.certified.proof import least
from ncgear.optimum.task import Task


def motion_programme(
    task: Task,
    on: CrankCycle,
    asked: Demands,
    curve: Ranges | NearMotion | None = None,
    *,
    closed: bool = True,
    with_peak: bool = False,
    powers_w: tuple[float, float] = (0.0, inf),
    priced: Sequence[Priced] = (),
) -> MotionProgramme:
    """The programme of all motions that keep the demands, and of further motions that only keep these relations.

    ``curve`` adds the driving curve.  Ranges give its relation for all motions within them.  Near a motion, the
    relation is q'' <= 2 + 2 sqrt(q) + q'^2/q with q'^2/q bounded from below by its tangent.  A motion that keeps this
    relation has a convex driving curve, but some motions with a convex driving curve do not keep it.  This programme
    finds motions and proves nothing.  Without ``closed``, the cycle may take any driving angle.  ``powers_w`` is the
    range of the search for peak powers where the peak power is not limited.  The peak of acceleration is a variable
    ``with_peak``, up to ``MOST_ACCELERATION``, or where it is limited.  Figures that are ``priced`` are variables
    within their ranges, and demands.
    """
    asked = replace(asked, **{figure.name: min(figure.most, getattr(asked, figure.name)) for figure in priced})
    made = MotionProgramme(task, on, asked, curve if isinstance(curve, Ranges) else None, priced)
    made.limit_acceleration(with_peak)
    made.limit_power(powers_w)
    if asked.convex:
        rows.limit_bulge(made)
    if not isinf(asked.steepness):
        rows.limit_lean(made)
    if isinstance(curve, Ranges):
        if asked.convex:
            rows.limit_driving_curve(made, curve)
        if closed and rows.needs_times(task, asked):
            rows.limit_times(made, curve)
    if isinstance(curve, NearMotion):
        rows.follow_driving_curve(made, curve)
    made.limit_speeds()
    made.limit_decelerations()
    made.limit_energies()
    rows.limit_flank_load(made, curve if isinstance(curve, Ranges) else None)
    rows.least_times(made)
    rows.take_time(made, closed)
    return made


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
        """Least driving angle of motions that keep all other demands, over the cycle's; infinite without any."""
        made = self.programme(closed=False)
        return least(made.programme, made.angle).value

    @property
    def excess(self) -> float:
        """Excess of the least driving angle over the cycle's, as a share of it; zero or less means no excess."""
        return self.closing - 1.0

    @property
    def is_open(self) -> bool:
        """False only where certainly no law keeps the demands."""
        return self.excess <= 0.0

    def least_peak(self, name: str) -> float:
        """The least value of a demand, by its name in ``Demands``; at most zero where no single programme gives it."""
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
        names = (*PEAKS, "steepness")
        return self.under(**{name: factor * getattr(self.asked, name) for name in names})

    def under(self, **demands: Any) -> LimitProblem:
        """The problem with other values of some demands."""
        return replace(self, asked=replace(self.asked, **demands))
