"""The standing parts of a scene, the boxes of its views, and contours with as many points as a picture needs.

The walls beside the slider are hatched like the ground in a drawing.  The material in front of the slider has a grain,
which shows how the slider presses it.
"""

from __future__ import annotations

from collections.abc import Sequence
from math import pi

import numpy as np
import shapely
from shapely import Polygon

from ncgear.drawings.scene.bodies import CRANK_EYE, Chamber
from ncgear.drawings.scene.scene import Scene
from ncgear.numerics.arrays import Array


def simplified(contours_mm: Sequence[Array], tolerance_mm: float) -> list[Array]:
    """Contours (shape (n, 2) each, outer one first) without points that are within the tolerance of the rest."""
    polygon = Polygon(contours_mm[0], contours_mm[1:])
    fewer = shapely.simplify(polygon, tolerance_mm, preserve_topology=True)
    return [np.asarray(ring.coords)[:-1] for ring in (fewer.exterior, *fewer.interiors)]


HATCHES = 44
"""Strokes along a wall."""

HATCH_LENGTH = 0.07
"""Length of a stroke of the hatching across the wall, as a share of the chamber's height."""

STRAWS = 150
HALF_STRAW = np.array([0.03, 0.065])
"""Half the length of straws that lie along the chamber, as a share of the material's depth, and of straws that lie
across it, as a share of the chamber's height.
"""

SPREAD = np.array([0.8191725134, 0.6710436067, 0.5497004779])
"""Powers of the inverse root of x^4 = x + 1; the fractions of their multiples fill a cube evenly, with no randomness.

Source: M. Roberts, "The unreasonable effectiveness of quasirandom sequences", 2018.
"""


def wall_mm(chamber: Chamber) -> Array:
    """The open line of the chamber's walls in mm, shape (n, 2): two sides, and an end where there is material."""
    half = chamber.height_mm / 2.0
    low, high = chamber.linkage.offset_mm - half, chamber.linkage.offset_mm + half
    start, end = chamber.start_mm, chamber.end_mm
    return np.array([[start, low], [end, low], [end, high], [start, high]])


def hatches_mm(chamber: Chamber) -> Array:
    """Slanting strokes outside both sides, in mm, shape (n, 2, 2); they mark the walls as parts of the frame."""
    wall, length = wall_mm(chamber), HATCH_LENGTH * chamber.height_mm
    foot = np.linspace(chamber.start_mm, chamber.end_mm, HATCHES + 1)[1:]
    (_, low), (_, high) = wall[0], wall[2]
    strokes = []
    for side, across in ((low, -length), (high, length)):
        level = np.full_like(foot, side)
        strokes.append(np.stack([np.stack([foot, level], -1), np.stack([foot - length, level + across], -1)], axis=1))
    return np.concatenate(strokes)


def straws() -> Array:
    """Strokes of the material's grain, shape (n, 2, 2): x in shares of its depth, y in shares of the chamber's height.

    As the depth shrinks, the strokes come closer together, like straw.
    """
    along, across, lean = np.mod(np.outer(np.arange(1, STRAWS + 1), SPREAD), 1.0).T
    middle = np.stack([along, across - 0.5], axis=-1)
    half = HALF_STRAW * np.stack([np.cos(pi * lean), np.sin(pi * lean)], axis=-1)
    low, high = np.array([0.0, -0.5]), np.array([1.0, 0.5])
    strokes: Array = np.clip(np.stack([middle - half, middle + half], axis=1), low, high)
    return strokes


SLACK = 0.03
"""Room around the parts in a view, as a share of the larger side of their box."""

MESH_IN_MODULES = 9.0
"""Width and height of the view of the mesh, in modules."""

Box = tuple[float, float, float, float]
"""Left, bottom, width and height in mm of the frame of the scene."""


def views(scene: Scene) -> dict[str, Box]:
    """The boxes of the views: the whole machine, and where there are gears, all gears and the mesh.

    The box of the mesh is about the origin; it has to be moved to the pitch point.
    """
    reach = scene.machine.linkage.crank_mm * (1.0 + CRANK_EYE)
    crank = np.array([[-reach, -reach], [reach, reach]])
    standing = np.vstack([wall_mm(scene.chamber), hatches_mm(scene.chamber).reshape(-1, 2)])
    # Two corners of the square in which each gear turns.
    corners = [np.array(gear.axis_mm) + side * gear.body.reach_mm for gear in scene.gears for side in (-1.0, 1.0)]
    gears = np.array(corners).reshape(-1, 2)
    found = {"machine": _box_around(np.vstack([crank, standing, gears]))}
    if scene.pairs:
        found["gears"] = _box_around(gears)
        size = MESH_IN_MODULES * max(pair.module_mm for pair in scene.pairs)
        found["mesh"] = (-size / 2.0, -size / 2.0, size, size)
    return found


def _box_around(points: Array) -> Box:
    low, high = points.min(axis=0), points.max(axis=0)
    slack = SLACK * float(np.max(high - low))
    (left, bottom), (width, height) = low - slack, high - low + 2.0 * slack
    return float(left), float(bottom), float(width), float(height)
