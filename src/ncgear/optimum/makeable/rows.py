"""The rows of the programme: levels of every kind as sums of local terms and linear parts, zero or at most zero.

Terms are local to a place.  Besides there are variables of the whole law.  Terms depend on some of them, the lengths of
the pairs and means of swings, and not on others: levels, the excess, bases of spreads and running integrals.
"""

from __future__ import annotations

from abc import ABC, abstractmethod
from collections.abc import Sequence
from dataclasses import dataclass, field
from math import pi
from typing import Any

import numpy as np
from scipy import sparse

from ncgear.numerics.arrays import Array, IndexArray
from ncgear.optimum.makeable.levels import TURN, LevelKind, WishLevel
from ncgear.optimum.makeable.places import CellPlaces
from ncgear.optimum.makeable.quantities import RatioPlace, Slider, Term, length_rates

RUNNING = {LevelKind.INTEGRAL, LevelKind.DEVIATION, LevelKind.SWING, LevelKind.RMS}
"""Kinds that are integrals over the driving angle."""

SPANNING = {LevelKind.SPREAD, LevelKind.SWING}
"""Kinds that hold all values between a base and the level above it."""

TWO_SIDED = SPANNING | {LevelKind.DEVIATION}
"""Kinds that hold their terms from above and from below."""


UNHEARD = 1e-2
"""Weight of the whole root mean square in the level of high harmonics: it picks the law with the least whole among laws
without high harmonics."""


class WholeLaw(ABC):
    """Variables of the whole law on which terms depend: symbols of the programme, or the values that a judge computes.

    ``angle_rad`` is the driving angle at a place, which harmonics need.
    """

    angle_rad: Term

    @abstractmethod
    def mean_of(self, term: Term) -> Term:
        """The mean of a term over the driving angle."""

    @abstractmethod
    def fitted(self, term: Term, waves: Sequence[Term]) -> Sequence[Term]:
        """The part of every wave in a term that leaves the least mean square of the rest."""

    @abstractmethod
    def size_of(self, square: Term, cycle_rad: float) -> Term:
        """The root of a square's mean over the driving angle of a cycle, over zero."""

    @abstractmethod
    def wave(self, angle_rad: Term) -> tuple[Term, Term]:
        """Cosine and sine."""


def level_terms(
    levels: Sequence[WishLevel], ratios: Sequence[RatioPlace], slider: Slider, lengths: Sequence[Term], whole: WholeLaw
) -> list[list[Term]]:
    """Every level's terms at a place; terms of integrals are per unit of phi2, terms of swings less their means.

    The root of a mean square is the least of (size + mean square/size)/2 over all sizes, so its term is a mean too.
    """
    found = []
    for level in levels:
        terms = level.terms(ratios, slider, lengths)
        if level.kind is LevelKind.SWING:
            terms = tuple(term - whole.mean_of(term) for term in terms)
        if level.kind is LevelKind.RMS:
            terms = tuple(_of_root(level, _square(level, term, whole), whole) for term in terms)
        found.append([term * ratios[0].ratio if level.kind in RUNNING else term for term in terms])
    return found


def _square(level: WishLevel, term: Term, whole: WholeLaw) -> Term:
    """The square of a term, or of its rest above the order of a level."""
    if level.order is None:
        return term**2
    turn = 2.0 * pi / level.cycle_rad * whole.angle_rad
    waves = [1.0, *(wave for order in range(1, level.order + 1) for wave in whole.wave(order * turn))]
    rest = term - sum(size * wave for size, wave in zip(whole.fitted(term, waves), waves, strict=True))
    return rest**2 + (UNHEARD * term) ** 2


def _of_root(level: WishLevel, square: Term, whole: WholeLaw) -> Term:
    size = whole.size_of(square, level.cycle_rad)
    return (size + square / size) / (2.0 * level.cycle_rad)


