"""An outline in polar coordinates about its gear's axis.

``PolarOutline`` tells which vertices lie in given directions.  ``RadialRuns`` cut an outline into runs along which the
distance from the axis grows or falls all the way.  A circle about the axis crosses such a run once, and bins of radii
tell where.
"""

from __future__ import annotations

from functools import cached_property
from math import ceil, pi, sqrt

import numpy as np

from ncgear.frozen import dataclass
from ncgear.numerics.arrays import Array, ComplexArray, IndexArray, Mask, counted_up
from ncgear.numerics.plane import across, along, angle_between, square

TURN = 2.0 * np.pi


@dataclass(frozen=True, eq=False)
class PolarOutline:
    """An outline around the origin, with bounds to find vertices by their polar angle.

    Over three turns, ``reached`` is the largest angle up to each vertex and ``left`` the smallest angle from it on;
    both grow all along, even where the outline turns back.
    """

    outline: ComplexArray
    reached: Array
    left: Array

    def windows(self, direction: Array, half_width: Array) -> tuple[IndexArray, IndexArray]:
        """Stretches of vertices (first number and count) with all vertices in sectors, and a vertex more at either end.

        Polar angles and half widths in rad, shape (n,).  Numbers may be negative: they count round the outline.
        """
        count = self.outline.size
        base = self.reached[count]
        middle = base + np.mod(direction - base, TURN)
        first = np.searchsorted(self.reached, middle - half_width) - 1
        after = np.searchsorted(self.left, middle + half_width) + 1
        return first - count, np.minimum(after - first, count)


def polar_outline(outline: ComplexArray) -> PolarOutline:
    """The bounds of an outline, shape (n,), that goes round the origin once, counter-clockwise."""
    angle = np.unwrap(np.angle(outline))
    turns = np.concatenate([angle - TURN, angle, angle + TURN])
    return PolarOutline(outline, np.maximum.accumulate(turns), np.minimum.accumulate(turns[::-1])[::-1])


SECTORS_PER_PITCH = 8
"""Sectors per pitch for finding runs by their direction; finer sectors hardly leave out more runs."""

BINS_PER_ENTRY = 2
"""Bins of squared radii per entry of the longest run, for finding entries."""

NO_RUN = -1
"""Stands for no run in the tables of runs near sectors."""


@dataclass(frozen=True, eq=False)
class RadialRuns:
    """The runs of an outline in order, each outwards from its end nearest the axis.

    ``point`` and ``square`` (squared distance from the axis) have shape (entries,), ``first`` and ``last`` number each
    run's entries and ``rising`` tells whether the outline runs outwards there, shape (runs,).  ``near`` lists the runs
    within reach of each sector, shape (sectors, any number), padded with NO_RUN.
    """

    point: ComplexArray
    square: Array
    first: IndexArray
    last: IndexArray
    rising: Mask
    near: IndexArray

    @cached_property
    def polar_rad(self) -> Array:
        """Polar angle of each entry."""
        return np.angle(self.point)

    @cached_property
    def radius_mm(self) -> Array:
        """Distance of each entry from the axis."""
        return np.sqrt(self.square)

    @property
    def heading_rad(self) -> Array:
        """The first value of ``headings`` for the chord after each entry; meaningless at the last entry of a run."""
        return self._headings[0]

    @property
    def aside_mm(self) -> Array:
        """The second value of ``headings``."""
        return self._headings[1]

    @cached_property
    def _headings(self) -> tuple[Array, Array]:
        return headings(self.point, np.append(np.diff(self.point), 1.0))

    @cached_property
    def inner(self) -> Array:
        """Squared radius at which each run begins; infinite for NO_RUN."""
        return np.append(self.square[self.first], np.inf)

    @cached_property
    def outer(self) -> Array:
        """Squared radius at which each run ends; -1 for NO_RUN."""
        return np.append(self.square[self.last], -1.0)

    @cached_property
    def reach(self) -> tuple[Array, Array]:
        """Least and largest squared radius of the runs near each sector, shape (sectors,) each."""
        return self.inner[self.near].min(axis=1), self.outer[self.near].max(axis=1)

    @cached_property
    def _bins(self) -> int:
        """Number of bins of squared radii for each run; most bins hold at most one entry."""
        return BINS_PER_ENTRY * int((self.last - self.first).max() + 1)

    @cached_property
    def _per_square(self) -> Array:
        """Bins per squared mm of each run."""
        return self._bins / np.maximum(self.outer[:-1] - self.inner[:-1], np.finfo(float).tiny)

    @cached_property
    def _first_in_bin(self) -> IndexArray:
        """First entry in each bin of a run or beyond, bins + 1 numbers for each run, in the order of runs."""
        run, _ = counted_up(self.first, self.last - self.first + 1)
        places = np.arange(self.first.size * (self._bins + 1))
        return np.searchsorted(self._bin(run, self.square), places)

    def _bin(self, run: IndexArray, squared: Array) -> IndexArray:
        """Places of squared radii in the table of bins, which grow with the radius."""
        bins = (squared - self.inner[run]) * self._per_square[run]
        return np.clip(bins, 0.0, self._bins).astype(int) + run * (self._bins + 1)

    def sector(self, polar_rad: Array) -> IndexArray:
        """Number of the sector that each polar angle, from -pi to pi, lies in."""
        sectors = len(self.near)
        sector = np.floor(polar_rad * (sectors / TURN)).astype(int)
        return np.where(sector < 0, sector + sectors, sector) % sectors

    def entry_beyond(self, run: IndexArray, squared: Array) -> IndexArray:
        """First entry of runs at or beyond squared radii; the number after the last entry where there is none."""
        found, last = self._first_in_bin[self._bin(run, squared)], self.last[run]
        short = np.nonzero((found <= last) & (self.square[np.minimum(found, self.square.size - 1)] < squared))[0]
        while short.size:
            found[short] += 1
            short = short[found[short] <= last[short]]
            short = short[self.square[found[short]] < squared[short]]
        return found


