"""The closed outline of a gear as lines and arcs of circles that join without corners.

Drawings for cutters have these: all programs read arcs, and few arcs follow a flank more closely than many chords.

Each stretch of a curve is followed by two arcs that touch each other, and that begin and end on the curve in its own
direction (a biarc).  Of all such pairs, the pair with equally long tangents at its ends is taken.  Its distance from
the curve is the change of the curvature along it, times the square of its length, over some hundreds.  Source: K. M.
Bolton, "Biarc curves", Computer-Aided Design 7 (1975) 89-92.
"""

from __future__ import annotations

import numpy as np

from ncgear.errors import Unanswered
from ncgear.frozen import dataclass
from ncgear.numerics.arrays import Array, ComplexArray, IndexArray
from ncgear.numerics.plane import across, along, as_complex, as_points
from ncgear.teeth.contour import INSIDE, SAME_IN_MODULES, SHORTEST_IN_MODULES, SPANS
from ncgear.teeth.gear import ToothedGear
from ncgear.teeth.outline import exact_curves
from ncgear.teeth.stretch import CurveStretch

SEEN = 0.9
"""Share of the tolerance that arcs may stray at the probes: between them they stray by a few per cent more."""

PROBES = np.linspace(0.0, 1.0, 9)[1:-1]
"""Shares of a biarc's way at which it is compared with its curve; its error has a few waves along the way."""


@dataclass(frozen=True, eq=False)
class ArcOutline:
    """A closed, counter-clockwise chain of lines and arcs in mm through points (n, 2), first point not repeated.

    ``bulges`` (n,) describe the piece after each point: 0 for a line, else the tangent of a quarter of the arc's angle,
    positive counter-clockwise.  ``deviation_mm`` is the largest distance found from the exact curves.
    """

    points_mm: Array
    bulges: Array
    deviation_mm: float


def arc_outline(gear: ToothedGear, tolerance_mm: float) -> ArcOutline:
    """Lines and arcs within ``tolerance_mm`` of the exact curves; raises Unanswered where the most spans stray."""
    module = gear.flanks.rack.module_mm
    found = [_followed(stretch, tolerance_mm, module) for stretch in exact_curves(gear.tips, gear.sides)]
    chains = [chain for chains in found for chain in chains if chain.point.size]
    points, bulges, keys = (
        np.concatenate([getattr(chain, name) for chain in chains]) for name in ("point", "bulge", "key")
    )
    order = np.argsort(keys, kind="stable")
    points, bulges = points[order], bulges[order]
    # A row ends where the next begins: its last point is left out, except at gaps of equivalent gears.
    real = np.abs(np.roll(points, -1) - points) > SHORTEST_IN_MODULES * module
    points, bulges = points[real], bulges[real]
    if float(np.sum(across(points, np.roll(points, -1)))) < 0.0:
        points, bulges = points[::-1], np.roll(-bulges[::-1], -1)
    return ArcOutline(as_points(points), bulges, max(chain.deviation_mm for chain in chains))


@dataclass(frozen=True, eq=False)
class _Chain:
    """Beginnings of lines and arcs, their bulges (0 at a row's last point) and keys along the outline, (n,)."""

    point: ComplexArray
    bulge: Array
    key: Array
    deviation_mm: float


def _followed(stretch: CurveStretch, tolerance: float, module: float) -> list[_Chain]:
    """Chains along all rows of a stretch, each with as few spans as are close enough."""
    ends = as_complex(stretch.at(np.arange(stretch.owner.size)[:, None], np.linspace(0.0, 1.0, 3))[0])
    rows = np.nonzero(np.abs(np.diff(ends, axis=1)).sum(axis=1) > SHORTEST_IN_MODULES * module)[0]
    found: list[_Chain] = []
    for spans in (1, *SPANS):
        if not rows.size:
            return found
        points, bulges, deviation = _biarcs(stretch, rows, spans, SAME_IN_MODULES * module)
        close = deviation <= SEEN * tolerance
        if close.any():
            found.append(_flat(stretch, rows[close], points[close], bulges[close], float(deviation[close].max())))
        rows = rows[~close]
    if rows.size:
        raise Unanswered(f"a curve of tooth {stretch.owner[rows[0]] // 2 + 1} is not followed by {SPANS[-1]} biarcs")
    return found


