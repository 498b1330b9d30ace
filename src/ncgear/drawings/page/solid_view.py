"""A pair of gears in 3D for the page: the viewer that comes with trimesh, packed, and started only when asked for.

trimesh has a page for a scene: three.js with its controls, and the scene as GLB, all within it (both under
the MIT licence).  That page is packed by gzip, which every browser unpacks, and lies in the report as text that is not
run.  script/page.js puts it into a frame when its button is pressed.  The report's policy lets only this one script
run there, which has the hash that is given here, and lets it read what is in the page itself.
"""

from __future__ import annotations

import gzip
import re
from base64 import b64encode
from importlib.util import find_spec
from itertools import product
from math import cos, sin
from pathlib import Path
from zipfile import ZipFile

import numpy as np

from ncgear.drawings.page.assets import hash_of
from ncgear.drawings.solid_pair import Camera, as_on_screen, pair_glb, placed_pair
from ncgear.frozen import dataclass
from ncgear.project.drive import Drive

MOST_BYTES = 1_000_000
"""A view that takes more of the page is left out: of gears in very fine chords, or with very many teeth."""

SCENE = "$B64GLTF"

SEEN_FROM_RAD = -0.8
"""Angle by which the camera is turned about x: from above the nearer side of both gears."""

ACROSS_DEG, UP_DEG, NEAREST = 60.0, 45.0, 0.01
"""What the camera sees to the sides and up, and how far away at least; the viewer makes angles those of its frame."""

DISTANCE = 1.05
"""Distance of the camera from the middle, as a share of the diagonal of the box around both gears."""


@dataclass(frozen=True)
class SolidView:
    """The view of one pair: its packed page in base64, empty where it takes too much, and the hash of its script."""

    title: str
    packed: str
    script_hash: str


def solid_view(drive: Drive, title: str) -> SolidView:
    """The view of a pair; raises as the drive's solids do."""
    # The viewer shows shares of light as they are, without the coding of screens.
    scene = pair_glb(drive, as_on_screen, _camera(drive))
    html = viewer().replace(SCENE, b64encode(scene).decode())
    scripts = re.findall(r"<script>(.*?)</script>", html, re.DOTALL)
    if len(scripts) != 1:
        raise RuntimeError(f"the viewer of trimesh has {len(scripts)} scripts; the page knows one")
    packed = b64encode(gzip.compress(html.encode(), mtime=0)).decode()
    return SolidView(title, packed if len(packed) <= MOST_BYTES else "", hash_of(scripts[0]))


def viewer() -> str:
    """The page of trimesh's viewer, with ``SCENE`` where a scene belongs; trimesh, slow to load, stays unloaded."""
    found = find_spec("trimesh")
    if found is None or found.origin is None:
        raise RuntimeError("trimesh, which brings the viewer, is not installed")
    with ZipFile(Path(found.origin).parent / "resources" / "templates" / "viewer.zip") as packed:
        return packed.read("viewer.html.template").decode()


def _camera(drive: Drive) -> Camera:
    """The camera, turned by ``SEEN_FROM_RAD``, at its distance from the middle of the box around both gears."""
    cos_x, sin_x = cos(SEEN_FROM_RAD), sin(SEEN_FROM_RAD)
    turned = np.array([[1.0, 0.0, 0.0], [0.0, cos_x, -sin_x], [0.0, sin_x, cos_x]])
    boxes = []
    for mesh, place in placed_pair(drive).values():
        corners = np.array(list(product(*mesh.bounds.T)))
        boxes.append(corners @ place[:3, :3].T + place[:3, 3])
    low, high = np.vstack(boxes).min(axis=0), np.vstack(boxes).max(axis=0)
    middle, diagonal = (low + high) / 2.0, float(np.linalg.norm(high - low))
    place = np.eye(4)
    place[:3, :3], place[:3, 3] = turned, middle + DISTANCE * diagonal * turned[:, 2]
    return Camera(ACROSS_DEG, UP_DEG, NEAREST, place)
