"""3MF files, which hold their unit: both gears side by side on one plate for printing, and assembled at phi1 = 0.

Formats: 3MF Consortium, "3D Manufacturing Format Core Specification" 1.3 and its production extension 1.1.2.
"""

from __future__ import annotations

import zipfile
from collections.abc import Mapping
from io import BytesIO
from itertools import count
from uuid import UUID

from ncgear.numerics.arrays import Array, IndexArray
from ncgear.project.drive import Drive
from ncgear.solids.mesh.triangles import TriangleMesh

GAP_MM = 5.0
"""Gap in mm between the gears on the plate, so that they are not printed as one."""

LONG_AGO = (1980, 1, 1, 0, 0, 0)
"""The earliest time that a ZIP archive can hold; with it the same design gives the same bytes at any time."""

HEAD = "<?xml version='1.0' encoding='utf-8'?>\n"
NAMESPACES = (
    'xmlns="http://schemas.microsoft.com/3dmanufacturing/core/2015/02"'
    ' xmlns:b="http://schemas.microsoft.com/3dmanufacturing/beamlattice/2017/02"'
    ' xmlns:m="http://schemas.microsoft.com/3dmanufacturing/material/2015/02"'
    ' xmlns:p="http://schemas.microsoft.com/3dmanufacturing/production/2015/06"'
    ' xmlns:s="http://schemas.microsoft.com/3dmanufacturing/slice/2015/07"'
    ' xmlns:sc="http://schemas.microsoft.com/3dmanufacturing/securecontent/2019/04"'
)
"""Those that writers of 3MF declare; p, of the identities, is the one in use."""

RELATIONSHIPS = (
    f'{HEAD}<Relationships xmlns="http://schemas.openxmlformats.org/package/2006/relationships">'
    '<Relationship Type="http://schemas.microsoft.com/3dmanufacturing/2013/01/3dmodel" Target="/3D/3dmodel.model" '
    'Id="rel0"/></Relationships>'
)
TYPES = {
    "jpeg": "image/jpeg",
    "jpg": "image/jpeg",
    "model": "application/vnd.ms-package.3dmanufacturing-3dmodel+xml",
    "png": "image/png",
    "rels": "application/vnd.openxmlformats-package.relationships+xml",
    "texture": "application/vnd.ms-package.3dmanufacturing-3dmodeltexture",
}
CONTENT_TYPES = (
    f'{HEAD}<Types xmlns="http://schemas.openxmlformats.org/package/2006/content-types">'
    + "".join(f'<Default Extension="{name}" ContentType="{kind}"/>' for name, kind in TYPES.items())
    + "</Types>"
)


def threemf_files(drive: Drive) -> dict[str, bytes]:
    """``gears.3mf`` and ``pair.3mf``: the solids of the STL files, apart from each other and assembled."""
    driving, driven = drive.solids.driving.mesh, drive.solids.driven.mesh
    apart = float(driving.bounds[1][0] - driven.bounds[0][0]) + GAP_MM
    places = {"gears.3mf": apart, "pair.3mf": drive.pitch.center_distance_mm}
    return {name: threemf_bytes({"driving": (driving, 0.0), "driven": (driven, x)}) for name, x in places.items()}


def threemf_bytes(parts: Mapping[str, tuple[TriangleMesh, float]]) -> bytes:
    """A file of meshes in mm by their names, each with its shift along x; the same meshes give the same bytes."""
    files = {"3D/3dmodel.model": _model(parts), "_rels/.rels": RELATIONSHIPS, "[Content_Types].xml": CONTENT_TYPES}
    made = BytesIO()
    with zipfile.ZipFile(made, "w", zipfile.ZIP_DEFLATED) as archive:
        for name, text in files.items():
            archive.writestr(zipfile.ZipInfo(name, LONG_AGO), text, zipfile.ZIP_DEFLATED)
    return made.getvalue()


def _model(parts: Mapping[str, tuple[TriangleMesh, float]]) -> str:
    """The model: its objects, and where each of them stands; identities are counted, not random."""
    identities = (f'p:UUID="{UUID(int=number)}"' for number in count(1))
    objects = [
        f'<object id="{number}" name="{name}" type="model" {next(identities)}><mesh>'
        f"<vertices>{_rows(mesh.vertices, 'vertex', ('x', 'y', 'z'))}</vertices>"
        f"<triangles>{_rows(mesh.faces, 'triangle', ('v1', 'v2', 'v3'))}</triangles></mesh></object>"
        for number, (name, (mesh, _)) in enumerate(parts.items(), 1)
    ]
    build = next(identities)
    items = [
        f'<item objectid="{number}" transform="1.0 0.0 0.0 0.0 1.0 0.0 0.0 0.0 1.0 {x_mm} 0.0 0.0" {next(identities)} '
        f'partnumber="{name}"/>'
        for number, (name, (_, x_mm)) in enumerate(parts.items(), 1)
    ]
    return (
        f'{HEAD}<model {NAMESPACES} unit="millimeter"><resources>{"".join(objects)}</resources>'
        f"<build {build}>{''.join(items)}</build></model>"
    )


def _rows(numbers: Array | IndexArray, element: str, names: tuple[str, str, str]) -> str:
    """An element for each row of an array of shape (n, 3)."""
    places = " ".join(f'{name}="{{}}"' for name in names)
    one = f"<{element} {places} />"
    return (one * len(numbers)).format(*numbers.ravel().tolist())
