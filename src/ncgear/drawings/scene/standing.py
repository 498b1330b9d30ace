"""The standing parts of a scene, the boxes of its views, and contours with as many points as a picture needs.

The walls beside a slider, the supports of axes and other guides are hatched like the ground in a drawing.  The
material in front of the slider has a grain, which shows how the slider presses it.
"""

from __future__ import annotations

from collections.abc import Sequence
from math import pi

import numpy as np
import shapely
from shapely import Polygon

from ncgear.drawings.scene.bodies import CRANK_EYE, Chamber
from ncgear.drawings.scene.scene import Scene
from ncgear.mechanisms.mechanism import Mechanism
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


SUPPORT = 0.16
"""Height of a support and half its width, as a share of the crank's length."""

SUPPORT_HATCHES = 6
"""Strokes under a support; a guide has so many in a length of the crank."""


def supports_mm(linkage: Mechanism) -> list[Array]:
    """The lines of the supports of fixed axes and of guides that stand, in mm, shape (n, 2) each."""
    size, lines = SUPPORT * linkage.crank_mm, list[Array]()
    for x, y in linkage.pivots_mm:
        foot = y - size
        lines.append(np.array([(x - size, foot), (x, y), (x + size, foot)]))
        lines.append(np.array([(x - 1.4 * size, foot), (x + 1.4 * size, foot)]))
    return [*lines, *map(np.array, linkage.guides_mm)]


def support_hatches_mm(linkage: Mechanism) -> Array:
    """Slanting strokes that mark supports and guides as parts of the frame, in mm, shape (n, 2, 2)."""
    size = SUPPORT * linkage.crank_mm
    grounds = [((x + 1.4 * size, y - size), (x - 1.4 * size, y - size)) for x, y in linkage.pivots_mm]
    strokes = [np.empty((0, 2, 2))]
    for start, end in map(np.array, (*grounds, *linkage.guides_mm)):
        length = float(np.hypot(*(end - start)))
        along = (end - start) / length
        count = max(SUPPORT_HATCHES, round(SUPPORT_HATCHES * length / linkage.crank_mm))
        foot = start + np.linspace(0.0, length, count + 1)[1:, None] * along
        slant = 0.4 * size * (np.array([-along[1], along[0]]) - along)
        strokes.append(np.stack([foot, foot + slant], axis=1))
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
    linkage, chamber = scene.machine.linkage, scene.chamber
    reach = linkage.crank_mm * (1.0 + CRANK_EYE)
    crank = np.array([[-reach, -reach], [reach, reach]]) if scene.links else np.empty((0, 2))
    standing = [*supports_mm(linkage), support_hatches_mm(linkage).reshape(-1, 2), scene.swept_mm]
    if chamber is not None:
        standing += [wall_mm(chamber), hatches_mm(chamber).reshape(-1, 2)]
    # Two corners of the square in which each gear turns.
    corners = [np.array(gear.axis_mm) + side * gear.body.reach_mm for gear in scene.gears for side in (-1.0, 1.0)]
    gears = np.array(corners).reshape(-1, 2)
    found = {"machine": _box_around(np.vstack([crank, *standing, gears]))}
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
