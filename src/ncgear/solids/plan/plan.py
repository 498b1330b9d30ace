"""The plan of a gear's body: what is asked of it, with the places at which there is room for it."""

from __future__ import annotations

from dataclasses import replace

import shapely
from shapely import Polygon
from shapely.geometry.base import BaseGeometry

from ncgear.numerics.arrays import Array
from ncgear.solids.plan.body import Blank, BodyPlan, circle_points
from ncgear.solids.plan.parallel import moved_inwards
from ncgear.solids.plan.pockets import lightening_holes, web_of
from ncgear.solids.plan.room import full_disc, index_hole, require_hub_room, require_room

CLEARANCE_KEY = "gears.process_clearance_mm"


def planned(
    outline_mm: Array, blank: Blank, direction_rad: float, module_mm: float, tolerance_mm: float, key: str
) -> BodyPlan:
    """The body of a gear with straight teeth, from its outline as designed, shape (n, 2).

    ``direction_rad`` is where the index hole goes; ``key`` (``gears.driving``) names the gear in errors.  Raises
    NoSuchMechanism where the outline crosses itself, WrongInput where something asked for has no room.
    """
    disc = full_disc(outline_mm, key)
    if blank.clearance_mm > 0.0:
        disc = moved_inwards(disc, blank.clearance_mm, tolerance_mm, CLEARANCE_KEY)
    return planned_within(disc, disc, blank, direction_rad, module_mm, tolerance_mm, key)


def planned_within(
    disc: Polygon, room: Polygon, blank: Blank, direction_rad: float, module_mm: float, tolerance_mm: float, key: str
) -> BodyPlan:
    """The body on a disc, for whose cuts there is the room that all sections of the gear have in common."""
    if blank.bore is not None:
        require_room(room, blank.bore, tolerance_mm, key, blank.clearance_mm)
    if blank.hub is not None:
        require_hub_room(room, blank.hub, key)
    bore = blank.bore.widened(blank.clearance_mm) if blank.bore else None
    hub_mm = blank.hub.diameter_mm if blank.hub else 0.0
    mark = index_hole(room, bore, direction_rad, module_mm, hub_mm) if blank.index_hole else None
    web = web_of(room, mark, blank.web, module_mm, tolerance_mm, key) if blank.web else None
    plan = BodyPlan(
        disc, blank.face_width_mm, tolerance_mm, bore, mark, (), blank.hub, web, blank.chamfer_mm, blank.clearance_mm
    )
    if blank.holes is None:
        return plan
    return replace(plan, lightening_holes=lightening_holes(_free(plan, room), blank.holes, tolerance_mm, key))


def _free(plan: BodyPlan, room: Polygon) -> BaseGeometry:
    """Where holes may be: in the pockets or, without web, anywhere beside bore, hub and index hole."""
    if plan.web is not None:
        return shapely.union_all(plan.web.pockets)
    cut = replace(plan, disc=room).section
    if plan.hub is None:
        return cut
    return cut.difference(Polygon(circle_points(plan.hub.diameter_mm / 2.0, plan.chord_tolerance_mm)))
