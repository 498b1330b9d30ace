"""Contours with fewer points, for pictures: what is thinner than a line need not be drawn.

What stands still: walls with the hatching that marks the ground, and the grain of the material.

Which part of a scene each view shows: boxes (left, bottom, width, height) in mm.
"""

from __future__ import annotations

from collections.abc import Sequence
from math import pi

import numpy as np
import shapely
from shapely import Polygon

from ncgear.drawings.scene.bodies import CRANK_EYE, Body, Chamber
from ncgear.drawings.scene.scene import Scene
from ncgear.numerics.arrays import Array


def simplified(contours_mm: Sequence[Array], tolerance_mm: float) -> list[Array]:
    """Contours (shape (n, 2) each, outer one first) with fewer points, no dropped point farther than the tolerance."""
    polygon = Polygon(contours_mm[0], contours_mm[1:])
    fewer = shapely.simplify(polygon, tolerance_mm, preserve_topology=True)
    return [np.asarray(ring.coords)[:-1] for ring in (fewer.exterior, *fewer.interiors)]


HATCHES = 44
"""Strokes along a wall."""

HATCH_LENGTH = 0.07
"""Length of a stroke of the hatching across the wall, as a share of the chamber's height."""

STRAWS = 150
HALF_STRAW = np.array([0.03, 0.065])
"""Half a straw's length where it lies along the chamber, and across it: shares of the depth and of the height."""

SPREAD = np.array([0.8191725134, 0.6710436067, 0.5497004779])
"""Powers of the inverse root of x^4 = x + 1, whose multiples, whole parts left out, fill a cube evenly without any
random number (M. Roberts, "The unreasonable effectiveness of quasirandom sequences", 2018)."""


def wall_mm(chamber: Chamber) -> Array:
    """The open line around the slider's way, shape (n, 2): two sides, and an end where there is material."""
    half = chamber.height_mm / 2.0
    low, high = chamber.linkage.offset_mm - half, chamber.linkage.offset_mm + half
    start, end = chamber.start_mm, chamber.end_mm
    return np.array([[start, low], [end, low], [end, high], [start, high]])


def hatches_mm(chamber: Chamber) -> Array:
    """Strokes outside both sides, shape (n, 2, 2): the wall is part of the frame."""
    wall, length = wall_mm(chamber), HATCH_LENGTH * chamber.height_mm
    foot = np.linspace(chamber.start_mm, chamber.end_mm, HATCHES + 1)[1:]
    (_, low), (_, high) = wall[0], wall[2]
    sides = ((low, -length), (high, length))
    return np.concatenate([_strokes(foot, at, across, length) for at, across in sides])


def _strokes(foot: Array, at: float, across: float, back: float) -> Array:
    """Slanting strokes from points of a level line."""
    level = np.full_like(foot, at)
    return np.stack([np.stack([foot, level], -1), np.stack([foot - back, level + across], -1)], axis=1)


def straws() -> Array:
    """Strokes of the material's grain, shape (n, 2, 2): shares of its depth in x, of the chamber's height in y.

    Drawn over a depth that shrinks, they close up as straw does.
    """
    along, across, lean = np.mod(np.outer(np.arange(1, STRAWS + 1), SPREAD), 1.0).T
    middle = np.stack([along, across - 0.5], axis=-1)
    half = HALF_STRAW * np.stack([np.cos(pi * lean), np.sin(pi * lean)], axis=-1)
    low, high = np.array([0.0, -0.5]), np.array([1.0, 0.5])
    strokes: Array = np.clip(np.stack([middle - half, middle + half], axis=1), low, high)
    return strokes


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
