"""Pairs of chords of two outlines that are near each other where the gears mesh, in any positions.

Positions may follow each other so closely that one set of pairs serves a stretch of them.
"""

from __future__ import annotations

from dataclasses import dataclass
from functools import cached_property

import numpy as np
from numpy.lib.stride_tricks import sliding_window_view

from ncgear.contact.placement import Placement
from ncgear.contact.written.chords import Cells, Chords, PolarOutline, cells_near, chords_of, polar_outline
from ncgear.numerics.arrays import Array, ComplexArray, IndexArray, counted_up
from ncgear.numerics.plane import across, square

LONGEST_IN_PITCHES = 0.15
"""Longer chords of the driving outline are cut into pieces: one long chord would make all of them have many pairs."""

CELL_IN_PITCHES = 0.15
"""Size of the cells by which pairs are found; smaller ones find fewer pairs that are not near and take longer to make.
"""

ROUNDING = 1e-6
"""Share of the reach by which chords count as longer, so that rounding errors leave no gap where two of them join."""

STRETCHES = 9, 3, 1
"""Numbers of positions in a stretch, of which the greatest is taken that leaves chords near each other."""


@dataclass(frozen=True, eq=False)
class MeshedOutlines:
    """The chords of both outlines, with the material on their left, where ``placement`` puts them.

    Long chords of the driving outline are cut into pieces.
    """

    placement: Placement
    driving: Chords
    driven: Chords

    @cached_property
    def driven_twice(self) -> Chords:
        """The driven outline's chords twice round, as cells count them."""
        return Chords.joined([self.driven, self.driven])

    @cached_property
    def _polar(self) -> PolarOutline:
        return polar_outline(self.driving.start)

    def mesh_windows(self, position: IndexArray, reach_mm: float) -> tuple[IndexArray, IndexArray]:
        """First numbers and counts of the driving chords that are looked at in any of k positions, shape (n, k).

        They are those in the sector that a circle of radius ``reach_mm`` about the pitch point spans from the driving
        axis: half a turn to either side where the axis is within it.
        """
        share = reach_mm / self.placement.driving_radius_mm[position]
        half_width = np.where(share < 1.0, np.arcsin(np.minimum(share, 1.0)), np.pi)
        direction = self.placement.mesh_direction_rad[position]
        low, high = (direction - half_width).min(axis=1), (direction + half_width).max(axis=1)
        first, count = self._polar.windows((low + high) / 2.0, (high - low) / 2.0)
        return first % self.driving.start.size, count


def meshed_outlines(driving: ComplexArray, driven: ComplexArray, placement: Placement) -> MeshedOutlines:
    """Two outlines by their vertices, shape (n,), in their own frames, with the material on their left."""
    pieces = chords_of(driving, LONGEST_IN_PITCHES * placement.pitch_mm)
    return MeshedOutlines(placement, pieces, chords_of(driven, np.inf))


