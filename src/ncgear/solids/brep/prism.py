"""Prisms: a plane section between wires, extruded along z."""

from __future__ import annotations

from collections.abc import Sequence

from OCP.BRepBuilderAPI import BRepBuilderAPI_MakeFace
from OCP.BRepPrimAPI import BRepPrimAPI_MakePrism
from OCP.gp import gp_Pln, gp_Vec
from OCP.ShapeFix import ShapeFix_Face
from OCP.TopoDS import TopoDS_Face, TopoDS_Shape, TopoDS_Wire


def prism(outer: TopoDS_Wire, holes: Sequence[TopoDS_Wire], height_mm: float) -> TopoDS_Shape:
    """The solid between an outer wire and holes in z = 0, from there up to a height."""
    return BRepPrimAPI_MakePrism(_section(outer, holes), gp_Vec(0.0, 0.0, height_mm)).Shape()


def _section(outer: TopoDS_Wire, holes: Sequence[TopoDS_Wire]) -> TopoDS_Face:
    """The face between wires, whatever their senses."""
    maker = BRepBuilderAPI_MakeFace(gp_Pln(), outer, True)
    for hole in holes:
        maker.Add(hole)
    fix = ShapeFix_Face(maker.Face())
    fix.FixOrientation()
    return fix.Face()
