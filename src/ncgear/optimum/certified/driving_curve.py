"""The driving curve's convexity in the certified limit: how far q'/q can be from that of the best motion known.

The relation of the driving curve is not convex in q = s^2, but nearly so where r = q'/q is known within a narrow range.
At checkpoints, values of r are excluded: with the mean of r in one cell beyond a value, the programme has no motion
below a target.  So every motion below the target has a mean of r within ranges there.  Between the checkpoints r
follows, because convexity itself bounds its slope: with i = 1/s = i12, the driving curve is convex where

    r' <= 2 i + 2 i^2      (from q'' <= 2 + 2 sqrt(q) + q'^2/q, divided by q)

Then the relation can be added with these ranges, and the next ranges are narrower.  The target is a limit if the last
programme's least value is no less; otherwise that value is.
"""

from __future__ import annotations

from collections.abc import Callable, Sequence
from dataclasses import dataclass, replace
from itertools import pairwise
from math import cos, inf, sqrt
from typing import Literal

import numpy as np

from ncgear.numerics.arrays import Array, IndexArray
from ncgear.optimum.certified.cycle import Cycle
from ncgear.optimum.certified.demands import Rates


@dataclass(frozen=True, eq=False)
class Tried:
    """A certain least value of a programme, and q at the places of a motion near it; None where none was found."""

    value: float
    q: Array | None


@dataclass(frozen=True, eq=False)
class Trials:
    """What can be asked of the programmes of one cycle.

    ``least`` gives the least value of the goal with ranges of r; ``along`` the same along the tangent (see
    ``motion.motion_programme``); ``least_q`` the least q at a place of all motions whose goal is below a value.
    """

    on: Cycle
    least: Callable[[Rates | None], Tried]
    along: Callable[[Rates], Tried]
    least_q: Callable[[Rates | None, int, float], float]


@dataclass(frozen=True, eq=False)
class Solved:
    """A value, and q at the places of a motion near it."""

    value: float
    q: Array


STEPS = 3
"""Steps along the tangent: the motion found keeps the driving curve convex, and three steps find all of it but 1e-6."""

SHARES = (0.75, 0.4, 0.2)
"""Shares of the way from the limit without the driving curve to the motion found: aimed at until one is met."""

APART_RAD = 0.06
"""Greatest distance of checkpoints."""

ROUNDS = 3
"""Most rounds of narrower ranges; two are the rule."""

LEAST_GAIN = 0.01
"""Share of the way to the target that the first rounds must have gained for another one to follow."""

TRIALS = 3
"""Most trials of one end of a range in a round."""

FIRST_WIDTH = 2.0
"""Half width of a range of r, per rad, that is tried first."""

ROOM = 1.12
"""By how much a range is wider than the estimate from the first trial: the value grows about as its square."""

WIDER = 3.0
"""Most by which a range is made wider at once."""

NARROWER = 0.5
"""How much narrower than the range known a range is that is tried in the next round."""


def motion_along(trials: Trials, found: Solved) -> Solved:
    """The motion to which a few steps along the tangent of the driving curve's relation lead, from another one."""
    for _ in range(STEPS):
        rates = mean_rates(trials.on, found.q)
        step = trials.along(Rates(rates, rates, rates, rates, found.q))
        if step.q is None:
            break
        found = Solved(step.value, step.q)
    return found


def with_driving_curve(trials: Trials, without: Solved, motion: Solved, ratio_max: float) -> float:
    """A certain least value with the driving curve convex, from the answer without it and a motion that keeps it."""
    on = trials.on
    stretches = [
        Stretch(cells, _checkpoints(on, cells), ratio_max)
        for cells in _stretches(cells_that_matter(on, without.q, motion.q), on.count)
    ]
    proven = without.value
    for share in SHARES:
        target = without.value + share * (motion.value - without.value)
        proven = max(proven, _aimed_at(trials, stretches, Solved(target, motion.q), without.value, ratio_max))
        if proven >= target:
            break
    return proven


