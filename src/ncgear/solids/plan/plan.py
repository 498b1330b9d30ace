"""The plan of a gear's body: its outline, the wishes for the body, and the places that have room for them."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import replace
from math import cos, pi, sin

import numpy as np
import shapely
from shapely import Polygon
from shapely.geometry.base import BaseGeometry

from ncgear.numerics.arrays import Array
from ncgear.pitch.shape import Gear, Mesh, meeting_direction_rad
from ncgear.solids.plan.areas import TooThick, floored, moved_inwards, moved_outwards
from ncgear.solids.plan.body import (
    ArcSlot,
    Blank,
    BodyPlan,
    RingBlank,
    RoundHole,
    circle_points,
    hole_points,
    slot_points,
)
from ncgear.solids.plan.pockets import lightening_holes, web_of
from ncgear.solids.plan.room import (
    INNER_WALL_IN_MODULES,
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
        disc = moved_inwards(disc, blank.clearance_mm, tolerance_mm, CLEARANCE_KEY)
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
            moved_outwards(plan.disc, largest, plan.chord_tolerance_mm, CLEARANCE_KEY)
        except TooThick as narrower:
            largest = narrower.largest_mm
            right = f"{-floored(largest):.10g} mm is the most" if largest > 0.0 else "no kerf is right"
        raise TooThick(
            f"a kerf of {2.0 * half_mm:g} mm does not go into {name} of {width:g} mm; {right}",
            key=CLEARANCE_KEY,
            largest_mm=largest,
        )
    return replace(
        plan,
        disc=moved_outwards(plan.disc, half_mm, plan.chord_tolerance_mm, CLEARANCE_KEY),
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
    return openings + [("lightening holes", one.diameter_mm) for one in plan.lightening_holes[:1]]


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
        disc = moved_inwards(disc, clearance, tolerance_mm, CLEARANCE_KEY)
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
