"""The proof, by reading it back, that a written STEP file still holds its solids."""

from __future__ import annotations

from collections.abc import Sequence
from io import BytesIO

from OCP.BRepCheck import BRepCheck_Analyzer
from OCP.IFSelect import IFSelect_ReturnStatus
from OCP.STEPControl import STEPControl_Reader
from OCP.TopoDS import TopoDS_Shape

from ncgear.solids.brep.parts import faces_of, solids_of, volume_mm3

VOLUME_TOLERANCE = 2e-5
"""Relative difference allowed between a solid and the same one read back: the kernel's integrals are no better, since
it finds the edges of faces anew (tests/test_step.py holds them against sections); faces are counted."""


def require_same(data: bytes, shapes: Sequence[TopoDS_Shape]) -> None:
    """Raise RuntimeError, a fault of ncgear, unless a file holds valid solids with faces and volumes of ``shapes``."""
    whole = _read(data)
    if not BRepCheck_Analyzer(whole).IsValid():
        raise RuntimeError("a STEP file holds solids that are not valid")
    for shape, found in zip(shapes, solids_of(whole), strict=True):
        _require_alike(shape, found)


def _read(data: bytes) -> TopoDS_Shape:
    reader = STEPControl_Reader()
    if reader.ReadStream("step", BytesIO(data)) != IFSelect_ReturnStatus.IFSelect_RetDone:
        raise RuntimeError("a STEP file cannot be read back")
    reader.TransferRoots()
    return reader.OneShape()


def _require_alike(shape: TopoDS_Shape, found: TopoDS_Shape) -> None:
    faces, faces_found = (len(faces_of(one)) for one in (shape, found))
    volume, volume_found = volume_mm3(shape), volume_mm3(found)
    if faces != faces_found or not abs(volume_found - volume) <= VOLUME_TOLERANCE * volume:
        raise RuntimeError(
            f"a STEP file holds {faces_found} faces about {volume_found:.9g} mm3, not {faces} about {volume:.9g} mm3"
        )
