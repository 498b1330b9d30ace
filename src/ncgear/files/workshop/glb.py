"""GLB (binary glTF): the assembled pair at phi1 = 0, for viewers and web pages."""

from __future__ import annotations

from trimesh.exchange.gltf import export_glb

from ncgear.drawings.solid_pair import linear_light, solid_pair
from ncgear.project.drive import Drive


def glb_files(drive: Drive) -> dict[str, bytes]:
    """``pair.glb`` with the nodes ``driving`` and ``driven``."""
    # Without normals, viewers shade each triangle by itself, so that edges stay sharp.
    return {"pair.glb": export_glb(solid_pair(drive, linear_light), include_normals=False)}
