"""What is cut off a gear's body: pockets, bore, set-screw hole, as the solids that tools sweep."""

from __future__ import annotations

from math import cos, sin

import numpy as np
import shapely
from OCP.TopoDS import TopoDS_Shape, TopoDS_Wire
from shapely import LinearRing, Polygon

from ncgear.solids.body import BodyPlan
from ncgear.solids.brep.prism import cylinder, prism
from ncgear.solids.brep.wires import bore_wire, circle_wire, wire_of
from ncgear.teeth.arcs import ring_of_arcs

AT_CORNERS = 8.0 / 17.0
"""Of the chord tolerance, within which walls of pockets pass the corners: they are then within it everywhere."""

SHORT_OF_HUB = 4.0
"""Chord tolerances: a pocket that goes round a hub stops three short of it, for its chords' sake."""

BEYOND_MM = 1.0
"""How far tools go on beyond what they cut, so that no two faces lie in each other."""


def pocket_tools(plan: BodyPlan) -> list[TopoDS_Shape]:
    """The pockets of a web, with walls of lines and arcs; none where there is no web."""
    return [] if plan.web is None else [_pocket(pocket, plan.web.thickness_mm, plan) for pocket in plan.web.pockets]


def bore_tool(plan: BodyPlan) -> list[TopoDS_Shape]:
    """The bore with its keyway, if there is one."""
    if plan.bore is None:
        return []
    return [prism(bore_wire(plan.bore), [], -BEYOND_MM, plan.height_mm + BEYOND_MM)]


def screw_drill(plan: BodyPlan) -> list[TopoDS_Shape]:
    """The drill of a hub's set screw, from the axis to beyond the hub, if there is one."""
    if plan.hub is None or plan.hub.set_screw is None:
        return []
    screw = plan.hub.set_screw
    start = np.array([0.0, 0.0, screw.height_mm])
    direction = np.array([cos(screw.direction_rad), sin(screw.direction_rad), 0.0])
    return [cylinder(start, direction, screw.diameter_mm / 2.0, plan.hub.diameter_mm / 2.0 + BEYOND_MM)]


def _pocket(pocket: Polygon, low: float, plan: BodyPlan) -> TopoDS_Shape:
    outer, *inner = (_round(ring, plan) for ring in (pocket.exterior, *pocket.interiors))
    return prism(outer, inner, low, plan.face_width_mm + BEYOND_MM)


def _round(ring: LinearRing, plan: BodyPlan) -> TopoDS_Wire:
    """A polygon's ring as a circle about the axis, or else as lines and arcs, within the chord tolerance."""
    corners, within = shapely.get_coordinates(ring)[:-1], AT_CORNERS * plan.chord_tolerance_mm
    radii = np.hypot(corners[:, 0], corners[:, 1])
    middle = float(radii.max() + radii.min()) / 2.0
    if radii.max() - middle > within:
        return wire_of(ring_of_arcs(corners, within))
    hub = plan.hub.diameter_mm / 2.0 if plan.hub else 0.0
    # The hub's own side goes on down to the web, without a ledge of a few micrometres.
    return circle_wire(0.0, 0.0, hub if abs(middle - hub) <= SHORT_OF_HUB * plan.chord_tolerance_mm else middle)
