"""Outlines of one gear's sections cut at corresponding places, so that a point of one has its like in all others.

Each tooth is cut where its lands end and where flank and fillet join, tangentially or in the corner that an undercut
leaves.  Between two such places every section has one piece of outline, and a place in it is named by its share of the
piece's length.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from scipy.spatial import cKDTree

from ncgear.numerics.arrays import Array, IndexArray
from ncgear.numerics.plane import signed_area
from ncgear.teeth.flank import FILLET
from ncgear.teeth.gear import ToothedGear

AGREEMENT = 1e-7
"""Distance, in modules, at which a place computed from the exact curves counts as a vertex of the outline: rounding
of gears of up to a thousand modules, far below any chord."""

PER_TOOTH = 6
"""Places on each tooth."""


@dataclass(frozen=True, eq=False)
class Pieces:
    """An outline from its first place round to it again, in the sense of growing arc length of the pitch curve.

    ``points_mm`` has shape (n + 1, 2), first point repeated; ``length_mm`` (n + 1,) is the outline's length up to each
    point, ``cut_mm`` (pieces + 1,) that up to each place and to the end.
    """

    points_mm: Array
    length_mm: Array
    cut_mm: Array

    @property
    def count(self) -> int:
        """Number of pieces, six for each tooth."""
        return len(self.cut_mm) - 1

    def lengths_at(self, piece: IndexArray, share: Array) -> Array:
        """Lengths along the outline at shares (0 to 1) of pieces, shape (c,)."""
        start, end = self.cut_mm[piece], self.cut_mm[piece + 1]
        return np.asarray(start + (end - start) * share)

    def at(self, piece: IndexArray, share: Array) -> Array:
        """Points at shares of pieces, shape (c, 2)."""
        along = self.lengths_at(piece, share)
        return np.column_stack([np.interp(along, self.length_mm, column) for column in self.points_mm.T])


def pieces_of(gear: ToothedGear) -> Pieces:
    """The outline of a gear cut at its teeth's places.

    Raises RuntimeError, a fault of ncgear, where these are not found on it in their order.
    """
    places = _places(gear)
    outline = gear.outline_mm if signed_area(places) > 0.0 else gear.outline_mm[::-1]
    distance, vertex = cKDTree(outline).query(places)
    if np.max(distance) > AGREEMENT * gear.flanks.rack.module_mm:
        raise RuntimeError(f"a tooth's corner is {np.max(distance):.3g} mm away from its outline")
    cut = np.append(np.mod(vertex - vertex[0], len(outline)), len(outline))
    if np.any(np.diff(cut) < 0):
        raise RuntimeError(f"the corners of tooth {int(np.argmin(np.diff(cut))) // PER_TOOTH + 1} are out of order")
    points = np.roll(outline, -vertex[0], axis=0)
    closed = np.concatenate([points, points[:1]])
    length = np.concatenate([[0.0], np.cumsum(np.linalg.norm(np.diff(closed, axis=0), axis=1))])
    return Pieces(closed, length, length[cut])


def _places(gear: ToothedGear) -> Array:
    """Back root, back joint, back tip, front tip, front joint, front root of each tooth in turn, shape (6 z, 2)."""
    sides, flanks = gear.sides, gear.flanks
    every = np.arange(flanks.count)
    first, after = np.searchsorted(sides.owner, every), np.searchsorted(sides.owner, every, side="right")
    before_fillet = np.concatenate([[0], np.cumsum(sides.kind != FILLET)])
    joint = np.minimum(first + before_fillet[after] - before_fillet[first], after - 1)
    run = np.stack([first, joint, after - 1], axis=1)
    parameter = np.stack([sides.start[first], sides.start[joint], sides.end[after - 1]], axis=1)
    point = flanks.curve_of(sides.kind[run.ravel()], np.repeat(every, 3), parameter.ravel())[0].reshape(-1, 3, 2)
    point[0::2] = point[0::2, ::-1]
    return point.reshape(-1, 2)
