"""Prisms: a plane section between wires, extruded along z; and cylinders along any axis."""

from __future__ import annotations

from collections.abc import Sequence

from OCP.BRepBuilderAPI import BRepBuilderAPI_MakeFace
from OCP.BRepPrimAPI import BRepPrimAPI_MakeCylinder, BRepPrimAPI_MakePrism
from OCP.gp import gp_Ax2, gp_Dir, gp_Pln, gp_Pnt, gp_Trsf, gp_Vec
from OCP.ShapeFix import ShapeFix_Face
from OCP.TopLoc import TopLoc_Location
from OCP.TopoDS import TopoDS_Face, TopoDS_Shape, TopoDS_Wire

from ncgear.numerics.arrays import Array


def prism(outer: TopoDS_Wire, holes: Sequence[TopoDS_Wire], low_mm: float, high_mm: float) -> TopoDS_Shape:
    """The solid between an outer wire and holes in z = 0, from a height to another."""
    made = BRepPrimAPI_MakePrism(_section(outer, holes), gp_Vec(0.0, 0.0, high_mm - low_mm)).Shape()
    return made if low_mm == 0.0 else made.Moved(_raised(low_mm))


def cylinder(start_mm: Array, direction: Array, radius_mm: float, length_mm: float) -> TopoDS_Shape:
    """The cylinder from a point of shape (3,) along a direction."""
    axis = gp_Ax2(gp_Pnt(*start_mm.tolist()), gp_Dir(*direction.tolist()))
    return BRepPrimAPI_MakeCylinder(axis, radius_mm, length_mm).Shape()


def _raised(height: float) -> TopLoc_Location:
    move = gp_Trsf()
    move.SetTranslation(gp_Vec(0.0, 0.0, height))
    return TopLoc_Location(move)


def _section(outer: TopoDS_Wire, holes: Sequence[TopoDS_Wire]) -> TopoDS_Face:
    """The face between wires, whatever their senses."""
    maker = BRepBuilderAPI_MakeFace(gp_Pln(), outer, True)
    for hole in holes:
        maker.Add(hole)
    fix = ShapeFix_Face(maker.Face())
    fix.FixOrientation()
    return fix.Face()
