"""Files of solids: GLB (binary glTF), the assembled pair for viewers and web pages, and 3MF, which holds its unit.

3MF files have both gears side by side on one plate for printing, and assembled at phi1 = 0.  Sources: 3MF Consortium,
core specification 1.3 and production extension 1.1; parts of the archive by ECMA-376.

Gears of a GLB file turn by their law, so that a viewer or a page plays it (glTF 2.0, animations).  Angles are keys of
one animation at the speed of the machine, one for each degree of the driving gear; viewers turn evenly between keys.
It ends when both gears stand as at first; gears that turn less than once come back.
"""

from __future__ import annotations

import json
import struct
import zipfile
from collections.abc import Iterable, Mapping
from io import BytesIO
from itertools import count
from math import cos, degrees, gcd, pi, sin
from typing import Any
from uuid import UUID

import numpy as np

from ncgear.drawings.solid_pair import linear_light, pair_scene
from ncgear.frozen import dataclass
from ncgear.numerics.arrays import Array
from ncgear.pitch.shape import Mesh
from ncgear.project.drive import Drive
from ncgear.ratio.transmission import Pair, Transmission
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
    return {
        name: archive(gears, [PlacedBody("driving", "driving"), PlacedBody("driven", "driven", x_mm)])
        for name, x_mm in places.items()
    }


@dataclass(frozen=True)
class PlacedBody:
    """A body of a model by its own name and that of its mesh: its shift in mm, and its turn about z in rad."""

    name: str
    mesh: str
    x_mm: float = 0.0
    y_mm: float = 0.0
    z_mm: float = 0.0
    turn_rad: float = 0.0

    @property
    def written(self) -> str:
        """The rows of the matrix that points, as rows, are multiplied with."""
        along, across = cos(self.turn_rad), sin(self.turn_rad)
        turn = f"{along} {across} 0.0 {0.0 - across} {along} 0.0 0.0 0.0 1.0"
        return f"{turn} {self.x_mm} {self.y_mm} {self.z_mm}"


def mesh_text(mesh: TriangleMesh) -> str:
    """A mesh in mm as the elements of a model."""
    points = '<vertex x="{}" y="{}" z="{}" />' * len(mesh.vertices)
    triangles = '<triangle v1="{}" v2="{}" v3="{}" />' * len(mesh.faces)
    points = points.format(*mesh.vertices.ravel().tolist())
    triangles = triangles.format(*mesh.faces.ravel().tolist())
    return f"<vertices>{points}</vertices><triangles>{triangles}</triangles>"


def archive(meshes: Mapping[str, str], bodies: Iterable[PlacedBody]) -> bytes:
    """A file of bodies with meshes (see ``mesh_text``) by their names; the same give the same bytes."""
    identities, numbers = (
        (UUID(int=number) for number in count(1)),
        {name: place for place, name in enumerate(meshes, 1)},
    )
    objects = "".join(
        f'<object id="{number}" name="{name}" type="model" p:UUID="{next(identities)}"><mesh>{meshes[name]}</mesh>'
        "</object>"
        for name, number in numbers.items()
    )
    build = f'<build p:UUID="{next(identities)}">'
    items = "".join(
        f'<item objectid="{numbers[body.mesh]}" transform="{body.written}" p:UUID="{next(identities)}"'
        f' partnumber="{body.name}"/>'
        for body in bodies
    )
    places = " ".join(f'{name}="{SCHEMAS}{end}"' for name, end in NAMESPACES.items())
    model = f'{HEAD}<model {places} unit="millimeter"><resources>{objects}</resources>{build}{items}</build></model>'
    made = BytesIO()
    with zipfile.ZipFile(made, "w", zipfile.ZIP_DEFLATED) as new:
        for name, text in (("3D/3dmodel.model", model), ("_rels/.rels", RELATIONS), ("[Content_Types].xml", TYPES)):
            new.writestr(zipfile.ZipInfo(name, LONG_AGO), text.encode(), zipfile.ZIP_DEFLATED, PACKED)
    return made.getvalue()


def glb_files(drive: Drive) -> dict[str, bytes]:
    """``pair.glb`` with the nodes ``driving`` and ``driven``, which turn by the law."""
    still = pair_scene(drive.solids, drive.pitch.center_distance_mm, linear_light).export(file_type="glb")
    return {"pair.glb": turning(still, drive.pair, Mesh(drive.gears.mesh), drive.machine.speed_rad_s)}


PER_DEGREE = 1
"""Keys for each degree of the driving gear: with 1, a driven gear is missed by some microrad, 1 um at 100 mm."""

FLOAT = 5126
"""Number of single precision among the types of glTF."""

CORNERS, FACETS = 34962, 34963
"""Numbers in glTF for the content of a stretch of the file: values of corners, and corners of facets."""

JSON, BINARY = 0x4E4F534A, 0x004E4942
"""Kinds of chunks of a GLB file."""


def turning_angles(transmission: Transmission) -> tuple[Array, Array]:
    """Angles of the driving and of the driven gear in rad, until they stand as at first; shape (n,) each."""
    lobes = transmission.lobes
    if not lobes.repeats:
        phi1 = _keys(lobes.driving_period_rad)
        phi1 = np.append(phi1, phi1[-2::-1])
    else:
        phi1 = _keys(2.0 * pi * lobes.driven / gcd(lobes.driving, lobes.driven))
    return phi1, transmission.driven_angle(phi1).value


