"""Gears as solids whose every flank, fillet and land is one face."""

from __future__ import annotations

from OCP.BRepCheck import BRepCheck_Analyzer
from OCP.TopoDS import TopoDS_Shape, TopoDS_Wire

from ncgear.solids.body import BodyPlan
from ncgear.solids.brep.booleans import cut, fused
from ncgear.solids.brep.cuts import BEYOND_MM, bore_tool, pocket_tools, screw_drill
from ncgear.solids.brep.helical import helical_shape
from ncgear.solids.brep.prism import prism
from ncgear.solids.brep.wires import bore_wire, circle_wire, wire_of
from ncgear.solids.patches import Patches
from ncgear.teeth.contour import Contour


def gear_shape(contour: Contour, plan: BodyPlan) -> TopoDS_Shape:
    """A gear from z = 0 up to its upper face or its hub's, as its plan says, but for chamfer and clearance.

    Raises RuntimeError, a fault of ncgear, unless the kernel finds one valid solid.
    """
    outer, holes = wire_of(contour.curves), _round_holes(plan)
    if plan.hub is not None or plan.web is not None:
        return _sound(_cut_and_bored(prism(outer, holes, 0.0, plan.face_width_mm), plan))
    bore = [] if plan.bore is None else [bore_wire(plan.bore)]
    return _sound(prism(outer, [*holes, *bore], 0.0, plan.face_width_mm))


def helical_gear_shape(patches: Patches, plan: BodyPlan, *, herringbone: bool) -> TopoDS_Shape:
    """A gear with helical teeth, as ``gear_shape``."""
    drills = [prism(hole, [], -BEYOND_MM, plan.face_width_mm + BEYOND_MM) for hole in _round_holes(plan)]
    return _sound(_cut_and_bored(cut(helical_shape(patches, herringbone=herringbone), drills), plan))


def ring_shape(contour: Contour, plan: BodyPlan, radius_mm: float) -> TopoDS_Shape:
    """A ring between its tooth outline and a cylinder about its axis; raises as ``gear_shape``."""
    holes = [wire_of(contour.curves), *_round_holes(plan)]
    return _sound(prism(circle_wire(0.0, 0.0, radius_mm), holes, 0.0, plan.face_width_mm))


def _round_holes(plan: BodyPlan) -> list[TopoDS_Wire]:
    return [circle_wire(hole.x_mm, hole.y_mm, hole.diameter_mm / 2.0) for hole in plan.round_holes]


def _cut_and_bored(shape: TopoDS_Shape, plan: BodyPlan) -> TopoDS_Shape:
    """Pockets first, so that a hub stands on what they leave; the bore last, so that it is one face all the way up."""
    shape = cut(shape, pocket_tools(plan))
    if plan.hub is not None:
        circle = circle_wire(0.0, 0.0, plan.hub.diameter_mm / 2.0)
        shape = fused(shape, prism(circle, [], plan.face_width_mm, plan.height_mm))
    return cut(shape, [*bore_tool(plan), *screw_drill(plan)])


def _sound(shape: TopoDS_Shape) -> TopoDS_Shape:
    if not BRepCheck_Analyzer(shape).IsValid():
        raise RuntimeError("a gear's solid is not valid")
    return shape