def closing_terms(ratios: Sequence[RatioPlace]) -> list[Term]:
    """The values integrated over the turn with any levels: every ratio, and the rate of every pair's length."""
    return [*(ratio.ratio for ratio in ratios), *length_rates(ratios)]


@dataclass(frozen=True, eq=False)
class RowBlock:
    """Rows that hold one term of one level, from the row ``first`` on, at places of the programme or ends of cells.

    An integral has one row and one place, which has no meaning.  With ``sense`` 1 rows hold the term from above; with
    -1 they hold a spread, a swing or a deviation from below.  ``base`` is the column of the base of a spread or swing.
    ``running`` are the columns of the running integral, without the first end of a cell, where it is zero.
    """

    level: int
    term: int
    first: int
    places: IndexArray
    sense: int
    base: int | None = None
    running: IndexArray | None = None

    @property
    def rows(self) -> slice:
        """Numbers of the rows."""
        return slice(self.first, self.first + self.places.size)


@dataclass(frozen=True)
class WholeColumns:
    """Columns of the whole law's variables: of variables in terms, of levels and of the excess.

    Lengths are first.  ``sizes`` are the columns of root mean squares.
    """

    first_unknown: int
    first_level: int
    excess: int
    sizes: Sequence[int] = ()


@dataclass(eq=False)
class ProgrammeRows:
    """Rows that grow as levels are added: ``equations``, which are zero, and then rows at or below zero.

    ``terms`` counts the terms at a place and ``wholes`` the variables of the whole.
    """

    at: CellPlaces
    columns: WholeColumns
    terms: int
    wholes: int
    count: int = 0
    equations: int = 0
    first_angle: int | None = None
    blocks: list[RowBlock] = field(default_factory=list)
    _local: list[Any] = field(default_factory=list)
    _whole: list[Any] = field(default_factory=list)
    _fixed: list[Array] = field(default_factory=list)

    def new(self, count: int, fixed: float = 0.0) -> IndexArray:
        """Numbers of new rows, with a constant part."""
        self.count += count
        self._fixed.append(np.full(count, fixed))
        return np.arange(self.count - count, self.count)

    def new_wholes(self, count: int) -> IndexArray:
        """Columns of new variables of the whole law."""
        self.wholes += count
        return np.arange(self.wholes - count, self.wholes)

    def put_term(self, row: Any, place: Any, term: int, weight: Any = 1.0) -> None:
        """Add a term at places to rows, with weights; row, place and weight broadcast to one shape."""
        self._local.append(np.broadcast_arrays(row, place * self.terms + term, weight))

    def put_whole(self, row: Any, column: Any, weight: Any = 1.0) -> None:
        """Add variables of the whole to rows, with weights."""
        self._whole.append(np.broadcast_arrays(row, column, weight))

    def matrices(self) -> tuple[Any, Any, Array]:
        """Matrix on the terms, columns place * terms + term; matrix on the whole's variables; constants, (rows,)."""
        local = _matrix(self._local, (self.count, self.at.count * self.terms))
        return local, _matrix(self._whole, (self.count, self.wholes)), np.concatenate(self._fixed)


