"""Whether a gear has room for the wishes for its body: the bore, the hub, and the index hole that marks its pose.

A gear's section is a polygon, in mm: the disc inside its tooth outline, or a ring.  A part that has no room is refused,
with the largest size that fits.  At phi1 = 0 the index holes of both gears lie on the line of centres and face each
other across the pitch point, so that they show how the gears go together; a ring has its index hole in its rim.
"""

from __future__ import annotations

from collections.abc import Callable, Sequence
from dataclasses import replace
from math import cos, degrees, hypot, pi, sin

import numpy as np
import shapely
from shapely import LineString, Point, Polygon
from shapely.geometry.base import BaseGeometry

from ncgear.errors import WrongInput
from ncgear.numerics.arrays import Array
from ncgear.solids.plan.areas import floored, largest_fitting, raised, said_largest, stl_resolution_mm
from ncgear.solids.plan.body import FEWEST_CHORDS, Bore, EndStop, Hub, RoundHole, bore_points, slot_points
from ncgear.teeth.outline import simple_polygon

DIAMETER_IN_MODULES = 0.5
"""Diameter of an index hole, if it is over ``USEFUL_MM``."""

USEFUL_MM, LEAST_MM = 2.0, 1.0
"""Diameters in mm: the least that a printer leaves open and that takes off weight, and the smallest common drill, for
index holes of gears without room for more.  Holes without a given size are not made smaller."""

OUTER_WALL_IN_MODULES = 1.5
"""Least material between the hole and the tooth outline: with it the hole does not reach into the foot of a tooth,
between the roots at its sides."""

INNER_WALL_IN_MODULES = 1.0
"""Least material between the hole and the bore, its keyway, the axis of a gear without a bore, or a ring's circle; and
around the bore, up to the teeth and to the parts that stand about the axis."""

SLOT_CHORDS = 1e-3
"""Chord tolerance of a slot while room is sought for it, as a share of its width: far below any wall."""

RADII = 60
"""Number of radii that are tried for a slot where the given radius has no room."""


def full_disc(outline_mm: Array, key: str) -> Polygon:
    """The disc inside an outline (mm, (n, 2)); raises NoSuchMechanism for ``key`` with the place of a crossing."""
    gap = outline_mm - np.roll(outline_mm, 1, axis=0)
    return simple_polygon(outline_mm[np.hypot(gap[:, 0], gap[:, 1]) > stl_resolution_mm(outline_mm)], key)


def common_disc(outlines_mm: Sequence[Array], key: str) -> Polygon:
    """The area about the axis that all sections of a gear share; outlines (n, 2) each, ``key`` as in ``full_disc``."""
    common = shapely.intersection_all([full_disc(outline, key) for outline in outlines_mm])
    return max(shapely.get_parts(common), key=lambda part: part.area)


def require_room(
    disc: Polygon, bore: Bore, wall_mm: float, chord_tolerance_mm: float, key: str, clearance_mm: float
) -> None:
    """Raise WrongInput for ``key``.bore_mm, with the largest bore, unless widened bore and keyway leave a wall."""
    if has_room(disc, bore.widened(clearance_mm), wall_mm, chord_tolerance_mm):
        return
    largest = largest_bore_mm(disc, bore, wall_mm, chord_tolerance_mm, clearance_mm)
    cut = "a bore" if bore.keyway is None else "a bore with this keyway"
    needed = "a larger gear" if bore.keyway is None else "a shallower keyway or a larger gear"
    right = said_largest(largest, f"none fits; {needed} is needed")
    problem = f"{cut} of {bore.diameter_mm:g} mm leaves less than {wall_mm:g} mm, one module, to the teeth; {right}"
    raise WrongInput(problem, key=f"{key}.bore_mm")


