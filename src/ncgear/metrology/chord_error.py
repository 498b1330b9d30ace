"""Distance of a closed line of chords from the exact curves of a gear, at points that the chords do not use."""

from __future__ import annotations

import numpy as np
import shapely

from ncgear.numerics.arrays import Array, ComplexArray, counted_up
from ncgear.numerics.plane import as_complex
from ncgear.teeth.gear import ToothedGear
from ncgear.teeth.outline import exact_curves

PER_CURVE = 21
"""Checked points of each flank, fillet and land, at equal shares, in addition to the points of chords and arcs."""

OFF_GRID = 0.382
"""Share of the way between two of these points at which the first one lies."""

CHORDS = 8
"""Chords of an outline that are one line of the search."""

FEW = 256
"""Points that are measured first, from those that seem nearest to those that seem farthest; of the other points, only
those that may be farther than the farthest of these are measured."""


def exact_points(gear: ToothedGear) -> Array:
    """Points of all exact curves of a gear's outline, shape (n, 2)."""
    share = (np.arange(PER_CURVE) + OFF_GRID) / PER_CURVE
    stretches = exact_curves(gear.tips, gear.sides)
    points = [one.at(np.arange(one.owner.size)[:, None], share)[0].reshape(-1, 2) for one in stretches]
    return np.concatenate(points)


def farthest_mm(points: Array, outline_mm: Array) -> float:
    """The largest distance of points (n, 2) from a closed line through others (m, 2)."""
    # Lines of a few chords: hardly more distances than with single chords, and far fewer lines.
    first = np.arange(0, len(outline_mm), CHORDS)
    last = np.minimum(first + CHORDS, len(outline_mm))
    line, corner = counted_up(first, last - first + 1)
    tree = shapely.STRtree(shapely.linestrings(outline_mm[corner % len(outline_mm)], indices=line))
    most = _at_most_mm(as_complex(points), as_complex(outline_mm))
    chosen = np.argsort(most)[:: max(most.size // FEW, 1)]
    few = _farthest_mm(points[chosen], tree)
    most[chosen] = 0.0
    return max(few, _farthest_mm(points[most > few], tree))


def _at_most_mm(points: ComplexArray, outline: ComplexArray) -> Array:
    """Distances of points (n,) from two chords of a closed line (m,): upper bounds of their distances from the line.

    The chords are those at the corner next to the point by the angle about the axis. On teeth that no ray from the axis
    crosses twice they are the nearest chords or next to them.
    """
    angle = np.angle(outline)
    by_angle = np.argsort(angle)
    corner = by_angle[np.searchsorted(angle[by_angle], np.angle(points)) - 1]
    return np.minimum(
        _from_chords_mm(points, outline[corner], outline[(corner + 1) % outline.size]),
        _from_chords_mm(points, outline[corner], outline[corner - 1]),
    )


def _from_chords_mm(points: ComplexArray, start: ComplexArray, end: ComplexArray) -> Array:
    """Distances of points from chords, shape (n,) each."""
    chord, way = end - start, points - start
    length = np.square(chord.real) + np.square(chord.imag)
    share = (way.real * chord.real + way.imag * chord.imag) / np.where(length > 0.0, length, 1.0)
    return np.abs(way - np.clip(share, 0.0, 1.0) * chord)


def _farthest_mm(points: Array, tree: shapely.STRtree) -> float:
    """The largest distance of points (n, 2) from the nearest line of a tree each; 0 for no points."""
    _, distance = tree.query_nearest(shapely.points(points), return_distance=True, all_matches=False)
    return float(distance.max(initial=0.0))
