"""The plan of a gear's body: its outline, the wishes for the body, the places that have room for them, and the cuts.

Pockets are cut from above only, so that the gear lies on a level face when it is printed and is never turned over.
Holes stand in evenly spread directions, each as far out as its walls allow: there, holes have most room beside each
other, and take away most of the moment of inertia.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import replace
from math import acos, ceil, cos, pi, sin

import numpy as np
import shapely
from shapely import Polygon
from shapely.geometry.base import BaseGeometry

from ncgear.errors import WrongInput
from ncgear.numerics.arrays import Array
from ncgear.pitch.shape import Gear, Mesh, meeting_direction_rad
from ncgear.solids.plan import areas
from ncgear.solids.plan.body import (
    ArcSlot,
    Blank,
    BodyPlan,
    HoleSet,
    RingBlank,
    RoundHole,
    Web,
    WebSize,
    circle_points,
    hole_points,
    slot_points,
)
from ncgear.solids.plan.room import (
    INNER_WALL_IN_MODULES,
    USEFUL_MM,
    around_axis,
    full_disc,
    index_hole,
    require_crank_pin_room,
    require_hub_room,
    require_room,
    require_slot_room,
    require_wall_around_bore,
    rim_hole,
)
from ncgear.teeth.gear import ToothedGear
from ncgear.teeth.outline import exact_curves
from ncgear.teeth.reach import FILLET_CURVE, PROBES, ROOT_LAND

CORNER_IN_MODULES = 1.0
"""Least radius of a pocket's corners: the radius of a round tool, which cannot reach narrower places."""

TURNS = 12
"""Angles, between one direction and the next, by which the directions of the holes are turned to find most room."""


def web_of(disc: Polygon, cuts: Sequence[Array], size: WebSize, module_mm: float, tolerance_mm: float, key: str) -> Web:
    """The web of a gear; its disc in mm has cuts, polygons of shape (n, 2): an index hole, a slot, or none.

    Pockets keep the rim's wall to the nearest point of the tooth outline.  Raises WrongInput for ``key``.web.rim_mm,
    with the thickest rim that leaves a pocket, where there is no room for a pocket.
    """
    around = _kept(cuts, size.hub_mm, module_mm, tolerance_mm)
    corner = CORNER_IN_MODULES * module_mm
    pockets = _pockets(disc, around, size.rim_mm, corner, tolerance_mm)
    if pockets:
        return Web(size.thickness_mm, tuple(pockets))
    largest = areas.largest_fitting(
        lambda rim: bool(_pockets(disc, around, rim, corner, tolerance_mm)), 0.0, size.rim_mm
    )
    right = areas.said_largest(largest, "there is none beside any rim; a smaller hub_mm or a larger gear is needed")
    problem = f"a rim of {size.rim_mm:g} mm leaves no room for a pocket beside a hub of {size.hub_mm:g} mm; {right}"
    raise WrongInput(problem, key=f"{key}.web.rim_mm")


def _kept(cuts: Sequence[Array], hub: float, module: float, tolerance: float) -> BaseGeometry:
    """The area that no pocket cuts: the hub, and the wall around each cut."""
    kept: BaseGeometry = Polygon(circle_points(hub / 2.0 + tolerance, tolerance))
    wall, quarter = INNER_WALL_IN_MODULES * module, quarter_chords(module, tolerance)
    return shapely.union_all([kept, *(Polygon(cut).buffer(wall, quad_segs=quarter) for cut in cuts)])


def _pockets(disc: Polygon, kept: BaseGeometry, rim: float, corner: float, tolerance: float) -> list[Polygon]:
    """The room for pockets with rounded corners, two tolerances from walls: for chords and for points left out."""
    inside = disc.buffer(-rim - corner - 2.0 * tolerance, quad_segs=quarter_chords(rim + corner, tolerance))
    quarter = quarter_chords(corner, tolerance)
    room = inside.difference(kept.buffer(corner + 2.0 * tolerance, quad_segs=quarter)).buffer(corner, quad_segs=quarter)
    return areas.polygons(shapely.simplify(room, tolerance / 2.0))


