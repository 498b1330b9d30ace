"""GLB (binary glTF): the assembled pair at phi1 = 0, for viewers and web pages.

The format's unit is the metre, and its y axis points up: millimetres are scaled, and the gears' axes stand along y.
"""

from __future__ import annotations

import numpy as np
from trimesh import Scene, Trimesh
from trimesh.exchange.gltf import export_glb
from trimesh.visual import TextureVisuals
from trimesh.visual.material import PBRMaterial

from ncgear.drawings.plots.canvas import DRIVEN, DRIVING
from ncgear.numerics.arrays import Array
from ncgear.project.drive import Drive

METRE_PER_MM = 0.001

COLORS = {"driving": DRIVING, "driven": DRIVEN}
"""The colours of the gears, which are those of the pictures."""

SURFACE = {"metallicFactor": 0.2, "roughnessFactor": 0.6}
"""Shares of glTF's material; it is dull, so that shading and not reflections show the teeth."""

Y_UP = np.array([[1.0, 0.0, 0.0], [0.0, 0.0, 1.0], [0.0, -1.0, 0.0]])
"""Turns z up into y up."""


def glb_files(drive: Drive) -> dict[str, bytes]:
    """``pair.glb`` with the nodes ``driving`` and ``driven``."""
    solids, distance = drive.solids, drive.pitch.center_distance_mm
    scene = Scene()
    for name, mesh, x_mm in (("driving", solids.driving.mesh, 0.0), ("driven", solids.driven.mesh, distance)):
        scene.add_geometry(_colored(mesh, name), node_name=name, geom_name=name, transform=_placed(x_mm))
    # Without normals, viewers shade each triangle by itself, so that edges stay sharp.
    return {"pair.glb": export_glb(scene, include_normals=False)}


def _colored(mesh: Trimesh, name: str) -> Trimesh:
    color = [*linear_light(COLORS[name]), 1.0]
    material = PBRMaterial(name=name, baseColorFactor=color, **SURFACE)
    return Trimesh(mesh.vertices, mesh.faces, process=False, visual=TextureVisuals(material=material))


def linear_light(color: str) -> Array:
    """Shares of light, shape (3,), of a colour in the numbers of screens (``#rrggbb``); glTF materials need them.

    Source: IEC 61966-2-1 (sRGB).
    """
    coded = np.array([int(color[place : place + 2], 16) for place in (1, 3, 5)]) / 255.0
    return np.where(coded <= 0.04045, coded / 12.92, ((coded + 0.055) / 1.055) ** 2.4)


def _placed(x_mm: float) -> Array:
    """The transform from mm in the gear's frame to metres in the scene, with the gear on the line of centres."""
    matrix = np.eye(4)
    matrix[:3, :3] = METRE_PER_MM * Y_UP
    matrix[:3, 3] = METRE_PER_MM * Y_UP @ np.array([x_mm, 0.0, 0.0])
    return matrix
