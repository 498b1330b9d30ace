"""The assembled pair in 3D: as a scene of trimesh, and so as binary glTF, and as a viewer on the page."""

from __future__ import annotations

import gzip
import re
from base64 import b64encode
from collections.abc import Callable
from math import cos, sin
from typing import TYPE_CHECKING

import numpy as np

from ncgear.drawings.page.assets import asset, hash_of
from ncgear.drawings.palette import LIGHT
from ncgear.frozen import dataclass
from ncgear.numerics.arrays import Array

if TYPE_CHECKING:
    from trimesh import Scene

    from ncgear.solids.mesh.pair import SolidPair


METRE_PER_MM = 0.001

SURFACE = {"roughnessFactor": 0.6, "metallicFactor": 0.2}
"""Properties of the material in glTF; it is dull, so that shading and not reflections show the teeth."""

Y_UP = np.array([[1.0, 0.0, 0.0], [0.0, 0.0, 1.0], [0.0, -1.0, 0.0]])
"""Matrix that turns z up into y up."""


def pair_scene(solids: SolidPair, center_distance_mm: float, coded: Callable[[str], Array]) -> Scene:
    """Both gears in the colours of the pictures, as the nodes ``driving`` and ``driven``.

    ``coded`` turns a colour in the numbers of screens into shares of light.  Without normals, viewers shade each
    triangle by itself, so that edges stay sharp.
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


MOST_BYTES = 1_000_000
"""Largest view on the page; a larger one, of gears with very fine chords or very many teeth, is left out."""

SCENE = "$B64GLTF"

SEEN_FROM_RAD = -0.8
"""Angle by which the camera is turned about x: from above the nearer side of both gears."""

FIELD_DEG, NEAREST = (60.0, 45.0), 0.01
"""Angles of view to the sides and up, which the viewer fits to its frame, and the least visible distance."""

DISTANCE = 1.05
"""Distance of the camera from the middle, as a share of the diagonal of the box around both gears."""


@dataclass(frozen=True)
class SolidView:
    """The view of one pair: its packed page in base64, empty where it is too large, and the hash of its script."""

    title: str
    packed: str
    script_hash: str


def solid_view(solids: SolidPair, center_distance_mm: float, title: str) -> SolidView:
    """The view of a pair."""
    # The viewer shows shares of light as they are, without the coding of screens.
    scene = pair_scene(solids, center_distance_mm, as_on_screen)
    from trimesh.scene.cameras import Camera

    # The camera is turned by ``SEEN_FROM_RAD``, at its distance from the middle of the box around both gears.
    cos_x, sin_x = cos(SEEN_FROM_RAD), sin(SEEN_FROM_RAD)
    place = np.eye(4)
    place[1:3, 1:3] = [[cos_x, -sin_x], [sin_x, cos_x]]
    low, high = scene.bounds
    place[:3, 3] = (low + high) / 2.0 + DISTANCE * float(np.linalg.norm(high - low)) * place[:3, 2]
    scene.camera = Camera("camera", fov=FIELD_DEG, z_near=NEAREST)
    scene.camera_transform = place
    html = asset("viewer/viewer.html").replace(SCENE, b64encode(scene.export(file_type="glb")).decode())
    (script,) = re.findall(r"<script>(.*?)</script>", html, re.DOTALL)
    packed = b64encode(gzip.compress(html.encode(), mtime=0)).decode()
    return SolidView(title, packed if len(packed) <= MOST_BYTES else "", hash_of(script))