def quarter_chords(radius_mm: float, tolerance_mm: float) -> int:
    """Number of parts of a quarter circle, for shapely, at which the arcs of a parallel keep the tolerance."""
    return max(2, ceil(pi / 4.0 / acos(max(1.0 - tolerance_mm / 4.0 / radius_mm, 0.0))))


def lightening_holes(room: BaseGeometry, asked: HoleSet, tolerance_mm: float, key: str) -> tuple[RoundHole, ...]:
    """Holes within a room in mm, with walls to its edges and to each other.

    Raises WrongInput for ``key``.lightening_holes, with the largest diameter that fits, where the holes have no room,
    or where no diameter is given and only holes under ``USEFUL_MM`` fit.
    """
    wanted = asked.diameter_mm
    if wanted is not None and (places := _places(room, asked, wanted, tolerance_mm)) is not None:
        return _holes(places, wanted)
    most = wanted if wanted is not None else float(np.abs(room.bounds).max()) if not room.is_empty else 0.0
    largest = areas.largest_fitting(lambda size: _places(room, asked, size, tolerance_mm) is not None, 0.0, most)
    if wanted is None and largest >= USEFUL_MM:
        size = areas.floored(largest)
        places = _places(room, asked, size, tolerance_mm)
        assert places is not None
        return _holes(places, size)
    raise _without_room(asked, largest, f"{key}.lightening_holes")


def _holes(places: Array, diameter: float) -> tuple[RoundHole, ...]:
    return tuple(RoundHole(float(x), float(y), diameter) for x, y in places)


def _without_room(asked: HoleSet, largest: float, key: str) -> WrongInput:
    given = asked.diameter_mm is not None
    named = f"{asked.count} holes of {asked.diameter_mm:g} mm" if given else f"{asked.count} holes"
    helps = "fewer holes, thinner walls, or a smaller hub are needed"
    right = areas.said_largest(largest, f"none fit; {helps}")
    if 0.0 < largest < USEFUL_MM:
        right = f"{right}, and under {USEFUL_MM:g} mm holes take off next to nothing; {helps}"
    problem = f"{named} do not keep walls of {asked.wall_mm:g} mm to every edge and to each other; {right}"
    return WrongInput(problem, key=f"{key}.diameter_mm" if given else key)


def _places(room: BaseGeometry, asked: HoleSet, diameter: float, tolerance: float) -> Array | None:
    """Centres of the holes, shape (count, 2), for the first turn with room for them; None where no turn has room."""
    # Chords of the parallel's arcs come nearer to the edge by up to a tolerance.
    inset = diameter / 2.0 + asked.wall_mm + tolerance
    inside = room.buffer(-inset, quad_segs=quarter_chords(inset, tolerance))
    if inside.is_empty:
        return None
    shapely.prepare(inside)
    for turn in np.arange(TURNS) / TURNS:
        places = _farthest(inside, 2.0 * np.pi / asked.count * (np.arange(asked.count) + turn))
        if places is not None and _apart(places) >= diameter + asked.wall_mm:
            return places
    return None


def _farthest(inside: BaseGeometry, direction: Array) -> Array | None:
    """The farthest point of an area in each direction from the axis, shape (n, 2); None if a direction misses it."""
    reach = 2.0 * float(np.abs(inside.bounds).max())
    ends = reach * np.column_stack([np.cos(direction), np.sin(direction)])
    rays = shapely.linestrings(np.stack([np.zeros_like(ends), ends], axis=1))
    met = [shapely.get_coordinates(part) for part in shapely.intersection(rays, inside)]
    if not all(len(points) for points in met):
        return None
    return np.array([points[np.argmax(np.hypot(points[:, 0], points[:, 1]))] for points in met])


