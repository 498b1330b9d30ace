"""The proof that a mesh is the closed solid it should be."""

from __future__ import annotations

from trimesh import Trimesh


def require_sound(mesh: Trimesh, volume_mm3: float, tolerance: float) -> None:
    """Raise RuntimeError unless a mesh is closed, evenly wound, and of the volume given to a relative tolerance."""
    if not mesh.is_watertight:
        raise RuntimeError("a gear's mesh is not watertight")
    if not mesh.is_winding_consistent:
        raise RuntimeError("a gear's mesh has facets that face the wrong way")
    if not abs(float(mesh.volume) - volume_mm3) <= tolerance * volume_mm3:
        raise RuntimeError(f"a gear's mesh holds {mesh.volume:.9g} mm3 instead of {volume_mm3:.9g} mm3")
