"""Binary STL and the proof, by reading it back, that the written file still holds the solid."""

from __future__ import annotations

from io import BytesIO

import numpy as np
import trimesh
from trimesh import Trimesh
from trimesh.exchange.stl import export_stl

from ncgear.solids.sound import require_sound

VOLUME_TOLERANCE = 1e-5
"""Relative volume that single precision may cost; a millionth is usual, a lost facet costs more than this."""

BOUNDS_TOLERANCE = 1e-6
"""Single precision of a coordinate, relative to the largest one: 2^-24, rounded up generously."""


def stl_bytes(mesh: Trimesh) -> bytes:
    """The mesh as binary STL, mm in single precision, read back and checked before it is handed out.

    Raises RuntimeError when what was written is not the same closed solid, a fault of ncgear.
    """
    data = export_stl(mesh)
    read_back(data, mesh)
    return data


def read_back(data: bytes, original: Trimesh) -> Trimesh:
    """The solid that an STL file holds, its vertices merged; raises RuntimeError unless it is closed and has the
    volume and the bounds of ``original`` to single precision."""
    mesh = trimesh.load_mesh(BytesIO(data), file_type="stl")
    require_sound(mesh, float(original.volume), VOLUME_TOLERANCE)
    allowed = BOUNDS_TOLERANCE * float(np.abs(original.bounds).max())
    if not np.allclose(mesh.bounds, original.bounds, rtol=0.0, atol=allowed):
        raise RuntimeError(f"a written solid spans {mesh.bounds.tolist()} instead of {original.bounds.tolist()} mm")
    return mesh
