"""Crossings of plane curves, by chords and by Newton's method on the curves themselves; of chords with circles."""

from __future__ import annotations

from collections.abc import Callable

import numpy as np

from ncgear.numerics.arrays import Array, ComplexArray, IndexArray, Mask
from ncgear.numerics.plane import across, along, as_complex, square

CurveFunction = Callable[[Array], tuple[Array, Array]]
"""Function of parameters of n curves, (n,) or (n, m): points and derivatives by the parameter, shape (n, ..., 2)."""

NEWTON_STEPS = 12
"""Convergence is quadratic: from a hundredth of a curve's length five steps reach rounding error."""

ZOOM, ZOOMS, ZOOM_POINTS = 5.0, 8, 13
"""Each round of closing in keeps a fifth of the interval, about two chords; eight rounds keep a 400 000th of it."""


BLOCK = 16
"""Chords that are compared together where the box around them meets the box of a chord."""


def chord_crossings(first: Array, second: Array) -> tuple[IndexArray, Array, Array]:
    """Rows where polylines (n, p, 2) cross polylines of the same row (n, q, 2), and fractional indices along both."""
    row, chord, block = _near_chords(first, second)
    (x1, y1), (across1, up1) = (column[row, chord].T[:, :, None] for column in (first, np.diff(first, axis=1)))
    facing = block[:, None] * BLOCK + np.arange(BLOCK)
    last = second.shape[1] - 2
    start = second[row[:, None], np.minimum(facing, last)]
    (x2, y2), (across2, up2) = (
        np.moveaxis(at, 2, 0) for at in (start, second[row[:, None], np.minimum(facing, last) + 1] - start)
    )
    area = across1 * up2 - up1 * across2
    aside, above = x2 - x1, y2 - y1
    # Shares along both chords, times the area: dividing only where both lie within the chords saves half the time.
    along1, along2 = aside * up2 - above * across2, aside * up1 - above * across1
    sign = np.sign(area)
    within1, within2 = along1 * sign, along2 * sign
    size = np.abs(area)
    inside = (within1 >= 0.0) & (within1 <= size) & (within2 >= 0.0) & (within2 <= size) & (size > 0.0)
    hit = np.nonzero(inside & (facing <= last))
    near = hit[0]
    return row[near], chord[near] + along1[hit] / area[hit], facing[hit] + along2[hit] / area[hit]


def boxes(lines: Array) -> tuple[Array, Array]:
    """Least and greatest coordinates of polylines (n, p, 2), (n, 2) each; coordinate by coordinate, which is faster."""
    columns = np.ascontiguousarray(np.moveaxis(lines, 2, 0))
    return columns.min(axis=2).T, columns.max(axis=2).T


def _near_chords(first: Array, second: Array) -> tuple[IndexArray, IndexArray, IndexArray]:
    """Rows and numbers of chords of ``first``, and blocks of chords of ``second`` whose boxes they meet, in order."""
    low, high = (ends[:, None] for ends in boxes(second))
    start, end = first[:, :-1], first[:, 1:]
    least, most = np.minimum(start, end), np.maximum(start, end)
    row, chord = np.nonzero(np.all((most >= low) & (least <= high), axis=2))
    blocks = np.arange(0, second.shape[1] - 1, BLOCK)
    low = np.minimum.reduceat(np.minimum(second[:, :-1], second[:, 1:]), blocks, axis=1)
    high = np.maximum.reduceat(np.maximum(second[:, :-1], second[:, 1:]), blocks, axis=1)
    meets = np.all((most[row, chord][:, None] >= low[row]) & (least[row, chord][:, None] <= high[row]), axis=2)
    pair, block = np.nonzero(meets)
    return row[pair], chord[pair], block


def refined_crossings(
    first: CurveFunction, second: CurveFunction, start1: Array, start2: Array, tolerance: float
) -> tuple[Array, Array, Mask]:
    """Parameters of the crossings near the starts, and whether both points agree to ``tolerance``; shape (n,) each."""
    at1, at2 = start1.copy(), start2.copy()
    for _ in range(NEWTON_STEPS):
        (point1, slope1), (point2, slope2) = (map(as_complex, curve) for curve in (first(at1), second(at2)))
        gap = point2 - point1
        met = np.abs(gap) <= tolerance
        if met.all():
            return at1, at2, met
        area = across(slope1, slope2)
        area = np.where(area == 0.0, np.inf, area)
        at1 = at1 + across(gap, slope2) / area
        at2 = at2 + across(gap, slope1) / area
    gap = as_complex(second(at2)[0]) - as_complex(first(at1)[0])
    return at1, at2, np.abs(gap) <= tolerance


def zoomed_crossings(
    first: CurveFunction, second: CurveFunction, middle1: Array, middle2: Array, reach1: Array, reach2: Array
) -> tuple[Array, Array, Mask]:
    """Crossings within ``reach`` of the given parameters, and whether they are really there; shape (n,) all.

    For crossings so flat that Newton's method wanders off: ever finer chords close in on them.  A crossing that
    only the coarse chords showed disappears on the way.
    """
    at1, at2, there = middle1.copy(), middle2.copy(), np.ones(middle1.size, dtype=bool)
    for step in range(ZOOMS):
        shares = np.linspace(-1.0, 1.0, ZOOM_POINTS) * ZOOM ** float(-step)
        points1 = first(at1[:, None] + reach1[:, None] * shares)[0]
        points2 = second(at2[:, None] + reach2[:, None] * shares)[0]
        row, index1, index2 = chord_crossings(points1, points2)
        there &= np.isin(np.arange(there.size), row)
        share1, share2 = (np.interp(index, np.arange(ZOOM_POINTS), shares) for index in (index1, index2))
        nearest = np.lexsort((np.abs(share1) + np.abs(share2), row))
        rows, chosen = np.unique(row[nearest], return_index=True)
        at1[rows] += reach1[rows] * share1[nearest[chosen]]
        at2[rows] += reach2[rows] * share2[nearest[chosen]]
    return at1, at2, there


def circle_crossings(start: ComplexArray, step: ComplexArray, squared_radius: Array) -> tuple[Array, Array]:
    """Shares of the way along chords at which they cross circles about the origin, and the arms of forces on them.

    The chords lead from ``start``, on one side of the circle, to ``start + step`` on the other; the force is across
    the chord.  All arrays have one shape.
    """
    growth, length = along(start, step), square(step)
    missing = squared_radius - square(start)
    root = np.sqrt(np.maximum(growth * growth + length * missing, 0.0))
    divisor = growth + np.copysign(root, missing)
    return missing / np.where(divisor == 0.0, 1.0, divisor), root / np.sqrt(length)
