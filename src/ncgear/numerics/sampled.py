"""Many smooth functions at once, by their values at the same Chebyshev points of an interval, ends included.

The polynomial through the values is the function itself, to rounding error, once its last coefficients have died away
(L. N. Trefethen, "Approximation Theory and Approximation Practice", SIAM 2013, chapters 3 to 8).  So integrals, values
between the points and extrema are taken from the polynomial.  The functions run along the last axis.
"""

from __future__ import annotations

from collections.abc import Sequence
from functools import cache
from math import pi

import numpy as np
from numpy.polynomial import chebyshev

from ncgear.numerics.arrays import Array, IndexArray, Mask
from ncgear.numerics.zeros import zeros_between

LAST = 3
"""How many of the last coefficients tell whether a function is resolved: even and odd ones, and one to spare, since one
may be zero by chance."""

NEGLIGIBLE = 1e-13
"""A top between two points is looked for only if it may exceed the largest value by more than this share of it;
rounding errors of the slopes make less."""

HIGHER = 0.5
"""Share of its largest second difference along the points by which a function may exceed its largest value at them.

The points are even in the angle whose cosine they are.  Between two of them a function leaves its chord by an eighth of
the step's square times its second derivative, hence by an eighth of a second difference; four times that is allowed,
since the second derivative of a resolved function may be larger between the points, but not by as much
(tests/test_sampled.py)."""

NEWTON_STEPS = 2
"""Newton's steps to the place of a top from the zero of the line through the slopes at two neighbouring points."""

LAST_STEP = 1e-7
"""Share of a piece: after a last step under it a place is as exact as rounding allows; the others are bracketed."""

FINER = 2
"""Parts that each interval between points is divided into where sign changes of the derivative are looked for."""


@cache
def shares(count: int) -> Array:
    """Chebyshev points of [0, 1], ends included, shape (count,)."""
    points: Array = (1.0 - np.cos(np.linspace(0.0, pi, count))) / 2.0
    return points


@cache
def integration(count: int) -> Array:
    """Matrix from values at the points to the integrals from 0 to each of them, shape (count, count)."""
    values = chebyshev.chebvander(2.0 * shares(count) - 1.0, count)
    integrals = chebyshev.chebint(np.eye(count), lbnd=-1, axis=0) / 2.0
    matrix: Array = values @ integrals @ _coefficients(count)
    return matrix


def integrated(values: Array) -> Array:
    """Integral over all pieces of values per share of the piece, shape (n, pieces, count), as shape (n,)."""
    total: Array = (values @ integration(values.shape[-1])[-1]).sum(axis=1)
    return total


def tails(values: Array) -> tuple[Array, Array]:
    """Largest of the last coefficients, and the largest value, of each function, shape (...,) both.

    The coefficients are infinite where a value is not finite.
    """
    last = np.abs(values @ _coefficients(values.shape[-1])[-LAST:].T).max(axis=-1)
    size = np.maximum(values.max(axis=-1), -values.min(axis=-1))
    return np.where(np.isfinite(last) & np.isfinite(size), last, np.inf), size


def extremes(quantities: Sequence[Array], there: Mask) -> list[tuple[Array, Array]]:
    """Smallest and largest value of each quantity over the p functions of each of n owners, shape (n,) each.

    A quantity has values of shape (n, p, count), or of fewer functions, the first ones.  ``there`` (shape (n, p)) says
    which functions count: their values are finite.  Without any function results are infinite.
    """
    best, chosen, owners = list[Array](), list[Array](), list[IndexArray]()
    for values in quantities:
        counted = there[:, : values.shape[1]]
        higher = HIGHER * np.abs(values[..., 2:] - 2.0 * values[..., 1:-1] + values[..., :-2]).max(axis=2)
        for sign, ends in ((-1.0, -values.min(axis=2)), (1.0, values.max(axis=2))):
            ends = np.where(counted, ends, -np.inf)
            most = ends.max(axis=1)
            owner, place = np.nonzero(ends + higher > (most + NEGLIGIBLE * np.abs(most))[:, None])
            chosen.append(sign * values[owner, place])
            owners.append(owner + len(best) * len(there))
            best.append(most)
    rows = _largest(np.concatenate(chosen), np.concatenate(owners), np.concatenate(best)).reshape(-1, 2, len(there))
    return [(-low, high) for low, high in rows]


