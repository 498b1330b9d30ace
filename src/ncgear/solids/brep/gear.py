"""Gears as solids whose every flank, fillet and land is one face.

Straight teeth are a prism over the exact outline.  Helical and herringbone teeth are sewn from B-spline surfaces and
two plane ends.  Each tool sweeps a solid; pockets, bore and set-screw hole are cut with these solids.
"""

from __future__ import annotations

from collections.abc import Sequence
from math import asin, cos, sin

import numpy as np
import shapely
from OCP.BRepAlgoAPI import BRepAlgoAPI_BooleanOperation, BRepAlgoAPI_Cut, BRepAlgoAPI_Fuse
from OCP.BRepBuilderAPI import (
    BRepBuilderAPI_MakeEdge,
    BRepBuilderAPI_MakeFace,
    BRepBuilderAPI_MakeSolid,
    BRepBuilderAPI_MakeVertex,
    BRepBuilderAPI_MakeWire,
    BRepBuilderAPI_Sewing,
)
from OCP.BRepCheck import BRepCheck_Analyzer
from OCP.BRepGProp import BRepGProp
from OCP.BRepLib import BRepLib
from OCP.BRepPrimAPI import BRepPrimAPI_MakeCylinder, BRepPrimAPI_MakePrism
from OCP.collections import Array1_double, Array1_gp_Pnt, Array1_int, Array2_gp_Pnt
from OCP.GC import GC_MakeArcOfCircle, GC_MakeSegment
from OCP.Geom import Geom_BSplineCurve, Geom_BSplineSurface, Geom_Curve
from OCP.gp import gp_Ax2, gp_Circ, gp_Dir, gp_Pln, gp_Pnt, gp_Trsf, gp_Vec
from OCP.GProp import GProp_GProps
from OCP.ShapeFix import ShapeFix_Face
from OCP.ShapeUpgrade import ShapeUpgrade_UnifySameDomain
from OCP.TopAbs import TopAbs_FACE, TopAbs_ShapeEnum, TopAbs_SHELL, TopAbs_SOLID
from OCP.TopExp import TopExp_Explorer
from OCP.TopLoc import TopLoc_Location
from OCP.TopoDS import TopoDS, TopoDS_Face, TopoDS_Shape, TopoDS_Wire
from shapely import LinearRing

from ncgear.errors import Unanswered
from ncgear.numerics.arrays import Array
from ncgear.numerics.plane import bow_middles
from ncgear.solids.helical.patches import Patches
from ncgear.solids.plan.body import ArcSlot, BodyPlan, Bore
from ncgear.teeth.contour import DEGREE, Arc, Contour, Curve, Line, Spline, ring_of_arcs

UP = gp_Dir(0.0, 0.0, 1.0)


def wire_of(curves: Sequence[Curve], height_mm: float = 0.0) -> TopoDS_Wire:
    """A closed wire of curves that share vertices; raises Unanswered where the kernel finds them apart."""
    vertices = [BRepBuilderAPI_MakeVertex(_point(curve.start, height_mm)).Vertex() for curve in curves]
    maker = BRepBuilderAPI_MakeWire()
    for curve, start, end in zip(curves, vertices, [*vertices[1:], vertices[0]], strict=True):
        geometry = geometry_of(curve, height_mm)
        edge = BRepBuilderAPI_MakeEdge(geometry, start, end, geometry.FirstParameter(), geometry.LastParameter())
        maker.Add(edge.Edge())
        if not maker.IsDone():
            raise Unanswered(f"a curve that begins at {curve.start.tolist()} mm does not close an outline")
    return maker.Wire()


def geometry_of(curve: Curve, height: float) -> Geom_Curve:
    """The kernel's curve, level at a height in mm."""
    match curve:
        case Line():
            return GC_MakeSegment(_point(curve.start, height), _point(curve.end, height)).Value()
        case Arc():
            return GC_MakeArcOfCircle(*(_point(at, height) for at in (curve.start, curve.middle, curve.end))).Value()
        case Spline():
            poles = Array1_gp_Pnt(1, len(curve.poles_mm))
            for number, pole in enumerate(curve.poles_mm, 1):
                poles.SetValue(number, _point(pole, height))
            return Geom_BSplineCurve(poles, *knots_of(curve.knots), DEGREE)


def knots_of(knots: Array) -> tuple[Array1_double, Array1_int]:
    """Distinct knots and the multiplicity of each, from knots of shape (n,)."""
    distinct, times = np.unique(knots, return_counts=True)
    values, multiplicities = Array1_double(1, distinct.size), Array1_int(1, distinct.size)
    for number, (knot, count) in enumerate(zip(distinct, times, strict=True), 1):
        values.SetValue(number, float(knot))
        multiplicities.SetValue(number, int(count))
    return values, multiplicities


def _point(at: Array, height: float) -> gp_Pnt:
    return gp_Pnt(float(at[0]), float(at[1]), height)


