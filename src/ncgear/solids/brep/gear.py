"""Gears as solids whose every flank, fillet and land is one face.

Straight teeth are a prism over the exact outline.  Helical and herringbone teeth are sewn from B-spline surfaces and
two plane ends.  Each tool sweeps a solid; pockets, bore and set-screw hole are cut with these solids.
"""

from __future__ import annotations

from math import cos, sin

import numpy as np
import shapely
from OCP.BRepBuilderAPI import BRepBuilderAPI_MakeFace, BRepBuilderAPI_MakeSolid, BRepBuilderAPI_Sewing
from OCP.BRepLib import BRepLib
from OCP.collections import Array2_gp_Pnt
from OCP.Geom import Geom_BSplineSurface
from OCP.gp import gp_Dir, gp_Pln, gp_Pnt
from OCP.TopAbs import TopAbs_SHELL
from OCP.TopoDS import TopoDS, TopoDS_Face, TopoDS_Shape, TopoDS_Wire
from shapely import LinearRing

from ncgear.errors import Unanswered
from ncgear.numerics.arrays import Array
from ncgear.solids.brep.shapes import (
    bore_wire,
    circle_wire,
    cut,
    cylinder,
    fused,
    knots_of,
    parts_of,
    prism,
    slot_wire,
    sound,
    wire_of,
)
from ncgear.solids.helical.patches import Patches
from ncgear.solids.plan.body import BodyPlan
from ncgear.teeth.contour import DEGREE, Contour, Spline, ring_of_arcs

AT_CORNERS = 8.0 / 17.0
"""Share of the chord tolerance to which pocket walls pass the polygon's corners; then they keep the whole tolerance
everywhere."""

SHORT_OF_HUB = 4.0
"""Gap, in chord tolerances, up to which a pocket's circle is the hub's: pockets stop three tolerances short of a
hub."""

BEYOND = 0.1
"""How far tools go beyond the material that they cut, as a share of the face width, so that no two faces coincide."""

SAME_MM = 1e-7
"""Distance at which the kernel takes two points as one, at any size of the model (its confusion)."""

SEWN_MM = 10.0 * SAME_MM
"""Distance at which edges are sewn: both have the same poles, but the kernel's own points stray by 1e-7 mm."""


def gear_shape(contour: Contour, plan: BodyPlan) -> TopoDS_Shape:
    """A gear without chamfer and clearance from z = 0 up; raises Unanswered unless it is one valid solid."""
    outer, holes = wire_of(contour.curves), _holes(plan)
    if plan.hub is not None or plan.web is not None:
        return sound(_cut_and_bored(prism(outer, holes, 0.0, plan.face_width_mm), plan))
    bore = [] if plan.bore is None else [bore_wire(plan.bore)]
    return prism(outer, [*holes, *bore], 0.0, plan.face_width_mm)


def helical_gear_shape(patches: Patches, plan: BodyPlan, *, herringbone: bool) -> TopoDS_Shape:
    """A gear with helical teeth, made and refused as in ``gear_shape``."""
    beyond = BEYOND * plan.face_width_mm
    drills = [prism(hole, [], -beyond, plan.face_width_mm + beyond) for hole in _holes(plan)]
    return sound(_cut_and_bored(cut(_helical_shape(patches, herringbone=herringbone), drills), plan))


def ring_shape(contour: Contour, plan: BodyPlan, radius_mm: float) -> TopoDS_Shape:
    """A ring between its tooth outline and a cylinder about its axis; raises as ``gear_shape``."""
    holes = [wire_of(contour.curves), *_holes(plan)]
    return prism(circle_wire(0.0, 0.0, radius_mm), holes, 0.0, plan.face_width_mm)


def _holes(plan: BodyPlan) -> list[TopoDS_Wire]:
    slot = [slot_wire(plan.slot)] if plan.slot else []
    return slot + [circle_wire(hole.x_mm, hole.y_mm, hole.diameter_mm / 2.0) for hole in plan.round_holes]


def _cut_and_bored(shape: TopoDS_Shape, plan: BodyPlan) -> TopoDS_Shape:
    """The toothed shape with pockets cut first, so that a hub stands on them, and the bore cut last, as one face."""
    shape = cut(shape, _pocket_tools(plan))
    if plan.hub is not None:
        circle = circle_wire(0.0, 0.0, plan.hub.diameter_mm / 2.0)
        shape = fused(shape, prism(circle, [], plan.face_width_mm, plan.height_mm))
    beyond = BEYOND * plan.face_width_mm
    bore = [] if plan.bore is None else [prism(bore_wire(plan.bore), [], -beyond, plan.height_mm + beyond)]
    return cut(shape, [*bore, *_screw_drill(plan)])


