"""Many smooth functions at once, by their values at the same Chebyshev points of an interval, ends included.

The polynomial through the values is the function itself, to rounding error, once its last coefficients have died away
(L. N. Trefethen, "Approximation Theory and Approximation Practice", SIAM 2013, chapters 3 to 8).  So integrals, values
between the points and extrema are taken from the polynomial.  The points run along the last but one axis, and owners
of functions along the last one, where numpy adds and compares whole rows.
"""

from __future__ import annotations

from collections.abc import Sequence
from functools import cache, cached_property
from math import pi
from typing import NamedTuple

import numpy as np
from numpy.polynomial import chebyshev

from ncgear.frozen import dataclass
from ncgear.numerics.arrays import Array, IndexArray, Mask
from ncgear.numerics.zeros import zeros_between

LAST = 3
"""Number of last coefficients that show whether a function is resolved: even and odd coefficients, and one to spare,
since one may be zero by chance."""

NEGLIGIBLE = 1e-13
"""A top between two points is searched only if it may exceed the largest value by more than this share of it; rounding
errors of the slopes make less."""

HIGHER = 0.5
"""Largest excess of a function over its largest value at the points, as a share of its largest second difference there.

The points are even in the angle whose cosine they are.  Between two of them a function leaves its chord by an eighth of
the step's square times its second derivative, hence by an eighth of a second difference; four times that is allowed,
since the second derivative of a resolved function may be larger between the points, but not by as much
(tests/test_sampled.py)."""

NEWTON_STEPS = 3
"""Newton's steps to the place of a top from the zero of the line through the slopes at two neighbouring points."""

LAST_STEP = 1e-6
"""Share of a piece: after a last step below it a place and the value there are as exact as rounding allows; other
places are bracketed."""


@cache
def shares(count: int) -> Array:
    """Chebyshev points of [0, 1], ends included, shape (count,)."""
    return (1.0 - np.cos(np.linspace(0.0, pi, count))) / 2.0


@cache
def integration(count: int) -> Array:
    """Matrix from values at the points to the integrals from 0 to each of them, shape (count, count)."""
    values = chebyshev.chebvander(2.0 * shares(count) - 1.0, count)
    integrals = chebyshev.chebint(np.eye(count), lbnd=-1, axis=0) / 2.0
    return values @ integrals @ _coefficients(count)


def integrated(values: Array) -> Array:
    """Integral over all pieces of values per share of the piece, from shape (pieces, count, n) to shape (n,)."""
    return (integration(values.shape[-2])[-1] @ values).sum(axis=0)


@dataclass(frozen=True, eq=False)
class Functions:
    """The p functions of each of n owners by their values at the points, shape (p, count, n)."""

    values: Array

    @cached_property
    def low(self) -> Array:
        """Smallest value at the points, shape (p, n)."""
        return self.values.min(axis=1)

    @cached_property
    def high(self) -> Array:
        """Largest value at the points, shape (p, n)."""
        return self.values.max(axis=1)

    @cached_property
    def size(self) -> Array:
        """Largest magnitude at the points, shape (p, n)."""
        return np.maximum(self.high, -self.low)

    @cached_property
    def tails(self) -> Array:
        """Largest of the last coefficients, shape (p, n), infinite where a value is not finite."""
        last = np.abs(_coefficients(self.values.shape[1])[-LAST:] @ self.values).max(axis=1)
        return np.where(np.isfinite(last) & np.isfinite(self.size), last, np.inf)

    @cached_property
    def higher(self) -> Array:
        """Largest possible excess of a function over its largest value at the points, shape (p, n)."""
        steps = np.diff(self.values, axis=1)
        bends = np.subtract(steps[:, 1:], steps[:, :-1], out=steps[:, 1:])
        return HIGHER * np.maximum(bends.max(axis=1), -bends.min(axis=1))


class Sought(NamedTuple):
    """Functions, the mask of functions that count (shape (p, n)), and signs.

    The sign 1 seeks the largest value, -1 the largest of minus the values, both together the largest magnitude.  With a
    ``limit``, only whether the largest value exceeds it matters.
    """

    functions: Functions
    there: Mask
    signs: tuple[float, ...]
    limit: float | None = None


def extremes(sought: Sequence[Sought]) -> list[Array]:
    """The largest value with any of the signs over each owner's functions, (n,) for each sought; -inf without any."""
    best, chosen, owners = list[Array](), list[Array](), list[IndexArray]()
    for functions, there, signs, limit in sought:
        ends = [np.where(there, functions.high if sign > 0.0 else -functions.low, -np.inf) for sign in signs]
        most = np.max(ends, axis=(0, 1))
        needed = most + NEGLIGIBLE * np.abs(most) if limit is None else np.where(most > limit, np.inf, limit)
        enough = needed - functions.higher
        for sign, end in zip(signs, ends, strict=True):
            place, owner = np.nonzero(end > enough)
            chosen.append(sign * functions.values[place, :, owner])
            owners.append(owner + len(best) * most.size)
        best.append(most)
    found = _largest(np.concatenate(chosen).T, np.concatenate(owners), np.concatenate(best))
    return list(found.reshape(len(best), -1))


