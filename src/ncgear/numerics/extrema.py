"""Largest and smallest values of a smooth function on intervals, located by the zeros of its derivative."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from dataclasses import replace

import numpy as np

from ncgear.frozen import dataclass
from ncgear.numerics.arrays import Array, IndexArray, Mask, distinct
from ncgear.numerics.jet import Jet
from ncgear.numerics.zeros import zeros_between

SAMPLES = 129
"""Points per piece, and four more for each of its knots, between which sign changes of the derivative are searched. Two
extrema closer than a 128th of a piece may be missed together; their values differ by at most that distance cubed times
a twelfth of the third derivative."""

ROUGH = 0.01
"""Largest miss of a sample from the cubic through its neighbours, as a share of the largest value.  A wave of nine
samples misses it by this share; narrower features, as in a ratio of 1:200, are refined until they miss by less."""

FINE, BEYOND = 1e-6, 10.0
"""Where the value may be the largest or the smallest, samples are added until they miss by this share only.  It may be
if a sample is nearer to the largest or smallest one so far than ten times its miss."""

HALVINGS = 30
"""Most halvings of a step: steps of 1e-11 of a piece are next to rounding."""

WAVY = 0.9
"""If a larger share of samples misses the cubic, finer samples do not help: waves are narrower than three samples."""

DOUBTFUL = 0.1
"""If a larger share of samples misses the cubic, the function may be zero but for rounding errors."""

ASIDE = 1e-9
"""Shift of samples that shows rounding errors, as a share of a step; they differ from one number to the next."""

FLAT = 4.0 * np.finfo(float).eps
"""Largest rise over a step of a slope that counts as zero, as a share of the largest value: a sample of such a slope is
as good as an extremum beside it.  Where the function is constant, slopes are rounding errors, and change their signs at
every other sample."""

MOST_ADDED = 20_000
"""Number of points added to a piece at which refinement ends; a ratio of 1:200 takes 200."""

NEXT = 1e-3
"""Share of a step at which a further sample is taken beside a sample of zero slope.  A zero of third order leaves a
slope of 1e-6 there, which is more than rounding; an extremum that is nearer to an inflection differs from it in height
by at most 1e-9 of the step's rise."""

LEADING = 2.0
"""Factor by which a function may be steeper within a step over which its slope changes its sign than at the step's
ends, where only the largest and the smallest value matter: towards an extremum it gets less steep."""

NO_KNOTS = np.empty(0)


@dataclass(frozen=True)
class Extremum:
    """A value and the argument at which it is reached."""

    value: float
    at: float


def extreme(name: str, unit: str, found: Extremum, factor: float = 1.0) -> dict[str, float]:
    """An extreme value as a figure by its key, and as another one the driving angle at which it is."""
    return {f"{name}_{unit}": factor * found.value, f"{name}_at_rad": found.at}


def stationary_points(function: Callable[[Array], Jet], start: float, end: float, knots: Array = NO_KNOTS) -> Array:
    """Both ends, every point between them where the derivative changes sign, and samples where it is not finite.

    The points rise.  ``function`` maps points (shape (n,)) to a jet of order 1 or more, and is evaluated within
    [start, end] only.  It varies about equally between any two neighbours of ``knots`` (shape (m,), rising); knots
    outside [start, end] are ignored.
    """

    def functions(points: Array) -> list[Jet]:
        return [function(points)]

    samples = _sampled_each(functions, grid_between(start, end, knots))
    return _stationary(functions, samples, [of.changes for of in samples])[0]


Functions = Callable[[Array], Sequence[Jet]]
"""Function of points, shape (n,): jets of several functions there, each of order 1 or more."""


@dataclass(frozen=True, eq=False)
class _Samples:
    """A function at rising points, with its slopes there; shape (n,) each."""

    points: Array
    values: Array
    slopes: Array

    @property
    def rise(self) -> float:
        """The largest rise over a step of a slope that counts as zero."""
        return FLAT * float(np.max(np.abs(self.values)))

    @property
    def changes(self) -> IndexArray:
        """The steps, by the numbers of their first points, over which the slope changes its sign."""
        return np.nonzero(np.sign(self.slopes[:-1]) * np.sign(self.slopes[1:]) < 0)[0]

    @property
    def leading_changes(self) -> IndexArray:
        """The ``changes`` over which the function may go beyond all samples if it is at most LEADING times as steep."""
        step = self.changes
        beside = np.array([step, step + 1])
        values, rises = self.values[beside], LEADING * np.abs(self.slopes[beside]) * np.diff(self.points)[step]
        # Values that are not numbers are examined too.
        within = (values + rises < self.values.max()) & (values - rises > self.values.min())
        return step[~within.all(axis=0)]


def _sampled_each(functions: Functions, grid: Array) -> list[_Samples]:
    """Each of several functions on a grid, refined where the samples show too little."""
    return [
        _beside_flat(one, _sampled(one, grid, first))
        for number, first in enumerate(functions(grid))
        for one in (lambda points, number=number: functions(points)[number],)
    ]


def _stationary(functions: Functions, samples: list[_Samples], changes: list[IndexArray]) -> list[Array]:
    """As ``stationary_points``, for each of several functions, in the steps over which their slopes change signs."""
    brackets = [
        np.array(
            [of.points[step], of.points[step + 1], of.slopes[step], of.slopes[step + 1], np.full(step.size, of.rise)]
        )
        for of, step in zip(samples, changes, strict=True)
    ]
    return [
        distinct(np.concatenate([of.points[[0, -1]], of.points[1:-1][inner], zeros]))
        for of, zeros in zip(samples, _changes_of_sign(functions, brackets), strict=True)
        for inner in ((of.slopes[1:-1] == 0.0) | ~np.isfinite(of.slopes[1:-1]),)
    ]