def _apart(places: Array) -> float:
    """Least distance between any two of the points; infinite for a single point."""
    between = np.hypot(*(places[:, None] - places[None, :]).transpose(2, 0, 1))
    np.fill_diagonal(between, np.inf)
    return float(between.min())


CLEARANCE_KEY = "gears.process_clearance_mm"

RING_KEY = "gears.driven"
"""Key of the only gear that can be a ring."""


def planned(
    outline_mm: Array, blank: Blank, direction_rad: float, module_mm: float, tolerance_mm: float, key: str
) -> BodyPlan:
    """The body of a gear with straight teeth, from its outline as designed, shape (n, 2).

    ``direction_rad`` is the polar angle of the index hole; ``key`` (``gears.driving``) names the gear in errors.
    Raises NoSuchMechanism where the outline crosses itself, WrongInput where a wish has no room.
    """
    disc = full_disc(outline_mm, key)
    if blank.clearance_mm < 0.0:
        finished = planned_within(
            disc, disc, replace(blank, clearance_mm=0.0), direction_rad, module_mm, tolerance_mm, key
        )
        return _with_kerf(finished, -blank.clearance_mm)
    if blank.clearance_mm > 0.0:
        disc = areas.moved_inwards(disc, blank.clearance_mm, tolerance_mm, CLEARANCE_KEY)
    return planned_within(disc, disc, blank, direction_rad, module_mm, tolerance_mm, key)


def planned_within(
    disc: Polygon, room: Polygon, blank: Blank, direction_rad: float, module_mm: float, tolerance_mm: float, key: str
) -> BodyPlan:
    """The body on a disc; its cuts must fit into the room that all sections of the gear share."""
    bore = blank.bore.widened(blank.clearance_mm) if blank.bore else None
    hub_mm = blank.hub.diameter_mm if blank.hub else 0.0
    if blank.bore is not None:
        require_room(room, blank.bore, INNER_WALL_IN_MODULES * module_mm, tolerance_mm, key, blank.clearance_mm)
    if blank.hub is not None:
        require_hub_room(room, blank.hub, key)
    for name, about_axis_mm in (("hub.diameter_mm", hub_mm), ("web.hub_mm", blank.web.hub_mm if blank.web else 0.0)):
        if bore is not None and about_axis_mm:
            require_wall_around_bore(bore, about_axis_mm, INNER_WALL_IN_MODULES * module_mm, f"{key}.{name}")
    slot, pin_mm = _slot(room, blank, around_axis(bore, hub_mm, module_mm), direction_rad, module_mm, key)
    cuts = [slot_points(slot, tolerance_mm)] if slot else []
    crank_pin = _crank_pin(room, blank, [around_axis(bore, hub_mm, module_mm), *map(Polygon, cuts)], module_mm, key)
    cuts += [hole_points(crank_pin, tolerance_mm)] if crank_pin else []
    beside = shapely.union_all([Polygon(cut) for cut in cuts]) if cuts else None
    mark = index_hole(room, bore, direction_rad, module_mm, hub_mm, beside) if blank.index_hole else None
    cuts += [hole_points(mark, tolerance_mm)] if mark else []
    web = web_of(room, cuts, blank.web, module_mm, tolerance_mm, key) if blank.web else None
    plan = BodyPlan(
        disc,
        blank.face_width_mm,
        tolerance_mm,
        bore,
        mark,
        (),
        blank.hub,
        web,
        blank.chamfer_mm,
        blank.clearance_mm,
        slot,
        pin_mm,
        crank_pin,
    )
    if blank.holes is None:
        return plan
    return replace(plan, lightening_holes=lightening_holes(_free(plan, room), blank.holes, tolerance_mm, key))


