"""How far a closed line of chords is from the exact curves of a gear: measured at points that no chord knows of."""

from __future__ import annotations

import numpy as np
import shapely
from numpy.typing import NDArray

from ncgear.numerics.arrays import Array, counted_up
from ncgear.teeth.gear import ToothedGear
from ncgear.teeth.outline import exact_curves

PER_CURVE = 21
"""Points of each flank, fillet and land that are looked at, at equal shares beside all that chords and arcs go by."""

OFF_GRID = 0.382
"""Share of the way between two of these points at which the first one lies."""

CHORDS = 8
"""Chords of an outline that are found as one line."""

FEW = 16
"""Every so many points are measured at once; each of the others where they do not show that it is nearer."""


def exact_points(gear: ToothedGear) -> Array:
    """Points of all exact curves of a gear's outline, shape (n, 2)."""
    share = (np.arange(PER_CURVE) + OFF_GRID) / PER_CURVE
    stretches = exact_curves(gear.tips, gear.sides)
    points = [one.at(np.arange(one.owner.size)[:, None], share)[0].reshape(-1, 2) for one in stretches]
    return np.concatenate(points)


def farthest_mm(points: Array, outline_mm: Array) -> float:
    """The largest distance of points (n, 2) from a closed line through others (m, 2)."""
    # Lines of a few chords: hardly more is measured than with each chord by itself, and far fewer lines are made.
    first = np.arange(0, len(outline_mm), CHORDS)
    last = np.minimum(first + CHORDS, len(outline_mm))
    line, corner = counted_up(first, last - first + 1)
    tree = shapely.STRtree(shapely.linestrings(outline_mm[corner % len(outline_mm)], indices=line))
    places = shapely.points(points)
    # Most points are seen to be nearer than the farthest of a few; only the others are measured.
    few = _farthest_mm(places[::FEW], tree)
    nearer, _ = tree.query(places, predicate="dwithin", distance=few)
    return max(few, _farthest_mm(np.delete(places, nearer), tree))


def _farthest_mm(places: NDArray[np.object_], tree: shapely.STRtree) -> float:
    """The largest distance of places from the nearest line of a tree each; 0 for no places."""
    _, distance = tree.query_nearest(places, return_distance=True, all_matches=False)
    return float(distance.max(initial=0.0))
