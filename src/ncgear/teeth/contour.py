"""The closed outline of a gear as few smooth curves: lines, arcs of circles, and cubic B-splines.

Programs for solids make a face of each curve, so that a flank stays a single face; a polygon would give a facet for
every chord.

Each spline passes through exact points of its curve, with as few spans as a tolerance allows.  The curve is
interpolated in its own parameter, in which it is analytic, with its exact slopes at both ends.  So the error falls with
the fourth power of the span, also beside a cusp, where the curve's speed is nearly zero.
Source: C. de Boor, "A Practical Guide to Splines", revised edition, Springer 2001, chapter V (complete splines).
"""

from __future__ import annotations

from dataclasses import replace

import numpy as np

from ncgear.errors import Unanswered
from ncgear.frozen import dataclass
from ncgear.numerics.arrays import Array, ComplexArray, IndexArray, Mask
from ncgear.numerics.plane import across, as_complex, square
from ncgear.teeth.gear import ToothedGear
from ncgear.teeth.outline import exact_curves
from ncgear.teeth.stretch import CurveStretch


@dataclass(frozen=True, eq=False)
class Line:
    """A straight line; points of shape (2,) in mm."""

    start: Array
    end: Array


@dataclass(frozen=True, eq=False)
class Arc:
    """The arc of a circle through three points of shape (2,) in mm."""

    start: Array
    middle: Array
    end: Array


@dataclass(frozen=True, eq=False)
class Spline:
    """A cubic B-spline: clamped knots (n + 4,), poles (n, 2) in mm."""

    knots: Array
    poles_mm: Array

    @property
    def start(self) -> Array:
        """First point, shape (2,)."""
        return np.asarray(self.poles_mm[0])

    @property
    def end(self) -> Array:
        """Last point, shape (2,)."""
        return np.asarray(self.poles_mm[-1])


Curve = Line | Arc | Spline


@dataclass(frozen=True, eq=False)
class Contour:
    """Curves in order round a gear, each from the end of the last, and their largest distance from the exact curves."""

    curves: tuple[Curve, ...]
    deviation_mm: float


CURVES_SHARE = 0.1
"""Largest distance of curves in files from the exact curves, as a share of the chord tolerance.

The working flanks of an outline have a share of at least 0.15.  So faces and arcs are closer than outlines of chords,
and gears made from them have no larger error of the law."""

SAME_IN_MODULES = 3e-8
"""A curve this near to a line or a circle becomes a line or an arc: about the distance at which programs for solids
merge two points of teeth of module 3."""

SHORTEST_IN_MODULES = 100.0 * SAME_IN_MODULES
"""Curves shorter than this are left out, and the curve before ends where the curve after begins: so narrow a face would
be smaller than its tolerances."""

LOOKED_AT = np.linspace(0.0, 1.0, 9)
"""Shares of a curve at which it is compared with a line or a circle; it bends too little to wave between them."""


def contour_of(gear: ToothedGear, tolerance_mm: float, flank_tolerance_mm: float | None = None) -> Contour:
    """A gear's outline as curves within ``tolerance_mm`` of the exact curves; flanks may have their own tolerance.

    Raises Unanswered where this is not possible for a curve, or a curve does not begin where the last ends.
    """
    flanks, *others = exact_curves(gear.tips, gear.sides)
    module = gear.flanks.rack.module_mm
    placed = _pieces(flanks, flank_tolerance_mm or tolerance_mm, module)
    placed += [piece for stretch in others for piece in _pieces(stretch, tolerance_mm, module)]
    ordered = sorted(placed, key=lambda piece: piece.rank)
    curves = [piece.curve for piece in ordered]
    whole = _bridged(curves, module) if gear.flanks.equivalent else curves
    pairs = zip(whole, [*whole[1:], whole[0]], strict=True)
    closed = tuple(_ending(piece, after.start, module) for piece, after in pairs)
    return Contour(closed, max(piece.deviation_mm for piece in ordered))


