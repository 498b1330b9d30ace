"""The largest of a size that fits, told to whoever asked for more.

A gear's section as a polygon: the disc inside its tooth outline, and its room for the bore.

The room for the hub on a gear's upper face.

The index hole: a small through hole that shows how the two gears go together.

At phi1 = 0 those of both gears lie on the line of centres and face each other across the pitch point.  A ring's is in
its rim.
"""

from __future__ import annotations

from collections.abc import Callable, Sequence
from dataclasses import replace
from math import cos, floor, sin

import numpy as np
import shapely
from shapely import LineString, Point, Polygon
from shapely.geometry.base import BaseGeometry

from ncgear.errors import WrongInput
from ncgear.numerics.arrays import Array
from ncgear.solids.plan.body import FEWEST_CHORDS, Bore, Hub, RoundHole, bore_points
from ncgear.teeth.outline import simple_polygon

RESOLUTION_MM = 1e-4
"""How near the largest is found: a hundredth of what is told of it."""


def largest_fitting(fits: Callable[[float], bool], low_mm: float, high_mm: float) -> float:
    """The largest size that fits between two in mm, by bisection; 0 where none does.

    What is smaller than a fitting size fits; ``low_mm`` itself is not tried.
    """
    fitting = 0.0
    while high_mm - low_mm > RESOLUTION_MM:
        middle = (low_mm + high_mm) / 2.0
        if fits(middle):
            low_mm = fitting = middle
        else:
            high_mm = middle
    return fitting


def floored(size_mm: float) -> float:
    """Rounded down to 0.01 mm, so that the stated size itself fits; smaller ones as they are."""
    return floor(size_mm * 100.0) / 100.0 or size_mm


def said_largest(largest_mm: float, otherwise: str) -> str:
    """The end of a refusal: the largest that fits, or what else would be right where none does."""
    return f"the largest that fits is {floored(largest_mm):g} mm" if largest_mm > 0.0 else otherwise


def disc_with_room(outline_mm: Array, bore: Bore | None, chord_tolerance_mm: float, key: str) -> Polygon:
    """The full disc inside a tooth outline (mm, shape (n, 2)), known to have room for the bore.

    ``key`` (``gears.driving``) names the gear in errors: NoSuchMechanism where the outline crosses itself, WrongInput
    when the bore does not fit.
    """
    disc = full_disc(outline_mm, key)
    if bore is not None:
        require_room(disc, bore, chord_tolerance_mm, key)
    return disc


def full_disc(outline_mm: Array, key: str) -> Polygon:
    """The full disc inside a tooth outline (mm, shape (n, 2)).

    Raises NoSuchMechanism for ``key`` (``gears.driving``), naming the place, where the outline crosses itself.
    """
    return simple_polygon(_distinct(outline_mm), key)


def common_disc(outlines_mm: Sequence[Array], key: str) -> Polygon:
    """What all sections of a gear have in common around its axis; outlines of shape (n, 2) each, ``key`` as above."""
    common = shapely.intersection_all([full_disc(outline, key) for outline in outlines_mm])
    return max(shapely.get_parts(common), key=lambda part: part.area)


def _distinct(outline: Array) -> Array:
    """Without points so close to the one before that the single precision of STL files could merge the two."""
    step = 2.0 * float(np.spacing(np.float32(np.abs(outline).max())))
    gap = outline - np.roll(outline, 1, axis=0)
    return outline[np.hypot(gap[:, 0], gap[:, 1]) > step]


def require_room(disc: Polygon, bore: Bore, chord_tolerance_mm: float, key: str, clearance_mm: float = 0.0) -> None:
    """Raise WrongInput for ``key``.bore_mm unless bore and keyway leave a wall of one chord tolerance everywhere.

    They are widened by the clearance first.  The message states the largest bore that fits.
    """
    if _has_room(disc, bore.widened(clearance_mm), chord_tolerance_mm):
        return
    largest = largest_bore_mm(disc, bore, chord_tolerance_mm, clearance_mm)
    cut = "a bore" if bore.keyway is None else "a bore with this keyway"
    right = said_largest(largest, "none fits; a larger gear is needed")
    problem = f"{cut} of {bore.diameter_mm:g} mm reaches the tooth outline; {right}"
    raise WrongInput(problem, key=f"{key}.bore_mm")


def largest_bore_mm(disc: Polygon, bore: Bore, chord_tolerance_mm: float, clearance_mm: float = 0.0) -> float:
    """Largest diameter in mm, up to ``bore``'s own, at which it fits with the same keyway; 0 when none does.

    A bore lies within every larger one with the same keyway, so that what fits is one interval.
    """

    def fits(diameter: float) -> bool:
        return _has_room(disc, replace(bore, diameter_mm=diameter).widened(clearance_mm), chord_tolerance_mm)

    return largest_fitting(fits, bore.keyway.width_mm if bore.keyway else 0.0, bore.diameter_mm)


def _has_room(disc: Polygon, bore: Bore, wall: float) -> bool:
    # The true circle bulges beyond its inscribed polygon by up to one chord tolerance, hence twice the wall.
    cut = Polygon(bore_points(bore, wall))
    return bool(disc.contains(cut) and cut.distance(disc.exterior) >= 2.0 * wall)


def require_hub_room(disc: Polygon, hub: Hub, key: str) -> None:
    """Raise WrongInput for ``key``.hub.diameter_mm unless the hub stands within the gear's tooth roots.

    Then no hub reaches over its own outline, and hubs of two gears meet as little as their outlines do.
    """
    axis = Point(0.0, 0.0)
    largest = 2.0 * float(disc.exterior.distance(axis)) if disc.contains(axis) else 0.0
    if hub.diameter_mm <= largest:
        return
    right = said_largest(largest, "none fits about an axis outside the teeth")
    problem = f"a hub of {hub.diameter_mm:g} mm reaches over the tooth spaces, to where the mate's may be; {right}"
    raise WrongInput(problem, key=f"{key}.hub.diameter_mm")


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
