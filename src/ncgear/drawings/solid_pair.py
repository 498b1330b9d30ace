"""The assembled pair at phi1 = 0 as binary glTF (GLB), in the metre and with y up, as glTF has it.

Millimetres are scaled, and the gears' axes stand along y.  Format: Khronos Group, "glTF 2.0 Specification" (ISO/IEC
12113:2022); without normals, viewers shade each triangle by itself, so that edges stay sharp.
"""

from __future__ import annotations

import json
from collections.abc import Callable, Sequence
from dataclasses import dataclass
from typing import Any

import numpy as np

from ncgear.drawings.palette import LIGHT
from ncgear.numerics.arrays import Array
from ncgear.project.drive import Drive
from ncgear.solids.mesh.triangles import TriangleMesh

METRE_PER_MM = 0.001

SURFACE = {"roughnessFactor": 0.6, "metallicFactor": 0.2}
"""Shares of glTF's material; it is dull, so that shading and not reflections show the teeth."""

Y_UP = np.array([[1.0, 0.0, 0.0], [0.0, 0.0, 1.0], [0.0, -1.0, 0.0]])
"""Turns z up into y up."""

NEAREST_M = 0.01
"""Distance from a camera below which nothing is shown."""

MAGIC, VERSION, JSON_CHUNK, BINARY_CHUNK = 0x46546C67, 2, 0x4E4F534A, 0x004E4942
"""Numbers of the format: of the file and its version, and of its two chunks."""

UNSIGNED, FLOAT, TRIANGLES = 5125, 5126, 4
"""Numbers of the format: of 32-bit integers, of single precision, and of what corners are put together to."""


@dataclass(frozen=True, eq=False)
class Camera:
    """A camera by its place among the gears (4 x 4), the angle that it sees up, and width by height of its picture."""

    placed: Array
    up_rad: float
    aspect: float


@dataclass(frozen=True, eq=False)
class PlacedGear:
    """A gear in mm in its own frame, its shares of red, green and blue, and its place in metres (4 x 4)."""

    name: str
    mesh: TriangleMesh
    color: Array
    placed: Array

    @property
    def bounds_m(self) -> Array:
        """The least and the largest coordinates of the gear in its place, shape (2, 3)."""
        corners = self.mesh.vertices @ self.placed[:3, :3].T + self.placed[:3, 3]
        return np.array([corners.min(axis=0), corners.max(axis=0)])


def placed_gears(drive: Drive, coded: Callable[[str], Array]) -> list[PlacedGear]:
    """Both gears in the colours of the pictures, ``driving`` and ``driven``; raises as the solids do.

    ``coded`` makes shares of light of a colour in the numbers of screens.
    """
    solids, distance = drive.solids, drive.pitch.center_distance_mm
    return [
        PlacedGear(name, mesh, coded(LIGHT[name]), _placed(x_mm))
        for name, mesh, x_mm in (("driving", solids.driving.mesh, 0.0), ("driven", solids.driven.mesh, distance))
    ]


def as_on_screen(color: str) -> Array:
    """Shares of a colour in the numbers of screens (``#rrggbb``), shape (3,)."""
    return np.array([int(color[place : place + 2], 16) for place in (1, 3, 5)]) / 255.0


def linear_light(color: str) -> Array:
    """Shares of light, shape (3,), of a colour in the numbers of screens (``#rrggbb``); glTF materials need them.

    Source: IEC 61966-2-1 (sRGB); in steps of 1/255, as files of gears have always had them.
    """
    coded = as_on_screen(color)
    light = np.where(coded <= 0.04045, coded / 12.92, ((coded + 0.055) / 1.055) ** 2.4)
    return np.asarray(np.round(255.0 * light) / 255.0)


def _placed(x_mm: float) -> Array:
    """The transform from mm in the gear's frame to metres in the scene, with the gear on the line of centres."""
    matrix = np.eye(4)
    matrix[:3, :3] = METRE_PER_MM * Y_UP
    matrix[:3, 3] = METRE_PER_MM * Y_UP @ np.array([x_mm, 0.0, 0.0])
    return matrix


def glb_bytes(gears: Sequence[PlacedGear], camera: Camera | None = None) -> bytes:
    """The file, with a node for each gear by its name, and one for the camera if there is one."""
    parts = [
        part for gear in gears for part in (gear.mesh.faces.ravel().astype("<u4"), gear.mesh.vertices.astype("<f4"))
    ]
    ends = np.cumsum([0, *(part.nbytes for part in parts)]).tolist()
    nodes: list[dict[str, Any]] = [
        {"name": gear.name, "mesh": number, "matrix": _columns(gear.placed)} for number, gear in enumerate(gears)
    ]
    cameras: dict[str, Any] = {}
    if camera is not None:
        nodes.append({"name": "camera", "camera": 0, "matrix": _columns(camera.placed)})
        seen = {"aspectRatio": camera.aspect, "yfov": camera.up_rad, "znear": NEAREST_M}
        cameras["cameras"] = [{"name": "camera", "type": "perspective", "perspective": seen}]
    tree = {
        "scene": 0,
        "scenes": [{"nodes": list(range(len(nodes)))}],
        "asset": {"version": "2.0", "generator": "ncgear"},
        "accessors": [_accessor(part, number) for number, part in enumerate(parts)],
        "meshes": [
            {
                "name": gear.name,
                "primitives": [
                    {
                        "attributes": {"POSITION": 2 * number + 1},
                        "indices": 2 * number,
                        "mode": TRIANGLES,
                        "material": number,
                    }
                ],
            }
            for number, gear in enumerate(gears)
        ],
        "materials": [
            {
                "pbrMetallicRoughness": {"baseColorFactor": [*gear.color.tolist(), 1.0], **SURFACE},
                "name": gear.name,
                "doubleSided": False,
            }
            for gear in gears
        ],
        **cameras,
        "nodes": nodes,
        "buffers": [{"byteLength": ends[-1]}],
        "bufferViews": [
            {"buffer": 0, "byteOffset": start, "byteLength": part.nbytes}
            for start, part in zip(ends[:-1], parts, strict=True)
        ],
    }
    text = json.dumps(tree, separators=(",", ":"), allow_nan=False).encode()
    # Both chunks are of whole words; those of the second one are so by their kinds.
    text += b" " * (-len(text) % 4)
    return b"".join(
        [
            _words(MAGIC, VERSION, 12 + 8 + len(text) + 8 + ends[-1]),
            _words(len(text), JSON_CHUNK),
            text,
            _words(ends[-1], BINARY_CHUNK),
            *(part.tobytes() for part in parts),
        ]
    )


def _accessor(part: Array, number: int) -> dict[str, Any]:
    """What the format wants to know of corners (n,), or of points (n, 3)."""
    flat = part.ndim == 1
    kind: dict[str, Any] = {"componentType": UNSIGNED if flat else FLOAT, "type": "SCALAR" if flat else "VEC3"}
    low, high = (np.atleast_1d(end(part, axis=0)).tolist() for end in (np.min, np.max))
    return {**kind, "bufferView": number, "count": len(part), "max": high, "min": low}


def _columns(matrix: Array) -> list[float]:
    columns: list[float] = matrix.T.ravel().tolist()
    return columns


def _words(*numbers: int) -> bytes:
    return np.array(numbers, dtype="<u4").tobytes()
