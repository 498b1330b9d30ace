"""Helical and herringbone gears as solids between B-spline surfaces and two plane ends."""

from __future__ import annotations

import numpy as np
from OCP.BRepBuilderAPI import BRepBuilderAPI_MakeFace, BRepBuilderAPI_MakeSolid, BRepBuilderAPI_Sewing
from OCP.BRepLib import BRepLib
from OCP.collections import Array2_gp_Pnt
from OCP.Geom import Geom_BSplineSurface
from OCP.gp import gp_Dir, gp_Pln, gp_Pnt
from OCP.TopAbs import TopAbs_SHELL
from OCP.TopoDS import TopoDS, TopoDS_Face, TopoDS_Shape

from ncgear.numerics.arrays import Array
from ncgear.solids.brep.parts import parts_of
from ncgear.solids.brep.wires import knots_of, wire_of
from ncgear.solids.patches import Patches
from ncgear.teeth.contour import SAME_MM, Spline
from ncgear.teeth.splines import DEGREE

SEWN_MM = 10.0 * SAME_MM
"""Distance at which edges are sewn: theirs are the same poles, and the kernel's own points stray by 1e-7 mm."""


def helical_shape(patches: Patches, *, herringbone: bool) -> TopoDS_Shape:
    """The toothed solid without anything cut into it, from z = 0 up.

    Raises RuntimeError, a fault of ncgear, where the surfaces do not close.
    """
    halves = [patches.poles_mm]
    if herringbone:
        halves.append(patches.poles_mm[:, :, ::-1] * [1.0, 1.0, -1.0] + [0.0, 0.0, 2.0 * _top(patches.poles_mm)])
    ends = _end(patches, halves[0][:, :, 0]), _end(patches, halves[-1][:, :, -1])
    sides = [_side(patches, poles) for half in halves for poles in half]
    return _sewn([*sides, *ends])


def _top(poles: Array) -> float:
    return float(poles[..., 2].max())


def _side(patches: Patches, poles: Array) -> TopoDS_Face:
    """The face through poles (n along, n up, 3)."""
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
    sewing = BRepBuilderAPI_Sewing(SEWN_MM)
    for face in faces:
        sewing.Add(face)
    sewing.Perform()
    shells = parts_of(sewing.SewedShape(), TopAbs_SHELL)
    if len(shells) != 1 or sewing.NbFreeEdges():
        raise RuntimeError(f"the surfaces of helical teeth do not close: {sewing.NbFreeEdges()} free edges")
    solid = BRepBuilderAPI_MakeSolid(TopoDS.Shell(shells[0])).Solid()
    BRepLib.OrientClosedSolid_s(solid)
    return solid