def rows_of(
    levels: Sequence[WishLevel], term_counts: Sequence[int], at: CellPlaces, cycles_rad: Sequence[float]
) -> ProgrammeRows:
    """The rows of levels with their terms, for pairs that turn through ``cycles_rad`` per turn of the crank."""
    # First come two equations for every pair: its driving angle and its length
    pairs, of_levels = len(cycles_rad), sum(term_counts)
    unknown, sizes = pairs, []
    for level, count in zip(levels, term_counts, strict=True):
        for _ in range(count):
            unknown += level.kind is LevelKind.SWING
            if level.kind is LevelKind.RMS:
                unknown += 1 if level.order is None else 2 * level.order + 2
                sizes.append(unknown - 1)
    columns = WholeColumns(pairs, unknown, unknown + len(levels), sizes)
    rows = ProgrammeRows(at, columns, of_levels + 2 * pairs, columns.excess + 1)
    everywhere, turn = np.arange(at.count), at.integral_weights(TURN)
    for pair, cycle in enumerate(cycles_rad):
        rows.put_term(rows.new(1, -cycle), everywhere, of_levels + pair, turn)
        row = rows.new(1)
        rows.put_term(row, everywhere, of_levels + pairs + pair, turn)
        rows.put_whole(row, pair, -1.0)
    if any(level.order is not None for level in levels):
        rows.first_angle = _angles(rows, of_levels)
    each = [(number, level) for number, level in enumerate(levels) for _ in range(term_counts[number])]
    running = {term: _running(rows, term) for term, (_, level) in enumerate(each) if level.kind is LevelKind.SWING}
    rows.equations = rows.count
    for term, (number, level) in enumerate(each):
        places, base = at.within(level.stretch), None
        if level.kind in RUNNING:
            # Ends of cells, or no place at all
            places = np.arange(at.number.shape[0]) if level.kind is LevelKind.SWING else np.zeros(1, dtype=int)
        if level.kind in SPANNING:
            base = int(rows.new_wholes(1)[0])
        for sense in (1, -1) if level.kind in TWO_SIDED else (1,):
            _hold(rows, level, RowBlock(number, term, rows.count, places, sense, base, running.get(term)))
    return rows


def _hold(rows: ProgrammeRows, level: WishLevel, block: RowBlock) -> None:
    at, sense, columns = rows.at, block.sense, rows.columns
    row = rows.new(block.places.size, -sense * level.target)
    if level.kind is LevelKind.SWING:
        rows.put_whole(row[1:], block.running, sense)
    elif level.kind in RUNNING:
        rows.put_term(row, np.arange(at.count), block.term, sense * at.integral_weights(level.stretch))
    else:
        rows.put_term(row, block.places, block.term, sense)
    if block.base is not None:
        rows.put_whole(row, block.base, -sense)
    if sense > 0 or block.base is None:
        rows.put_whole(row, columns.first_level + block.level, -1.0)
        rows.put_whole(row, columns.excess, -1.0)
    rows.blocks.append(block)


def _running(rows: ProgrammeRows, term: int) -> IndexArray:
    """Columns of a term's running integral at all ends of cells except the first and the last, where it is zero."""
    cells = rows.at.number.shape[0]
    column, row = rows.new_wholes(cells - 1), rows.new(cells)
    rows.put_term(row[:, None], rows.at.number, term, rows.at.weight)
    rows.put_whole(row[:-1], column, -1.0)
    rows.put_whole(row[1:], column)
    return column


def _angles(rows: ProgrammeRows, ratio: int) -> int:
    """The first of the columns of the driving angles at all places, which the term ``ratio`` adds up to."""
    at = rows.at
    first = int(rows.new_wholes(at.count)[0])
    rows.put_whole(rows.new(1), first)
    start, middle, end = at.number.T
    step = np.diff(at.ends_rad) / 24.0
    for to, weights in ((middle, (5.0, 8.0, -1.0)), (end, (4.0, 16.0, 4.0))):
        row = rows.new(start.size)
        rows.put_whole(row, first + to)
        rows.put_whole(row, first + start, -1.0)
        for place, weight in zip((start, middle, end), weights, strict=True):
            rows.put_term(row, place, ratio, -weight * step)
    # At the extended dead centre two places have one angle
    again = np.nonzero(start[1:] != end[:-1])[0]
    row = rows.new(again.size)
    rows.put_whole(row, first + start[1:][again])
    rows.put_whole(row, first + end[:-1][again], -1.0)
    return first


def _matrix(parts: Sequence[Any], shape: tuple[int, int]) -> Any:
    """A sparse matrix from triplets; entries at the same place add up."""
    row, column, value = (np.concatenate([np.ravel(part[k]) for part in parts]) for k in range(3))
    return sparse.coo_matrix((value, (row, column)), shape=shape)