def _slot(
    room: Polygon, blank: Blank, axis: BaseGeometry, direction_rad: float, module_mm: float, key: str
) -> tuple[ArcSlot | None, tuple[float, float] | None]:
    """The slot of the end stop, away from the mate, and its pin's centre; both None where no end stop is asked for."""
    stop = blank.end_stop
    if stop is None:
        return None, None
    middle = direction_rad + pi
    wide = replace(stop, clearance_mm=stop.clearance_mm + 2.0 * blank.clearance_mm)
    require_slot_room(room, wide, axis, middle, INNER_WALL_IN_MODULES * module_mm, key)
    pin = stop.pin_rad(middle)
    place = stop.radius_mm * cos(pin), stop.radius_mm * sin(pin)
    return stop.slot(middle).widened(blank.clearance_mm), place


def _crank_pin(
    room: Polygon, blank: Blank, others: Sequence[BaseGeometry], module_mm: float, key: str
) -> RoundHole | None:
    """The hole of the crank pin, widened for the process; None where none is asked for."""
    asked = blank.crank_pin
    if asked is None:
        return None
    wall_mm = INNER_WALL_IN_MODULES * module_mm
    require_crank_pin_room(room, asked, shapely.union_all(others), wall_mm, blank.clearance_mm, key)
    return replace(asked, diameter_mm=asked.diameter_mm + 2.0 * blank.clearance_mm)


def _free(plan: BodyPlan, room: Polygon) -> BaseGeometry:
    """Where holes may be: in the pockets or, without a web, anywhere beside bore, hub and index hole."""
    if plan.web is not None:
        return shapely.union_all(plan.web.pockets)
    cut = replace(plan, disc=room).section
    if plan.hub is None:
        return cut
    return cut.difference(Polygon(circle_points(plan.hub.diameter_mm / 2.0, plan.chord_tolerance_mm)))


def _with_kerf(plan: BodyPlan, half_mm: float) -> BodyPlan:
    """The body with all cuts except pockets moved out by half a kerf; raises TooThick for too thick a cutter."""
    openings = [(width, name) for name, width in _widths_cut(plan)]
    if openings and min(openings)[0] <= 2.0 * half_mm:
        width, name = min(openings)
        largest, right = width / 2.0, f"over {-width / 2.0:g} mm is right"
        try:
            areas.moved_outwards(plan.disc, largest, plan.chord_tolerance_mm, CLEARANCE_KEY)
        except areas.TooThick as narrower:
            largest = narrower.largest_mm
            right = f"{-areas.floored(largest):.10g} mm is the most" if largest > 0.0 else "no kerf is right"
        raise areas.TooThick(
            f"a kerf of {2.0 * half_mm:g} mm does not go into {name} of {width:g} mm; {right}",
            key=CLEARANCE_KEY,
            largest_mm=largest,
        )
    return replace(
        plan,
        disc=areas.moved_outwards(plan.disc, half_mm, plan.chord_tolerance_mm, CLEARANCE_KEY),
        bore=plan.bore.widened(-half_mm) if plan.bore else None,
        index_hole=_narrowed(plan.index_hole, half_mm) if plan.index_hole else None,
        lightening_holes=tuple(_narrowed(hole, half_mm) for hole in plan.lightening_holes),
        slot=plan.slot.widened(-half_mm) if plan.slot else None,
        crank_pin=_narrowed(plan.crank_pin, half_mm) if plan.crank_pin else None,
        clearance_mm=-half_mm,
    )


def _widths_cut(plan: BodyPlan) -> list[tuple[str, float]]:
    """The names and widths in mm of all openings that a cutter must enter, except the spaces of the teeth."""
    bore, hole = plan.bore, plan.index_hole
    openings = [("a bore", bore.diameter_mm)] if bore else []
    openings += [("a keyway", bore.keyway.width_mm)] if bore and bore.keyway else []
    openings += [("an index hole", hole.diameter_mm)] if hole else []
    openings += [("a slot", plan.slot.width_mm)] if plan.slot else []
    openings += [("the crank pin's hole", plan.crank_pin.diameter_mm)] if plan.crank_pin else []
    return openings + [("lightening holes", hole.diameter_mm) for hole in plan.lightening_holes[:1]]


