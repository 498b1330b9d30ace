"""Whether an outline is a simple polygon: the last look at what no single tooth's side can see."""

from __future__ import annotations

import re
from math import atan2, degrees

import shapely
from shapely import Polygon

from ncgear.errors import NoSuchMechanism
from ncgear.numerics.arrays import Array

REMEDY = "more teeth, a smaller addendum or dedendum, or a less uneven ratio avoids that"


def simple_polygon(outline_mm: Array, key: str) -> Polygon:
    """The polygon of an outline in mm, shape (n, 2).

    Raises NoSuchMechanism for ``key``, naming the place, where the outline crosses itself: both sides of one space may
    meet where the pitch curve is deeply concave.
    """
    polygon = Polygon(outline_mm)
    if not polygon.is_valid:
        raise NoSuchMechanism(f"the tooth outline crosses itself{_place(polygon)}; {REMEDY}", key=key)
    return polygon


def _place(polygon: Polygon) -> str:
    """Where a polygon is invalid, as far as GEOS says: its reason reads ``Self-intersection[x y]``."""
    numbers = re.findall(r"-?\d[\d.e+-]*", shapely.is_valid_reason(polygon))
    if len(numbers) < 2:
        return ""
    x, y = float(numbers[0]), float(numbers[1])
    return f" at x = {x:.5g} mm, y = {y:.5g} mm (polar angle {degrees(atan2(y, x)):.4g} deg in the gear's frame)"
