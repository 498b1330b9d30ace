"""Union and difference of meshes in double precision, by the manifold library."""

from __future__ import annotations

import manifold3d
import numpy as np
from trimesh import Trimesh

from ncgear.numerics.arrays import Array


def solid_of(mesh: Trimesh) -> manifold3d.Manifold:
    """A mesh for booleans, in double precision; raises RuntimeError where it is no closed solid."""
    solid = manifold3d.Manifold(manifold3d.Mesh64(np.asarray(mesh.vertices), np.asarray(mesh.faces, dtype=np.uint64)))
    if solid.status() != manifold3d.Error.NoError:
        raise RuntimeError(f"a gear's mesh is no solid: {solid.status()}")
    return solid


def mesh_of(solid: manifold3d.Manifold) -> Trimesh:
    """The mesh of a solid."""
    made = solid.to_mesh64()
    points: Array = np.asarray(made.vert_properties)[:, :3]
    return Trimesh(points, np.asarray(made.tri_verts).astype(np.int64))
