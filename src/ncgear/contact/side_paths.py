"""The sides of teeth as chords of their exact curves, to find out on which curve a contact is, and their corners."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from ncgear.numerics.arrays import Array, ComplexArray, IndexArray
from ncgear.numerics.plane import angle_between, as_complex
from ncgear.teeth.flank import Flanks
from ncgear.teeth.sides import Sides

CHORDS = 12
"""Chords per run of a curve; the exact curve strays from them by some thousandths of a module."""

KINK_RAD = 1e-6
"""Angle between two runs from which their joint is a corner; tangential joints are found to 1e-9."""

NOWHERE = complex(np.nan, np.nan)


@dataclass(frozen=True, eq=False)
class SidePaths:
    """All f flanks of a gear with c chords each, in the gear's frame, from the tip inwards, padded with NaN.

    ``start`` and ``step`` are the chords, ``run`` numbers the run of ``sides`` that each belongs to, ``first`` and
    ``last`` are the run's parameters at the chord's ends, shape (f, c) each.  ``corner`` has the places at which a side
    has an edge, its tip first, then where two of its curves meet at an angle, shape (f, any number).
    """

    flanks: Flanks
    sides: Sides
    start: ComplexArray
    step: ComplexArray
    run: IndexArray
    first: Array
    last: Array
    corner: ComplexArray

    def curve(self, run: IndexArray, parameter: Array) -> tuple[Array, Array]:
        """Points of the exact curves of runs (shape (n,)) and derivatives; parameters of shape (n, ...)."""
        return self.flanks.curve_of(self.sides.kind[run], self.sides.owner[run], parameter)


def side_paths(flanks: Flanks, sides: Sides) -> SidePaths:
    """The paths of all flanks of a gear."""
    share = np.linspace(0.0, 1.0, CHORDS + 1)
    parameter = sides.start[:, None] + (sides.end - sides.start)[:, None] * share
    points, slopes = (as_complex(array) for array in flanks.curve_of(sides.kind, sides.owner, parameter))
    number = _number_within(sides.owner)
    place = sides.owner[:, None], number[:, None] * CHORDS + np.arange(CHORDS)
    shape = flanks.count, (int(number.max()) + 1) * CHORDS
    run = np.zeros(shape, dtype=int)
    run[place] = np.arange(number.size)[:, None]
    return SidePaths(
        flanks,
        sides,
        _table(shape, place, points[:, :-1]),
        _table(shape, place, np.diff(points, axis=1)),
        run,
        _table(shape, place, parameter[:, :-1]).real,
        _table(shape, place, parameter[:, 1:]).real,
        _corners(sides, points, slopes),
    )


def _number_within(owner: IndexArray) -> IndexArray:
    """Running number of each entry among those of the same owner; owners are in order."""
    return np.arange(owner.size) - np.searchsorted(owner, owner)


def _table(shape: tuple[int, int], place: tuple[IndexArray, IndexArray], values: Array | ComplexArray) -> ComplexArray:
    table = np.full(shape, NOWHERE)
    table[place] = values
    return table


def _corners(sides: Sides, points: ComplexArray, slopes: ComplexArray) -> ComplexArray:
    """The start of each side, and the start of each run that does not go on in the direction of the one before."""
    heading = slopes * np.sign(sides.end - sides.start)[:, None]
    tip = np.append(True, np.diff(sides.owner) != 0)
    bend = np.append(np.inf, np.abs(angle_between(heading[:-1, -1], heading[1:, 0])))
    sharp = np.nonzero(tip | (bend > KINK_RAD))[0]
    owner, number = sides.owner[sharp], _number_within(sides.owner[sharp])
    return _table((len(sides.tip_mm), int(number.max()) + 1), (owner, number), points[sharp, 0])