@dataclass(frozen=True, eq=False)
class Stretches:
    """Stretches of k positions each, and the driving chords that are looked at in them.

    ``position`` numbers the positions, shape (stretches, k); the last may be repeated.  ``width`` driving chords are
    looked at, from number ``first`` on; ``windows`` are their middles, shape (chords, width), for every first chord.
    As the driven gear sees them, points move about a ``pole`` of the driving gear's frame: from where they are in the
    middle of the stretch by no more than ``shift_mm`` and ``turn_rad`` times their distance from the pole.  No chord
    that is looked at moves farther than ``moved_mm``.
    """

    outlines: MeshedOutlines
    position: IndexArray
    first: IndexArray
    width: int
    pole: ComplexArray
    shift_mm: Array
    turn_rad: Array

    @property
    def middle(self) -> IndexArray:
        """The position in the middle of each stretch."""
        return self.position[:, self.position.shape[1] // 2]

    @cached_property
    def windows(self) -> ComplexArray:
        """See the class."""
        middle = self.outlines.driving.middle
        return sliding_window_view(np.concatenate([middle, middle[: self.width - 1]]), self.width)

    @cached_property
    def moved_mm(self) -> float:
        """See the class."""
        if self.position.shape[1] == 1:
            return 0.0
        from_pole = square(self.windows[self.first] - self.pole[:, None]).max(axis=1)
        farthest = np.sqrt(from_pole) + self.outlines.driving.half_mm.max()
        return float((self.shift_mm + self.turn_rad * farthest).max())

    def cells(self, reach_mm: float) -> Cells:
        """Cells that name the driven chords that may be as near to driving ones as ``reach_mm``."""
        margin = float(self.outlines.driving.half_mm.max()) + self.moved_mm
        return cells_near(self.outlines.driven, reach_mm + margin, CELL_IN_PITCHES * self.outlines.placement.pitch_mm)


def stretches_of(outlines: MeshedOutlines, position: IndexArray, reach_mm: float, most_mm: float) -> Stretches:
    """The longest stretches of positions, shape (n,), in which no chord moves farther than ``most_mm``.

    Outlines are compared within the sector of the driving gear that ``reach_mm`` from the pitch point spans.
    """
    for length in STRETCHES:
        number = np.arange(-(-position.size // length) * length).reshape(-1, length)
        rows = position[np.minimum(number, position.size - 1)]
        first, count = outlines.mesh_windows(rows, reach_mm)
        found = Stretches(outlines, rows, first, int(count.max()), *_moving(outlines.placement, rows))
        if found.moved_mm <= most_mm:
            break
    return found


def _moving(placement: Placement, position: IndexArray) -> tuple[ComplexArray, Array, Array]:
    """The pole of each stretch, and its ``shift_mm`` and ``turn_rad``."""
    middle = position[:, position.shape[1] // 2]
    pole = placement.driving_radius_mm[middle] * np.exp(1j * placement.mesh_direction_rad[middle])
    one = np.ones(1, dtype=complex)
    shift = placement.driving_points(pole[:, None], position) - placement.driving_points(pole, middle)[:, None]
    turn = placement.driving_directions(one, position) - placement.driving_directions(one, middle)[:, None]
    return pole, np.abs(shift).max(axis=1), np.abs(turn).max(axis=1)


@dataclass(frozen=True, eq=False)
class Pairs:
    """Pairs of chords by their numbers, the driven ones counted twice round, and their stretch; shape (n,) each."""

    row: IndexArray
    driving: IndexArray
    driven: IndexArray

    def at_each(self, length: int) -> Pairs:
        """Each pair at each position of its stretch, with the number of the position instead."""
        position = (self.row[:, None] * length + np.arange(length)).ravel()
        return Pairs(position, np.repeat(self.driving, length), np.repeat(self.driven, length))


def near_pairs(stretches: Stretches, cells: Cells, rows: IndexArray, reach_mm: float) -> Pairs:
    """All pairs of chords that come as near as ``reach_mm`` somewhere in some stretches, and a few more.

    ``rows`` choose the stretches, which pairs number from 0 on.
    """
    driving, driven = stretches.outlines.driving, stretches.outlines.driven_twice
    placement, first, middle = stretches.outlines.placement, stretches.first[rows], stretches.middle[rows]
    places = placement.driving_points(stretches.windows[first], middle[:, None]).ravel()
    cell = cells.cell(places)
    kept = np.nonzero(cells.beyond[cell])[0]
    row, column = np.divmod(kept, stretches.width)
    chord = (first[row] + column) % driving.start.size
    begin = cells.first[cell[kept]]
    own, other = counted_up(begin, cells.beyond[cell[kept]] - begin)
    half, other_half, places = driving.half_mm[chord], driven.half_mm, places[kept]
    # How far chords move within the stretch: farther, the farther they are from the pole.
    away = np.abs(driving.middle[chord] - stretches.pole[rows][row]) + half
    moved = stretches.shift_mm[rows][row] + stretches.turn_rad[rows][row] * away
    # Chords at no common distance from the driven axis come upon each other nowhere.
    around = half + moved + ROUNDING * reach_mm
    inner, outer = np.abs(places) - around, np.abs(places) + around
    close = np.nonzero((driven.outer_mm[other] >= inner[own]) & (driven.inner_mm[other] <= outer[own]))[0]
    own, other = own[close], other[close]
    between, near = driven.middle[other] - places[own], reach_mm + moved
    close = np.nonzero(square(between) <= ((near + half)[own] + other_half[other]) ** 2)[0]
    own, other, between = own[close], other[close], between[close]
    direction = placement.driving_directions(driving.direction[chord], middle[row])[own]
    other_direction, near = driven.direction[other], near[own]
    # How far one chord's middle is from the other's line, less how far its ends are nearer.
    lean = np.abs(across(direction, other_direction))
    beside = np.abs(across(direction, between)) - lean * other_half[other]
    other_beside = np.abs(across(other_direction, between)) - lean * half[own]
    close = np.nonzero((beside <= near) & (other_beside <= near))[0]
    own, other = own[close], other[close]
    return Pairs(row[own], chord[own], other)
