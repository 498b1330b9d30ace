"""Which part of a scene each view shows: boxes (left, bottom, width, height) in mm."""

from __future__ import annotations

import numpy as np

from ncgear.numerics.arrays import Array
from ncgear.scene.bodies import Body
from ncgear.scene.links import CRANK_EYE
from ncgear.scene.scene import Scene
from ncgear.scene.standing import hatches_mm, wall_mm

SLACK = 0.03
"""Room around what is shown, as a share of its larger side."""

MESH_IN_MODULES = 9.0
"""Width and height of the view on the mesh."""

Box = tuple[float, float, float, float]


def views(scene: Scene) -> dict[str, Box]:
    """The whole machine, and where there are gears all of them; ``mesh`` is about the origin, to follow a point."""
    found = {"machine": _machine(scene)}
    if scene.pairs:
        found["gears"] = _around(_gear_corners(scene))
        size = MESH_IN_MODULES * max(pair.module_mm for pair in scene.pairs)
        found["mesh"] = (-size / 2.0, -size / 2.0, size, size)
    return found


def _machine(scene: Scene) -> Box:
    reach = scene.machine.linkage.crank_mm * (1.0 + CRANK_EYE)
    crank = np.array([[-reach, -reach], [reach, reach]])
    standing = np.vstack([wall_mm(scene.chamber), hatches_mm(scene.chamber).reshape(-1, 2)])
    return _around(np.vstack([crank, standing, _gear_corners(scene)]))


def _gear_corners(scene: Scene) -> Array:
    gears = [gear for pair in scene.pairs for gear in (pair.driving, pair.driven)]
    return np.array([corner for gear in gears for corner in _corners(gear.body, gear.axis_mm)]).reshape(-1, 2)


def _corners(body: Body, axis_mm: tuple[float, float]) -> Array:
    reach, axis = body.reach_mm, np.array(axis_mm)
    return np.stack([axis - reach, axis + reach])


def _around(points: Array) -> Box:
    low, high = points.min(axis=0), points.max(axis=0)
    slack = SLACK * float(np.max(high - low))
    (left, bottom), (width, height) = low - slack, high - low + 2.0 * slack
    return float(left), float(bottom), float(width), float(height)
