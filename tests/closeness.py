"""How far points are from closed polygons."""

from __future__ import annotations

import numpy as np
import shapely
from numpy.typing import NDArray

Array = NDArray[np.float64]


def farthest(points: Array, ring: Array) -> float:
    """Largest distance of points (n, 2) from a closed ring (m, 2)."""
    return max((apart(points, ring)).tolist())


def apart(points: Array, ring: Array) -> Array:
    """Distances of points (n, 2) from a closed ring (m, 2)."""
    chords = shapely.STRtree(shapely.linestrings(np.stack([ring, np.roll(ring, -1, axis=0)], axis=1)))
    _, distance = chords.query_nearest(shapely.points(points), all_matches=False, return_distance=True)
    return np.asarray(distance)
