"""Outlines of one gear's sections cut at corresponding places, so that a point of one has its like in all others.

A tooth is cut where its lands end and where flank and fillet join, tangentially or in the corner that an undercut
leaves; that gives six pieces.  Each is cut once more, at its sharpest corner where it has one (a fold that was trimmed
away) and else where it would be by the nearest section that has one, or in the middle.  Between two such places every
section has one piece of outline, and a place in it is named by its share of the piece's length.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np
from scipy.spatial import cKDTree

from ncgear.numerics.arrays import Array, IndexArray
from ncgear.teeth.flank import FILLET
from ncgear.teeth.gear import ToothedGear

AGREEMENT = 1e-7
"""Distance, in modules, at which a place computed from the exact curves counts as a vertex of the outline: rounding
of gears of up to a thousand modules, far below any chord."""

PER_TOOTH = 6
"""Places that are found on each tooth."""


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
        """Number of pieces."""
        return len(self.cut_mm) - 1

    def lengths_at(self, piece: IndexArray, share: Array) -> Array:
        """Lengths along the outline at shares (0 to 1) of pieces, shape (c,)."""
        start, end = self.cut_mm[piece], self.cut_mm[piece + 1]
        return np.asarray(start + (end - start) * share)

    def at(self, piece: IndexArray, share: Array) -> Array:
        """Points at shares of pieces, shape (c, 2)."""
        along = self.lengths_at(piece, share)
        return np.column_stack([np.interp(along, self.length_mm, column) for column in self.points_mm.T])

    def cut_again(self, share: Array) -> Pieces:
        """With each piece cut in two at a share of its length, shape (pieces,)."""
        middle = self.lengths_at(np.arange(self.count), share)
        both = np.column_stack([self.cut_mm[:-1], middle]).ravel()
        return Pieces(self.points_mm, self.length_mm, np.append(both, self.cut_mm[-1]))


def pieces_of(sections: Sequence[ToothedGear]) -> list[Pieces]:
    """The outlines of one gear's sections at rising heights, cut at the same places.

    Raises RuntimeError, a fault of ncgear, where these are not found on an outline in their order.
    """
    found = [_cut(section) for section in sections]
    shares = _filled(np.stack([corner for _, corner in found]))
    return [pieces.cut_again(share) for (pieces, _), share in zip(found, shares, strict=True)]


def _cut(gear: ToothedGear) -> tuple[Pieces, Array]:
    """The outline cut at the places of its teeth, and the share at which each piece has a corner, NaN without one."""
    places, joints = _places(gear)
    outline = gear.outline_mm if _signed_area(places) > 0.0 else gear.outline_mm[::-1]
    outline = np.roll(outline, -_vertices(outline, places[:1], gear)[0], axis=0)
    cut = np.append(_vertices(outline, places, gear), len(outline))
    if np.any(np.diff(cut) < 0):
        raise RuntimeError(f"the corners of tooth {int(np.argmin(np.diff(cut))) // PER_TOOTH + 1} are out of order")
    closed = np.concatenate([outline, outline[:1]])
    length = np.concatenate([[0.0], np.cumsum(np.linalg.norm(np.diff(closed, axis=0), axis=1))])
    return Pieces(closed, length, length[cut]), _corners(outline, length, cut, _vertices(outline, joints, gear))


def _places(gear: ToothedGear) -> tuple[Array, Array]:
    """Back root, back joint, back tip, front tip, front joint, front root of each tooth in turn, and where runs begin.

    Shapes (6 z, 2) and (runs, 2).
    """
    sides, flanks = gear.sides, gear.flanks
    begin = flanks.curve_of(sides.kind, sides.owner, sides.start)[0]
    every = np.arange(flanks.count)
    first, after = np.searchsorted(sides.owner, every), np.searchsorted(sides.owner, every, side="right")
    before_fillet = np.concatenate([[0], np.cumsum(sides.kind != FILLET)])
    joint = np.minimum(first + before_fillet[after] - before_fillet[first], after - 1)
    root = flanks.curve_of(sides.kind[after - 1], every, sides.end[after - 1])[0]
    inwards = np.stack([begin[first], begin[joint], root], axis=1)
    inwards[0::2] = inwards[0::2, ::-1]
    return inwards.reshape(-1, 2), begin


def _vertices(outline: Array, places: Array, gear: ToothedGear) -> IndexArray:
    """Numbers of the vertices at places (p, 2)."""
    distance, vertex = cKDTree(outline).query(places)
    if np.max(distance) > AGREEMENT * gear.flanks.rack.module_mm:
        raise RuntimeError(f"a tooth's corner is {np.max(distance):.3g} mm away from its outline")
    return np.asarray(vertex)


def _corners(outline: Array, length: Array, cut: IndexArray, joints: IndexArray) -> Array:
    """Share of each piece at which its sharpest joint of two runs stands, NaN where there is none inside."""
    chord = np.roll(outline, -1, axis=0) - outline
    before, after = np.roll(chord, 1, axis=0)[joints], chord[joints]
    turn = np.abs(np.arctan2(before[:, 0] * after[:, 1] - before[:, 1] * after[:, 0], np.sum(before * after, axis=1)))
    ordered = joints[np.argsort(turn)]
    inside = ordered[~np.isin(ordered, cut)]
    piece = np.searchsorted(cut, inside, side="right") - 1
    start, end = length[cut[piece]], length[cut[piece + 1]]
    share = np.full(len(cut) - 1, np.nan)
    # The sharpest comes last and stays.
    share[piece] = (length[inside] - start) / (end - start)
    return share


def _filled(shares: Array) -> Array:
    """Shares of sections (l, p) with those of the nearest section that has one in place of NaN, 1/2 if none has."""
    apart = np.abs(np.arange(len(shares))[:, None] - np.arange(len(shares)))[..., None]
    nearest = np.argmin(np.where(np.isnan(shares)[None], np.inf, apart), axis=1)
    filled = np.take_along_axis(shares, nearest, axis=0)
    return np.where(np.isnan(filled), 0.5, filled)


def _signed_area(points: Array) -> float:
    x, y = points.T
    return float(np.sum(x * np.roll(y, -1) - y * np.roll(x, -1))) / 2.0
