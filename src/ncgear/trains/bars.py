"""Outlines of bars between axes, such as carriers and arms."""

from __future__ import annotations

from collections.abc import Sequence
from math import acos, ceil, pi

import numpy as np

from ncgear.numerics.arrays import Array
from ncgear.numerics.plane import as_points


def bar_mm(axes: Sequence[complex], width_mm: float, tolerance_mm: float) -> Array:
    """The outline of all points within half the width of the line through axes, shape (n, 2), counter-clockwise.

    Axes are complex numbers in mm, two or more; round ends are chords within the tolerance.
    """
    from shapely import LineString

    radius = width_mm / 2.0
    quarter = max(ceil(pi / 4.0 / acos(1.0 - min(tolerance_mm / radius, 0.5))), 4)
    area = LineString(as_points(np.asarray(axes))).buffer(radius, quad_segs=quarter)
    outline: Array = np.asarray(area.exterior.coords)[:-1]
    if area.exterior.is_ccw:
        return outline
    return outline[::-1]
