"""Ranges of q = s^2 that all motions below a target keep; with them two non-convex relations enter the limit.

They are the convexity of the driving curve and, with masses, the time of each cell (see ``motion``).  Programmes find
the least and the greatest q at checkpoints of all motions whose goal is below the target.  Between two of them the
driven curve bounds q from above, the driving curve from below: with i = 1/s = i12 and y = ln q, both are convex where

    1 + s + s'' >= 0     and     y'' <= 2 i + 2 i^2

Where curves need not be convex, the pressure angle bounds q both ways: |s'| <= t (1 + s), so 1 + s changes by a factor
of exp(t d) at most over d rad of the crank.

Then the relations can be added with these ranges, and the next ranges are narrower (``tree``).
"""

from __future__ import annotations

from collections.abc import Sequence
from itertools import pairwise
from math import inf, pi

import numpy as np

from ncgear.frozen import dataclass
from ncgear.numerics.arrays import Array, IndexArray
from ncgear.optimum.certified.cycle import CrankCycle
from ncgear.optimum.certified.demands import Demands, Ranges

LOWER = 0.02
"""Largest distance of ln q between two checkpoints below the chord through them."""

LEANING = 0.6
"""Largest distance of ln q from that chord where only the pressure angle bounds it."""

ROUNDING = 1e-9
"""Relative error that a range between checkpoints may have by rounding, with much to spare."""


def halves(on: CrankCycle) -> list[IndexArray]:
    """All places of the turn, in two parts that share their ends."""
    middle = on.count // 2
    return [np.arange(middle + 1), np.append(np.arange(middle, on.count), 0)]


def parts_between(on: CrankCycle, places: IndexArray, motion: Array, asked: Demands) -> list[IndexArray]:
    """Places in a row in parts from checkpoint to checkpoint, between which ln q hardly leaves the chord.

    ``motion`` is q at the places of a motion that keeps demands.
    """
    ratio = 1.0 / np.sqrt(motion)
    if asked.convex:
        # A chord of length L is missed by R L^2/8
        apart = np.sqrt(8.0 * LOWER / (2.0 * ratio + 2.0 * ratio**2))
    else:
        # At its middle by t (1 + s)/s L
        apart = LEANING / (asked.steepness * (1.0 + ratio))
    gone = np.concatenate([[0.0], np.cumsum(on.step_rad[places[:-1]] / np.minimum(apart[:-1], apart[1:]))])
    count = max(1, round(float(gone[-1])))
    numbers = np.searchsorted(gone, gone[-1] * np.arange(count + 1) / count - 1e-9)
    ends = np.unique(np.minimum(numbers, places.size - 1)).tolist()
    return [places[first : last + 1] for first, last in pairwise(ends)]


@dataclass(frozen=True, eq=False)
class KnownRanges:
    """Ranges of q at the places, shape (n,)."""

    least: Array
    most: Array

    def within(self, place: int, least: float, most: float) -> KnownRanges:
        """The ranges with a range at a place, unless a narrower range is known."""
        low, high = self.least.copy(), self.most.copy()
        low[place] = max(low[place], least)
        high[place] = min(high[place], most)
        return KnownRanges(low, high)

    @property
    def empty(self) -> bool:
        """Whether some place has no possible q."""
        return bool(np.any(self.least > self.most))


def cells_that_matter(on: CrankCycle, without: Array, motion: Array) -> IndexArray:
    """The cells beside places where the driving curve is concave without the relation, or flat with it."""
    matter = (_spare(on, without) < 0.0) | (_spare(on, motion) < FLAT)
    return np.nonzero(matter | np.roll(matter, -1))[0]


FLAT = 0.02
"""Convexity, over the size of its terms, below which the driving curve counts as flat."""


def _spare(on: CrankCycle, q: Array) -> Array:
    """1 + s - s s'' + s'^2 over the size of its terms, shape (n,): the room until the driving curve is flat."""
    after, before = on.step_rad, np.roll(on.step_rad, 1)
    s = np.sqrt(q)
    forward, backward = (np.roll(s, -1) - s) / after, (s - np.roll(s, 1)) / before
    bend, slope = 2.0 * (forward - backward) / (after + before), (forward + backward) / 2.0
    return (1.0 + s - s * bend + slope**2) / (1.0 + s + np.abs(s * bend) + slope**2)