def _changes_of_sign(functions: Functions, brackets: list[Array]) -> list[Array]:
    """Zeros of the slopes of several functions at once; brackets (5, n): low, high, slopes there, rise that is zero."""
    low, high, at_low, at_high, least = np.concatenate(brackets, axis=1)
    if not low.size:
        return [low for _ in brackets]
    counts = [bracket.shape[1] for bracket in brackets]
    owner, every = np.repeat(np.arange(len(brackets)), counts), np.arange(low.size)

    def slopes(points: Array) -> Array:
        chosen: Array = np.array([jet.derivative(1) for jet in functions(points)])[owner, every]
        return np.where(np.abs(chosen) * (high - low) <= least, 0.0, chosen)

    return np.split(zeros_between(slopes, low, high, (at_low, at_high)), np.cumsum(counts)[:-1])


def grid_between(start: float, end: float, knots: Array) -> Array:
    """Points from start to end, as many between any two neighbouring knots, in pairs of steps of equal length."""
    edges = np.concatenate([[start], knots[(knots > start) & (knots < end)], [end]])
    each = 2 * -(-(SAMPLES - 1 + 4 * (edges.size - 2)) // (2 * (edges.size - 1)))
    shares = np.arange(each) / each
    return np.append((edges[:-1, None] + np.diff(edges)[:, None] * shares).ravel(), end)


def _sampled(function: Callable[[Array], Jet], grid: Array, jet: Jet) -> _Samples:
    """Samples of a function: the grid is refined where every second sample is far from its neighbours' cubic."""
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
                return _Samples(points, values, np.zeros_like(slopes))
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
    found = _ordered(points, values, slopes)
    step = np.diff(found.points)
    rise = np.abs(found.slopes) * np.maximum(np.append(step, 0.0), np.append(0.0, step))
    return replace(found, slopes=np.where(rise <= found.rise, 0.0, found.slopes))


def _is_noise(function: Callable[[Array], Jet], points: Array, values: Array) -> bool:
    """Whether a function has only rounding errors: as a rule it then has another value right beside a sample."""
    beside = function(points[:-1] + ASIDE * np.diff(points)).value
    return bool(np.mean(np.abs(beside - values[:-1]) > ROUGH * np.max(np.abs(values))) > DOUBTFUL)


def _beside_flat(function: Callable[[Array], Jet], known: _Samples) -> _Samples:
    """The samples, with one more on either side of each zero slope, where an inflection may hide a change of sign."""
    grid = known.points
    flat = np.nonzero(known.slopes[1:-1] == 0.0)[0] + 1
    if not flat.size or flat.size == grid.size - 2:
        return known
    beside = [grid[flat] - NEXT * (grid[flat] - grid[flat - 1]), grid[flat] + NEXT * (grid[flat + 1] - grid[flat])]
    jets = [function(points) for points in beside]
    values = np.concatenate([known.values, *(jet.value for jet in jets)])
    slopes = np.concatenate([known.slopes, *(jet.derivative(1) for jet in jets)])
    return _ordered(np.concatenate([grid, *beside]), values, slopes)


def _ordered(points: Array, values: Array, slopes: Array) -> _Samples:
    order = np.argsort(points, kind="stable")
    return _Samples(points[order], values[order], slopes[order])


def _missed(points: Array, values: Array, slopes: Array, triples: tuple[IndexArray, IndexArray, IndexArray]) -> Array:
    """Distance of each middle sample from the cubic with the values and slopes of its two neighbours."""
    low, middle, high = triples
    cubic = (values[low] + values[high]) / 2.0 + (points[high] - points[low]) * (slopes[low] - slopes[high]) / 8.0
    return np.abs(values[middle] - cubic)


def _may_be_extreme(values: Array, missed: Array, middle: IndexArray) -> Mask:
    """Whether the function about each middle sample may go beyond all samples, by the distance that it ``missed``."""
    reach = BEYOND * missed
    return (values[middle] + reach > np.max(values)) | (values[middle] - reach < np.min(values))


def extremes(
    function: Callable[[Array], Jet], start: float, end: float, knots: Array = NO_KNOTS
) -> tuple[Extremum, Extremum]:
    """Smallest and largest value on [start, end]; arguments as in ``stationary_points``."""
    return extremes_on(lambda points: [function(points)], grid_between(start, end, knots))[0]


def extremes_on(functions: Functions, grid: Array) -> list[tuple[Extremum, Extremum]]:
    """Smallest and largest value of several functions on a grid of ``grid_between``, from end to end."""
    samples = _sampled_each(functions, grid)
    places = _stationary(functions, samples, [of.leading_changes for of in samples])
    ends = np.cumsum([points.size for points in places])
    found = []
    for number, (points, jet) in enumerate(zip(places, functions(np.concatenate(places)), strict=True)):
        values = jet.value[ends[number] - points.size : ends[number]]
        low, high = (Extremum(float(values[at]), float(points[at])) for at in (np.argmin(values), np.argmax(values)))
        found.append((low, high))
    return found


def bounds_on(grid: Array, jet: Jet) -> tuple[float, float]:
    """Bounds of a function by its jet of order 1 or more on a grid, quickly; infinite where samples show too little."""
    values, slopes, low = jet.value, jet.derivative(1), np.arange(0, grid.size - 2, 2)
    if not np.max(_missed(grid, values, slopes, (low, low + 1, low + 2))) <= ROUGH * np.max(np.abs(values)):
        return -np.inf, np.inf
    step = np.diff(grid)
    beyond = LEADING * np.max(np.abs(slopes) * np.maximum(np.append(step, 0.0), np.append(0.0, step)))
    return float(np.min(values) - beyond), float(np.max(values) + beyond)
