"""The fixed parts of a scene, the boxes of its views, and contours with only the points that a picture needs.

The walls beside a slider, the supports of axes and other guides are hatched like the ground in a drawing.  Straw in
front of the slider has a grain, which shows how the slider presses it.
"""

from __future__ import annotations

from collections.abc import Sequence
from functools import lru_cache
from math import pi

import numpy as np
import shapely

from ncgear.drawings.scene.bodies import CRANK_EYE, Chamber
from ncgear.drawings.scene.scene import Scene
from ncgear.mechanisms.mechanism import Mechanism
from ncgear.numerics.arrays import Array


def simplified(contours_mm: Sequence[Array], tolerance_mm: float) -> list[Array]:
    """Contours (shape (n, 2) each) without points that are within the tolerance of the rest; the first point stays."""
    closed = [shapely.linestrings(np.vstack([contour, contour[:1]])) for contour in contours_mm]
    # Lines take a seventh of the time of polygons, for which crossings must be prevented.
    return [
        shapely.get_coordinates(shapely.simplify(line, tolerance_mm, preserve_topology=False))[:-1] for line in closed
    ]


HATCHES = 44
"""Number of strokes along a wall."""

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


WALL_GAP = 0.03
"""Least gap between a wall and a part that moves through it, as a share of the crank's length."""


@lru_cache(maxsize=1)
def walls_mm(scene: Scene) -> list[Array]:
    """The open lines of the chamber's walls in mm, shape (n, 2) each; none without a chamber.

    Two sides, and an end where there is material; for a table only the lower side.  Where there is material behind the
    slider, a wall closes it in, with an opening for the links that pass.  A side begins where no link reaches it: a rod
    that swings out passes before it, not through it.
    """
    chamber = scene.chamber
    if chamber is None:
        return []
    low, high = _sides_mm(chamber)
    low_start, high_start = wall_starts_mm(scene, chamber)
    end = chamber.end_mm
    if chamber.pushed_mm is not None:
        return [np.array([[low_start, low], [end, low]])]
    lower, upper = np.array([[low_start, low], [end, low]]), np.array([[end, high], [high_start, high]])
    walls = [np.vstack([lower, upper])] if chamber.begins_mm is not None else [lower, upper]
    if chamber.behind_mm is not None:
        start, (below, above) = chamber.start_mm, _opening_mm(scene, chamber)
        walls += [np.array([[start, low], [start, below]])] if low < below and low_start == start else []
        walls += [np.array([[start, above], [start, high]])] if above < high and high_start == start else []
    return walls


def _sides_mm(chamber: Chamber) -> tuple[float, float]:
    half = chamber.height_mm / 2.0
    return chamber.linkage.offset_mm - half, chamber.linkage.offset_mm + half


def wall_starts_mm(scene: Scene, chamber: Chamber) -> tuple[float, float]:
    """Starts of the lower and the upper side: the chamber's start, or beyond the last place that a link reaches.

    The output, which slides between them, does not count.
    """
    gap = WALL_GAP * chamber.linkage.crank_mm
    low, high = _sides_mm(chamber)
    others = [scene.swept_mm[link.name] for link in scene.links[1:]]

    def start(level_mm: float) -> float:
        reached = [crossings(moved[..., ::-1], level_mm) for moved in others]
        return float(max(chamber.start_mm, *(places.max(initial=-np.inf) + gap for places in reached)))

    return start(low + gap), start(high - gap)


def _opening_mm(scene: Scene, chamber: Chamber) -> tuple[float, float]:
    """The lowest and the highest level at which a link passes the chamber's start, with a gap."""
    gap = WALL_GAP * chamber.linkage.crank_mm
    just_before = chamber.start_mm - 1e-6 * chamber.linkage.stroke_mm
    levels = np.concatenate([crossings(moved, just_before) for moved in scene.swept_mm.values()])
    middle = chamber.linkage.offset_mm
    return float(levels.min(initial=middle)) - gap, float(levels.max(initial=middle)) + gap


