"""GLB (binary glTF): the assembled pair at phi1 = 0, for viewers and web pages."""

from __future__ import annotations

from ncgear.drawings.solid_pair import linear_light, pair_scene
from ncgear.project.drive import Drive


def glb_files(drive: Drive) -> dict[str, bytes]:
    """``pair.glb`` with the nodes ``driving`` and ``driven``."""
    return {"pair.glb": pair_scene(drive, linear_light).export(file_type="glb")}