@dataclass(frozen=True, eq=False)
class _Piece:
    """A curve, its place along the outline, and its distance from the exact curve."""

    rank: float
    curve: Curve
    deviation_mm: float


def _pieces(stretch: CurveStretch, tolerance: float, module: float) -> list[_Piece]:
    same = SAME_IN_MODULES * module
    probes = stretch.at(np.arange(stretch.owner.size)[:, None], LOOKED_AT)[0]
    rows = np.nonzero(np.linalg.norm(np.diff(probes, axis=1), axis=2).sum(axis=1) > SHORTEST_IN_MODULES * module)[0]
    plain = {}
    for row in rows[_perhaps_plain(as_complex(probes[rows]), same)]:
        found = line_or_arc(probes[row], same)
        if found is not None:
            plain[int(row)] = _Piece(float(stretch.rank[row]), *found)
    bent = np.setdiff1d(rows, list(plain))
    splines = [
        _Piece(float(stretch.rank[row]), Spline(group.knots, poles), float(deviation))
        for group in fitted_splines(stretch, bent, tolerance)
        for row, poles, deviation in zip(group.row, group.poles_mm, group.deviation_mm, strict=True)
    ]
    return [*plain.values(), *splines]


def _perhaps_plain(points: ComplexArray, within_mm: float) -> Mask:
    """Whether rows of points (shape (r, n)) are near a line, or near a circle through three of them; shape (r,)."""
    start, middle, end = points[:, :1], points[:, points.shape[1] // 2, None], points[:, -1:]
    near, far = middle - start, end - start
    straight = np.abs(across(far, points - start)) <= 2.0 * within_mm * np.abs(far)
    area = 2.0 * across(near, far)
    off = 1j * (near * square(far) - far * square(near)) / np.where(area == 0.0, np.inf, area)
    round_ = np.abs(np.abs(points - start - off) - np.abs(off)) <= 2.0 * within_mm
    return straight.all(axis=1) | round_.all(axis=1)


def _bridged(curves: list[Curve], module: float) -> list[Curve]:
    """The curves with a line in each gap: equivalent gears have gaps beside lands, which belong to other circles."""
    closed: list[Curve] = []
    for curve, after in zip(curves, [*curves[1:], curves[0]], strict=True):
        closed.append(curve)
        if np.linalg.norm(after.start - curve.end) > SHORTEST_IN_MODULES * module:
            closed.append(Line(curve.end, after.start))
    return closed


def _ending(curve: Curve, end: Array, module: float) -> Curve:
    """The curve with its end moved by a rounding error, or by as much as a curve that was left out."""
    gap = float(np.linalg.norm(curve.end - end))
    if not gap <= 2.0 * SHORTEST_IN_MODULES * module:
        raise Unanswered(f"two curves of an outline are {gap:.3g} mm apart where they should meet")
    if isinstance(curve, Spline):
        return replace(curve, poles_mm=np.vstack([curve.poles_mm[:-1], end]))
    return replace(curve, end=end)


DEGREE = 3
"""Degree of the splines: twice continuously differentiable, and known to every program for solids."""

SPANS = tuple(count for power in range(1, 10) for count in (2**power, 3 * 2 ** (power - 1)))
"""Numbers of spans that are tried in turn, up to 768; a curve that takes more is not smooth."""

PROBES = np.array([0.25, 0.5, 0.75])
"""Shares of each span at which the spline is compared with the curve; its error is largest near the middle."""

INSIDE = np.array([1e-9, 1.0 - 1e-9])
"""Shares at which the slopes at both ends are taken.  At a joint of the pitch curve itself the slope may belong to the
joint's other side; at this distance from the joint the slope is wrong by a billionth."""


@dataclass(frozen=True, eq=False)
class Splines:
    """Splines of the same number of spans for some rows of a stretch.

    ``knots`` (n + 7,), n being the spans, from 0 to 1, clamped; ``poles_mm`` (r, n + 3, 2) for the rows ``row`` (r,);
    ``deviation_mm`` (r,) is the largest distance found between spline and curve at the same parameter.
    """

    row: IndexArray
    knots: Array
    poles_mm: Array
    deviation_mm: Array


def fitted_splines(stretch: CurveStretch, rows: IndexArray, tolerance_mm: float) -> list[Splines]:
    """Splines for the chosen rows within ``tolerance_mm``; raises Unanswered where the most spans stray."""
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
        raise Unanswered(f"a curve of tooth {stretch.owner[rows[0]] // 2 + 1} is not followed by {SPANS[-1]} spans")
    return found


def _interpolated(stretch: CurveStretch, rows: IndexArray, spans: int) -> Splines:
    from scipy.interpolate import make_interp_spline

    share = np.linspace(0.0, 1.0, spans + 1)
    point, (start, end) = stretch.at(rows[:, None], share)[0], stretch.at(rows[:, None], INSIDE)[1].swapaxes(0, 1)
    spline = make_interp_spline(share, point.swapaxes(0, 1), k=DEGREE, bc_type=([(1, start)], [(1, end)]))
    between = (np.arange(spans)[:, None] + PROBES).ravel() / spans
    apart = spline(between).swapaxes(0, 1) - stretch.at(rows[:, None], between)[0]
    return Splines(rows, spline.t, spline.c.swapaxes(0, 1), np.linalg.norm(apart, axis=2).max(axis=1))


def line_or_arc(points_mm: Array, within_mm: float) -> tuple[Line | Arc, float] | None:
    """The line or arc from the first to the last of points (n, 2), and its distance from the others, or None."""
    start, middle, end = points_mm[0], points_mm[len(points_mm) // 2], points_mm[-1]
    for curve in (Line(start, end), Arc(start, middle, end)):
        if (off := float(distances_mm(curve, points_mm).max())) <= within_mm:
            return curve, off
    return None


def distances_mm(curve: Line | Arc, points_mm: Array) -> Array:
    """Distances of points (n, 2) from the whole line or circle, shape (n,); infinite where an arc has no circle."""
    if isinstance(curve, Line):
        chord = (curve.end - curve.start) / np.linalg.norm(curve.end - curve.start)
        arm = points_mm - curve.start
        return np.asarray(np.abs(chord[0] * arm[:, 1] - chord[1] * arm[:, 0]))
    center, radius = _circle(curve)
    return np.asarray(np.abs(np.linalg.norm(points_mm - center, axis=1) - radius))


def _circle(arc: Arc) -> tuple[Array, float]:
    """Centre and radius of an arc's circle; a point infinitely far away for points in line."""
    rows = np.array([arc.middle - arc.start, arc.end - arc.start])
    if np.linalg.det(rows) == 0.0:
        return np.full(2, np.inf), 0.0
    arm = np.linalg.solve(rows, np.sum(rows**2, axis=1) / 2.0)
    return arc.start + arm, float(np.linalg.norm(arm))


def ring_of_arcs(ring_mm: Array, within_mm: float) -> list[Line | Arc]:
    """A closed polygon (n, 2) as lines and arcs, each as long as it stays within a distance of all its corners.

    They stay within twice that distance of the middles of its sides and so, if these are parabolas, within 17/8 of it
    everywhere.  Each takes at most a third of the corners, so that it turns by less than half a circle.
    """
    closed, found, first = np.vstack([ring_mm, ring_mm[:1]]), [], 0
    longest = max(1, len(ring_mm) // 3)
    while first < len(ring_mm):
        last, curve = first + 1, _through(closed[first : first + 2], within_mm)
        while last < min(first + longest, len(ring_mm)):
            farther = _through(closed[first : last + 2], within_mm)
            if farther is None:
                break
            last, curve = last + 1, farther
        assert curve is not None
        found.append(curve)
        first = last
    return found


def _through(corners: Array, within: float) -> Line | Arc | None:
    """The line or arc along the sides between corners (n, 2), if any."""
    found = line_or_arc(corners, within)
    if found is None or distances_mm(found[0], (corners[:-1] + corners[1:]) / 2.0).max() > 2.0 * within:
        return None
    return found[0]
