"""The assembled pair at phi1 = 0 as a scene of trimesh, in the metre and with y up, as glTF has it.

Millimetres are scaled, and the gears' axes stand along y.
"""

from __future__ import annotations

from collections.abc import Callable
from typing import TYPE_CHECKING

import numpy as np

from ncgear.drawings.palette import LIGHT
from ncgear.numerics.arrays import Array
from ncgear.project.drive import Drive

if TYPE_CHECKING:
    from trimesh import Scene, Trimesh

METRE_PER_MM = 0.001

SURFACE = {"metallicFactor": 0.2, "roughnessFactor": 0.6}
"""Shares of glTF's material; it is dull, so that shading and not reflections show the teeth."""

Y_UP = np.array([[1.0, 0.0, 0.0], [0.0, 0.0, 1.0], [0.0, -1.0, 0.0]])
"""Turns z up into y up."""


def solid_pair(drive: Drive, coded: Callable[[str], Array]) -> Scene:
    """Both gears in the colours of the pictures, as the nodes ``driving`` and ``driven``; raises as the solids do.

    ``coded`` makes shares of light of a colour in the numbers of screens.
    """
    from trimesh import Scene

    solids, distance = drive.solids, drive.pitch.center_distance_mm
    scene = Scene()
    for name, mesh, x_mm in (("driving", solids.driving.mesh, 0.0), ("driven", solids.driven.mesh, distance)):
        body = _colored(mesh, name, coded(LIGHT[name]))
        scene.add_geometry(body, node_name=name, geom_name=name, transform=_placed(x_mm))
    return scene


def _colored(mesh: Trimesh, name: str, light: Array) -> Trimesh:
    from trimesh import Trimesh
    from trimesh.visual import TextureVisuals
    from trimesh.visual.material import PBRMaterial

    material = PBRMaterial(name=name, baseColorFactor=[*light, 1.0], **SURFACE)
    return Trimesh(mesh.vertices, mesh.faces, process=False, visual=TextureVisuals(material=material))


def as_on_screen(color: str) -> Array:
    """Shares of a colour in the numbers of screens (``#rrggbb``), shape (3,)."""
    return np.array([int(color[place : place + 2], 16) for place in (1, 3, 5)]) / 255.0


def linear_light(color: str) -> Array:
    """Shares of light, shape (3,), of a colour in the numbers of screens (``#rrggbb``); glTF materials need them.

    Source: IEC 61966-2-1 (sRGB).
    """
    coded = as_on_screen(color)
    return np.where(coded <= 0.04045, coded / 12.92, ((coded + 0.055) / 1.055) ** 2.4)


def _placed(x_mm: float) -> Array:
    """The transform from mm in the gear's frame to metres in the scene, with the gear on the line of centres."""
    matrix = np.eye(4)
    matrix[:3, :3] = METRE_PER_MM * Y_UP
    matrix[:3, 3] = METRE_PER_MM * Y_UP @ np.array([x_mm, 0.0, 0.0])
    return matrix