def radial_runs(outline: ComplexArray, reach_mm: float, pitch_mm: float) -> RadialRuns:
    """The runs of an outline (n,) about the origin; near sectors by arcs of up to ``reach_mm``."""
    chord, foot = with_feet(outline, np.roll(outline, -1))
    ring = np.insert(outline, chord + 1, foot)
    rising = square(np.roll(ring, -1)) > square(ring)
    # The ring begins where a run begins.
    turn = int(np.argmax(rising != np.roll(rising, 1)))
    ring, rising = np.roll(ring, -turn), np.roll(rising, -turn)
    start = np.nonzero(rising != np.roll(rising, 1))[0]
    count = np.diff(np.append(start, ring.size)) + 1
    first = np.cumsum(count) - count
    run, step = counted_up(np.zeros_like(count), count)
    outwards = rising[start]
    point = ring[(start[run] + np.where(outwards[run], step, count[run] - 1 - step)) % ring.size]
    near = _near_sectors(point, run, first, reach_mm, pitch_mm)
    return RadialRuns(point, square(point), first, first + count - 1, outwards, near)


def _near_sectors(
    point: ComplexArray, run: IndexArray, first: IndexArray, reach_mm: float, pitch_mm: float
) -> IndexArray:
    """The runs near each sector; sectors start at the polar angle 0."""
    begin = point[first]
    swept, margin = angle_between(begin[run], point), reach_mm / np.abs(begin)
    sectors = ceil(2.0 * pi * sqrt(float(square(point).max())) / pitch_mm * SECTORS_PER_PITCH)
    low = np.angle(begin) + np.minimum.reduceat(swept, first) - margin
    high = np.angle(begin) + np.maximum.reduceat(swept, first) + margin
    low_sector, high_sector = (np.floor(angle * (sectors / (2.0 * pi))).astype(int) for angle in (low, high))
    owner, sector = counted_up(low_sector, np.minimum(high_sector - low_sector + 1, sectors))
    order = np.argsort(sector % sectors, kind="stable")
    owner, sector = owner[order], (sector % sectors)[order]
    width = np.bincount(sector, minlength=sectors)
    near = np.full((sectors, int(width.max())), NO_RUN)
    near[sector, np.arange(owner.size) - (np.cumsum(width) - width)[sector]] = owner
    return near


def headings(point: ComplexArray, outwards: ComplexArray) -> tuple[Array, Array]:
    """Polar angles in rad of directions, and how far to their left points stand of the origin, in mm; shape (n,) each.

    A straight line from ``point`` on ``outwards``, along which the radius grows, crosses a circle of radius r about the
    origin at the polar angle heading + arcsin(aside / r).
    """
    length = np.sqrt(np.maximum(square(outwards), np.finfo(float).tiny))
    return np.angle(outwards), across(outwards, point) / length


def with_feet(start: ComplexArray, end: ComplexArray) -> tuple[IndexArray, ComplexArray]:
    """Numbers of the chords whose nearest point to the origin is between their ends, and these points (feet)."""
    step = end - start
    share = -along(step, start) / np.maximum(square(step), np.finfo(float).tiny)
    inside = np.nonzero((share > 0.0) & (share < 1.0))[0]
    return inside, start[inside] + share[inside] * step[inside]
