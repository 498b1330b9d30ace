"""The levels of a spline of ln i12 around a turn: the judge of the optimiser, in plain arrays.

The judge's places have the programme's cells, in more steps.  A parabola through three places gives the values between
them; its error of a peak goes with the third power of the step.
"""

from __future__ import annotations

from collections.abc import Sequence
from functools import cached_property
from math import sqrt

import numpy as np

from ncgear.frozen import dataclass
from ncgear.numerics.arrays import Array, IndexArray
from ncgear.optimum.makeable.levels import TURN, LevelKind, WishLevel
from ncgear.optimum.makeable.places import CellPlaces
from ncgear.optimum.makeable.quantities import RatioPlace, length_rates
from ncgear.optimum.makeable.rows import RowBlock, WholeLaw, closing_terms, level_terms
from ncgear.optimum.makeable.spline import SplineRows

INTEGRALS = {LevelKind.INTEGRAL, LevelKind.DEVIATION, LevelKind.RMS}
"""Kinds with a single integral over a stretch."""

SMALLEST = 1e-6
"""Least root mean square, in its unit: smaller values count as this."""

CLOSE_RAD = 1e-7
"""Deviation that counts as none: a law's rounded ratios close an angle to a thousandth of it."""


def ratios(
    at: CellPlaces, rows: SplineRows, coefficients: Array, cycles_rad: Sequence[float]
) -> tuple[RatioPlace, ...]:
    """i12 at all places, shape (m,) each, and iB with a second cycle; coefficients have shape (pairs n,).

    The splines are shifted so that the driving angles of a turn are the cycles.
    """
    found = []
    for own, cycle in zip(coefficients.reshape(len(cycles_rad), -1), cycles_rad, strict=True):
        series, first, second = rows.of(own)
        logarithm = series + np.log(cycle / over_turn(at, np.exp(series)))
        found.append(RatioPlace(logarithm, np.exp(logarithm), np.exp(-logarithm), first, second))
    return tuple(found)


def over_turn(at: CellPlaces, values: Array) -> float:
    """Integral over phi2 of values at all places."""
    return float(np.sum(values[at.number] * at.weight))


def lengths(at: CellPlaces, law: Sequence[RatioPlace]) -> list[float]:
    """Rolled length of every pair in one cycle over its centre distance."""
    return [over_turn(at, rate) for rate in length_rates(law)]