def crossings(closed_mm: Array, x_mm: float) -> Array:
    """The y at which closed contours (points in mm, shape (m, n, 2)) cross a line x = ``x_mm``, shape (k,)."""
    following = np.roll(closed_mm, -1, axis=1)
    (x0, y0), (x1, y1) = np.moveaxis(closed_mm, -1, 0), np.moveaxis(following, -1, 0)
    crossing = (x0 < x_mm) != (x1 < x_mm)
    share = (x_mm - x0[crossing]) / (x1[crossing] - x0[crossing])
    return y0[crossing] + share * (y1 - y0)[crossing]


def hatches_mm(scene: Scene) -> Array:
    """Slanting strokes outside both sides, in mm, shape (n, 2, 2); they mark the walls as parts of the frame."""
    chamber = scene.chamber
    if chamber is None:
        return np.empty((0, 2, 2))
    length, strokes = HATCH_LENGTH * chamber.height_mm, []
    feet = np.linspace(chamber.start_mm, chamber.end_mm, HATCHES + 1)[1:]
    sides = list(zip(_sides_mm(chamber), wall_starts_mm(scene, chamber), (-length, length), strict=True))
    for side, start, across in sides if chamber.pushed_mm is None else sides[:1]:
        foot = feet[feet >= start]
        level = np.full_like(foot, side)
        strokes.append(np.stack([np.stack([foot, level], -1), np.stack([foot - length, level + across], -1)], axis=1))
    return np.concatenate(strokes)


SUPPORT = 0.16
"""Height of a support and half its width, as a share of the crank's length."""

SUPPORT_HATCHES = 6
"""Number of strokes under a support; a guide has as many in a length of the crank."""


def supports_mm(linkage: Mechanism) -> list[Array]:
    """The lines of the supports of fixed axes and of fixed guides, in mm, shape (n, 2) each."""
    size, lines = SUPPORT * linkage.crank_mm, list[Array]()
    for x, y in linkage.pivots_mm.values():
        foot = y - size
        lines.append(np.array([(x - size, foot), (x, y), (x + size, foot)]))
        lines.append(np.array([(x - 1.4 * size, foot), (x + 1.4 * size, foot)]))
    return [*lines, *map(np.array, linkage.guides_mm)]


def support_hatches_mm(linkage: Mechanism) -> Array:
    """Slanting strokes that mark supports and guides as parts of the frame, in mm, shape (n, 2, 2)."""
    size = SUPPORT * linkage.crank_mm
    grounds = [((x + 1.4 * size, y - size), (x - 1.4 * size, y - size)) for x, y in linkage.pivots_mm.values()]
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
    return np.clip(np.stack([middle - half, middle + half], axis=1), low, high)


SLACK = 0.03
"""Room around the parts in a view, as a share of the larger side of their box."""

MESH_IN_MODULES = 9.0
"""Width and height of the view of the mesh, in modules."""

Box = tuple[float, float, float, float]
"""Left, bottom, width and height in mm of the frame of the scene."""


@lru_cache(maxsize=1)
def views(scene: Scene) -> dict[str, Box]:
    """The boxes of the views: the whole machine, and where there are gears, all gears and the mesh.

    The box of the mesh is about the origin; it has to be moved to the pitch point.  Where the gears of a shaft by
    itself cannot be made, there is nothing to see: the box is a square about its axis.
    """
    linkage = scene.machine.linkage
    reach = linkage.crank_mm * (1.0 + CRANK_EYE)
    square = np.array([[-reach, -reach], [reach, reach]])
    crank = square if scene.links or not scene.pairs else np.empty((0, 2))
    lines, strokes = [*supports_mm(linkage), *walls_mm(scene)], [support_hatches_mm(linkage), hatches_mm(scene)]
    standing = [*lines, *(some.reshape(-1, 2) for some in (*strokes, *scene.swept_mm.values()))]
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