def circle_wire(x_mm: float, y_mm: float, radius_mm: float) -> TopoDS_Wire:
    """A whole circle as one edge."""
    circle = gp_Circ(gp_Ax2(gp_Pnt(x_mm, y_mm, 0.0), UP), radius_mm)
    return BRepBuilderAPI_MakeWire(BRepBuilderAPI_MakeEdge(circle).Edge()).Wire()


def bore_wire(bore: Bore) -> TopoDS_Wire:
    """The bore's circle, or its arc and the three sides of the keyway."""
    radius = bore.diameter_mm / 2.0
    if bore.keyway is None:
        return circle_wire(0.0, 0.0, radius)
    half, reach = bore.keyway.width_mm / 2.0, bore.reach_mm
    begin = asin(half / radius)
    upper, lower = radius * np.array([[cos(begin), sin(begin)], [cos(begin), -sin(begin)]])
    floor = np.array([[reach, -half], [reach, half]])
    arc = Arc(upper, np.array([-radius, 0.0]), lower)
    return wire_of([arc, Line(lower, floor[0]), Line(*floor), Line(floor[1], upper)])


def slot_wire(slot: ArcSlot) -> TopoDS_Wire:
    """The six arcs of a slot."""
    start = slot.points
    arcs = zip(start, bow_middles(start, slot.bulges), np.roll(start, -1, axis=0), strict=True)
    return wire_of([Arc(*three) for three in arcs])


def prism(outer: TopoDS_Wire, holes: Sequence[TopoDS_Wire], low_mm: float, high_mm: float) -> TopoDS_Shape:
    """The solid between an outer wire and holes in z = 0, between heights; raises Unanswered where wires cross."""
    maker = BRepBuilderAPI_MakeFace(gp_Pln(), outer, True)
    for hole in holes:
        maker.Add(hole)
    fix = ShapeFix_Face(maker.Face())
    fix.FixOrientation()
    made = BRepPrimAPI_MakePrism(sound(fix.Face()), gp_Vec(0.0, 0.0, high_mm - low_mm)).Shape()
    return made if low_mm == 0.0 else made.Moved(moved_by(gp_Vec(0.0, 0.0, low_mm)))


def sound(shape: TopoDS_Shape) -> TopoDS_Shape:
    """The shape; raises Unanswered unless the kernel finds it valid."""
    if not BRepCheck_Analyzer(shape).IsValid():
        raise Unanswered("a gear's solid is not valid")
    return shape


def moved_by(step: gp_Vec) -> TopLoc_Location:
    """The location of a shape that is moved without turning."""
    move = gp_Trsf()
    move.SetTranslation(step)
    return TopLoc_Location(move)


def cylinder(start_mm: Array, direction: Array, radius_mm: float, length_mm: float) -> TopoDS_Shape:
    """The cylinder from a point of shape (3,) along a direction."""
    axis = gp_Ax2(gp_Pnt(*start_mm.tolist()), gp_Dir(*direction.tolist()))
    return BRepPrimAPI_MakeCylinder(axis, radius_mm, length_mm).Shape()


def fused(first: TopoDS_Shape, second: TopoDS_Shape) -> TopoDS_Shape:
    """Two solids that touch, as one; faces that go on from one to the other become one."""
    whole = ShapeUpgrade_UnifySameDomain(_one(BRepAlgoAPI_Fuse(first, second)), False, True, False)
    whole.Build()
    return whole.Shape()


def cut(shape: TopoDS_Shape, tools: Sequence[TopoDS_Shape]) -> TopoDS_Shape:
    """The solid that remains when tools are cut off it."""
    for tool in tools:
        shape = _one(BRepAlgoAPI_Cut(shape, tool))
    return shape


def _one(done: BRepAlgoAPI_BooleanOperation) -> TopoDS_Shape:
    """The solid that an operation leaves; raises Unanswered unless there is exactly one."""
    solids = solids_of(done.Shape()) if done.IsDone() else []
    if len(solids) != 1:
        raise Unanswered(f"a gear's body falls into {len(solids)} solids")
    return solids[0]


def solids_of(shape: TopoDS_Shape) -> list[TopoDS_Shape]:
    """The solids of a shape, in their order."""
    return parts_of(shape, TopAbs_SOLID)


def faces_of(shape: TopoDS_Shape) -> list[TopoDS_Shape]:
    """The faces of a shape, in their order."""
    return parts_of(shape, TopAbs_FACE)


def parts_of(shape: TopoDS_Shape, kind: TopAbs_ShapeEnum) -> list[TopoDS_Shape]:
    """The parts of one kind of a shape, in their order."""
    explorer, found = TopExp_Explorer(shape, kind), []
    while explorer.More():
        found.append(explorer.Current())
        explorer.Next()
    return found


def volume_mm3(shape: TopoDS_Shape) -> float:
    """The volume that a solid's faces enclose, to about five digits."""
    properties = GProp_GProps()
    BRepGProp.VolumeProperties_s(shape, properties)
    return float(properties.Mass())


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
    wire = wire_of([Spline(patches.along, pole[:, :2]) for pole in poles], height)
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