def _aimed_at(trials: Trials, stretches: Sequence[Stretch], aim: Solved, without: float, ratio_max: float) -> float:
    """The target, or what is certain below it, from ranges of r about the motion's that are narrowed in rounds."""
    on = trials.on
    known = Known(np.full(on.count, -inf), np.full(on.count, inf), np.full(on.count, 1.0 / ratio_max**2))
    proven = base = without
    for _ in range(ROUNDS):
        for stretch in stretches:
            known = _with_least_q(trials, stretches, known, stretch, aim.q, aim.value)
        for stretch in stretches:
            for cell in stretch.checkpoints:
                known = _narrowed(trials, stretches, known, cell, aim, base)
        base = trials.least(_ranges(on, known, stretches, aim.q)).value
        proven = max(proven, min(aim.value, base))
        if base >= aim.value or not base > without + LEAST_GAIN * (aim.value - without):
            break
    return proven


@dataclass(frozen=True, eq=False)
class Stretch:
    """Cells in a row in which the driving curve matters, and those of them at which ranges are looked for."""

    cells: IndexArray
    checkpoints: Sequence[int]
    ratio_max: float


@dataclass(frozen=True, eq=False)
class Known:
    """Ranges of the mean of r in every cell, and least q at every place, shape (n,); known at checkpoints only."""

    least: Array
    most: Array
    least_q: Array


def mean_rates(on: Cycle, q: Array) -> Array:
    """The mean of q'/q in every cell, shape (n,)."""
    rates: Array = np.log(np.roll(q, -1) / q) / on.step_rad
    return rates


def cells_that_matter(on: Cycle, without: Array, motion: Array) -> IndexArray:
    """The cells beside places where the driving curve is bent inwards without the relation, or flat with it."""
    matter = (_spare(on, without) < 0.0) | (_spare(on, motion) < FLAT)
    return np.nonzero(matter | np.roll(matter, -1))[0]


FLAT = 0.02
"""What is left of convexity, over the size of its terms, below which the driving curve counts as flat."""


def _spare(on: Cycle, q: Array) -> Array:
    """1 + s - s s'' + s'^2 over the size of its terms, shape (n,): what is left until the driving curve is flat."""
    after, before = on.step_rad, np.roll(on.step_rad, 1)
    s = np.sqrt(q)
    forward, backward = (np.roll(s, -1) - s) / after, (s - np.roll(s, 1)) / before
    bend, slope = 2.0 * (forward - backward) / (after + before), (forward + backward) / 2.0
    spare: Array = (1.0 + s - s * bend + slope**2) / (1.0 + s + np.abs(s * bend) + slope**2)
    return spare


def _stretches(cells: IndexArray, count: int) -> list[IndexArray]:
    """Cells in a row, around the turn; gaps of two cells are closed."""
    if not cells.size:
        return []
    ordered = np.sort(cells)
    gaps = np.diff(np.append(ordered, ordered[0] + count))
    start = (int(np.argmax(gaps)) + 1) % ordered.size
    turned = np.concatenate([ordered[start:], ordered[:start] + count])
    parts = np.split(turned, np.nonzero(np.diff(turned) > 3)[0] + 1)
    return [np.arange(part[0], part[-1] + 1) % count for part in parts]


def _checkpoints(on: Cycle, cells: IndexArray) -> list[int]:
    """Cells of a stretch at most APART_RAD from each other, first and last among them."""
    chosen, gone = [int(cells[0])], 0.0
    for cell, after in zip(cells[:-1].tolist(), cells[1:].tolist(), strict=True):
        gone += float(on.step_rad[cell])
        if gone + float(on.step_rad[after]) > APART_RAD or after == cells[-1]:
            chosen.append(after)
            gone = 0.0
    return list(dict.fromkeys(chosen))


def _with_least_q(
    trials: Trials, stretches: Sequence[Stretch], known: Known, stretch: Stretch, motion: Array, target: float
) -> Known:
    """What is known once the least q at the checkpoints of a stretch has been looked for."""
    ranges, least_q = _ranges(trials.on, known, stretches, motion), known.least_q.copy()
    for place in [*stretch.checkpoints, (stretch.checkpoints[-1] + 1) % trials.on.count]:
        least_q[place] = max(least_q[place], trials.least_q(ranges, place, target))
    return replace(known, least_q=least_q)


