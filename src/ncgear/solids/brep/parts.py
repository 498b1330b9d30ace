"""Solids and faces that a shape consists of, and what they measure."""

from __future__ import annotations

from OCP.BRepGProp import BRepGProp
from OCP.GProp import GProp_GProps
from OCP.TopAbs import TopAbs_FACE, TopAbs_ShapeEnum, TopAbs_SOLID
from OCP.TopExp import TopExp_Explorer
from OCP.TopoDS import TopoDS_Shape


def solids_of(shape: TopoDS_Shape) -> list[TopoDS_Shape]:
    """Its solids in their order."""
    return parts_of(shape, TopAbs_SOLID)


def faces_of(shape: TopoDS_Shape) -> list[TopoDS_Shape]:
    """Its faces in their order."""
    return parts_of(shape, TopAbs_FACE)


def volume_mm3(shape: TopoDS_Shape) -> float:
    """The volume that a solid's faces enclose, to about five digits."""
    properties = GProp_GProps()
    BRepGProp.VolumeProperties_s(shape, properties)
    return float(properties.Mass())


def parts_of(shape: TopoDS_Shape, kind: TopAbs_ShapeEnum) -> list[TopoDS_Shape]:
    """Its parts of a kind in their order."""
    explorer, found = TopExp_Explorer(shape, kind), []
    while explorer.More():
        found.append(explorer.Current())
        explorer.Next()
    return found
