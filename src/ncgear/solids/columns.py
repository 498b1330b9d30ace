"""Columns of a stack of sections: places, the same in every section, between which chords stay close to outlines."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np

from ncgear.numerics.arrays import Array, IndexArray, Mask
from ncgear.solids.pieces import Pieces

SPREADS = 5
"""Rounds of placing columns by what the last ones left; the more even the curves, the fewer are needed."""

HALVINGS = 16
"""Rounds of halving what strays even then, at corners within a piece: down to far below any chord of an outline."""

SPARE, LEAST = 1.05, 1e-3
"""Columns are placed a twentieth closer than they seem to be needed, and on a straight piece at all."""

TINY = float(np.finfo(float).tiny)


@dataclass(frozen=True)
class Limits:
    """What columns are for: how far, in mm, a section's outline may be from its chords, and the middle of a
    quadrilateral between neighbouring sections from its diagonals."""

    sagitta_mm: float
    twist_mm: float


@dataclass(frozen=True, eq=False)
class Columns:
    """Places of columns in order, shape (c,) each: piece and share of its length.  Each piece begins with one."""

    piece: IndexArray
    share: Array

    def rings(self, sections: Sequence[Pieces]) -> Array:
        """Points of the columns in mm on each of l sections, shape (l, c, 2)."""
        return np.stack([section.at(self.piece, self.share) for section in sections])

    def spread(self, wanted: Array) -> Columns:
        """As many columns on each piece as its intervals together want, each interval divided alike.

        ``wanted`` (c,) is into how many parts the interval after each column wants to be divided, whole or not.
        """
        dense = np.maximum(wanted, LEAST) * SPARE
        reached = np.concatenate([[0.0], np.cumsum(dense)])
        begins = np.append(np.nonzero(np.diff(self.piece, prepend=-1))[0], self.piece.size)
        start, total = reached[begins[:-1]], np.diff(reached[begins])
        counts = np.ceil(total).astype(int)
        piece, step = _numbered(counts)
        target = start[piece] + (total / counts)[piece] * step
        place = np.interp(target, reached, np.append(self.piece + self.share, counts.size))
        return Columns(piece, np.where(step == 0, 0.0, place - piece))

    def halved(self, wide: Mask) -> Columns:
        """With the intervals halved after the columns that are marked, shape (c,)."""
        after = np.append(self.share[1:], 0.0)
        middle = (self.share + np.where(after > 0.0, after, 1.0)) / 2.0
        row, step = _numbered(np.where(wide, 2, 1))
        return Columns(self.piece[row], np.where(step == 0, self.share[row], middle[row]))


def spread_columns(sections: Sequence[Pieces], limits: Limits) -> Columns:
    """Columns about as far apart as the limits allow, by the sections they are for."""
    columns = Columns(np.arange(sections[0].count), np.zeros(sections[0].count))
    for _ in range(SPREADS):
        columns = columns.spread(_wanted(columns, sections, limits))
    return columns


def close_columns(columns: Columns, sections: Sequence[Pieces], limits: Limits) -> Columns:
    """The columns with others halfway between them until the limits are kept on all sections.

    Raises RuntimeError, a fault of ncgear, if they cannot be kept so.
    """
    for _ in range(HALVINGS):
        wide = _wanted(columns, sections, limits) > 1.0
        if not wide.any():
            return columns
        columns = columns.halved(wide)
    raise RuntimeError(f"a section's outline strays from its chords even after {HALVINGS} halvings")


def _wanted(columns: Columns, sections: Sequence[Pieces], limits: Limits) -> Array:
    """Into how many parts each interval would have to be divided, shape (c,).

    A sagitta falls with the square of the interval, a twist in proportion to it.
    """
    rings = columns.rings(sections)
    sagitta = np.max([sagittas(columns, *pair) for pair in zip(sections, rings, strict=True)], axis=0)
    return np.asarray(np.maximum(np.sqrt(sagitta / limits.sagitta_mm), twists(rings) / limits.twist_mm))


def sagittas(columns: Columns, section: Pieces, ring: Array) -> Array:
    """Largest distance in mm of a section's outline from the chord after each column, shape (c,)."""
    at = section.lengths_at(columns.piece, columns.share)
    chord = np.searchsorted(at, section.length_mm[:-1], side="right") - 1
    start, step = ring[chord], (np.roll(ring, -1, axis=0) - ring)[chord]
    arm = section.points_mm[:-1] - start
    along = np.sum(arm * step, axis=1) / np.maximum(np.sum(step * step, axis=1), TINY)
    away = arm - np.clip(along, 0.0, 1.0)[:, None] * step
    largest = np.zeros(len(ring))
    np.maximum.at(largest, chord, np.hypot(away[:, 0], away[:, 1]))
    return largest


def twists(rings: Array) -> Array:
    """How far the middle of the quadrilaterals after each column is from their diagonals', the most of all layers.

    Shape (c,), in mm; only what is across the chords counts, since what is along them lies in the surface.
    """
    chord = np.roll(rings, -1, axis=1) - rings
    lower, upper = chord[:-1], chord[1:]
    across = np.abs(lower[..., 0] * upper[..., 1] - lower[..., 1] * upper[..., 0])
    length = np.linalg.norm(lower + upper, axis=-1) / 2.0
    return np.asarray(np.max(across / np.maximum(length, TINY), axis=0) / 4.0)


def _numbered(counts: IndexArray) -> tuple[IndexArray, IndexArray]:
    """Each row as often as it counts, and the numbers from 0 within it."""
    row = np.repeat(np.arange(counts.size), counts)
    return row, np.arange(row.size) - np.repeat(np.cumsum(counts) - counts, counts)
