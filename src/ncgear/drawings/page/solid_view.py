"""A pair of gears in 3D for the page: a viewer, packed, and started only when asked for.

``viewer/viewer.html`` is a page for a scene: three.js with its controls, and the scene as GLB, all within it.  It is
packed by gzip, which every browser unpacks, and lies in the report as text that is not run.  script/page.js puts it
into a frame when its button is pressed.  The report's policy lets only this one script run there, which has the hash
that is given here, and lets it read what is in the page itself.
"""

from __future__ import annotations

import gzip
import re
from base64 import b64encode
from math import cos, sin
from typing import TYPE_CHECKING

import numpy as np

from ncgear.drawings.page.assets import asset, hash_of
from ncgear.drawings.solid_pair import as_on_screen, pair_scene
from ncgear.frozen import dataclass

if TYPE_CHECKING:
    from trimesh import Scene

    from ncgear.solids.mesh.pair import SolidPair

MOST_BYTES = 1_000_000
"""A view that takes more of the page is left out: of gears in very fine chords, or with very many teeth."""

SCENE = "$B64GLTF"

SEEN_FROM_RAD = -0.8
"""Angle by which the camera is turned about x: from above the nearer side of both gears."""

FIELD_DEG, NEAREST = (60.0, 45.0), 0.01
"""What the camera sees to the sides and up, and how far away at least; the viewer makes angles those of its frame."""

DISTANCE = 1.05
"""Distance of the camera from the middle, as a share of the diagonal of the box around both gears."""


@dataclass(frozen=True)
class SolidView:
    """The view of one pair: its packed page in base64, empty where it takes too much, and the hash of its script."""

    title: str
    packed: str
    script_hash: str


def solid_view(solids: SolidPair, center_distance_mm: float, title: str) -> SolidView:
    """The view of a pair."""
    # The viewer shows shares of light as they are, without the coding of screens.
    scene = pair_scene(solids, center_distance_mm, as_on_screen)
    _set_camera(scene)
    html = asset("viewer/viewer.html").replace(SCENE, b64encode(scene.export(file_type="glb")).decode())
    (script,) = re.findall(r"<script>(.*?)</script>", html, re.DOTALL)
    packed = b64encode(gzip.compress(html.encode(), mtime=0)).decode()
    return SolidView(title, packed if len(packed) <= MOST_BYTES else "", hash_of(script))


def _set_camera(scene: Scene) -> None:
    """The camera, turned by ``SEEN_FROM_RAD``, at its distance from the middle of the box around both gears."""
    from trimesh.scene.cameras import Camera

    cos_x, sin_x = cos(SEEN_FROM_RAD), sin(SEEN_FROM_RAD)
    place = np.eye(4)
    place[1:3, 1:3] = [[cos_x, -sin_x], [sin_x, cos_x]]
    low, high = scene.bounds
    place[:3, 3] = (low + high) / 2.0 + DISTANCE * float(np.linalg.norm(high - low)) * place[:3, 2]
    scene.camera = Camera("camera", fov=FIELD_DEG, z_near=NEAREST)
    scene.camera_transform = place
