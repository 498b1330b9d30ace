"""A pair of gears in 3D for the page: the viewer that comes with trimesh, packed, and started only when asked for.

trimesh has a page for a scene: three.js with its controls, and the scene as GLB, all within it (both under the MIT
licence).  That page is packed by gzip, which every browser unpacks, and lies in the report as text that is not
run.  script/solid.js puts it into a frame when its button is pressed.  The report's policy lets only this one script
run there, which has the hash that is given here, and lets it read what is in the page itself.
"""

from __future__ import annotations

import gzip
import re
from base64 import b64encode
from collections.abc import Sequence
from dataclasses import dataclass
from hashlib import sha256
from importlib.util import find_spec
from math import pi
from pathlib import Path
from zipfile import ZipFile

import numpy as np

from ncgear.drawings.solid_pair import Camera, PlacedGear, as_on_screen, glb_bytes, placed_gears
from ncgear.project.drive import Drive

MOST_BYTES = 1_000_000
"""A view that takes more of the page is left out: of gears in very fine chords, or with very many teeth."""

TURNED_RAD = -0.8
"""Angle by which the camera is turned about x: it looks from above at the nearer side of both gears."""

UP_RAD, ASPECT = pi / 4.0, 4.0 / 3.0
"""Angle that the camera sees up, and width by height; the viewer makes them those of its frame."""

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
    gears = placed_gears(drive, as_on_screen)
    glb = glb_bytes(gears, _camera(gears))
    html = _viewer().replace("$B64GLTF", b64encode(glb).decode())
    scripts = re.findall(r"<script>(.*?)</script>", html, re.DOTALL)
    if len(scripts) != 1:
        raise RuntimeError(f"the viewer of trimesh has {len(scripts)} scripts; the page knows one")
    packed = b64encode(gzip.compress(html.encode(), mtime=0)).decode()
    return SolidView(title, packed if len(packed) <= MOST_BYTES else "", hash_of(scripts[0]))


def _viewer() -> str:
    """The page of the viewer, with a mark where its scene belongs; trimesh itself, which takes long, is not loaded."""
    package = find_spec("trimesh")
    if package is None or package.origin is None:
        raise RuntimeError("trimesh, whose viewer the page shows, is not installed")
    with ZipFile(Path(package.origin).parent / "resources" / "templates" / "viewer.zip") as archive:
        return archive.read("viewer.html.template").decode()


def _camera(gears: Sequence[PlacedGear]) -> Camera:
    """A camera turned by an angle about x that looks at the middle of the box around both gears, as it sees it."""
    bounds = np.array([gear.bounds_m for gear in gears])
    low, high = bounds[:, 0].min(axis=0), bounds[:, 1].max(axis=0)
    sine, cosine = np.sin(TURNED_RAD), np.cos(TURNED_RAD)
    placed = np.eye(4)
    placed[1:3, 1:3] = [[cosine, -sine], [sine, cosine]]
    seen = np.array([low, high]) @ placed[:3, :3]
    middle = placed[:3, :3] @ (seen.min(axis=0) + 0.5 * np.ptp(seen, axis=0))
    placed[:3, 3] = middle + DISTANCE * float(np.linalg.norm(high - low)) * placed[:3, 2]
    return Camera(placed, UP_RAD, ASPECT)


def hash_of(script: str) -> str:
    """The hash of a script, as a policy names it."""
    return f"'sha256-{b64encode(sha256(script.encode()).digest()).decode()}'"
