"""One task under its limits, on one grid: whether a pair of peaks is certainly too low, and whether it is reached."""

from __future__ import annotations

from dataclasses import dataclass, replace
from functools import cached_property
from math import inf, pi

from ncgear.optimum.certified.attained import attained_durations_s
from ncgear.optimum.certified.ceilings import Peaks
from ncgear.optimum.certified.durations import least_durations_s
from ncgear.optimum.certified.passes import ROUNDING, Ceilings, fastest
from ncgear.optimum.certified.probes import Probes, probes
from ncgear.optimum.certified.road import Road, road
from ncgear.optimum.task import Limits, Task

PRESSING_SHARE = 0.8
"""Share of the cells in the working stroke when a mass is moved: the change of force in a cell is then the error."""


@dataclass(frozen=True, eq=False)
class Problem:
    """A task under limits, the cycle cut into about ``cells`` cells."""

    task: Task
    limits: Limits
    cells: int

    @cached_property
    def road(self) -> Road:
        """The cycle cut into cells."""
        share = PRESSING_SHARE if self.limits.mass_kg else self.task.linkage.working_angle_rad / (2.0 * pi)
        return road(self.task, self.cells, share)

    @cached_property
    def probes(self) -> Probes:
        """Points inside the cells."""
        return probes(self.road, self.task)

    def under(self, limits: Limits) -> Problem:
        """The same task under other limits."""
        return replace(self, limits=limits)

    def ceilings(self, peaks: Peaks) -> Ceilings | None:
        """Upper bounds of the fastest motion with these peaks; None where there is no motion."""
        return fastest(self.road, self.task, self.limits, peaks)

    def least_durations_s(self, peaks: Peaks, ceilings: Ceilings) -> tuple[float, float]:
        """Times in s of the working stroke and the return that no motion below the ceilings undercuts."""
        return least_durations_s(self.road, self.task, self.limits, peaks, ceilings)

    def is_open(self, peaks: Peaks) -> bool:
        """False only where certainly no law, however rough, closes the cycle with these peaks."""
        ceilings = self.ceilings(peaks)
        if ceilings is None:
            return False
        return self._in_time(self.least_durations_s(peaks, ceilings))

    def is_reached(self, peaks: Peaks) -> bool:
        """True only where a motion with these peaks, not a smooth one, closes the cycle."""
        ceilings = self.ceilings(peaks)
        if ceilings is None:
            return False
        found = attained_durations_s(self.road, self.probes, self.task, self.limits, peaks, ceilings)
        return self._in_time(found, slack=0.0)

    def _in_time(self, durations: tuple[float, float], slack: float = ROUNDING) -> bool:
        """Whether the strokes take no longer than they have; a slower motion can fill what time is left."""
        out, back = durations
        cycle, working = self.task.cycle_s, self.limits.working_rad
        if working is None:
            return (out + back) * (1.0 - slack) <= cycle
        given = working / self.task.speed_rad_s
        return out * (1.0 - slack) <= given and back * (1.0 - slack) <= cycle - given

    @property
    def given_peaks(self) -> Peaks:
        """The limits' own peaks, infinite where none is given."""
        limits = self.limits
        return Peaks(limits.peak_acceleration_mm_s2 or inf, limits.peak_power_w or inf)
