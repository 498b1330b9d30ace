"""A pair of gears in 3D for the page: the viewer that comes with trimesh, packed, and started only when asked for.

trimesh makes a page of its own of a scene: three.js with its controls, and the scene as GLB, all within it (both under
the MIT licence).  That page is packed by gzip, which every browser unpacks, and lies in the report as text that is not
run.  script/solid.js puts it into a frame when its button is pressed.  The report's policy lets only this one script
run there, which has the hash that is given here, and lets it read what is in the page itself.
"""

from __future__ import annotations

import gzip
import re
from base64 import b64encode
from dataclasses import dataclass
from hashlib import sha256

from ncgear.drawings.solid_pair import as_on_screen, solid_pair
from ncgear.project.drive import Drive

MOST_BYTES = 1_000_000
"""A view that takes more of the page is left out: of gears in very fine chords, or with very many teeth."""

SEEN_FROM = (-0.8, 0.0, 0.0)
"""Angles in rad by which the camera is turned about x, y and z: from above the nearer side of both gears."""

RESOLUTION, FIELD_DEG = (1280, 800), (60.0, 40.0)
"""Pixels and angles of the camera, across and up; the viewer makes them those of its frame."""

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
    from trimesh.scene.cameras import Camera
    from trimesh.viewer.notebook import scene_to_html

    # The viewer shows shares of light as they are, without the coding of screens.
    scene = solid_pair(drive, as_on_screen)
    # A camera without a name gets a random one.
    scene.camera = Camera("camera", resolution=RESOLUTION, fov=FIELD_DEG)
    scene.set_camera(angles=SEEN_FROM, distance=DISTANCE * float(scene.scale))
    html = scene_to_html(scene)
    scripts = re.findall(r"<script>(.*?)</script>", html, re.DOTALL)
    if len(scripts) != 1:
        raise RuntimeError(f"the viewer of trimesh has {len(scripts)} scripts; the page knows one")
    packed = b64encode(gzip.compress(html.encode(), mtime=0)).decode()
    return SolidView(title, packed if len(packed) <= MOST_BYTES else "", hash_of(scripts[0]))


def hash_of(script: str) -> str:
    """The hash of a script, as a policy names it."""
    return f"'sha256-{b64encode(sha256(script.encode()).digest()).decode()}'"
