"""The longest stretch of a motion over which the speed stays near one value."""

from __future__ import annotations

from collections.abc import Sequence
from functools import partial

import numpy as np

from ncgear.frozen import dataclass
from ncgear.kinematics.crank_stretches import Stroke
from ncgear.kinematics.motion import Machine, Stretch, stretches
from ncgear.numerics.arrays import Array, IndexArray, distinct
from ncgear.numerics.extrema import grid_between, stationary_points
from ncgear.numerics.jet import Jet
from ncgear.numerics.zeros import zeros_between

POINTS = 2048
"""Least number of driving angles of a stroke at which the longest stretch may begin, evenly spaced within each smooth
part.

Where the longest stretch begins and ends at slopes, it is even about the best beginning, so the nearest of n angles
costs about 1/n^2 of the stroke.  Where a peak or a dip of the speed decides, beginning and end are among the angles.
Both are within 1e-6 of the stroke in tests/test_even_speed.py.
"""

ALIKE = 1e-9
"""Largest relative difference of equal speeds: a constant speed has rounding errors."""


@dataclass(frozen=True)
class EvenStretch:
    """Driving angles between which the speed stays near one value, the places there, and the extreme speeds."""

    start_rad: float
    end_rad: float
    start_mm: float
    end_mm: float
    least_mm_s: float
    most_mm_s: float

    @property
    def length_mm(self) -> float:
        """Way between both ends."""
        return abs(self.end_mm - self.start_mm)

    @property
    def speed_mm_s(self) -> float:
        """The mean of the extreme speeds."""
        return (self.least_mm_s + self.most_mm_s) / 2.0


@dataclass(frozen=True, eq=False)
class _Samples:
    """Rising driving angles of a stroke with places in mm and speeds in mm per rad, shape (n,) each."""

    phi1_rad: Array
    place_mm: Array
    speed: Array


def spread(tolerance: float) -> float:
    """Greatest speed over least of a motion that stays within the share ``tolerance`` of one speed."""
    return (1.0 + tolerance) / (1.0 - tolerance)


def longest_even_stretch(machine: Machine, stroke: Stroke, tolerance: float) -> EvenStretch:
    """The longest way in a stroke over which the speed stays within the share ``tolerance`` of one value.

    At its ends the speed is exact, and its length is the greatest within a millionth of the stroke.
    """
    parts = [part for part in stretches(machine) if part.working is (stroke is Stroke.WORKING)]
    on = _sampled(parts, spread(tolerance))
    # A stretch between two of the deciding places must fit in spite of rounding errors.
    most = spread(tolerance) * (1.0 + ALIKE)
    last, highest, lowest = _reach(on.speed, most)
    share, level = _beyond(on.speed, last, highest, lowest, most)
    after = np.minimum(last + 1, on.speed.size - 1)
    ends_mm = on.place_mm[last] + share * (on.place_mm[after] - on.place_mm[last])
    best = int(np.argmax(np.abs(ends_mm - on.place_mm)))
    end_rad = _where(machine, on, int(last[best]), float(level[best]))
    speed = machine.speed_rad_s
    return EvenStretch(
        float(on.phi1_rad[best]),
        end_rad,
        float(on.place_mm[best]),
        float(machine.displacement(np.array([end_rad]), 0).value[0]),
        float(min(lowest[best], level[best])) * speed,
        float(max(highest[best], level[best])) * speed,
    )