def rows_of_places(cells: IndexArray, count: int) -> list[IndexArray]:
    """The places of cells in a row, around the turn; gaps of two cells are closed."""
    if not cells.size:
        return []
    ordered = np.sort(cells)
    gaps = np.diff(np.append(ordered, ordered[0] + count))
    turned = np.roll(ordered, -(int(np.argmax(gaps)) + 1))
    parts = np.split(turned, np.nonzero(np.diff(turned) % count > 3)[0] + 1)
    return [(part[0] + np.arange((part[-1] - part[0]) % count + 2)) % count for part in parts]


@dataclass(frozen=True, eq=False)
class CheckpointPlaces:
    """Places from each checkpoint to the next, shape (parts, n): a part of fewer places ends with its last again.

    ``angle_rad`` is the crank's angle from the part's first place.
    """

    places: IndexArray
    angle_rad: Array
    asked: Demands

    def everywhere(self, known: KnownRanges) -> Ranges:
        """Ranges of q at all places and in all cells between checkpoints, from known ranges."""
        places, angle, asked = self.places, self.angle_rad, self.asked
        if asked.convex:
            low, low_in_cell = _between_lower(known.least[places], angle, asked.ratio_max)
            high, high_in_cell = _between_upper(known.most[places], angle)
        else:
            low, low_in_cell = _leaning(known.least[places], angle, -asked.steepness)
            high, high_in_cell = _leaning(known.most[places], angle, asked.steepness)
        least, most, least_in_cell, most_in_cell = (np.full(known.least.size, end) for end in (0.0, inf) * 2)
        least[places], most[places] = low * (1.0 - ROUNDING), high * (1.0 + ROUNDING)
        true = np.diff(angle, axis=1) > 0.0
        cells = places[:, :-1][true]
        least_in_cell[cells] = low_in_cell[true] * (1.0 - ROUNDING)
        most_in_cell[cells] = high_in_cell[true] * (1.0 + ROUNDING)
        return Ranges(least, most, least_in_cell, most_in_cell)


def between(on: CrankCycle, parts: Sequence[IndexArray], asked: Demands) -> CheckpointPlaces:
    """The places of parts from checkpoint to checkpoint."""
    most = max(part.size for part in parts)
    places = np.array([np.pad(part, (0, most - part.size), mode="edge") for part in parts])
    steps = np.where(places[:, 1:] != places[:, :-1], on.step_rad[places[:, :-1]], 0.0)
    return CheckpointPlaces(places, np.cumsum(np.pad(steps, ((0, 0), (1, 0))), axis=1), asked)


def _leaning(known: Array, angle_rad: Array, steepness: float) -> tuple[Array, Array]:
    """Greatest q at places and in cells where 1 + s changes by exp(t d) over d rad; the least where t is negative."""
    sign = 1.0 if steepness > 0.0 else -1.0
    far, height = abs(steepness) * angle_rad, sign * np.log1p(np.sqrt(known))
    onward = np.minimum.accumulate(height - far, axis=1) + far
    at = np.minimum(onward, np.minimum.accumulate((height + far)[:, ::-1], axis=1)[:, ::-1] - far)
    in_cell = (at[:, :-1] + at[:, 1:] + np.diff(far, axis=1)) / 2.0
    q, q_in_cell = (np.maximum(np.expm1(sign * log), 0.0) ** 2 for log in (at, in_cell))
    return q, q_in_cell


def _between_upper(known: Array, angle_rad: Array) -> tuple[Array, Array]:
    """Greatest q at places from known places, and in the cells: 1 + s lies below the sine curve through both ends."""
    length, most = angle_rad[:, -1:], 1.0 + np.sqrt(known)
    bounded = np.isfinite(most[:, :1] + most[:, -1:])
    first, last = (np.where(bounded, end, 0.0) for end in (most[:, :1], most[:, -1:]))
    sine = (first * np.sin(length - angle_rad) + last * np.sin(angle_rad)) / np.sin(length)
    at = np.where(bounded, np.minimum(sine, most), most)
    in_cell = np.maximum(at[:, :-1], at[:, 1:]) / np.cos(np.diff(angle_rad, axis=1) / 2.0)
    in_cell = np.where(bounded, in_cell, inf)
    return (at - 1.0) ** 2, (in_cell - 1.0) ** 2


def _between_lower(known: Array, angle_rad: Array, ratio_max: float) -> tuple[Array, Array]:
    """Least q at places from known places, and in the cells: ln q bends up by 2 i + 2 i^2 at most."""
    length, log = angle_rad[:, -1:], np.log(known)
    ratio = _greatest_ratio(1.0 / np.sqrt(np.minimum(known[:, :1], known[:, -1:])), length, ratio_max)
    bend = 2.0 * ratio + 2.0 * ratio**2
    rise = (log[:, -1:] - log[:, :1]) / length
    chord = np.where(angle_rad < length, rise * angle_rad + log[:, :1], log[:, -1:])
    at = np.maximum(chord - bend * angle_rad * (length - angle_rad) / 2.0, -2.0 * np.log(ratio))
    at = np.maximum(at, log)
    in_cell = np.minimum(at[:, :-1], at[:, 1:]) - bend * np.diff(angle_rad, axis=1) ** 2 / 8.0
    return np.exp(at), np.exp(in_cell)


