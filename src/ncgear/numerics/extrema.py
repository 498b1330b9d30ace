"""Largest and smallest values of a smooth function on intervals, located by the zeros of its derivative."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from functools import partial

import numpy as np

from ncgear.frozen import dataclass
from ncgear.numerics.arrays import Array, IndexArray, Mask, distinct
from ncgear.numerics.jet import Jet
from ncgear.numerics.zeros import zeros_between

SAMPLES = 129
"""Points per piece, and four more for each of its knots, between which sign changes of the derivative are looked for.
Two extrema closer than a 128th of a piece may be missed together; their values differ by at most that distance cubed
times a twelfth of the third derivative."""

ROUGH = 0.01
"""Share of the largest value by which a sample may miss the cubic through its neighbours.  A wave of nine samples
misses it by this share; narrower features, as of a ratio of 1:200, are sampled more finely until they miss by less."""

FINE, BEYOND = 1e-6, 10.0
"""Where the value may be the largest or the smallest, samples are added until they miss by this share only.  It may be
so where a sample is less than ten times what it misses by away from the largest or smallest one so far."""

HALVINGS = 30
"""Most halvings of a step: steps of 1e-11 of a piece are next to rounding."""

WAVY = 0.9
"""If a larger share of samples misses the cubic, finer ones are of no use: waves are narrower than three samples."""

DOUBTFUL = 0.1
"""If a larger share of samples misses the cubic, the function may be zero but for rounding errors."""

ASIDE = 1e-9
"""Share of a step by which samples are moved to tell rounding errors, which differ from one number to the next."""

FLAT = 4.0 * np.finfo(float).eps
"""Rise over a step, as a share of the largest value, up to which a slope counts as zero: a sample of such a slope is as
good as an extremum beside it.  Where the function is constant, slopes are rounding errors, and change their signs at
every other sample."""

MOST_ADDED = 20_000
"""Number of points added to a piece at which refining ends; a ratio of 1:200 takes 200."""

NEXT = 1e-3
"""Share of a step at which a further sample is taken beside one of zero slope.  A zero of third order leaves a slope of
1e-6 there, which is more than rounding; an extremum that is nearer to an inflection differs from it in height by at
most 1e-9 of the step's rise."""

NO_KNOTS = np.empty(0)


@dataclass(frozen=True)
class Extremum:
    """A value and the argument at which it is reached."""

    value: float
    at: float


def stationary_points(function: Callable[[Array], Jet], start: float, end: float, knots: Array = NO_KNOTS) -> Array:
    """Both ends, every point between them where the derivative changes sign, and samples where it is not finite.

    The points rise.  ``function`` maps points (shape (n,)) to a jet of order 1 or more, and is evaluated within
    [start, end] only.  It varies about equally between any two neighbours of ``knots`` (shape (m,), rising); knots
    outside [start, end] are ignored.
    """
    return _stationary(lambda points: [function(points)], grid_between(start, end, knots))[0]


Functions = Callable[[Array], Sequence[Jet]]
"""From points, shape (n,), to jets of several functions there, each of order 1 or more."""


def _stationary(functions: Functions, grid: Array) -> list[Array]:
    """As ``stationary_points``, of each of several functions, on a grid that is given."""
    sampled = [
        _beside_flat(one, *_sampled(one, grid, first))
        for number, first in enumerate(functions(grid))
        for one in (partial(_one_of, functions, number),)
    ]
    changes = [np.nonzero(np.sign(slope[:-1]) * np.sign(slope[1:]) < 0)[0] for _, slope in sampled]
    brackets = [
        np.array([points[change], points[change + 1], slope[change], slope[change + 1]])
        for (points, slope), change in zip(sampled, changes, strict=True)
    ]
    found = _changes_of_sign(functions, brackets)
    return [
        distinct(np.concatenate([grid[[0, -1]], points[1:-1][(slope[1:-1] == 0.0) | ~np.isfinite(slope[1:-1])], zeros]))
        for (points, slope), zeros in zip(sampled, found, strict=True)
    ]


def _one_of(functions: Functions, number: int, points: Array) -> Jet:
    return functions(points)[number]


def _changes_of_sign(functions: Functions, brackets: list[Array]) -> list[Array]:
    """Zeros of the slopes of several functions, all sought at once since these have much in common.

    The brackets of each have shape (4, n): low and high ends, and slopes there.
    """
    low, high, *known = np.concatenate(brackets, axis=1)
    if not low.size:
        return [low for _ in brackets]
    counts = [bracket.shape[1] for bracket in brackets]
    owner, every = np.repeat(np.arange(len(brackets)), counts), np.arange(low.size)

    def slopes(points: Array) -> Array:
        chosen: Array = np.array([jet.derivative(1) for jet in functions(points)])[owner, every]
        return chosen

    return np.split(zeros_between(slopes, low, high, (known[0], known[1])), np.cumsum(counts)[:-1])