def turning_points(values: Array) -> tuple[IndexArray, Array, Array]:
    """Both ends of each function (shape (r, count)) and the places between where its slope changes its sign.

    The function's number, the place in [0, 1] and the value there, shape (k,) each.
    """
    count, fine = values.shape[1], shares(FINER * values.shape[1] - 1)
    slopes = values @ _refinement(count)[1].T
    row, place = np.nonzero((slopes[:, :-1] > 0.0) != (slopes[:, 1:] > 0.0))
    at, there = _turned(values[row], fine[place], fine[place + 1])
    ends = np.arange(len(values))
    return (
        np.concatenate([ends, ends, row]),
        np.concatenate([np.zeros(ends.size), np.ones(ends.size), at]),
        np.concatenate([values[:, 0], values[:, -1], there]),
    )


def sums_at(values: Array, share: Array) -> Array:
    """Each function (shape (r, count)) at its own place in [0, 1] (shape (r,))."""
    return _sums(_coefficients(values.shape[1]) @ values.T, share)


def _largest(values: Array, owner: IndexArray, samples: Array) -> Array:
    """Largest value of functions (shape (r, count)) by their owners, whose largest samples are known; shape (n,)."""
    best, (fine, slope) = samples.copy(), _refinement(values.shape[1])
    grid, slopes = values @ fine.T, values @ slope.T
    np.maximum.at(best, owner, grid.max(axis=1))
    rising = slopes > 0.0
    row, place = np.nonzero(rising[:, :-1] & ~rising[:, 1:])
    known = best[owner[row]]
    kept = _reach(grid, slopes, row, place) > known + NEGLIGIBLE * np.abs(known)
    row, place = row[kept], place[kept]
    points = shares(grid.shape[1])
    np.maximum.at(best, owner[row], _turned(values[row], points[place], points[place + 1])[1])
    return best


def _reach(grid: Array, slopes: Array, row: IndexArray, place: IndexArray) -> Array:
    """Upper bound of a top between two points: it lies below the tangents at both."""
    width = np.diff(shares(grid.shape[1]))[place]
    before = grid[row, place] + slopes[row, place] * width
    after = grid[row, place + 1] - slopes[row, place + 1] * width
    return np.minimum(before, after)


def _turned(values: Array, low: Array, high: Array) -> tuple[Array, Array]:
    """Where each function's slope changes sign between ``low`` and ``high``, and its value there; shape (k,) each.

    Where rounding hides the change of sign, the slope at one of both places is itself rounding error; the value at
    ``low`` is taken.
    """
    series, slope, bend = (np.ascontiguousarray(matrix @ values.T) for matrix in _series(values.shape[1]))
    before, after = _sums(slope, low), _sums(slope, high)
    changes = before * after < 0.0
    at = np.where(changes, low + (high - low) * before / np.where(changes, before - after, 1.0), low)
    step = np.where(changes, np.inf, 0.0)
    for _ in range(NEWTON_STEPS):
        tried = np.clip(at - _sums(slope, at) / _sums(bend, at), low, high)
        at, step = np.where(changes, tried, at), np.where(changes, np.abs(tried - at), step)
    rest = np.nonzero(~(step <= LAST_STEP))[0]
    if rest.size:
        inner = slope[:, rest]
        at[rest] = zeros_between(lambda share: _sums(inner, share), low[rest], high[rest])
    return at, _sums(series, at)


def _sums(coefficients: Array, share: Array) -> Array:
    """Chebyshev series (shape (degree + 1, k)), each at its own argument in [0, 1]."""
    return np.asarray(chebyshev.chebval(2.0 * share - 1.0, coefficients, tensor=False), dtype=np.float64)


@cache
def _coefficients(count: int) -> Array:
    """Matrix from values at the points to Chebyshev coefficients."""
    return np.asarray(np.linalg.inv(chebyshev.chebvander(2.0 * shares(count) - 1.0, count - 1)), dtype=np.float64)


@cache
def _series(count: int) -> tuple[Array, Array, Array]:
    """Matrices from values at the points to the function's coefficients, to those of its slope and of its bend."""
    slope = np.vstack([2.0 * chebyshev.chebder(np.eye(count), axis=0), np.zeros(count)])
    return _coefficients(count), slope @ _coefficients(count), slope @ slope @ _coefficients(count)


@cache
def _refinement(count: int) -> tuple[Array, Array]:
    """Matrices from values at the points to values and to slopes at the finer points."""
    finer = chebyshev.chebvander(2.0 * shares(FINER * count - 1) - 1.0, count - 1)
    values, slopes = (finer @ matrix for matrix in _series(count)[:2])
    return values, slopes
