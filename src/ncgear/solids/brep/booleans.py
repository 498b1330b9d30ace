"""What is left of a solid, or what two become, as one solid again."""

from __future__ import annotations

from collections.abc import Sequence

from OCP.BRepAlgoAPI import BRepAlgoAPI_BooleanOperation, BRepAlgoAPI_Cut, BRepAlgoAPI_Fuse
from OCP.ShapeUpgrade import ShapeUpgrade_UnifySameDomain
from OCP.TopoDS import TopoDS_Shape

from ncgear.solids.brep.parts import solids_of


def fused(first: TopoDS_Shape, second: TopoDS_Shape) -> TopoDS_Shape:
    """Two solids that touch, as one; faces that go on from one to the other become one."""
    whole = ShapeUpgrade_UnifySameDomain(_one(BRepAlgoAPI_Fuse(first, second)), False, True, False)
    whole.Build()
    return whole.Shape()


def cut(shape: TopoDS_Shape, tools: Sequence[TopoDS_Shape]) -> TopoDS_Shape:
    """A solid without what tools take off it."""
    for tool in tools:
        shape = _one(BRepAlgoAPI_Cut(shape, tool))
    return shape


def _one(done: BRepAlgoAPI_BooleanOperation) -> TopoDS_Shape:
    """The solid that an operation leaves; raises RuntimeError, a fault of ncgear, unless it is a single one."""
    solids = solids_of(done.Shape()) if done.IsDone() else []
    if len(solids) != 1:
        raise RuntimeError(f"a gear's body falls into {len(solids)} solids")
    return solids[0]