def _keys(range_rad: float) -> Array:
    return np.linspace(0.0, range_rad, round(degrees(range_rad) * PER_DEGREE) + 1)


def turning(glb: bytes, pair: Pair, mesh: Mesh, speed_rad_s: float) -> bytes:
    """The file with its nodes ``driving`` and ``driven`` turning; their places become shift, turn and scale.

    ``speed_rad_s`` is the speed of the machine's driving shaft, which turns the pair by its own law.
    """
    phi1, phi2 = turning_angles(pair.transmission)
    way = np.concatenate([[0.0], np.cumsum(np.abs(np.diff(pair.shaft_rad(phi1))))])
    return moving(glb, way / speed_rad_s, {"driving": (phi1, None), "driven": (mesh.sense * phi2, None)})


def moving(glb: bytes, seconds: Array, ways: Mapping[str, tuple[Array, Array | None]]) -> bytes:
    """The file with nodes moving by keys at ``seconds``, shape (n,).

    ``ways`` has for each node its angles of turning in rad in its own frame, shape (n,), and its places in the frame of
    the file, shape (n, 3), or None where it stays at its place.
    """
    content, binary = _chunks(glb)
    _tell_what_meshes_read(content)
    numbers, moved = [seconds[:, None]], []
    for name, (turned, places) in ways.items():
        node = next(node for node in content["nodes"] if node.get("name") == name)
        still = _parted(node)
        half = turned / 2.0
        spin = np.stack([0.0 * half, 0.0 * half, np.sin(half), np.cos(half)], axis=1)
        numbers.append(_after(still, spin))
        moved.append((name, "rotation"))
        if places is not None:
            numbers.append(places)
            moved.append((name, "translation"))
    first, binary = len(content["accessors"]), binary + bytes(-len(binary) % 4)
    for values in numbers:
        content["bufferViews"].append({"buffer": 0, "byteOffset": len(binary), "byteLength": 4 * values.size})
        kept = np.ascontiguousarray(values, dtype="<f4")
        view = len(content["bufferViews"]) - 1
        accessor: dict[str, Any] = {"bufferView": view, "componentType": FLOAT, "count": len(values)}
        if values.shape[1] == 1:
            accessor |= {"type": "SCALAR", "min": [float(kept.min())], "max": [float(kept.max())]}
        else:
            accessor["type"] = f"VEC{values.shape[1]}"
        content["accessors"].append(accessor)
        binary += kept.tobytes()
    content["buffers"][0]["byteLength"] = len(binary)
    places_of = {node.get("name"): place for place, node in enumerate(content["nodes"])}
    content["animations"] = [
        {
            "name": "turning",
            "samplers": [{"input": first, "output": first + 1 + number} for number in range(len(moved))],
            "channels": [
                {"sampler": number, "target": {"node": places_of[name], "path": path}}
                for number, (name, path) in enumerate(moved)
            ],
        }
    ]
    return _file(content, binary)


def _tell_what_meshes_read(content: dict[str, Any]) -> None:
    """Name the purpose of each stretch that a mesh reads, which the format's validator demands."""
    for primitive in (primitive for mesh in content["meshes"] for primitive in mesh["primitives"]):
        read = [(place, CORNERS) for place in primitive["attributes"].values()] + [(primitive["indices"], FACETS)]
        for place, target in read:
            content["bufferViews"][content["accessors"][place]["bufferView"]]["target"] = target


def _parted(node: dict[str, Any]) -> Array:
    """Turn a node's matrix into shift, quaternion and scale, since glTF animates no matrix; return the quaternion."""
    matrix = np.array(node.pop("matrix")).reshape(4, 4).T
    scale = float(np.linalg.norm(matrix[:3, 0]))
    turn = matrix[:3, :3] / scale
    # Of half a turn or less about an axis of the frame, as these are, the real part is not 0.
    real = float(np.sqrt(max(1.0 + np.trace(turn), 0.0))) / 2.0
    across = np.array([turn[2, 1] - turn[1, 2], turn[0, 2] - turn[2, 0], turn[1, 0] - turn[0, 1]]) / (4.0 * real)
    quaternion = np.append(across, real)
    node |= {"translation": matrix[:3, 3].tolist(), "rotation": quaternion.tolist(), "scale": [scale] * 3}
    return quaternion


def _after(first: Array, second: Array) -> Array:
    """The quaternions of turns that come before ``first`` in the body's own frame: first times second, (n, 4)."""
    across, real = first[:3], first[3]
    own, own_real = second[:, :3], second[:, 3:]
    return np.hstack(
        [real * own + own_real * across + np.cross(across, own), real * own_real - (own @ across)[:, None]]
    )


def _chunks(glb: bytes) -> tuple[dict[str, Any], bytes]:
    """The description and the numbers of a file."""
    length, _ = struct.unpack_from("<II", glb, 12)
    rest, _ = struct.unpack_from("<II", glb, 20 + length)
    return json.loads(glb[20 : 20 + length]), glb[28 + length : 28 + length + rest]


def _file(content: dict[str, Any], binary: bytes) -> bytes:
    text = json.dumps(content, separators=(",", ":")).encode()
    text += b" " * (-len(text) % 4)
    binary += bytes(-len(binary) % 4)
    chunks = struct.pack("<II", len(text), JSON) + text + struct.pack("<II", len(binary), BINARY) + binary
    return struct.pack("<4sII", b"glTF", 2, 12 + len(chunks)) + chunks
