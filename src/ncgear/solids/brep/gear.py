"""Gears with straight teeth as solids whose every flank, fillet and land is one face."""

from __future__ import annotations

from OCP.BRepCheck import BRepCheck_Analyzer
from OCP.TopoDS import TopoDS_Shape, TopoDS_Wire

from ncgear.solids.bore import Bore
from ncgear.solids.brep.prism import prism
from ncgear.solids.brep.wires import bore_wire, circle_wire, wire_of
from ncgear.solids.index_hole import IndexHole
from ncgear.teeth.contour import Contour


def gear_shape(contour: Contour, face_width_mm: float, bore: Bore | None, mark: IndexHole | None) -> TopoDS_Shape:
    """A gear from z = 0 up to its face width, with its bore and index hole.

    Raises RuntimeError, a fault of ncgear, unless the kernel finds the solid valid.
    """
    holes = [] if bore is None else [bore_wire(bore)]
    return _sound(prism(wire_of(contour.curves), [*holes, *_mark(mark)], face_width_mm))


def ring_shape(contour: Contour, face_width_mm: float, radius_mm: float, mark: IndexHole | None) -> TopoDS_Shape:
    """A ring between its tooth outline and a cylinder about its axis; raises as ``gear_shape``."""
    holes = [wire_of(contour.curves), *_mark(mark)]
    return _sound(prism(circle_wire(0.0, 0.0, radius_mm), holes, face_width_mm))


def _mark(mark: IndexHole | None) -> list[TopoDS_Wire]:
    return [] if mark is None else [circle_wire(mark.x_mm, mark.y_mm, mark.diameter_mm / 2.0)]


def _sound(shape: TopoDS_Shape) -> TopoDS_Shape:
    if not BRepCheck_Analyzer(shape).IsValid():
        raise RuntimeError("a gear's solid is not valid")
    return shape