def grid_between(start: float, end: float, knots: Array) -> Array:
    """Points from start to end, the same number between any two neighbouring knots, however close these are.

    An even number of steps lies between two knots, so that steps come in pairs of the same length.
    """
    edges = np.concatenate([[start], knots[(knots > start) & (knots < end)], [end]])
    each = 2 * -(-(SAMPLES - 1 + 4 * (edges.size - 2)) // (2 * (edges.size - 1)))
    shares = np.arange(each) / each
    return np.append((edges[:-1, None] + np.diff(edges)[:, None] * shares).ravel(), end)


def _sampled(function: Callable[[Array], Jet], grid: Array, jet: Jet) -> tuple[Array, Array]:
    """Points and slopes, more of them than those of the grid where the function's ``jet`` there tells too little.

    That is where a sample is far from the cubic through its two neighbours.
    The samples compared are every other point of the grid, from the second on; they lie halfway between neighbours.
    """
    points = grid
    values, slopes = jet.value, jet.derivative(1)
    low = np.arange(0, grid.size - 2, 2)
    middle, high = low + 1, low + 2
    for halving in range(HALVINGS):
        missed = _missed(points, values, slopes, (low, middle, high))
        scale = np.max(np.abs(values))
        if not halving:
            far = np.mean(missed > ROUGH * scale)
            if far > DOUBTFUL and _is_noise(function, points, values):
                return points, np.zeros_like(slopes)
            if far > WAVY:
                break
        rough = (missed > ROUGH * scale) | ((missed > FINE * scale) & _may_be_extreme(values, missed, middle))
        if not rough.any() or points.size > grid.size + MOST_ADDED:
            break
        low, high = np.concatenate([low[rough], middle[rough]]), np.concatenate([middle[rough], high[rough]])
        between = (points[low] + points[high]) / 2.0
        middle, jet = points.size + np.arange(between.size), function(between)
        points = np.concatenate([points, between])
        values, slopes = np.concatenate([values, jet.value]), np.concatenate([slopes, jet.derivative(1)])
    order = np.argsort(points, kind="stable")
    points, slopes = points[order], slopes[order]
    step = np.diff(points)
    rise = np.abs(slopes) * np.maximum(np.append(step, 0.0), np.append(0.0, step))
    return points, np.where(rise <= FLAT * np.max(np.abs(values)), 0.0, slopes)


def _is_noise(function: Callable[[Array], Jet], points: Array, values: Array) -> bool:
    """Whether a function has nothing but rounding errors: as a rule it is another one right beside a sample."""
    beside = function(points[:-1] + ASIDE * np.diff(points)).value
    return bool(np.mean(np.abs(beside - values[:-1]) > ROUGH * np.max(np.abs(values))) > DOUBTFUL)


def _beside_flat(function: Callable[[Array], Jet], grid: Array, slope: Array) -> tuple[Array, Array]:
    """The samples, with one on either side of each whose slope is zero.

    At an inflection the slope has the same sign on both sides, and its zero would hide a change in the step before.
    """
    flat = np.nonzero(slope[1:-1] == 0.0)[0] + 1
    if not flat.size or flat.size == slope.size - 2:
        return grid, slope
    beside = [grid[flat] - NEXT * (grid[flat] - grid[flat - 1]), grid[flat] + NEXT * (grid[flat + 1] - grid[flat])]
    points = np.concatenate([grid, *beside])
    slopes = np.concatenate([slope, *(function(points).derivative(1) for points in beside)])
    order = np.argsort(points, kind="stable")
    return points[order], slopes[order]


def _missed(points: Array, values: Array, slopes: Array, triples: tuple[IndexArray, IndexArray, IndexArray]) -> Array:
    """How far each middle sample is from the cubic with the values and slopes of its two neighbours."""
    low, middle, high = triples
    cubic = (values[low] + values[high]) / 2.0 + (points[high] - points[low]) * (slopes[low] - slopes[high]) / 8.0
    missed: Array = np.abs(values[middle] - cubic)
    return missed


def _may_be_extreme(values: Array, missed: Array, middle: IndexArray) -> Mask:
    """Whether the function about each middle sample may go beyond all samples, judged by how far it ``missed``."""
    reach = BEYOND * missed
    beyond: Mask = (values[middle] + reach > np.max(values)) | (values[middle] - reach < np.min(values))
    return beyond


def extremes(
    function: Callable[[Array], Jet], start: float, end: float, knots: Array = NO_KNOTS
) -> tuple[Extremum, Extremum]:
    """Smallest and largest value on [start, end], as of ``stationary_points``."""
    return extremes_on(lambda points: [function(points)], grid_between(start, end, knots))[0]


def extremes_on(functions: Functions, grid: Array) -> list[tuple[Extremum, Extremum]]:
    """Smallest and largest value of several functions on a grid as ``grid_between`` makes it, from end to end."""
    places = _stationary(functions, grid)
    ends = np.cumsum([points.size for points in places])
    found = []
    for number, (points, jet) in enumerate(zip(places, functions(np.concatenate(places)), strict=True)):
        values = jet.value[ends[number] - points.size : ends[number]]
        low, high = int(np.argmin(values)), int(np.argmax(values))
        found.append(
            (Extremum(float(values[low]), float(points[low])), Extremum(float(values[high]), float(points[high])))
        )
    return found
