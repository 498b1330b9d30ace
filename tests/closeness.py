"""How far points are from closed polygons and from pieces of curves."""

from __future__ import annotations

import numpy as np
import shapely
from numpy.typing import NDArray

Array = NDArray[np.float64]


def farthest(points: Array, ring: Array) -> float:
    """Largest distance of points (n, 2) from a closed ring (m, 2)."""
    return farthest_from_chords(points, np.stack([ring, np.roll(ring, -1, axis=0)], axis=1))


def farthest_from_pieces(points: Array, pieces: Array) -> float:
    """Largest distance of points (n, 2) from the nearest of open polygons (k, m, 2)."""
    return farthest_from_chords(points, np.stack([pieces[:, :-1], pieces[:, 1:]], axis=2).reshape(-1, 2, 2))


def farthest_from_chords(points: Array, chords: Array) -> float:
    """Largest distance of points (n, 2) from the nearest of chords (m, 2, 2)."""
    tree = shapely.STRtree(shapely.linestrings(chords))
    return float(tree.query_nearest(shapely.points(points), all_matches=False, return_distance=True)[1].max())
