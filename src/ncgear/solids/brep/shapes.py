"""Parts of gears with exact faces: closed wires, prisms and cylinders, and the solids that cuts leave.

Wires lie in the plane z = 0, or level at a height; prisms and cylinders are solids of the kernel.  A cut or a union
that does not leave exactly one solid is a fault.
"""

from __future__ import annotations

from collections.abc import Sequence
from math import asin, cos, sin

import numpy as np
from OCP.BRepAlgoAPI import BRepAlgoAPI_BooleanOperation, BRepAlgoAPI_Cut, BRepAlgoAPI_Fuse
from OCP.BRepBuilderAPI import (
    BRepBuilderAPI_MakeEdge,
    BRepBuilderAPI_MakeFace,
    BRepBuilderAPI_MakeVertex,
    BRepBuilderAPI_MakeWire,
)
from OCP.BRepCheck import BRepCheck_Analyzer
from OCP.BRepGProp import BRepGProp
from OCP.BRepPrimAPI import BRepPrimAPI_MakeCylinder, BRepPrimAPI_MakePrism
from OCP.collections import Array1_double, Array1_gp_Pnt, Array1_int
from OCP.GC import GC_MakeArcOfCircle, GC_MakeSegment
from OCP.Geom import Geom_BSplineCurve, Geom_Curve
from OCP.gp import gp_Ax2, gp_Circ, gp_Dir, gp_Pln, gp_Pnt, gp_Trsf, gp_Vec
from OCP.GProp import GProp_GProps
from OCP.ShapeFix import ShapeFix_Face
from OCP.ShapeUpgrade import ShapeUpgrade_UnifySameDomain
from OCP.TopAbs import TopAbs_FACE, TopAbs_ShapeEnum, TopAbs_SOLID
from OCP.TopExp import TopExp_Explorer
from OCP.TopLoc import TopLoc_Location
from OCP.TopoDS import TopoDS_Shape, TopoDS_Wire

from ncgear.errors import Unanswered
from ncgear.numerics.arrays import Array
from ncgear.numerics.plane import bow_middles
from ncgear.solids.plan.body import ArcSlot, Bore
from ncgear.teeth.contour import DEGREE, Arc, Curve, Line, Spline

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