def _greatest_ratio(at_ends: Array, length_rad: Array, most: float) -> Array:
    """The greatest i12 on stretches of the crank angle of a convex driving curve, from the greatest at their ends.

    Over the driving angle 1 + i lies at or below the sine curve through the ends: I <= (1 + M) / cos(I length/2) - 1,
    where I, the greatest i of the stretch, bounds the driving angle.  The right side is convex in I.  Where it is less
    than I at the greatest ratio of all, I is at most the first fixed point.
    """

    def above(ratio: Array) -> Array:
        half = ratio * length_rad / 2.0
        return np.where(half < 1.5, (1.0 + at_ends) / np.cos(np.minimum(half, 1.5)) - 1.0, inf)

    found = np.full(at_ends.shape, most)
    left, ratio = above(found) < most, at_ends
    for _ in range(100):
        if not np.any(left):
            break
        ratio = np.minimum(above(ratio), most)
        enough = np.minimum(ratio * (1.0 + 1e-6), most)
        settled = left & (above(enough) <= enough)
        found, left = np.where(settled, enough, found), left & ~settled
    return found


# --- three places in a row of a convex driving curve -----------------------------------------------------------------


def curved(low: Array, high: Array, before: Array, after: Array) -> tuple[Array, Array, Array, IndexArray]:
    """y0 >= first y- + second y+ + rest where y'' <= 2 exp(-y) + 2 exp(-y/2) and y lies between ``low`` and ``high``.

    ``before`` and ``after`` are the lengths of the cells on both sides, shape (k,); the last result has the places for
    which the relation holds.  The right side lies below its chord, a - c y.  The solutions of y'' + c y = a are a/c and
    waves of sqrt(c) per rad; the maximum principle holds while the places are less than half a wave apart.
    """
    wide = np.maximum(high - low, 1e-12)
    c = -(2.0 * np.exp(-low) * np.expm1(-wide) + 2.0 * np.exp(-low / 2.0) * np.expm1(-wide / 2.0)) / wide
    a = 2.0 * np.exp(-low) + 2.0 * np.exp(-low / 2.0) + c * low
    k = np.sqrt(c)
    whole = np.sin(k * (before + after))
    rest = -2.0 * np.sin(k * before / 2.0) * np.sin(k * after / 2.0) / np.cos(k * (before + after) / 2.0) * a / c
    good = np.nonzero(k * (before + after) < 0.9 * pi)[0]
    return np.sin(k * after) / whole, np.sin(k * before) / whole, rest, good


def along(rate: Array, about: Array, before: Array, after: Array) -> tuple[Array, Array, Array]:
    """q0 >= first q- + second q+ + rest where q'' <= 2 + 2 sqrt(q) + 2 rate q' - rate^2 q, shape (k,).

    The root of q lies below its tangent at ``about``, a value near q0, or at another value where that would lose
    digits.  With c = rate^2 - 1/sqrt(tangent) and k^2 = rate^2 - c the solutions are exp(rate t) times sinh of k t.
    """
    tangent = _tangent(rate**2, about)
    c, d = rate**2 - 1.0 / np.sqrt(tangent), 2.0 + np.sqrt(tangent)
    k = tangent**-0.25
    whole = np.sinh(k * (before + after))
    first = np.exp(rate * before) * np.sinh(k * after) / whole
    second = np.exp(-rate * after) * np.sinh(k * before) / whole
    rest: Array = d * (1.0 - first - second) / c
    return first, second, rest


LEAST_C = 0.3
"""Size of c from which 1 - first - second, about c h^2/2, keeps twelve digits on cells of a degree or two."""


def _tangent(product: Array, about: Array) -> Array:
    """The value of q for the tangent: the given value, or the nearest value whose c is not too small."""
    c = product - 1.0 / np.sqrt(about)
    lifted = np.where(c >= 0.0, product - LEAST_C, product + LEAST_C)
    lifted = np.where(lifted > 0.0, lifted, product + LEAST_C)
    moved = 1.0 / np.maximum(lifted, 1e-3) ** 2
    return np.where(np.abs(c) < LEAST_C, moved, about)
