"""3MF files, which hold their unit: both gears side by side on one plate for printing, and assembled at phi1 = 0."""

from __future__ import annotations

import re
import zipfile
from io import BytesIO
from itertools import count
from uuid import UUID

import numpy as np
from trimesh import Scene, Trimesh
from trimesh.exchange.threemf import export_3MF

from ncgear.project.drive import Drive

GAP_MM = 5.0
"""Gap in mm between the gears on the plate, so that they are not printed as one."""

LONG_AGO = (1980, 1, 1, 0, 0, 0)
"""The earliest time that a ZIP archive can hold; with it the same design gives the same bytes at any time."""

REPEATED = re.compile(rb'(<item)(?: xmlns(?::\w+)?="[^"]*")+')
"""Namespaces that the writer declares again on each item; the 3MF Consortium's own reader refuses them."""

IDENTITY = re.compile(rb'UUID="[0-9a-f-]{36}"')


def threemf_files(drive: Drive) -> dict[str, bytes]:
    """``gears.3mf`` and ``pair.3mf``: the solids of the STL files, apart from each other and assembled."""
    driving, driven = drive.solids.driving.mesh, drive.solids.driven.mesh
    apart = float(driving.bounds[1][0] - driven.bounds[0][0]) + GAP_MM
    places = {"gears.3mf": apart, "pair.3mf": drive.pitch.center_distance_mm}
    return {name: threemf_bytes({"driving": (driving, 0.0), "driven": (driven, x)}) for name, x in places.items()}


def threemf_bytes(parts: dict[str, tuple[Trimesh, float]]) -> bytes:
    """A file of meshes in mm by their names, each with its shift along x; the same meshes give the same bytes."""
    scene = Scene()
    for name, (mesh, x_mm) in parts.items():
        place = np.eye(4)
        place[0, 3] = x_mm
        scene.add_geometry(mesh, node_name=name, geom_name=name, transform=place)
    # The archive is only stored here; it is packed when it has its final form.
    return _reproducible(export_3MF(scene, compression=zipfile.ZIP_STORED))


def _reproducible(archive: bytes) -> bytes:
    """The archive in a form for strict readers, with a fixed time of writing and counted, not random, identities."""
    numbers, made = count(1), BytesIO()
    with zipfile.ZipFile(BytesIO(archive)) as old, zipfile.ZipFile(made, "w", zipfile.ZIP_DEFLATED) as new:
        for name in old.namelist():
            plain = REPEATED.sub(rb"\1", old.read(name))
            content = IDENTITY.sub(lambda _: f'UUID="{UUID(int=next(numbers))}"'.encode(), plain)
            new.writestr(zipfile.ZipInfo(name, LONG_AGO), content, zipfile.ZIP_DEFLATED)
    return made.getvalue()
