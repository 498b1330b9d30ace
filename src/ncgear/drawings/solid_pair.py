"""The assembled pair at phi1 = 0 as binary glTF (GLB), in the metre and with y up, as glTF has it.

Millimetres are scaled, and the gears' axes stand along y.  Source: Khronos Group, glTF 2.0 (ISO/IEC 12113:2022).
"""

from __future__ import annotations

import json
from collections.abc import Callable
from math import radians
from typing import Any

import numpy as np

from ncgear.drawings.palette import LIGHT
from ncgear.frozen import dataclass
from ncgear.numerics.arrays import Array
from ncgear.project.drive import Drive
from ncgear.solids.mesh.triangles import TriangleMesh

METRE_PER_MM = 0.001

SURFACE = {"roughnessFactor": 0.6, "metallicFactor": 0.2}
"""Shares of glTF's material; it is dull, so that shading and not reflections show the teeth."""

Y_UP = np.array([[1.0, 0.0, 0.0], [0.0, 0.0, 1.0], [0.0, -1.0, 0.0]])
"""Turns z up into y up."""

FLOAT, COUNT = 5126, 5125
"""glTF's numbers of the types of single precision, and of counts in 32 bits."""

TRIANGLES = 4
"""glTF's number of the way in which corners make triangles: three by three."""


@dataclass(frozen=True)
class Camera:
    """A camera of a scene: how far it sees to the sides and up in degrees, and where it stands, in the metre."""

    across_deg: float
    up_deg: float
    nearest: float
    place: Array


def placed_pair(drive: Drive) -> dict[str, tuple[TriangleMesh, Array]]:
    """Both gears by their names, each with its transform (4, 4) from mm in its own frame to metres in the scene."""
    solids, distance = drive.solids, drive.pitch.center_distance_mm
    return {"driving": (solids.driving.mesh, _placed(0.0)), "driven": (solids.driven.mesh, _placed(distance))}


def pair_glb(drive: Drive, coded: Callable[[str], Array], camera: Camera | None = None) -> bytes:
    """Both gears in the colours of the pictures, as the nodes ``driving`` and ``driven``; raises as the solids do.

    ``coded`` makes shares of light of a colour in the numbers of screens.  Without normals, viewers shade each triangle
    by itself, so that edges stay sharp.
    """
    parts = placed_pair(drive)
    accessors: list[dict[str, Any]] = []
    buffers: list[bytes] = []
    for mesh, _ in parts.values():
        corners, points = mesh.faces.astype("<u4").ravel(), mesh.vertices.astype("<f4")
        accessors += [
            {
                "componentType": COUNT,
                "type": "SCALAR",
                "bufferView": len(buffers),
                "count": corners.size,
                "max": [int(corners.max())],
                "min": [int(corners.min())],
            },
            {
                "componentType": FLOAT,
                "type": "VEC3",
                "byteOffset": 0,
                "bufferView": len(buffers) + 1,
                "count": len(points),
                "max": points.max(axis=0).tolist(),
                "min": points.min(axis=0).tolist(),
            },
        ]
        buffers += [corners.tobytes(), points.tobytes()]
    nodes = [_node(name, place, mesh=row) for row, (name, (_, place)) in enumerate(parts.items())]
    cameras = {}
    if camera is not None:
        sees = {
            "aspectRatio": camera.across_deg / camera.up_deg,
            "yfov": radians(camera.up_deg),
            "znear": camera.nearest,
        }
        cameras = {"cameras": [{"name": "camera", "type": "perspective", "perspective": sees}]}
        nodes.append(_node("camera", camera.place, camera=0))
    ends = np.cumsum([len(buffer) for buffer in buffers]).tolist()
    scene = {
        "scene": 0,
        "scenes": [{"nodes": list(range(len(nodes)))}],
        "asset": {"version": "2.0", "generator": "ncgear"},
        "accessors": accessors,
        "meshes": [_mesh(name, row) for row, name in enumerate(parts)],
        "materials": [_material(name, coded(LIGHT[name])) for name in parts],
        **cameras,
        "nodes": nodes,
        "buffers": [{"byteLength": ends[-1]}],
        "bufferViews": [
            {"buffer": 0, "byteOffset": end - len(buffer), "byteLength": len(buffer)}
            for buffer, end in zip(buffers, ends, strict=True)
        ],
    }
    return _packed(scene, b"".join(buffers))


def _node(name: str, place: Array, **shown: int) -> dict[str, Any]:
    return {"name": name, **shown, "matrix": place.T.ravel().tolist()}


def _mesh(name: str, row: int) -> dict[str, Any]:
    part = {"attributes": {"POSITION": 2 * row + 1}, "indices": 2 * row, "mode": TRIANGLES, "material": row}
    return {"name": name, "primitives": [part]}


def _material(name: str, light: Array) -> dict[str, Any]:
    shares = {"baseColorFactor": [*light.tolist(), 1.0], **SURFACE}
    return {"pbrMetallicRoughness": shares, "name": name, "doubleSided": False}


def _packed(scene: dict[str, Any], data: bytes) -> bytes:
    """A file of glTF's binary container: head, scene, data; parts begin at multiples of four bytes."""
    text = json.dumps(scene, separators=(",", ":")).encode()
    text += b" " * (-len(text) % 4)
    parts = [len(part).to_bytes(4, "little") + kind + part for kind, part in ((b"JSON", text), (b"BIN\0", data))]
    length = 12 + sum(map(len, parts))
    return b"".join([b"glTF", (2).to_bytes(4, "little"), length.to_bytes(4, "little"), *parts])


def as_on_screen(color: str) -> Array:
    """Shares of a colour in the numbers of screens (``#rrggbb``), shape (3,)."""
    return np.array([int(color[place : place + 2], 16) for place in (1, 3, 5)]) / 255.0


def linear_light(color: str) -> Array:
    """Shares of light, shape (3,), of a colour in the numbers of screens (``#rrggbb``); glTF materials need them.

    Source: IEC 61966-2-1 (sRGB).
    """
    coded = as_on_screen(color)
    return np.where(coded <= 0.04045, coded / 12.92, ((coded + 0.055) / 1.055) ** 2.4)


def _placed(x_mm: float) -> Array:
    """The transform from mm in the gear's frame to metres in the scene, with the gear on the line of centres."""
    matrix = np.eye(4)
    matrix[:3, :3] = METRE_PER_MM * Y_UP
    matrix[:3, 3] = METRE_PER_MM * Y_UP @ np.array([x_mm, 0.0, 0.0])
    return matrix
