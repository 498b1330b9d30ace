"""Where two families of plane curves cross: a search on chords, then Newton's method on the curves themselves."""

from __future__ import annotations

from collections.abc import Callable

import numpy as np

from ncgear.numerics.arrays import Array, IndexArray, Mask

CurveFunction = Callable[[Array], tuple[Array, Array]]
"""Parameters (shape (n,)), one for each of n curves, to points and derivatives by the parameter, shape (n, 2) each."""

NEWTON_STEPS = 12
"""Convergence is quadratic: from a hundredth of a curve's length five steps reach rounding error."""

ZOOM, ZOOMS, ZOOM_POINTS = 5.0, 8, 13
"""Each round of closing in keeps a fifth of the interval, about two chords; eight rounds keep a 400 000th of it."""


def chord_crossings(first: Array, second: Array) -> tuple[IndexArray, Array, Array]:
    """Where polylines ``first`` (shape (n, p, 2)) cross those of the same row in ``second`` (shape (n, q, 2)).

    Rows, and fractional indices along the first and the second polyline, one entry for each crossing.
    """
    start1, step1 = first[:, :-1, None, :], np.diff(first, axis=1)[:, :, None, :]
    start2, step2 = second[:, None, :-1, :], np.diff(second, axis=1)[:, None, :, :]
    offset, area = start2 - start1, _cross(step1, step2)
    with np.errstate(divide="ignore", invalid="ignore"):
        along1, along2 = _cross(offset, step2) / area, _cross(offset, step1) / area
    row, index1, index2 = np.nonzero((along1 >= 0.0) & (along1 <= 1.0) & (along2 >= 0.0) & (along2 <= 1.0))
    return row, index1 + along1[row, index1, index2], index2 + along2[row, index1, index2]


def refined_crossings(
    first: CurveFunction, second: CurveFunction, start1: Array, start2: Array, tolerance: float
) -> tuple[Array, Array, Mask]:
    """Parameters of the crossings near the starts, and whether the two points agree to ``tolerance``."""
    at1, at2 = start1.copy(), start2.copy()
    for _ in range(NEWTON_STEPS):
        (point1, slope1), (point2, slope2) = first(at1), second(at2)
        gap = point2 - point1
        if np.all(np.hypot(gap[:, 0], gap[:, 1]) <= tolerance):
            break
        area = _cross(slope1, slope2)
        area = np.where(area == 0.0, np.inf, area)
        at1 = at1 + _cross(gap, slope2) / area
        at2 = at2 + _cross(gap, slope1) / area
    gap = second(at2)[0] - first(at1)[0]
    return at1, at2, np.hypot(gap[:, 0], gap[:, 1]) <= tolerance


def zoomed_crossings(
    first: CurveFunction, second: CurveFunction, middle1: Array, middle2: Array, reach1: Array, reach2: Array
) -> tuple[Array, Array, Mask]:
    """Crossings within ``reach`` of the given parameters, closed in on by ever finer chords, and which are really
    there.

    All arrays have shape (n,), one curve pair each.  For crossings so flat that Newton's method wanders off; what only
    the coarse chords showed disappears on the way and is reported as false.
    """
    at1, at2, there = middle1.copy(), middle2.copy(), np.ones(middle1.size, dtype=bool)
    for step in range(ZOOMS):
        shares = np.linspace(-1.0, 1.0, ZOOM_POINTS) * ZOOM ** float(-step)
        points1 = _sampled(first, at1, reach1, shares)
        points2 = _sampled(second, at2, reach2, shares)
        row, index1, index2 = chord_crossings(points1, points2)
        there &= np.isin(np.arange(there.size), row)
        chosen = np.unique(row, return_index=True)
        index = np.arange(ZOOM_POINTS, dtype=float)
        at1[chosen[0]] += reach1[chosen[0]] * np.interp(index1[chosen[1]], index, shares)
        at2[chosen[0]] += reach2[chosen[0]] * np.interp(index2[chosen[1]], index, shares)
    return at1, at2, there


def _sampled(curve: CurveFunction, middle: Array, reach: Array, shares: Array) -> Array:
    """Points of each curve about its middle, shape (n, shares, 2)."""
    columns = [curve(middle + reach * share)[0] for share in shares]
    return np.stack(columns, axis=1)


def _cross(a: Array, b: Array) -> Array:
    return a[..., 0] * b[..., 1] - a[..., 1] * b[..., 0]
