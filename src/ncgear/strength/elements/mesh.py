"""Meshes of quadrilaterals for all teeth of a gear, mapped onto the exact outline without a mesher.

The meshes of all teeth differ only in the places of their nodes, so that all are assembled at once.  A tooth consists
of two grids.  The upper one joins the two sides from their corners, half-way through the fillets, up to the tip.  The
lower one is a strip of body, two pitches to either side of the tooth's middle.  It has stumps of the neighbouring
teeth, up to their corners; beyond their middles its outline follows the circle through the three stumps.  Its columns
run from the outline to another circle below the roots, towards the common centre, and its middle columns carry the
upper grid.  The strip is held at its bottom and at both of its ends.
"""

from __future__ import annotations

from dataclasses import replace
from typing import TypeVar

import numpy as np

from ncgear.frozen import dataclass
from ncgear.numerics.arrays import Array, ComplexArray, IndexArray, Mask
from ncgear.numerics.plane import along, angle_between
from ncgear.strength.elements.landmarks import MarkedOutline

Values = TypeVar("Values", Array, ComplexArray)
"""Numbers or places."""


@dataclass(frozen=True)
class MeshSize:
    """Numbers of elements, and their order: 1 for straight elements of four nodes, 2 for curved elements of nine.

    The defaults are the coarsest useful mesh; ``times`` makes finer meshes.

    ``across`` (even) counts elements from side to side of the tooth, ``flank`` along each flank, ``fillet`` from each
    flank's foot to the corner, and ``valley`` from there to the middle of the root land.  ``beyond`` counts three
    times: from there to the neighbour's corner, on to its middle, and over one pitch more.  ``deep`` counts from the
    roots to the held bottom.
    """

    order: int = 2
    across: int = 4
    flank: int = 4
    fillet: int = 2
    valley: int = 2
    beyond: int = 1
    deep: int = 3

    def times(self, finer: int) -> MeshSize:
        """The mesh with each element cut into ``finer`` by ``finer`` elements."""
        counts = {name: finer * getattr(self, name) for name in self.__dict__ if name != "order"}
        return replace(self, **counts)


@dataclass(frozen=True, eq=False)
class Topology:
    """The common part of the meshes of all teeth.

    ``cells`` (shape (e, (order + 1)^2)) numbers the nodes of each element, row by row of its own small grid; ``own``
    numbers the elements between the middles of both spaces beside the tooth.  ``held`` marks the fixed nodes.
    ``sides`` (shape (2, k)) numbers the nodes along the back and the front side, from the middle of the root land to
    the tip; the first ``root_nodes`` of them reach the foot.  ``middle`` numbers the nodes from the tip's middle down
    to the bottom.
    """

    order: int
    cells: IndexArray
    own: IndexArray
    held: Mask
    sides: IndexArray
    root_nodes: int
    middle: IndexArray


def topology_of(size: MeshSize) -> Topology:
    """The mesh of any tooth."""
    p = size.order
    aside = size.valley + 3 * size.beyond
    columns, rows = 2 * aside + size.across, size.deep
    strip = np.arange((columns * p + 1) * (rows * p + 1)).reshape(columns * p + 1, rows * p + 1)
    first, last = aside * p, (aside + size.across) * p
    upper = (size.fillet + size.flank) * p
    tooth = strip.size + np.arange(upper * (size.across * p + 1)).reshape(upper, -1)
    tooth = np.concatenate([strip[None, first : last + 1, 0], tooth])
    held = np.zeros(tooth.max() + 1, dtype=bool)
    held[strip[:, -1]] = held[strip[0]] = held[strip[-1]] = True
    valley = size.valley * p
    back = np.concatenate([strip[first - valley : first, 0], tooth[:, 0]])
    front = np.concatenate([strip[last + valley : last : -1, 0], tooth[:, -1]])
    half = size.across * p // 2
    middle = np.concatenate([tooth[::-1, half], strip[first + half, 1:]])
    cells = np.concatenate([cells_of(strip, p), cells_of(tooth, p)])
    # The strip's elements are numbered column by column.
    beyond = 3 * size.beyond * rows
    own = np.concatenate([np.arange(beyond, columns * rows - beyond), np.arange(columns * rows, len(cells))])
    return Topology(p, cells, own, held, np.stack([back, front]), valley + size.fillet * p + 1, middle)


def cells_of(grid: IndexArray, order: int) -> IndexArray:
    """The elements of a grid of node numbers, shape (e, (order + 1)^2)."""
    windows = np.lib.stride_tricks.sliding_window_view(grid, (order + 1, order + 1))[::order, ::order]
    return windows.reshape(-1, (order + 1) ** 2)


SAG = 0.03
"""Sag of the line between both corners of a tooth, as a share of its length.  A straight line would fold elements of
the baler's undercut teeth; more sag would disturb the stress beside the corners more."""

LEAST_BOTTOM = 0.35
"""Least radius of the held circle, as a share of the radius at the roots; else columns of sharp gears would meet."""

STRAIGHT = 1e-6
"""Curvature, times the module, that a line of roots is given at least, so that its circle has a centre."""


