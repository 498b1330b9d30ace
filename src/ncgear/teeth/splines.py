"""Cubic B-splines through exact points of many curves at once, with as few spans as a tolerance allows.

Each curve is interpolated in its own parameter, in which it is analytic, with its exact slopes at both ends: the error
falls with the fourth power of the span, at a cusp's side too, where the curve's speed is nearly zero.
Source: C. de Boor, "A Practical Guide to Splines", revised edition, Springer 2001, chapter V (complete splines).
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from scipy.interpolate import make_interp_spline

from ncgear.numerics.arrays import Array, IndexArray
from ncgear.teeth.chords import Stretch

DEGREE = 3
"""Twice continuously differentiable, and what every program for solids works with."""

SPANS = tuple(count for power in range(1, 10) for count in (2**power, 3 * 2 ** (power - 1)))
"""Numbers of spans that are tried in turn, up to 768: a curve that takes more is no smooth curve."""

PROBES = np.array([0.25, 0.5, 0.75])
"""Shares of each span at which the spline is held against the curve: its error is largest near the middle."""

INSIDE = np.array([1e-9, 1.0 - 1e-9])
"""Shares at which slopes at the ends are taken: at a joint of the pitch curve itself the slope may be that of its other
side, and so near to it a slope is wrong by a billionth."""


@dataclass(frozen=True, eq=False)
class Splines:
    """Splines of the same number of spans for some rows of a stretch.

    ``knots`` (n + 7,), n being the spans, from 0 to 1, clamped; ``poles_mm`` (r, n + 3, 2) for the rows ``row`` (r,);
    ``deviation_mm`` (r,) is how far points of spline and curve at the same parameter were found apart at most.
    """

    row: IndexArray
    knots: Array
    poles_mm: Array
    deviation_mm: Array


def fitted_splines(stretch: Stretch, rows: IndexArray, tolerance_mm: float) -> list[Splines]:
    """Splines for the chosen rows of a stretch, each closer to its curve than ``tolerance_mm``.

    Raises RuntimeError, a fault of ncgear, for a curve that the most spans do not follow.
    """
    found: list[Splines] = []
    for spans in SPANS:
        if not rows.size:
            return found
        made = _interpolated(stretch, rows, spans)
        close = made.deviation_mm <= tolerance_mm
        if close.any():
            found.append(Splines(rows[close], made.knots, made.poles_mm[close], made.deviation_mm[close]))
        rows = rows[~close]
    if rows.size:
        raise RuntimeError(f"a curve of flank {stretch.owner[rows[0]] + 1} is not followed by {SPANS[-1]} spans")
    return found


def _interpolated(stretch: Stretch, rows: IndexArray, spans: int) -> Splines:
    share = np.linspace(0.0, 1.0, spans + 1)
    point, (start, end) = stretch.at(rows[:, None], share)[0], stretch.at(rows[:, None], INSIDE)[1].swapaxes(0, 1)
    spline = make_interp_spline(share, point.swapaxes(0, 1), k=DEGREE, bc_type=([(1, start)], [(1, end)]))
    between = (np.arange(spans)[:, None] + PROBES).ravel() / spans
    apart = spline(between).swapaxes(0, 1) - stretch.at(rows[:, None], between)[0]
    return Splines(rows, spline.t, spline.c.swapaxes(0, 1), np.linalg.norm(apart, axis=2).max(axis=1))
