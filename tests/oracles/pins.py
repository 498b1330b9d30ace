"""Pins laid into the spaces of a polygon, by shapely alone: nothing here knows of flanks, racks or pitch curves."""

from __future__ import annotations

import numpy as np
from shapely import Polygon

Array = np.ndarray

FINE = 64
"""Chords of a quarter turn about a corner: a pin of 5 mm is 0.2 micrometres off."""

CORNER_RAD = 0.3
"""Angle from which a corner of the parallel is one between two sides of a space, and none of chords."""


def resting(outline_mm: Array, radius_mm: float, near_mm: Array, *, ring: bool = False) -> Array:
    """Centres (n, 2) of pins that rest on two sides of the spaces of an outline (m, 2) nearest to places (n, 2).

    The centres of all pins that touch are the parallel of the outline; where a pin touches on two sides the parallel
    has a corner that points into the space.
    """
    free = Polygon(outline_mm).buffer(-radius_mm if ring else radius_mm, quad_segs=FINE)
    points = np.asarray(free.exterior.coords)[:-1]
    ways = np.roll(points, -1, axis=0) - points
    ways = ways / np.linalg.norm(ways, axis=1)[:, None]
    before = np.roll(ways, 1, axis=0)
    bend = np.arcsin(np.clip(before[:, 0] * ways[:, 1] - before[:, 1] * ways[:, 0], -1.0, 1.0))
    turned = bend * (1.0 if free.exterior.is_ccw else -1.0)
    corners = points[(turned if ring else -turned) > CORNER_RAD]
    away = np.linalg.norm(corners - near_mm[:, None], axis=2)
    found: Array = corners[np.argmin(away, axis=1)]
    return found


def over_pins(outline_mm: Array, diameter_mm: float, one_mm: Array, other_mm: Array, *, ring: bool = False) -> Array:
    """The distances over two pins each, in a ring between them, in the spaces nearest to two places, shape (n, 2)."""
    first, second = np.split(resting(outline_mm, diameter_mm / 2.0, np.vstack([one_mm, other_mm]), ring=ring), 2)
    found: Array = np.linalg.norm(first - second, axis=1) + (-diameter_mm if ring else diameter_mm)
    return found
