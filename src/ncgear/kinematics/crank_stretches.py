"""Stretches of the crank angle in which the output moves: time, speed, deceleration, longest stretch of even speed."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from dataclasses import replace
from enum import Enum
from functools import partial
from itertools import pairwise
from math import pi
from typing import NamedTuple

import numpy as np

from ncgear.frozen import dataclass
from ncgear.kinematics.motion import Machine, Stretch, stretches
from ncgear.mechanisms.mechanism import Mechanism
from ncgear.numerics.arrays import Array, IndexArray, distinct
from ncgear.numerics.extrema import Extremum, extremes, grid_between, stationary_points
from ncgear.numerics.jet import Jet
from ncgear.numerics.zeros import zeros_between


class Stroke(Enum):
    """The way from the retracted to the extended dead centre, or the way back."""

    WORKING = "working"
    RETURN = "return"


class End(Enum):
    """A dead centre."""

    RETRACTED = "retracted"
    EXTENDED = "extended"


class CrankStretch(NamedTuple):
    """Crank angles in rad from ``start_rad`` to ``end_rad``, rising; a start under 0 lies in the turn before."""

    start_rad: float
    end_rad: float

    @property
    def rest(self) -> CrankStretch:
        """The rest of the turn."""
        return CrankStretch(self.end_rad, self.start_rad + 2.0 * pi)


def crank_angle_rad(linkage: Mechanism, place_mm: float, stroke: Stroke) -> float:
    """Crank angle, 0 to 2 pi, at which the output passes a place of the stroke."""
    returning = np.array([stroke is Stroke.RETURN])
    return float(linkage.crank_angle(np.array([place_mm], dtype=float), returning)[0])


def crank_at_way_rad(linkage: Mechanism, way_mm: float) -> float:
    """Crank angle at which the output has gone a way of 0 to 2 strokes from the retracted end."""
    if way_mm <= linkage.stroke_mm:
        return crank_angle_rad(linkage, way_mm, Stroke.WORKING)
    return crank_angle_rad(linkage, 2.0 * linkage.stroke_mm - way_mm, Stroke.RETURN)


def place_of(linkage: Mechanism, at_mm: float, stroke: Stroke) -> CrankStretch:
    """The crank angle of a place, as a stretch without length."""
    angle = crank_angle_rad(linkage, at_mm, stroke)
    return CrankStretch(angle, angle)


def by_stroke(linkage: Mechanism, stretch: CrankStretch) -> list[tuple[CrankStretch, Stroke]]:
    """The parts of a stretch in each stroke, in order, with angles from 0 to 2 pi."""
    turn = 2.0 * pi
    dead = [angle + whole for whole in (-turn, 0.0, turn) for angle in (0.0, linkage.working_angle_rad)]
    edges = [stretch.start_rad, *(angle for angle in dead if stretch.start_rad < angle < stretch.end_rad)]
    found = []
    for start, end in pairwise([*edges, stretch.end_rad]):
        whole, middle = divmod((start + end) / 2.0, turn)
        working = middle < linkage.working_angle_rad
        found.append(
            (CrankStretch(start - turn * whole, end - turn * whole), Stroke.WORKING if working else Stroke.RETURN)
        )
    return found


def about_end(linkage: Mechanism, end: End, within_mm: float) -> CrankStretch:
    """The crank angles about a dead centre at which the displacement is within ``within_mm`` of it."""
    if end is End.EXTENDED:
        place = linkage.stroke_mm - within_mm
        return CrankStretch(*(crank_angle_rad(linkage, place, stroke) for stroke in Stroke))
    back, out = (crank_angle_rad(linkage, within_mm, stroke) for stroke in (Stroke.RETURN, Stroke.WORKING))
    return CrankStretch(back - 2.0 * pi, out)


def nearest_dwell_mm(linkage: Mechanism, end: End, for_rad: float, ratio_max: float) -> float:
    """The least distance from an end within which the output can stay for a driving angle, in mm.

    i12 is at most ``ratio_max``, so the crank turns by for_rad / ratio_max at least; with x'' = d2x/dphi2^2 at the dead
    centre, this takes the output nearly |x''| (for_rad / ratio_max)^2 / 8 away.  The result is exact: the distance that
    is reached on both sides of the dead centre.  It is the whole stroke where the crank must turn all round.
    """
    crank_rad = for_rad / ratio_max
    low, high = 0.0, 1.0
    # The square root of the distance grows evenly with the angle, and bisection halves its error in each step.
    for _ in range(60):
        middle = (low + high) / 2.0
        stretch = about_end(linkage, end, linkage.stroke_mm * middle**2)
        low, high = (middle, high) if stretch.end_rad - stretch.start_rad < crank_rad else (low, middle)
    return linkage.stroke_mm * high**2


def time_ratio(machine: Machine) -> float:
    """Time of the working stroke over the time of the return."""
    working = machine.extended_rad
    return working / (machine.transmission.cycle_rad - working)


def crank_rad(machine: Machine, phi1_rad: float) -> float:
    """Crank angle at a driving angle of any cycle, counted from the retracted dead centre."""
    turns, local = divmod(phi1_rad, machine.transmission.cycle_rad)
    return 2.0 * pi * turns + float(machine.transmission.driven_angle(np.array([local]), 0).value[0])


def driving_rad(machine: Machine, crank_rad: float) -> float:
    """Driving angle at a crank angle of any turn, counted from the retracted dead centre."""
    turns, local = divmod(crank_rad, 2.0 * pi)
    whole = turns * machine.transmission.cycle_rad
    found = machine.driving_angles(np.array([local])) if local > 0.0 else np.zeros(1)
    return whole + (float(found[0]) if found.size else machine.transmission.cycle_rad)


def taken_rad(machine: Machine, stretch: CrankStretch) -> float:
    """Driving angle that a stretch of the crank angle takes."""
    return driving_rad(machine, stretch.end_rad) - driving_rad(machine, stretch.start_rad)


def speeds_mm_s(machine: Machine, stretch: CrankStretch) -> tuple[float, float]:
    """Least and greatest speed on a stretch of crank angles, at stationary points and both ends."""
    if not stretch.start_rad < stretch.end_rad:
        at = np.array([driving_rad(machine, stretch.start_rad)])
        speed = abs(float(machine.displacement(at, 1).derivative(1)[0])) * machine.speed_rad_s
        return speed, speed
    values = _extremes_of(machine, stretch, lambda part, phi1: part.speed(phi1, 1))
    return min(values) * machine.speed_rad_s, max(values) * machine.speed_rad_s


def deceleration_mm_s2(machine: Machine, stretch: CrankStretch) -> float:
    """The greatest fall of the speed in a second on a stretch of crank angles, 0 where the speed never falls."""
    values = _extremes_of(machine, stretch, lambda part, phi1: -part.speed(phi1, 2).differentiated())
    return max(0.0, max(values) * machine.speed_rad_s**2)


def _extremes_of(machine: Machine, stretch: CrankStretch, function: Callable[[Stretch, Array], Jet]) -> list[float]:
    """Least and greatest values of a function of smooth stretches of the motion, on a stretch of crank angles."""
    found: list[Extremum] = []
    for within, stroke in by_stroke(machine.linkage, stretch):
        start, end = driving_rad(machine, within.start_rad), driving_rad(machine, within.end_rad)
        for whole in stretches(machine):
            part = replace(whole, start_rad=max(start, whole.start_rad), end_rad=min(end, whole.end_rad))
            # Rounding must not bring in the other side of a dead centre
            if part.working is (stroke is Stroke.WORKING) and part.start_rad < part.end_rad:
                found += extremes(partial(function, part), part.start_rad, part.end_rad, np.array(part.knots_rad))
    return [extremum.value for extremum in found]


POINTS = 2048
"""Least number of driving angles of a stroke at which the longest stretch may begin, evenly spaced within each smooth
part.

Where the longest stretch begins and ends at slopes, it is even about the best beginning, so the nearest of n angles
costs about 1/n^2 of the stroke.  Where a peak or a dip of the speed decides, beginning and end are among the angles.
Both are within 1e-6 of the stroke in tests/test_wishes.py.
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
    while 1 << len(tops) <= count:
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