def _pocket_tools(plan: BodyPlan) -> list[TopoDS_Shape]:
    """The pockets of a web, with walls of lines and arcs; none where there is no web."""
    if plan.web is None:
        return []
    tools = []
    for pocket in plan.web.pockets:
        outer, *inner = (_round(ring, plan) for ring in (pocket.exterior, *pocket.interiors))
        tools.append(prism(outer, inner, plan.web.thickness_mm, (1.0 + BEYOND) * plan.face_width_mm))
    return tools


def _round(ring: LinearRing, plan: BodyPlan) -> TopoDS_Wire:
    """A polygon's ring as a circle about the axis, or else as lines and arcs, within the chord tolerance."""
    corners, within = shapely.get_coordinates(ring)[:-1], AT_CORNERS * plan.chord_tolerance_mm
    radii = np.hypot(corners[:, 0], corners[:, 1])
    middle = float(radii.max() + radii.min()) / 2.0
    if radii.max() - middle > within:
        return wire_of(ring_of_arcs(corners, within))
    hub = plan.hub.diameter_mm / 2.0 if plan.hub else 0.0
    # The hub's side goes on down to the web, without a ledge of a few micrometres.
    return circle_wire(0.0, 0.0, hub if abs(middle - hub) <= SHORT_OF_HUB * plan.chord_tolerance_mm else middle)


def _screw_drill(plan: BodyPlan) -> list[TopoDS_Shape]:
    """The drill of a hub's set screw, from the axis to beyond the hub, if there is one."""
    if plan.hub is None or plan.hub.set_screw is None:
        return []
    screw = plan.hub.set_screw
    start = np.array([0.0, 0.0, screw.height_mm])
    direction = np.array([cos(screw.direction_rad), sin(screw.direction_rad), 0.0])
    return [cylinder(start, direction, screw.diameter_mm / 2.0, (0.5 + BEYOND) * plan.hub.diameter_mm)]


def _helical_shape(patches: Patches, *, herringbone: bool) -> TopoDS_Shape:
    """The toothed solid alone, from z = 0 up; raises Unanswered where the surfaces do not close."""
    halves = [patches.poles_mm]
    if herringbone:
        top = float(patches.poles_mm[..., 2].max())
        halves.append(patches.poles_mm[:, :, ::-1] * [1.0, 1.0, -1.0] + [0.0, 0.0, 2.0 * top])
    ends = _end(patches, halves[0][:, :, 0]), _end(patches, halves[-1][:, :, -1])
    sides = [_side(patches, poles) for half in halves for poles in half]
    return _sewn([*sides, *ends])


def _side(patches: Patches, poles: Array) -> TopoDS_Face:
    grid = Array2_gp_Pnt(1, poles.shape[0], 1, poles.shape[1])
    for (row, column), _ in np.ndenumerate(poles[..., 0]):
        grid.SetValue(row + 1, column + 1, gp_Pnt(*poles[row, column].tolist()))
    (along, along_times), (up, up_times) = knots_of(patches.along), knots_of(patches.up)
    surface = Geom_BSplineSurface(grid, along, up, along_times, up_times, DEGREE, DEGREE)
    return BRepBuilderAPI_MakeFace(surface, SAME_MM).Face()


def _end(patches: Patches, poles: Array) -> TopoDS_Face:
    """The plane face within curves whose poles (patches, n along, 3) are all at one height."""
    height = float(poles[0, 0, 2])
    wire = wire_of([Spline(patches.along, one[:, :2]) for one in poles], height)
    return BRepBuilderAPI_MakeFace(gp_Pln(gp_Pnt(0.0, 0.0, height), gp_Dir(0.0, 0.0, 1.0)), wire, True).Face()


def _sewn(faces: list[TopoDS_Face]) -> TopoDS_Shape:
    """The solid that the faces enclose; raises Unanswered where they do not close."""
    sewing = BRepBuilderAPI_Sewing(SEWN_MM)
    for face in faces:
        sewing.Add(face)
    sewing.Perform()
    shells = parts_of(sewing.SewedShape(), TopAbs_SHELL)
    if len(shells) != 1 or sewing.NbFreeEdges():
        raise Unanswered(f"the surfaces of helical teeth do not close: {sewing.NbFreeEdges()} free edges")
    solid = BRepBuilderAPI_MakeSolid(TopoDS.Shell(shells[0])).Solid()
    BRepLib.OrientClosedSolid_s(solid)
    return solid