def largest_bore_mm(
    disc: Polygon, bore: Bore, wall_mm: float, chord_tolerance_mm: float, clearance_mm: float = 0.0
) -> float:
    """Largest diameter up to ``bore``'s own, in mm, that fits with the same keyway; 0 when no diameter fits."""

    def fits(diameter: float) -> bool:
        return has_room(disc, replace(bore, diameter_mm=diameter).widened(clearance_mm), wall_mm, chord_tolerance_mm)

    return largest_fitting(fits, bore.keyway.width_mm if bore.keyway else 0.0, bore.diameter_mm)


def has_room(disc: Polygon, bore: Bore, wall: float, tolerance: float) -> bool:
    """Whether a bore within a disc leaves a wall (mm) to its edge, with chords within the tolerance (mm)."""
    # The true circle bulges beyond its inscribed polygon by up to one chord tolerance.
    cut = Polygon(bore_points(bore, tolerance))
    return bool(disc.contains(cut) and cut.distance(disc.exterior) >= wall + tolerance)


def require_wall_around_bore(bore: Bore, about_axis_mm: float, wall_mm: float, key: str) -> None:
    """Raise WrongInput for ``key`` unless ``about_axis_mm`` leaves a wall around the bore; tells the smallest size."""
    least = 2.0 * (bore.farthest_mm + wall_mm)
    if about_axis_mm < least:
        problem = f"{about_axis_mm:g} mm leaves less than {wall_mm:g} mm, one module, around bore and keyway"
        raise WrongInput(f"{problem}; {raised(least):.10g} mm or more is right", key=key)


def require_hub_room(disc: Polygon, hub: Hub, key: str) -> None:
    """Raise WrongInput for ``key``.hub.diameter_mm unless the hub stands within the tooth roots."""
    axis = Point(0.0, 0.0)
    largest = 2.0 * float(disc.exterior.distance(axis)) if disc.contains(axis) else 0.0
    if hub.diameter_mm <= largest:
        return
    right = said_largest(largest, "none fits about an axis outside the teeth")
    problem = f"a hub of {hub.diameter_mm:g} mm reaches over the tooth spaces, to where the mate's may be; {right}"
    raise WrongInput(problem, key=f"{key}.hub.diameter_mm")


def require_slot_room(
    disc: Polygon, stop: EndStop, around_axis: BaseGeometry, middle_rad: float, wall_mm: float, key: str
) -> None:
    """Raise WrongInput for ``key``.end_stop.radius_mm, with a radius that would do, unless slots keep walls."""

    def fits(radius_mm: float) -> bool:
        if radius_mm <= stop.width_mm / 2.0:
            return False
        slot = replace(stop, radius_mm=radius_mm).slot(middle_rad)
        if not slot.low_rad < slot.high_rad:
            return False
        if 2.0 * radius_mm * sin(pi - (slot.high_rad - slot.low_rad) / 2.0) < slot.width_mm + wall_mm:
            return False
        cut = Polygon(slot_points(slot, SLOT_CHORDS * slot.width_mm)).buffer(wall_mm, quad_segs=FEWEST_CHORDS)
        return bool(disc.contains(cut) and not cut.intersects(around_axis))

    if fits(stop.radius_mm):
        return
    reach = float(np.abs(disc.bounds).max())
    fitting = [radius for radius in map(floored, np.linspace(0.0, reach, RADII + 1)[1:].tolist()) if fits(radius)]
    right = (
        f"{min(fitting, key=lambda radius: abs(radius - stop.radius_mm)):.10g} mm fits"
        if fitting
        else ("no radius fits; a thinner pin, less clearance_mm, a smaller bore or a larger gear is needed")
    )
    turned = degrees(abs(stop.turned_rad))
    problem = (
        f"a slot of {stop.width_mm:g} mm for a turn of {turned:.5g} deg, {stop.radius_mm:g} mm from the axis, leaves "
        f"less than {wall_mm:g} mm, one module, to the teeth, to bore, hub or axis, or between its ends; {right}"
    )
    raise WrongInput(problem, key=f"{key}.end_stop.radius_mm")


