"""One task under its limits, on one grid: whether a pair of peaks is certainly too low, and whether it is reached.

A motion that keeps all limits, close below the ceilings, shows from the other side where the limit lies.  It need not
be smooth: its acceleration, or the slope of its ratio, jumps between cells.
"""

from __future__ import annotations

from dataclasses import dataclass, fields
from functools import cached_property
from math import inf, isinf, pi

import numpy as np

from ncgear.numerics.arrays import Array, Mask
from ncgear.optimum.certified.passes import ROUNDING, Ceilings, fastest, least_durations_s, linear_s
from ncgear.optimum.certified.road import SHARES, Peaks, Probes, Road, probes, road
from ncgear.optimum.task import Limits, Task


@dataclass(frozen=True, eq=False)
class CellMotion:
    """A motion cell by cell: at the probes, shape (n, 9), and the time of each cell, shape (n, 1).

    ``turning`` is s = dphi2/dphi1, ``steer`` its derivative by phi2.
    """

    speed_mm_s: Array
    acceleration_mm_s2: Array
    turning: Array
    steer: Array
    seconds: Array


def attained_durations_s(
    road: Road, at: Probes, task: Task, limits: Limits, peaks: Peaks, ceilings: Ceilings
) -> tuple[float, float]:
    """Times in s of both strokes of a motion that keeps all limits; infinite where none is found."""
    motion = _evenly_pushed(road, at, task, ceilings)
    slowing = _slowing(motion, at, limits, peaks)
    if not isinf(limits.steepness):
        steered = _evenly_steered(road, at, task, ceilings)
        others = _slowing(steered, at, limits, peaks)
        motion = _chosen(others > slowing, steered, motion)
        slowing = np.maximum(slowing, others)
    factor = min(1.0, float(slowing.min()))
    if not np.all(motion.turning * factor * (1.0 + ROUNDING) >= 1.0 / limits.ratio_max):
        return inf, inf
    seconds = motion.seconds[:, 0] / factor
    return float(seconds[: road.extended].sum()), float(seconds[road.extended :].sum())


def _evenly_pushed(road: Road, at: Probes, task: Task, ceilings: Ceilings) -> CellMotion:
    """Constant acceleration in each cell, between the ceilings of its ends.

    At a dead centre x' and v are both zero: v^2 / x'^2 is a / x'', and the ratio's slope counts as unlimited.
    """
    start, end, omega = ceilings.energy_mm2_s2[:-1, None], ceilings.energy_mm2_s2[1:, None], task.speed_rad_s
    length = road.length_mm[:, None]
    speed = np.sqrt(2.0 * (start * (1.0 - at.share) + end * at.share))
    pushed = np.broadcast_to((end - start) / length, speed.shape)
    moving = at.slope_mm_rad > 0.0
    turning = np.sqrt(np.abs(pushed / at.bend_mm_rad2)) / omega
    np.divide(speed, omega * at.slope_mm_rad, out=turning, where=moving)
    steer = np.full(speed.shape, inf)
    np.divide(pushed / omega**2 - at.bend_mm_rad2 * turning**2, at.slope_mm_rad * turning, out=steer, where=moving)
    return CellMotion(speed, pushed, turning, steer, linear_s(start, end, length))


def _evenly_steered(road: Road, at: Probes, task: Task, ceilings: Ceilings) -> CellMotion:
    """s linear in the crank angle in each cell; 1/s is convex, so the trapezoid is no less than the time."""
    start, end, omega = ceilings.turning[:-1, None], ceilings.turning[1:, None], task.speed_rad_s
    turn = road.turn_rad[:, None]
    turning = start + (end - start) * SHARES
    steer = np.broadcast_to((end - start) / turn, turning.shape)
    acceleration = omega**2 * (at.bend_mm_rad2 * turning + at.slope_mm_rad * steer) * turning
    seconds = turn * (1.0 / start + 1.0 / end) / (2.0 * omega)
    return CellMotion(omega * at.slope_mm_rad * turning, acceleration, turning, steer, seconds)


def _chosen(mask: Mask, first: CellMotion, second: CellMotion) -> CellMotion:
    """The first motion in the cells of the mask, shape (n,), and the second in the others."""
    pairs = [(getattr(first, field.name), getattr(second, field.name)) for field in fields(CellMotion)]
    return CellMotion(*(np.where(mask[:, None], one, other) for one, other in pairs))


def _slowing(motion: CellMotion, at: Probes, limits: Limits, peaks: Peaks) -> Array:
    """Largest factors, shape (n,), by which the speed may be multiplied so that each cell keeps all limits inside.

    With a factor f, accelerations take f^2, speeds and s take f, and power takes f where the resistance presses, less
    where a mass is accelerated.  The slope of ln(1 + s) becomes f s' / (1 + f s).
    """
    power = (at.force_n * 1e3 + limits.mass_kg * motion.acceleration_mm_s2) * motion.speed_mm_s
    factors = [
        np.sqrt(_share(peaks.acceleration_mm_s2, np.abs(motion.acceleration_mm_s2))),
        _share(1e6 * peaks.power_w, power),
        _share(1.0 / limits.ratio_min, motion.turning),
    ]
    if not isinf(limits.steepness):
        factors.append(_share(limits.steepness, np.abs(motion.steer) - limits.steepness * motion.turning))
    least: Array = np.min(factors, axis=0)
    return least


def _share(most: float, load: Array) -> Array:
    """The limit over the largest load of each cell, shape (n,); infinite where there is none.

    Between two probes a smooth load exceeds the larger of them by at most an eighth of its second difference.
    """
    with np.errstate(invalid="ignore", over="ignore", divide="ignore"):
        between = np.nan_to_num(np.abs(np.diff(load, n=2, axis=1)).max(axis=1)) / 8.0
        share: Array = most / np.maximum(load.max(axis=1) + between, 0.0)
    return share


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
