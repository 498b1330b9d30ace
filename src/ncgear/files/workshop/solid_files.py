"""Files of solids: GLB (binary glTF), the assembled pair for viewers and web pages, and 3MF, which holds its unit.

3MF files have both gears side by side on one plate for printing, and assembled at phi1 = 0.  Sources: 3MF Consortium,
core specification 1.3 and production extension 1.1; parts of the archive by ECMA-376.
"""

from __future__ import annotations

import zipfile
from io import BytesIO
from itertools import count
from uuid import UUID

from ncgear.drawings.solid_pair import linear_light, pair_scene
from ncgear.files.workshop.turning import turning
from ncgear.pitch.shape import Mesh
from ncgear.project.drive import Drive
from ncgear.solids.mesh.triangles import TriangleMesh

GAP_MM = 5.0
"""Gap in mm between the gears on the plate, so that they are not printed as one."""

LONG_AGO = (1980, 1, 1, 0, 0, 0)
"""The earliest time that a ZIP archive can hold; with it the same design gives the same bytes at any time."""

PACKED = 4
"""Level of compression of zlib: half the time of its usual 6, with files of the same size."""

HEAD = "<?xml version='1.0' encoding='utf-8'?>\n"

SCHEMAS = "http://schemas.microsoft.com/3dmanufacturing/"
NAMESPACES = {
    "xmlns": "core/2015/02",
    "xmlns:b": "beamlattice/2017/02",
    "xmlns:m": "material/2015/02",
    "xmlns:p": "production/2015/06",
    "xmlns:s": "slice/2015/07",
    "xmlns:sc": "securecontent/2019/04",
}
"""Namespaces of a model; the identities are in the namespace of production."""

RELATIONS = (
    HEAD + '<Relationships xmlns="http://schemas.openxmlformats.org/package/2006/relationships">'
    '<Relationship Type="http://schemas.microsoft.com/3dmanufacturing/2013/01/3dmodel" Target="/3D/3dmodel.model"'
    ' Id="rel0"/></Relationships>'
)
KINDS = {
    "jpeg": "image/jpeg",
    "jpg": "image/jpeg",
    "model": "application/vnd.ms-package.3dmanufacturing-3dmodel+xml",
    "png": "image/png",
    "rels": "application/vnd.openxmlformats-package.relationships+xml",
    "texture": "application/vnd.ms-package.3dmanufacturing-3dmodeltexture",
}
TYPES = "".join(
    [
        HEAD,
        '<Types xmlns="http://schemas.openxmlformats.org/package/2006/content-types">',
        *(f'<Default Extension="{end}" ContentType="{kind}"/>' for end, kind in KINDS.items()),
        "</Types>",
    ]
)


PlacedMeshes = tuple[TriangleMesh, TriangleMesh, float]
"""The solids of the driving and of the driven gear in mm, and their centre distance in mm."""


def placed_meshes(drive: Drive) -> PlacedMeshes:
    """The placed solids of the STL files, which these files show."""
    return drive.solids.driving.triangles, drive.solids.driven.triangles, drive.pitch.center_distance_mm


def threemf_files(shown: PlacedMeshes) -> dict[str, bytes]:
    """``gears.3mf`` and ``pair.3mf``: the solids apart from each other and assembled."""
    driving, driven, distance_mm = shown
    places = {"gears.3mf": float(driving.bounds[1][0] - driven.bounds[0][0]) + GAP_MM, "pair.3mf": distance_mm}
    gears = {"driving": mesh_text(driving), "driven": mesh_text(driven)}
    return {name: archive(gears, {"driving": 0.0, "driven": x_mm}) for name, x_mm in places.items()}


def mesh_text(mesh: TriangleMesh) -> str:
    """A mesh in mm as the elements of a model."""
    points = '<vertex x="{}" y="{}" z="{}" />' * len(mesh.vertices)
    triangles = '<triangle v1="{}" v2="{}" v3="{}" />' * len(mesh.faces)
    points = points.format(*mesh.vertices.ravel().tolist())
    triangles = triangles.format(*mesh.faces.ravel().tolist())
    return f"<vertices>{points}</vertices><triangles>{triangles}</triangles>"


def archive(meshes: dict[str, str], x_mm: dict[str, float]) -> bytes:
    """A file of meshes (see ``mesh_text``) by their names, with their shifts along x; the same give the same bytes."""
    identities = (UUID(int=number) for number in count(1))
    objects = "".join(
        f'<object id="{number}" name="{name}" type="model" p:UUID="{next(identities)}"><mesh>{text}</mesh></object>'
        for number, (name, text) in enumerate(meshes.items(), 1)
    )
    build = f'<build p:UUID="{next(identities)}">'
    items = "".join(_item(number, name, x_mm[name], next(identities)) for number, name in enumerate(meshes, 1))
    places = " ".join(f'{name}="{SCHEMAS}{end}"' for name, end in NAMESPACES.items())
    model = f'{HEAD}<model {places} unit="millimeter"><resources>{objects}</resources>{build}{items}</build></model>'
    made = BytesIO()
    with zipfile.ZipFile(made, "w", zipfile.ZIP_DEFLATED) as new:
        for name, text in (("3D/3dmodel.model", model), ("_rels/.rels", RELATIONS), ("[Content_Types].xml", TYPES)):
            new.writestr(zipfile.ZipInfo(name, LONG_AGO), text.encode(), zipfile.ZIP_DEFLATED, PACKED)
    return made.getvalue()


def _item(number: int, name: str, x_mm: float, identity: UUID) -> str:
    """A part of the build at its place."""
    place = f"1.0 0.0 0.0 0.0 1.0 0.0 0.0 0.0 1.0 {x_mm} 0.0 0.0"
    return f'<item objectid="{number}" transform="{place}" p:UUID="{identity}" partnumber="{name}"/>'


def glb_files(drive: Drive) -> dict[str, bytes]:
    """``pair.glb`` with the nodes ``driving`` and ``driven``, which turn by the law."""
    still = pair_scene(drive.solids, drive.pitch.center_distance_mm, linear_light).export(file_type="glb")
    return {"pair.glb": turning(still, drive.pair, Mesh(drive.gears.mesh), drive.machine.speed_rad_s)}