def _sampled(parts: Sequence[Stretch], most: float) -> _Samples:
    """Even samples of every part, its stationary speeds, and the places of all speeds that may decide."""
    still = [
        stationary_points(partial(part.speed, order=1), part.start_rad, part.end_rad, _knots(part)) for part in parts
    ]
    speeds = [part.speed(angles, 0).value for part, angles in zip(parts, still, strict=True)]
    deciding = _distinct(np.concatenate(speeds))
    levels = np.concatenate([deciding, deciding * most, deciding / most])
    angles = [
        distinct(np.concatenate([points, _even(part, levels, -(-POINTS // len(parts)))]))
        for part, points in zip(parts, still, strict=True)
    ]
    jets = [part.displacement(points, 1) for part, points in zip(parts, angles, strict=True)]
    place, slope = (np.concatenate([getter(jet) for jet in jets]) for getter in (_value, _slope))
    return _Samples(np.concatenate(angles), place, np.abs(slope))


def _value(jet: Jet) -> Array:
    return jet.value


def _slope(jet: Jet) -> Array:
    return jet.derivative(1)


def _knots(part: Stretch) -> Array:
    return np.array(part.knots_rad)


def _distinct(values: Array) -> Array:
    """Positive values that differ by more than rounding errors."""
    rising = np.sort(values[values > 0.0])
    return rising[np.diff(rising, prepend=0.0) > ALIKE * rising]


def _even(part: Stretch, levels: Array, count: int) -> Array:
    """Driving angles of a part: its grid, cut evenly into ``count`` or more, and places where the speed passes a
    level."""
    grid = grid_between(part.start_rad, part.end_rad, _knots(part))
    pieces = -(-count // (grid.size - 1))
    shares = np.arange(pieces) / pieces
    grid = np.append((grid[:-1, None] + np.diff(grid)[:, None] * shares).ravel(), grid[-1])
    speed = part.speed(grid, 0).value
    over, moving = speed[:, None] > levels, np.abs(np.diff(speed)) > ALIKE * speed[1:]
    cell, level = np.nonzero((over[:-1] != over[1:]) & moving[:, None])
    if not cell.size:
        return grid
    wanted = levels[level]
    found = zeros_between(lambda phi1: part.speed(phi1, 0).value - wanted, grid[cell], grid[cell + 1])
    return distinct(np.concatenate([grid, found]))


def _reach(speed: Array, most: float) -> tuple[IndexArray, Array, Array]:
    """The last sample that a stretch from each sample reaches, and the highest and lowest speed up to there.

    Doubling: the extremes of 2^k samples in a row follow from the extremes of half as many, and from each sample the
    longest rows that fit are joined.
    """
    count = speed.size
    tops, lows = [speed], [speed]
    while 2 << len(tops) <= count:
        width = 1 << (len(tops) - 1)
        tops.append(np.maximum(tops[-1][:-width], tops[-1][width:]))
        lows.append(np.minimum(lows[-1][:-width], lows[-1][width:]))
    last, highest, lowest = np.arange(count), speed.copy(), speed.copy()
    for power in reversed(range(len(tops))):
        start = np.minimum(last + 1, tops[power].size - 1)
        higher, lower = np.maximum(highest, tops[power][start]), np.minimum(lowest, lows[power][start])
        fits = (last + (1 << power) < count) & (higher <= most * lower)
        last = np.where(fits, last + (1 << power), last)
        highest, lowest = np.where(fits, higher, highest), np.where(fits, lower, lowest)
    return last, highest, lowest


def _beyond(speed: Array, last: IndexArray, highest: Array, lowest: Array, most: float) -> tuple[Array, Array]:
    """Share of the step after the last sample that still belongs to each stretch, and the speed where it ends."""
    after = np.minimum(last + 1, speed.size - 1)
    level = np.where(speed[after] > speed[last], most * lowest, highest / most)
    change = speed[after] - speed[last]
    level = np.where(change == 0.0, speed[last], level)
    share: Array = np.where(change == 0.0, 0.0, (level - speed[last]) / np.where(change == 0.0, 1.0, change))
    return np.clip(share, 0.0, 1.0), level


def _where(machine: Machine, on: _Samples, last: int, level: float) -> float:
    """The driving angle after a sample at which the speed passes a level."""
    if last + 1 == on.phi1_rad.size or on.speed[last] == on.speed[last + 1]:
        return float(on.phi1_rad[last])

    def over(phi1: Array) -> Array:
        return np.abs(machine.displacement(phi1, 1).derivative(1)) - level

    ends = on.phi1_rad[last : last + 2]
    signs = over(ends)
    if not signs[0] * signs[1] < 0.0:
        return float(ends[int(np.argmin(np.abs(signs)))])
    return float(zeros_between(over, ends[:1], ends[1:])[0])