def turning_points(values: Array) -> tuple[IndexArray, Array, Array]:
    """Both ends of functions (count, r) and places of slopes' changes of sign: number, place in [0, 1], value; (k,)."""
    slopes = _slopes(len(values)) @ values
    place, row = np.nonzero((slopes[:-1] > 0.0) != (slopes[1:] > 0.0))
    at, there = _turned(values[:, row], slopes, row, place)
    ends = np.arange(values.shape[1])
    return (
        np.concatenate([ends, ends, row]),
        np.concatenate([np.zeros(ends.size), np.ones(ends.size), at]),
        np.concatenate([values[0], values[-1], there]),
    )


def values_at(values: Array, share: Array) -> Array:
    """Functions (shape (count, k), or with more axes between), each at its own place in [0, 1] (shape (k,)).

    By the barycentric formula, whose weights for these points alternate, halved at the ends (J.-P. Berrut, L. N.
    Trefethen, "Barycentric Lagrange Interpolation", SIAM Review 46 (2004)).
    """
    count = len(values)
    weights = np.where(np.arange(count) % 2, -1.0, 1.0)
    weights[[0, -1]] /= 2.0
    gaps = share - shares(count)[:, None]
    # At a point itself its own value counts
    gaps[gaps == 0.0] = np.finfo(float).tiny
    parts = weights[:, None] / gaps
    parts /= parts.sum(axis=0)
    return np.asarray(np.einsum("ik,i...k->...k", parts, values), dtype=np.float64)


def _largest(values: Array, owner: IndexArray, samples: Array) -> Array:
    """Largest value of functions (shape (count, r)) by their owners, whose largest samples are known; shape (n,)."""
    best, slopes = samples.copy(), _slopes(len(values)) @ values
    rising = slopes > 0.0
    place, row = np.nonzero(rising[:-1] & ~rising[1:])
    known = best[owner[row]]
    kept = _reach(values, slopes, row, place) > known + NEGLIGIBLE * np.abs(known)
    row, place = row[kept], place[kept]
    np.maximum.at(best, owner[row], _turned(values[:, row], slopes, row, place)[1])
    return best


def _reach(values: Array, slopes: Array, row: IndexArray, place: IndexArray) -> Array:
    """Upper bound of a top between two points: it lies below the tangents at both."""
    width = np.diff(shares(len(values)))[place]
    before = values[place, row] + slopes[place, row] * width
    after = values[place + 1, row] - slopes[place + 1, row] * width
    return np.minimum(before, after)


def _turned(values: Array, slopes: Array, row: IndexArray, place: IndexArray) -> tuple[Array, Array]:
    """Places where the slope of functions (shape (count, k)) changes sign after a point, and values there; shape (k,).

    ``slopes`` has the slopes of all functions at the points, ``row`` and ``place`` are the functions' numbers and the
    points.  The value after the last step is the parabola's there, exact to the third power of the step.
    """
    points = shares(len(values))
    low, high, before, after = points[place], points[place + 1], slopes[place, row], slopes[place + 1, row]
    known = np.stack([values, slopes[:, row], _bends(len(values)) @ values], axis=1)
    at = low + (high - low) * before / (before - after)
    for _ in range(NEWTON_STEPS):
        value, slope, bend = values_at(known, at)
        last, at = at, np.clip(at - slope / bend, low, high)
        top = value + (at - last) * (slope + (at - last) * bend / 2.0)
    rest = np.nonzero(~(np.abs(at - last) <= LAST_STEP))[0]
    if rest.size:
        # Where rounding hides the change of sign, the slope at one of both points is itself rounding error.
        at[rest] = low[rest]
        found = rest[before[rest] * after[rest] < 0.0]
        inner = known[:, 1, found]
        at[found] = zeros_between(lambda share: values_at(inner, share), low[found], high[found])
        top[rest] = values_at(known[:, 0, rest], at[rest])
    return at, top


@cache
def _coefficients(count: int) -> Array:
    return np.asarray(np.linalg.inv(chebyshev.chebvander(2.0 * shares(count) - 1.0, count - 1)), dtype=np.float64)


@cache
def _slopes(count: int) -> Array:
    """Matrix from values at the points to the slopes there."""
    return chebyshev.chebvander(2.0 * shares(count) - 1.0, count - 2) @ _derived(count)


@cache
def _bends(count: int) -> Array:
    """Matrix from values at the points to the second derivatives there."""
    bends = 2.0 * chebyshev.chebder(_derived(count), axis=0)
    return chebyshev.chebvander(2.0 * shares(count) - 1.0, count - 3) @ bends


def _derived(count: int) -> Array:
    """Matrix from values at the points to the coefficients of the slope."""
    return np.asarray(2.0 * chebyshev.chebder(_coefficients(count), axis=0), dtype=np.float64)