NEAR_CORNERS, NEAR_ROOTS, NEAR_SIDES = 1.5, 2.2, 1.6
"""Powers that make elements denser at the corners along valleys, at the roots downwards, and at sides across: then the
elements that meet in a corner have about the same size."""


def nodes_of(outline: MarkedOutline, size: MeshSize, module_mm: float, depth_mm: float) -> ComplexArray:
    """Places of the nodes of all z teeth in mm, shape (z, nodes), in the order of ``topology_of``.

    The body is held ``depth_mm`` below the line through the teeth's corners, or less where the gear is curved sharply.
    """
    p = size.order
    back, front = (outline.at(outline.corner_mm[:, side]) for side in (0, 1))
    stump = (back + front) / 2.0
    center = stump + _to_center(stump, outline.axis, module_mm)
    # Both halves of the strip's outline, from the corners outwards.
    valley, corner = outline.valley_mm, outline.corner_mm
    down, flat = _stations(size.valley, p, NEAR_CORNERS), _stations(size.beyond, p)
    halves = []
    for side, turn in ((0, 1), (1, -1)):
        across = np.roll(corner[:, 1 - side] - valley[:, 1 - side], turn)
        near = _between(corner[:, side], valley[:, side], down)
        far = _between(valley[:, side], valley[:, side] + across, flat)
        root = outline.at(np.concatenate([near[:, 1:], far[:, 1:]], axis=1))
        arm = np.roll(stump, turn) - center
        pitch_rad = angle_between(stump - center, arm)[:, None]
        circle = center[:, None] + arm[:, None] * np.exp(1j * pitch_rad * flat)
        halves.append(np.concatenate([root, _between(root[:, -1], circle[:, 0], flat)[:, 1:], circle[:, 1:]], axis=1))
    half = _stations(size.across // 2, p, NEAR_SIDES) / 2.0
    u = np.concatenate([half, 1.0 - half[-2::-1]])
    floor = _between(back, front, u) - outline.axis[:, None] * np.abs(front - back)[:, None] * SAG * 4.0 * u * (1.0 - u)
    outside = np.concatenate([halves[0][:, ::-1], floor, halves[1]], axis=1) - center[:, None]
    radius, below = np.abs(stump - center), along(center - stump, outline.axis) < 0.0
    held = np.where(below, np.maximum(radius - depth_mm, LEAST_BOTTOM * radius), radius + depth_mm)
    inside = outside / np.abs(outside) * held[:, None]
    strip = center[:, None, None] + _between(outside, inside, _stations(size.deep, p, NEAR_ROOTS))
    tooth = _upper(outline, size, floor, u)
    return np.concatenate([strip.reshape(len(strip), -1), tooth[:, 1:].reshape(len(strip), -1)], axis=1)


def _upper(outline: MarkedOutline, size: MeshSize, floor: ComplexArray, u: Array) -> ComplexArray:
    """Nodes of the upper grids, shape (z, rows, columns): blended from their four exact edges."""
    fillet, flank = (_stations(count, size.order) for count in (size.fillet, size.flank))
    corner, foot, tip = outline.corner_mm, outline.foot_mm, outline.tip_mm
    places = [
        np.concatenate([_between(corner[:, s], foot[:, s], fillet), _between(foot[:, s], tip[:, s], flank)[:, 1:]], 1)
        for s in (0, 1)
    ]
    sides = [outline.at(place) for place in places]
    land = outline.at(_between(tip[:, 0], tip[:, 1], u))
    ways = [(place - place[:, :1]) / (place[:, -1:] - place[:, :1]) for place in places]
    v = ((ways[0] + ways[1]) / 2.0)[:, :, None]
    left, right = sides[0][:, :, None], sides[1][:, :, None]
    bottom, top = floor[:, None, :], land[:, None, :]
    corners = (1.0 - v) * _between(floor[:, 0], floor[:, -1], u)[:, None]
    corners = corners + v * _between(land[:, 0], land[:, -1], u)[:, None]
    return np.asarray((1.0 - u) * left + u * right + (1.0 - v) * bottom + v * top - corners)


def _to_center(stump: ComplexArray, axis: ComplexArray, module_mm: float) -> ComplexArray:
    """From the stump of each tooth to the centre of the circle through it and both of its neighbours', shape (z,)."""
    before, behind = np.roll(stump, 1) - stump, np.roll(stump, -1) - stump
    # The circle's curvature as a vector towards its centre c: 1 / conj(c).
    bent = 2j * np.imag(before * np.conj(behind)) / (np.conj(before * behind) * (before - behind))
    bent = np.where(np.abs(bent) * module_mm < STRAIGHT, -axis * STRAIGHT / module_mm, bent)
    return np.asarray(1.0 / np.conj(bent))


def _between(first: Values, last: Values, share: Array) -> Values:
    """Values at shares of the ways from first to last, shape (..., shares)."""
    return np.asarray(first[..., None] + (last - first)[..., None] * share)


def _stations(count: int, order: int, power: float = 1.0) -> Array:
    """Places of the nodes of ``count`` elements along a way, from 0 to 1; denser at the start by a power."""
    ends = np.linspace(0.0, 1.0, count + 1) ** power
    return np.interp(np.arange(count * order + 1) / order, np.arange(count + 1), ends)
