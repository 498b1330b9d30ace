"""Largest and smallest values of a smooth function on intervals, located by the zeros of its derivative."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass

import numpy as np

from ncgear.numerics.arrays import Array
from ncgear.numerics.bracketed import zeros_between
from ncgear.numerics.jet import Jet

SAMPLES = 129
"""Points per piece, and four more for each of its knots, on which sign changes of the derivative are looked for; two
extrema closer than a 128th of a piece that cancel in sign differ from each other by less than the fourth power of that.
"""

NO_KNOTS = np.empty(0)


@dataclass(frozen=True)
class Extremum:
    """A value and the argument at which it is reached."""

    value: float
    at: float


def stationary_points(function: Callable[[Array], Jet], start: float, end: float, knots: Array = NO_KNOTS) -> Array:
    """Both ends, every point between them where the derivative changes sign, and samples where it is not finite.

    In rising order.

    ``function`` maps points (shape (n,)) to a jet of order 1 or more, and is evaluated within [start, end] only.
    ``knots`` (shape (m,), rising) are points between which it does about as much; those outside do not count.
    """
    grid = _grid(start, end, knots)
    slope = function(grid).derivative(1)
    change = np.nonzero(np.sign(slope[:-1]) * np.sign(slope[1:]) < 0)[0]
    flat = grid[1:-1][(slope[1:-1] == 0.0) | ~np.isfinite(slope[1:-1])]
    if not change.size:
        return np.unique(np.concatenate([[start, end], flat]))
    found = zeros_between(lambda points: function(points).derivative(1), grid[change], grid[change + 1])
    return np.unique(np.concatenate([[start, end], flat, found]))


def _grid(start: float, end: float, knots: Array) -> Array:
    """Points from start to end, as many between two knots as between any others, however near these are."""
    edges = np.concatenate([[start], knots[(knots > start) & (knots < end)], [end]])
    each = -(-(SAMPLES - 1 + 4 * (edges.size - 2)) // (edges.size - 1))
    shares = np.arange(each) / each
    return np.append((edges[:-1, None] + np.diff(edges)[:, None] * shares).ravel(), end)


def extremes(
    function: Callable[[Array], Jet], start: float, end: float, knots: Array = NO_KNOTS
) -> tuple[Extremum, Extremum]:
    """Smallest and largest value on [start, end]."""
    points = stationary_points(function, start, end, knots)
    values = function(points).value
    low, high = int(np.argmin(values)), int(np.argmax(values))
    return Extremum(float(values[low]), float(points[low])), Extremum(float(values[high]), float(points[high]))
