"""Where two families of plane curves cross: a search on chords, then Newton's method on the curves themselves."""

from __future__ import annotations

from collections.abc import Callable

import numpy as np

from ncgear.numerics.arrays import Array, IndexArray, Mask

CurveFunction = Callable[[Array], tuple[Array, Array]]
"""Parameters (shape (n,)), one for each of n curves, to points and derivatives by the parameter, shape (n, 2) each."""

NEWTON_STEPS = 12
"""Convergence is quadratic: from a hundredth of a curve's length five steps reach rounding error."""


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


def _cross(a: Array, b: Array) -> Array:
    return a[..., 0] * b[..., 1] - a[..., 1] * b[..., 0]