@dataclass(frozen=True, eq=False)
class JudgedLaw:
    """A law at the judge's places, as levels see it."""

    levels: Sequence[WishLevel]
    at: CellPlaces
    law: Sequence[RatioPlace]

    @cached_property
    def lengths(self) -> list[float]:
        """Rolled length of every pair in one cycle over its centre distance."""
        return lengths(self.at, self.law)

    @property
    def terms(self) -> list[list[Array]]:
        """Every level's terms in all cells, shape (n, p + 1) each, as ``rows.level_terms`` gives them."""
        return self._with_unknowns[0]

    @property
    def unknowns(self) -> list[float]:
        """The variables of the whole law that terms ask for, in their order."""
        return self._with_unknowns[1]

    @cached_property
    def angle_rad(self) -> Array:
        """The driving angle at every place, shape (m,)."""
        angle = np.zeros(self.at.count)
        angle[self.at.number] = running(self.at, self.law[0].ratio[self.at.number])
        return angle

    @property
    def flat(self) -> list[Array]:
        """All terms of all levels, in order."""
        return [term for terms in self.terms for term in terms]

    @cached_property
    def _with_unknowns(self) -> tuple[list[list[Array]], list[float]]:
        whole = _Values(self)
        found = level_terms(self.levels, self.law, self.at.slider, self.lengths, whole)
        each = [[(term + np.zeros(self.at.count))[self.at.number] for term in terms] for terms in found]
        return each, whole.unknowns

    @cached_property
    def reached(self) -> Array:
        """Every level, shape (levels,)."""
        each = zip(self.levels, self.terms, strict=True)
        return np.array([max(self._reached(level, term) for term in terms) for level, terms in each])

    def _reached(self, level: WishLevel, term: Array) -> float:
        if level.kind in INTEGRALS:
            found = self.integral(level, term)
            return found if level.kind is not LevelKind.DEVIATION else abs(found) if abs(found) > CLOSE_RAD else 0.0
        if level.kind is LevelKind.SWING:
            term = running(self.at, term)
        cells = self.at.cells(level.stretch)
        if not cells.size:
            values = np.empty(self.at.count)
            values[self.at.number] = term
            inside = values[self.at.within(level.stretch)][:, None]
            tops, bottoms = inside, inside
        else:
            tops, bottoms = peaks(term[cells]), -peaks(-term[cells])
        return float(np.max(tops) - (0.0 if level.kind is LevelKind.PEAK else np.min(bottoms)))

    def integral(self, level: WishLevel, term: Array) -> float:
        """A term's integral over a level's stretch, less the target."""
        cells = self.at.cells(level.stretch)
        return float(np.sum(term[cells] * self.at.weight[cells])) - level.target

    def missed(self, coarse: CellPlaces) -> Array:
        """Excess of the coarse places in every pair's driving angle and rolled length, shape (2 pairs,)."""
        each = [term[self.at.number] for term in closing_terms(self.law)]
        found = [np.sum(self._coarsely(coarse, term) * coarse.weight) - np.sum(term * self.at.weight) for term in each]
        return np.reshape(found, (2, -1)).T.ravel()

    @staticmethod
    def _coarsely(coarse: CellPlaces, term: Array) -> Array:
        """A term in cells at the coarse places alone, shape (n, q + 1)."""
        return term[:, :: (term.shape[1] - 1) // (coarse.number.shape[1] - 1)]

    def beyond(self, blocks: Sequence[RowBlock], coarse: CellPlaces) -> Array:
        """Rise of every row's term around its place over the value at the place, shape (rows at or below zero,).

        "Around" is half a step of the coarse places; an integral rises by the error of the coarse places.
        """
        flat = [(level, term) for level, terms in zip(self.levels, self.terms, strict=True) for term in terms]
        return np.concatenate([self._beyond(block, *flat[block.term], coarse) for block in blocks])

    def _beyond(self, block: RowBlock, level: WishLevel, term: Array, coarse: CellPlaces) -> Array:
        cells = coarse.cells(level.stretch)
        if level.kind in INTEGRALS:
            roughly = float(np.sum((self._coarsely(coarse, term) * coarse.weight)[cells])) - level.target
            return np.array([block.sense * (self.integral(level, term) - roughly)])
        if level.kind is LevelKind.SWING:
            ends = np.arange(cells.size)
            number = np.column_stack([ends, (ends + 1) % cells.size])
            return _rise(block.sense * running(self.at, term), number, cells.size)
        rise = _rise(block.sense * term[cells], coarse.number[cells], coarse.count)
        return rise[block.places]


class _Values(WholeLaw):
    """Values of the variables of the whole law."""

    def __init__(self, judged: JudgedLaw) -> None:
        self._judged, self.unknowns = judged, list[float]()

    @property
    def angle_rad(self) -> Array:
        """The driving angle at every place."""
        return self._judged.angle_rad

    def mean_of(self, term: Array) -> float:
        """The term's integral over the driving angle of the turn, over that angle."""
        at, ratio = self._judged.at, self._judged.law[0].ratio
        self.unknowns.append(over_turn(at, term * ratio) / over_turn(at, ratio))
        return self.unknowns[-1]

    def fitted(self, term: Array, waves: Sequence[Array | float]) -> list[float]:
        """By least squares with the weights of the integral over the driving angle."""
        at, each = self._judged.at, np.stack([wave + np.zeros(self._judged.at.count) for wave in waves])
        weight = at.integral_weights(TURN) * self._judged.law[0].ratio
        found = np.linalg.solve((each * weight) @ each.T, each @ (weight * term)).tolist()
        self.unknowns += found
        return list(found)

    def size_of(self, square: Array, cycle_rad: float) -> float:
        """At least the least size."""
        mean = over_turn(self._judged.at, square * self._judged.law[0].ratio) / cycle_rad
        self.unknowns.append(max(sqrt(mean), SMALLEST))
        return self.unknowns[-1]

    def wave(self, angle_rad: Array) -> tuple[Array, Array]:
        """Cosine and sine."""
        return np.cos(angle_rad), np.sin(angle_rad)


def running(at: CellPlaces, term: Array) -> Array:
    """Integral over phi2 of a term from the retracted dead centre on, in all cells, shape (n, p + 1)."""
    step = np.diff(at.ends_rad)[:, None] / (term.shape[1] - 1)
    start, middle, end = term[:, :-1:2], term[:, 1::2], term[:, 2::2]
    inside = np.zeros(term.shape)
    inside[:, 2::2] = np.cumsum(start + 4.0 * middle + end, axis=1) * step / 3.0
    inside[:, 1::2] = inside[:, :-1:2] + (5.0 * start + 8.0 * middle - end) * step / 12.0
    before: Array = np.cumsum(inside[:, -1]) - inside[:, -1]
    return before[:, None] + inside


def _rise(values: Array, number: IndexArray, count: int) -> Array:
    """Rise of values in cells (n, p + 1) around ``count`` places, numbered by (n, q + 1); 0 without a cell."""
    steps, coarse = values.shape[1] - 1, number.shape[1] - 1
    nearest = np.floor((np.arange(steps) + 0.5) * coarse / steps + 0.5).astype(int)
    there, around = np.zeros(count), np.full(count, -np.inf)
    there[number] = values[:, :: steps // coarse]
    np.maximum.at(around, number[:, nearest], peaks(values))
    return np.where(np.isfinite(around), around - there, 0.0)


def peaks(values: Array) -> Array:
    """Largest value in every step of the parabolas through values in cells, shape (n, p + 1), p even; shape (n, p)."""
    start, middle, end = values[:, :-1:2], values[:, 1::2], values[:, 2::2]
    tops = np.maximum(values[:, :-1], values[:, 1:])
    slope, bend = (end - start) / 2.0, start - 2.0 * middle + end
    share = np.divide(-slope, bend, out=np.ones(bend.shape), where=bend < 0.0)
    top = middle + share * slope / 2.0
    for step, inside in ((0, (share > -1.0) & (share <= 0.0)), (1, (share > 0.0) & (share < 1.0))):
        tops[:, step::2] = np.where(inside, np.maximum(tops[:, step::2], top), tops[:, step::2])
    return tops