def _flat(stretch: CurveStretch, rows: IndexArray, point: ComplexArray, bulge: Array, deviation: float) -> _Chain:
    share = np.linspace(0.0, 1.0, point.shape[1])
    # The last point of a row comes before the first of the next row, which has the same key.
    share[-1] -= 1e-9
    key = stretch.rank[rows, None] + stretch.span[rows, None] * share
    return _Chain(point.ravel(), bulge.ravel(), key.ravel(), deviation)


def _biarcs(stretch: CurveStretch, rows: IndexArray, spans: int, straight: float) -> tuple[ComplexArray, Array, Array]:
    """Points and bulges of arcs (r, 2 spans + 1) along rows, lines where they are flat, and distances of rows (r,)."""
    share = np.linspace(0.0, 1.0, spans + 1)
    point = as_complex(stretch.at(rows[:, None], share)[0])
    # At a joint of the pitch curve itself the slope may belong to the joint's other side.
    heading = as_complex(stretch.at(rows[:, None], np.clip(share, *INSIDE))[1])
    heading /= np.abs(heading)
    (start, end), (own, other) = (point[:, :-1], point[:, 1:]), (heading[:, :-1], heading[:, 1:])
    chord = end - start
    forwards, bent = along(own + other, chord), 1.0 - along(own, other)
    length = np.abs(chord) ** 2
    tangent = length / (forwards + np.sqrt(forwards**2 + 2.0 * bent * length))
    joint = (start + end + tangent * (own - other)) / 2.0
    first, second = _bulge(joint - start, own, straight), -_bulge(end - joint, other, straight)
    points = np.stack([start, joint], axis=2).reshape(len(rows), -1)
    bulges = np.stack([first, second], axis=2).reshape(len(rows), -1)
    probes = as_complex(stretch.at(rows[:, None, None], share[:-1, None] + PROBES / spans)[0])
    arcs = (start, joint, first), (joint, end, second)
    before = along((end - start)[..., None], probes - joint[..., None]) < 0.0
    apart = np.where(before, *(_distance(probes, *arc) for arc in arcs)).max(axis=(1, 2))
    return np.append(points, end[:, -1:], axis=1), np.append(bulges, np.zeros((len(rows), 1)), axis=1), apart


def _bulge(chord: ComplexArray, heading: ComplexArray, straight: float) -> Array:
    """Bulge of the arc that begins in a direction (a unit vector) and ends after a chord; 0 if nearly a line."""
    length = np.abs(chord)
    bulge = across(heading, chord) / np.maximum(length + along(heading, chord), np.finfo(float).tiny)
    return np.where(np.abs(bulge) * length / 2.0 > straight, bulge, 0.0)


def _distance(point: ComplexArray, start: ComplexArray, end: ComplexArray, bulge: Array) -> Array:
    """Distances, to first order, of points (shape (..., p)) from the whole line or circle of arcs (shape (...))."""
    chord, bulge = (end - start)[..., None], bulge[..., None]
    length = np.abs(chord)
    unit = chord / np.maximum(length, np.finfo(float).tiny)
    x, y = along(unit, point - start[..., None]), across(unit, point - start[..., None])
    # The circle through (0, 0), (l, 0) and the apex (l / 2, -b l / 2), as a function that is zero on it.
    off = 2.0 * bulge * (x * (x - length) + y * y) - (1.0 - bulge**2) * length * y
    slope = np.hypot(2.0 * bulge * (2.0 * x - length), 4.0 * bulge * y - (1.0 - bulge**2) * length)
    return np.asarray(np.abs(off) / np.maximum(slope, np.finfo(float).tiny))
