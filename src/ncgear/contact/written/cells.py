"""Chords of an outline, and which of them are near a place: found in the cells of a square grid."""

from __future__ import annotations

from functools import cached_property
from math import ceil

import numpy as np

from ncgear.frozen import dataclass
from ncgear.numerics.arrays import Array, Columns, ComplexArray, IndexArray, counted_up


@dataclass(frozen=True, eq=False)
class Chords(Columns):
    """Chords by their ``start``, ``direction`` (of length 1) and ``length_mm``, shape (n,) each."""

    start: ComplexArray
    direction: ComplexArray
    length_mm: Array

    @cached_property
    def middle(self) -> ComplexArray:
        """The point in the middle of each chord."""
        return self.start + self.direction * self.half_mm

    @cached_property
    def half_mm(self) -> Array:
        """Half the length of each chord."""
        return self.length_mm / 2.0


def chords_of(outline: ComplexArray, longest_mm: float) -> Chords:
    """The chords of a closed outline, shape (n,), in order; long chords are cut into equal pieces."""
    step = np.roll(outline, -1) - outline
    length = np.abs(step)
    pieces = np.maximum(np.ceil(length / longest_mm), 1.0).astype(int)
    chord, number = counted_up(np.zeros_like(pieces), pieces)
    direction = step / np.maximum(length, np.finfo(float).tiny)
    start = outline[chord] + step[chord] * (number / pieces[chord])
    return Chords(start, direction[chord], (length / pieces)[chord])


TILE = 16
"""Cells along each side of a tile.  Only tiles with named cells take memory: a gear's teeth cover few of them."""


@dataclass(frozen=True, eq=False)
class ChordGrid:
    """A square grid; each cell names a range of chords, which includes all chords near any place in the cell.

    The grid has ``side`` cells of ``cell_mm`` along each axis from its lower left ``corner``.  ``tile`` holds the
    number of the first cell of each tile, shape (tiles, tiles), 0 for all tiles without near chords.  ``first`` numbers
    the first chord of each cell's range and ``beyond`` the chord after its last, shape (cells,) each; both are 0 where
    no chord is near.  Counting continues where the outline begins again.
    """

    corner: complex
    cell_mm: float
    side: int
    tile: IndexArray
    first: IndexArray
    beyond: IndexArray

    def cell(self, places: ComplexArray) -> IndexArray:
        """Numbers of the cells that places lie in, shape (n,); no chord is near cells at the grid's edge."""
        steps = (places - self.corner).view(float) * (1.0 / self.cell_mm)
        number = np.clip(steps, 0.0, self.side - 1.0).astype(int)
        return _numbered(self.tile, number[0::2], number[1::2])


def cells_near(chords: Chords, near_mm: float, cell_mm: float) -> ChordGrid:
    """Cells that name the chords of a closed outline that come as near as ``near_mm`` to them."""
    # Every point of a chord is within half a cell of the middle of one of its pieces.
    count = np.ceil(chords.length_mm / cell_mm).astype(int)
    chord, number = counted_up(np.zeros_like(count), count)
    share = (number + 0.5) / count[chord]
    places = chords.start[chord] + chords.direction[chord] * (share * chords.length_mm[chord])
    around = near_mm + cell_mm / 2.0
    span = ceil(2.0 * around / cell_mm) + 1
    corner = complex(places.real.min(), places.imag.min()) - (around + cell_mm) * (1.0 + 1.0j)
    extent = max(places.real.max() - corner.real, places.imag.max() - corner.imag)
    side = int((extent + around) / cell_mm) + 3
    low = ((places - corner - around * (1.0 + 1.0j)).view(float) / cell_mm).astype(int)
    across, along = (low[at::2, None] + offset.ravel() for at, offset in enumerate(np.indices((span, span))))
    named = np.zeros((side // TILE + 1,) * 2, dtype=int)
    named[across // TILE, along // TILE] = TILE**2
    tile = np.cumsum(named).reshape(named.shape) * (named > 0)
    cell = _numbered(tile, across, along)
    cells = ChordGrid(corner, cell_mm, side, tile, *np.zeros((2, TILE**2 + int(named.sum())), dtype=int))
    _name(cells, cell.ravel(), np.repeat(chord, span * span))
    # Counting continues over the seam where the outline begins again.
    half = chords.length_mm.size // 2
    row, column = np.nonzero(cells.beyond[cell] - cells.first[cell] > half)
    counted_on = chord[row] + np.where(chord[row] < half, chords.length_mm.size, 0)
    order = np.argsort(counted_on, kind="stable")
    _name(cells, cell[row, column][order], counted_on[order])
    return cells


def _numbered(tile: IndexArray, across: IndexArray, along: IndexArray) -> IndexArray:
    """Numbers of cells from their places along both axes."""
    return tile[across // TILE, along // TILE] + across % TILE * TILE + along % TILE


def _name(cells: ChordGrid, cell: IndexArray, chord: IndexArray) -> None:
    """Name the range from the least to the greatest of each cell's chords, which are in ascending order."""
    cells.beyond[cell] = chord + 1
    cells.first[cell[::-1]] = chord[::-1]