def _narrowed(trials: Trials, stretches: Sequence[Stretch], known: Known, cell: int, aim: Solved, base: float) -> Known:
    """What is known once both ends of the range of r in one cell have been tried again.

    ``aim`` holds the target and the q about which ranges lie; ``base`` is the least value with what was known before.
    A range that does not reach the target is tried once more, wider by what its value lacks.
    """
    on = trials.on
    middle = float(mean_rates(on, aim.q)[cell])
    for side in (-1, 1):
        ends = known.least if side < 0 else known.most
        width = min(FIRST_WIDTH, (float(ends[cell]) - middle) * side * NARROWER)
        for _ in range(TRIALS):
            end = middle + side * width
            value = trials.least(_ranges(on, _beyond(known, cell, end, side), stretches, aim.q)).value
            if value >= aim.value:
                known = _within(known, cell, end, side)
                break
            lacking = (aim.value - base) / (value - base) if value > base else inf
            width *= min(ROOM * sqrt(lacking), WIDER)
    return known


def _beyond(known: Known, cell: int, end: float, side: int) -> Known:
    """The mean of r in one cell is beyond a value."""
    return _moved(known, cell, end, "least" if side > 0 else "most")


def _within(known: Known, cell: int, end: float, side: int) -> Known:
    """The mean of r in one cell is on this side of a value, unless a nearer one is known."""
    if side > 0:
        return _moved(known, cell, min(float(known.most[cell]), end), "most")
    return _moved(known, cell, max(float(known.least[cell]), end), "least")


def _moved(known: Known, cell: int, end: float, which: Literal["least", "most"]) -> Known:
    moved = np.array(getattr(known, which))
    moved[cell] = end
    return replace(known, **{which: moved})


def _ranges(on: Cycle, known: Known, stretches: Sequence[Stretch], motion: Array) -> Rates:
    """Ranges of r in all cells of the stretches, of its mean and everywhere, from those of means at checkpoints.

    The slope of r is at most R, so that with the mean of r at most H in a cell with its middle at m, r <= H + R (phi2 -
    m) after it, and with the mean at least L, r >= L - R (m - phi2) before it.
    """
    mean_least, mean_most = known.least.copy(), known.most.copy()
    least, most = np.full(on.count, -inf), np.full(on.count, inf)
    for stretch in stretches:
        cells = stretch.cells
        risen = _rises(on, known, stretch) * on.step_rad[cells]
        ends = np.cumsum(risen)
        middles = ends - risen / 2.0
        high = np.minimum.accumulate(known.most[cells] - middles)
        low = np.maximum.accumulate((known.least[cells] - middles)[::-1])[::-1]
        mean_most[cells], mean_least[cells] = high + middles, low + middles
        most[cells[1:]], least[cells[:-1]] = high[:-1] + ends[1:], low[1:] + (ends - risen)[:-1]
    return Rates(mean_least, mean_most, least, most, motion)


def _rises(on: Cycle, known: Known, stretch: Stretch) -> Array:
    """The greatest slope of r in every cell of a stretch, 2 i + 2 i^2 with the greatest ratio i there, shape (k,)."""
    cells = stretch.cells
    rises = np.empty(cells.size)
    numbers = [int(np.nonzero(cells == one)[0][0]) for one in stretch.checkpoints]
    for first, last in pairwise([*numbers, cells.size]):
        part = slice(first, max(last, first + 1))
        ends = cells[first], (cells[min(last, cells.size - 1)] + (last == cells.size)) % on.count
        at_ends = 1.0 / sqrt(float(np.min(known.least_q[list(ends)])))
        ratio = _greatest_ratio(at_ends, float(np.sum(on.step_rad[cells[part]])), stretch.ratio_max)
        rises[part] = 2.0 * ratio + 2.0 * ratio**2
    return rises


def _greatest_ratio(at_ends: float, length_rad: float, most: float) -> float:
    """The greatest i12 on a stretch of the crank angle of a convex driving curve, from the greatest at its ends.

    Over the driving angle 1 + i lies at or below the sine curve through the ends: I <= (1 + M) / cos(I length/2) - 1,
    where I, the greatest i of the stretch, bounds the driving angle.  The right side is convex in I.  Where it is less
    than I at the greatest ratio of all, I is at most the first fixed point.
    """

    def above(ratio: float) -> float:
        half = ratio * length_rad / 2.0
        return (1.0 + at_ends) / cos(half) - 1.0 if half < 1.5 else inf

    if not above(most) < most:
        return most
    ratio = at_ends
    for _ in range(100):
        ratio = above(ratio)
        enough = min(ratio * (1.0 + 1e-6), most)
        if above(enough) <= enough:
            return enough
    return most