def require_crank_pin_room(
    disc: Polygon, hole: RoundHole, others: BaseGeometry, wall_mm: float, clearance_mm: float, key: str
) -> None:
    """Raise WrongInput for ``key``.crank_pin.diameter_mm unless the hole keeps a wall to everything.

    The hole is first widened by the clearance.  ``others`` are the other cuts and the parts about the axis.  The
    message states the largest hole that fits.
    """
    center = Point(hole.x_mm, hole.y_mm)
    reach_mm = hypot(hole.x_mm, hole.y_mm)
    if disc.contains(center) and not others.contains(center):
        apart_mm = min(float(disc.exterior.distance(center)), float(others.distance(center)))
    else:
        apart_mm = 0.0
    largest = 2.0 * (apart_mm - wall_mm - clearance_mm)
    if hole.diameter_mm <= largest:
        return
    right = said_largest(largest, "none fits there; a larger gear, another crank or a thinner shaft is needed")
    problem = (
        f"a hole of {hole.diameter_mm:g} mm for the crank pin, {reach_mm:.5g} mm from the axis, leaves less than "
        f"{wall_mm:g} mm, one module, to the teeth, to bore, hub or axis, or to the end stop's slot; {right}"
    )
    raise WrongInput(problem, key=f"{key}.crank_pin.diameter_mm")


def index_hole(
    disc: Polygon,
    bore: Bore | None,
    direction_rad: float,
    module_mm: float,
    hub_mm: float = 0.0,
    beside: BaseGeometry | None = None,
) -> RoundHole | None:
    """The hole farthest out on the ray from the axis at polar angle ``direction_rad``; None where no wall allows one.

    Its diameter is half a module, or ``USEFUL_MM`` where that is more and has room, or ``LEAST_MM``.  The walls above
    are left all around it.  ``disc`` is the gear's section without bore, in mm; ``hub_mm`` is the diameter of its hub;
    ``beside`` is the area of the other cuts, which the hole must not meet.
    """
    other = around_axis(bore, hub_mm, module_mm)
    other = other if beside is None else other.union(beside)
    return _hole_on_ray(disc, direction_rad, module_mm, disc.exterior, other, np.argmax)


def rim_hole(ring: Polygon, direction_rad: float, module_mm: float) -> RoundHole | None:
    """The index hole of a ring (its section in mm), nearest to the teeth; None where the rim is too thin for it."""
    return _hole_on_ray(ring, direction_rad, module_mm, ring.interiors[0], ring.exterior, np.argmin)


def around_axis(bore: Bore | None, hub: float, module: float) -> BaseGeometry:
    """The area of the cuts and parts around the axis; the axis itself where there are none."""
    if hub > 0.0:
        return Point(0.0, 0.0).buffer(hub / 2.0, quad_segs=FEWEST_CHORDS)
    return Polygon(bore_points(bore, 0.01 * module)) if bore else Point(0.0, 0.0)


def _hole_on_ray(
    section: Polygon,
    direction: float,
    module: float,
    outline: BaseGeometry,
    other: BaseGeometry,
    chosen: Callable[[Array], np.intp],
) -> RoundHole | None:
    """The hole with its centre ``chosen`` by distance from the axis, with walls to the outline and the other area."""
    reach = float(np.abs(section.bounds).max()) * 2.0
    ray = LineString([(0.0, 0.0), (reach * cos(direction), reach * sin(direction))]).intersection(section)
    for least in (USEFUL_MM, LEAST_MM):
        diameter = max(DIAMETER_IN_MODULES * module, least)
        wide = diameter / 2.0 + OUTER_WALL_IN_MODULES * module
        # Teeth farther away reach no point of the ray.
        beside_teeth = outline.intersection(ray.buffer(2.0 * wide)).buffer(wide)
        beside_other = other.buffer(diameter / 2.0 + INNER_WALL_IN_MODULES * module)
        points = shapely.get_coordinates(ray.difference(beside_teeth.union(beside_other)))
        if len(points):
            x, y = points[chosen(np.hypot(points[:, 0], points[:, 1]))]
            return RoundHole(float(x), float(y), diameter)
    return None
