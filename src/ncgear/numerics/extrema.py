"""Largest and smallest values of a smooth function on intervals, located by the zeros of its derivative."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass

import numpy as np

from ncgear.numerics.arrays import Array
from ncgear.numerics.bracketed import zeros_between
from ncgear.numerics.jet import Jet

SAMPLES = 129
"""Points per piece on which sign changes of the derivative are looked for; two extrema closer than a 128th of a
piece that cancel in sign differ from each other by less than the fourth power of that."""


@dataclass(frozen=True)
class Extremum:
    """A value and the argument at which it is reached."""

    value: float
    at: float


def stationary_points(function: Callable[[Array], Jet], start: float, end: float, samples: int = SAMPLES) -> Array:
    """Both ends, every point between them where the derivative changes sign, and samples where it is not finite.

    In rising order.

    ``function`` maps points (shape (n,)) to a jet of order 1 or more, and is evaluated within [start, end] only.
    """
    return stationary_on(function, np.linspace(start, end, samples))


def stationary_on(function: Callable[[Array], Jet], grid: Array) -> Array:
    """The same between the ends of a grid in rising order, shape (n,), instead of an even one."""
    slope = function(grid).derivative(1)
    change = np.nonzero(np.sign(slope[:-1]) * np.sign(slope[1:]) < 0)[0]
    flat = grid[1:-1][(slope[1:-1] == 0.0) | ~np.isfinite(slope[1:-1])]
    if not change.size:
        return np.unique(np.concatenate([grid[[0, -1]], flat]))
    found = zeros_between(lambda points: function(points).derivative(1), grid[change], grid[change + 1])
    return np.unique(np.concatenate([grid[[0, -1]], flat, found]))


def extremes(
    function: Callable[[Array], Jet], start: float, end: float, samples: int = SAMPLES
) -> tuple[Extremum, Extremum]:
    """Smallest and largest value on [start, end]."""
    return extremes_on(function, np.linspace(start, end, samples))


def extremes_on(function: Callable[[Array], Jet], grid: Array) -> tuple[Extremum, Extremum]:
    """The same between the ends of a grid in rising order, shape (n,), on which sign changes are looked for."""
    points = stationary_on(function, grid)
    values = function(points).value
    low, high = int(np.argmin(values)), int(np.argmax(values))
    return Extremum(float(values[low]), float(points[low])), Extremum(float(values[high]), float(points[high]))
