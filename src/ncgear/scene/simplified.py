"""Contours with fewer points, for pictures: what is thinner than a line need not be drawn."""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np
import shapely
from shapely import Polygon

from ncgear.numerics.arrays import Array


def simplified(contours_mm: Sequence[Array], tolerance_mm: float) -> list[Array]:
    """Contours (shape (n, 2) each, outer one first) with fewer points, no dropped point farther than the tolerance."""
    polygon = Polygon(contours_mm[0], contours_mm[1:])
    fewer = shapely.simplify(polygon, tolerance_mm, preserve_topology=True)
    return [np.asarray(ring.coords)[:-1] for ring in (fewer.exterior, *fewer.interiors)]
