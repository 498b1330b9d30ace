"""Meshes of the program as meshes of trimesh, which judges them."""

from __future__ import annotations

from trimesh import Trimesh

from ncgear.solids.mesh.triangles import TriangleMesh


def as_trimesh(mesh: TriangleMesh) -> Trimesh:
    """The same vertices and triangles."""
    return Trimesh(mesh.vertices, mesh.faces, process=False)
