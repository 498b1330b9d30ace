"""The index hole: a small through hole that shows how the two gears go together.

At phi1 = 0 those of both gears lie on the line of centres and face each other across the pitch point.  A ring's is in
its rim.
"""

from __future__ import annotations

from math import cos, sin

import numpy as np
import shapely
from shapely import LineString, Point, Polygon
from shapely.geometry.base import BaseGeometry

from ncgear.solids.bore import FEWEST_CHORDS, Bore, bore_points
from ncgear.solids.round_hole import RoundHole

DIAMETER_IN_MODULES = 0.5
OUTER_WALL_IN_MODULES = 1.5
"""Least material between the hole and the tooth outline: enough that the hole does not reach into the foot of a tooth,
between the roots at its sides."""
INNER_WALL_IN_MODULES = 1.0
"""Least material between the hole and the bore, its keyway, the axis of a gear without bore, or a ring's circle."""


def index_hole(
    disc: Polygon, bore: Bore | None, direction_rad: float, module_mm: float, hub_mm: float = 0.0
) -> RoundHole | None:
    """The hole farthest out on the ray from the axis at polar angle ``direction_rad``; None where no wall allows one.

    Its diameter is half a module; the walls above are left all around it. ``disc`` is the gear's section without
    bore, in mm; ``hub_mm`` the diameter of the hub on it, which it passes by.
    """
    diameter = DIAMETER_IN_MODULES * module_mm
    outline = disc.exterior.buffer(diameter / 2.0 + OUTER_WALL_IN_MODULES * module_mm)
    inside = _axis(bore, hub_mm, module_mm).buffer(diameter / 2.0 + INNER_WALL_IN_MODULES * module_mm)
    points = shapely.get_coordinates(_ray(disc, direction_rad).difference(outline.union(inside)))
    if not len(points):
        return None
    x, y = points[np.argmax(np.hypot(points[:, 0], points[:, 1]))]
    return RoundHole(float(x), float(y), diameter)


def rim_hole(ring: Polygon, direction_rad: float, module_mm: float) -> RoundHole | None:
    """The same in a ring (its section in mm): the hole nearest to the teeth; None where the rim is too thin for one."""
    diameter = DIAMETER_IN_MODULES * module_mm
    outline = ring.interiors[0].buffer(diameter / 2.0 + OUTER_WALL_IN_MODULES * module_mm)
    outside = ring.exterior.buffer(diameter / 2.0 + INNER_WALL_IN_MODULES * module_mm)
    points = shapely.get_coordinates(_ray(ring, direction_rad).difference(outline.union(outside)))
    if not len(points):
        return None
    x, y = points[np.argmin(np.hypot(points[:, 0], points[:, 1]))]
    return RoundHole(float(x), float(y), diameter)


def _ray(disc: Polygon, direction: float) -> BaseGeometry:
    """The part of the ray from the axis that lies in a section."""
    reach = float(np.abs(disc.bounds).max()) * 2.0
    return LineString([(0.0, 0.0), (reach * cos(direction), reach * sin(direction))]).intersection(disc)


def _axis(bore: Bore | None, hub: float, module: float) -> BaseGeometry:
    """What is cut around the axis or stands there; the axis itself where nothing does."""
    if hub > 0.0:
        return Point(0.0, 0.0).buffer(hub / 2.0, quad_segs=FEWEST_CHORDS)
    return Polygon(bore_points(bore, 0.01 * module)) if bore else Point(0.0, 0.0)
