"""The assembled pair at phi1 = 0 as a scene of trimesh, and so as binary glTF (GLB): in the metre and with y up.

Millimetres are scaled, and the gears' axes stand along y, as glTF has it (Khronos Group, glTF 2.0, ISO/IEC 12113:2022).
Trimesh keeps shares of light to 1/255.
"""

from __future__ import annotations

from collections.abc import Callable
from typing import TYPE_CHECKING

import numpy as np

from ncgear.drawings.palette import LIGHT
from ncgear.numerics.arrays import Array

if TYPE_CHECKING:
    from trimesh import Scene

    from ncgear.solids.mesh.pair import SolidPair

METRE_PER_MM = 0.001

SURFACE = {"roughnessFactor": 0.6, "metallicFactor": 0.2}
"""Shares of glTF's material; it is dull, so that shading and not reflections show the teeth."""

Y_UP = np.array([[1.0, 0.0, 0.0], [0.0, 0.0, 1.0], [0.0, -1.0, 0.0]])
"""Turns z up into y up."""


def pair_scene(solids: SolidPair, center_distance_mm: float, coded: Callable[[str], Array]) -> Scene:
    """Both gears in the colours of the pictures, as the nodes ``driving`` and ``driven``.

    ``coded`` makes shares of light of a colour in the numbers of screens.  Without normals, viewers shade each triangle
    by itself, so that edges stay sharp.
    """
    # Slow to load.
    from trimesh import Scene
    from trimesh.visual import TextureVisuals
    from trimesh.visual.material import PBRMaterial

    scene = Scene()
    for name, solid, x_mm in (("driving", solids.driving, 0.0), ("driven", solids.driven, center_distance_mm)):
        mesh, place = solid.mesh.copy(), np.eye(4)
        color = [*coded(LIGHT[name]), 1.0]
        mesh.visual = TextureVisuals(
            material=PBRMaterial(name=name, baseColorFactor=color, doubleSided=False, **SURFACE)
        )
        place[:3, :3] = METRE_PER_MM * Y_UP
        place[:3, 3] = METRE_PER_MM * Y_UP @ np.array([x_mm, 0.0, 0.0])
        scene.add_geometry(mesh, node_name=name, geom_name=name, transform=place)
    return scene


def as_on_screen(color: str) -> Array:
    """Shares of a colour in the numbers of screens (``#rrggbb``), shape (3,)."""
    return np.array([int(color[place : place + 2], 16) for place in (1, 3, 5)]) / 255.0


def linear_light(color: str) -> Array:
    """Shares of light, shape (3,), of a colour in the numbers of screens (``#rrggbb``); glTF materials need them.

    Source: IEC 61966-2-1 (sRGB).
    """
    coded = as_on_screen(color)
    return np.where(coded <= 0.04045, coded / 12.92, ((coded + 0.055) / 1.055) ** 2.4)