def _narrowed(hole: RoundHole, half_mm: float) -> RoundHole:
    return replace(hole, diameter_mm=hole.diameter_mm - 2.0 * half_mm)


def planned_ring(outline_mm: Array, blank: RingBlank, module_mm: float, tolerance_mm: float) -> BodyPlan:
    """The body of an internal gear: a ring between its tooth outline, shape (n, 2), and a circle about its axis.

    Raises NoSuchMechanism where the outline crosses itself, WrongInput where the clearance takes teeth off.
    """
    clearance = max(blank.clearance_mm, 0.0)
    # The clearance is taken off the teeth only: a ring thicker by the clearance keeps its circle.
    disc = ring_section(outline_mm, blank.rim_mm + clearance, tolerance_mm)
    if clearance > 0.0:
        disc = areas.moved_inwards(disc, clearance, tolerance_mm, CLEARANCE_KEY)
    direction = meeting_direction_rad(Gear.DRIVEN, Mesh.INTERNAL)
    plan = BodyPlan(
        disc,
        blank.face_width_mm,
        tolerance_mm,
        index_hole=rim_hole(disc, direction, module_mm) if blank.index_hole else None,
        chamfer_mm=blank.chamfer_mm,
        clearance_mm=clearance,
    )
    return _with_kerf(plan, -blank.clearance_mm) if blank.clearance_mm < 0.0 else plan


def ring_section(outline_mm: Array, rim_mm: float, tolerance_mm: float) -> Polygon:
    """The ring's section in mm: a circle less the outline; the circle's polygon is inside it, within the tolerance."""
    hole = full_disc(outline_mm, RING_KEY)
    return Polygon(circle_points(outer_radius_mm(outline_mm, rim_mm), tolerance_mm), [hole.exterior])


def outer_radius_mm(outline_mm: Array, rim_mm: float) -> float:
    """Radius of the circle that leaves the rim outside all roots; rings are turned and clamped by circles."""
    return float(np.hypot(outline_mm[:, 0], outline_mm[:, 1]).max()) + rim_mm


def walls_mm(gear: ToothedGear, plan: BodyPlan) -> Array:
    """The least wall in mm under both roots of each tooth, shape (z,); infinite where the body has no other edge.

    Edges are the bore with its keyway, holes, slots and the sides of pockets, and for a ring its rim.  A hole narrower
    than a pitch, such as the index hole, does not count as an edge: beside it the root stands on the body.
    """
    pitch_mm = pi * gear.flanks.rack.module_mm
    mark, pin = (
        hole if hole is not None and hole.diameter_mm >= pitch_mm else None
        for hole in (plan.index_hole, plan.crank_pin)
    )
    wide = tuple(hole for hole in plan.lightening_holes if hole.diameter_mm >= pitch_mm)
    section = replace(plan, lightening_holes=wide, index_hole=mark, crank_pin=pin).section
    edges = [section.exterior] if plan.is_ring else list(section.interiors)
    edges += [] if plan.web is None else [pocket.exterior for pocket in plan.web.pockets]
    flanks, curves = gear.flanks, exact_curves(gear.tips, gear.sides)
    found = np.full(flanks.count // 2, np.inf)
    if not edges:
        return found[: gear.teeth]
    every = shapely.union_all(edges)
    shapely.prepare(every)
    for kind in (FILLET_CURVE, ROOT_LAND):
        curve = curves[kind]
        rows = np.arange(curve.owner.size)
        points = curve.at(rows[:, None], PROBES)[0]
        least = shapely.distance(every, shapely.points(points)).min(axis=1)
        # A root belongs to the tooth of its flank, and a land to the teeth on both of its sides.
        np.minimum.at(found, curve.owner // 2 % found.size, least)
        if kind == ROOT_LAND:
            np.minimum.at(found, (curve.owner // 2 + 1) % found.size, least)
    return found[: gear.teeth]
