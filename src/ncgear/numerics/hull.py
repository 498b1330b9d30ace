"""Convex hulls of plane curves that can only be evaluated: no derivative, kinks and jumps allowed.

The hull tells the largest value of a curve's part along any direction.  From samples the search closes in on every
stretch of a curve that may leave the hull by the slopes beside it.  As in ``ncgear.numerics.highest``, it does not see
a peak wholly between two neighbouring samples.
"""

from __future__ import annotations

from collections.abc import Callable, Iterable, Sequence

import numpy as np

from ncgear.frozen import dataclass
from ncgear.numerics.arrays import Array, ComplexArray, Mask
from ncgear.numerics.highest import ROUNDS, SHARES, STEEPER

WAYS = np.exp(2j * np.pi * np.arange(16) / 16)
"""Directions whose farthest points are joined first: most points lie within, and are no corners."""


def corners(points: ComplexArray) -> ComplexArray:
    """The corners of the convex hull of points x + i y (shape (n,), n > 0), counter-clockwise, shape (c,)."""
    far = points[np.real(points * np.conj(WAYS)[:, None]).argmax(axis=1)]
    edges = np.roll(far, -1) - far
    left = np.imag(np.conj(edges)[:, None] * (points - far[:, None])) > 0.0
    # By their x, and points of the same x by their y
    outer = np.unique(points[~left[edges != 0.0].all(axis=0)] if edges.any() else points[:1]).tolist()
    return np.array([*_chain(outer), *_chain(reversed(outer))] if len(outer) > 1 else outer)


def _chain(rising: Iterable[complex]) -> list[complex]:
    """One side of the hull of points in order, without its last corner (A. M. Andrew's monotone chain)."""
    kept = list[complex]()
    for point in rising:
        while len(kept) > 1 and ((kept[-1] - kept[-2]).conjugate() * (point - kept[-1])).imag <= 0.0:
            kept.pop()
        kept.append(point)
    return kept[:-1]


def depths(hull: ComplexArray, points: ComplexArray) -> Array:
    """How deep points (n,) lie within a hull of corners (c,); below 0 outside of it, 0 in a hull of one point."""
    edges = np.roll(hull, -1) - hull
    normals = 1j * edges / np.maximum(np.abs(edges), np.finfo(float).tiny)
    into = np.stack([normals.real, normals.imag], axis=1) @ np.stack([points.real, points.imag])
    return np.min(into - np.real(np.conj(normals) * hull)[:, None], axis=0)


@dataclass(frozen=True, eq=False)
class _Curve:
    """A curve at rising places, shape (n,), and which intervals between them, shape (n - 1,), may leave its hull."""

    at: Array
    values: ComplexArray
    hull: ComplexArray
    open: Mask

    def inner(self, missed: float) -> Array:
        """Places, shape (k, SHARES - 1), in the intervals in which the curve may go farther than ``missed`` beyond.

        A smooth curve leaves its chord by an eighth of its change of slope over an interval, and so do the slopes of
        the interval and of a smooth neighbour differ; beside a jump of its own, it leaves it by the slopes beside it.
        """
        width = np.diff(self.at)
        slope = np.diff(self.values) / width
        before, after = np.append(slope[1:2], slope[:-1]), np.append(slope[1:], slope[-2:-1])
        bent = np.minimum(np.abs(slope - before), np.abs(after - slope)) / 2.0
        leaves = width * np.minimum(bent, STEEPER * np.maximum(np.abs(before), np.abs(after)))
        rows = np.flatnonzero(self.open & (leaves > missed))
        ends = np.unique(np.concatenate([rows, rows + 1]))
        deep = np.zeros(self.at.size)
        deep[ends] = depths(self.hull, self.values[ends])
        rows = rows[leaves[rows] > missed + np.minimum(deep[rows], deep[rows + 1])]
        return self.at[rows, None] + width[rows, None] * (np.arange(1, SHARES) / SHARES)

    def cut(self, inner: Array, values: ComplexArray) -> _Curve:
        """The curve with the values found at inner places, shape (k, SHARES - 1); only their intervals stay open."""
        rows = np.searchsorted(self.at, inner[:, 0]) - 1
        cut = np.zeros(self.open.size, dtype=bool)
        cut[rows] = True
        before = np.repeat(rows + 1, SHARES - 1)
        at, all_values = np.insert(self.at, before, inner.ravel()), np.insert(self.values, before, values.ravel())
        hull = corners(np.append(self.hull, values.ravel()))
        return _Curve(at, all_values, hull, np.repeat(cut, np.where(cut, SHARES, 1)))


def hull_of_each(
    curves: Callable[[Array], ComplexArray], places: Array, values: ComplexArray, missed: Sequence[float]
) -> list[ComplexArray]:
    """The corners of the hull of each of q curves between rising places (n,), n > 2, with ``values`` (q, n) there.

    ``curves`` maps places (m,) to values x + i y, (q, m).  Hulls are known to ``missed`` each.
    """
    found = [_Curve(places, own, corners(own), np.ones(places.size - 1, dtype=bool)) for own in values]
    for _ in range(ROUNDS):
        inner = [curve.inner(most) for curve, most in zip(found, missed, strict=True)]
        rising = np.unique(np.concatenate([own.ravel() for own in inner]))
        if not rising.size:
            break
        there = curves(rising)
        found = [
            curve.cut(own, row[np.searchsorted(rising, own)])
            for curve, own, row in zip(found, inner, there, strict=True)
        ]
    return [curve.hull for curve in found]
