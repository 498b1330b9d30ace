"""Barriers of a cell that no motion within limits passes upwards, however light the machine.

With s = dphi/dphi1 and q = s^2 as in ``sweeps``, each limit leaves an amount, and a slope q' takes a share of it: the
slope is possible where its share is not over the amount.  A limit forbids all slopes over a line's where the line's own
slope takes too much and the share is positive.  No amount is divided by the inertia, which may be next to nothing.
"""

from __future__ import annotations

from collections.abc import Callable
from math import inf
from typing import Any

import numpy as np

from ncgear.frozen import dataclass
from ncgear.numerics.arrays import Array

SHARES = np.array([[0.0], [0.5], [1.0]])
"""The three places of a cell, as shares of it from the end where a sweep enters it."""

Place = Any
"""Index of cells and their places in arrays (n, 3)."""

Line = tuple[Array, Array, Array]
"""Lines of a cell: the start, infinite where there is none, the end, and the steepest slope."""

LOOSE = 1e-4
"""Share of q that a cell may add to a curve before lines are tried in its place."""

SCANNED = 12
"""Values of q between the greatest and the least at which the level of a limit is looked for."""

NEARBY = 1e-6
"""Share of q between two slopes that tell how fast a slope changes with q."""

ROUNDING = 1e-7
"""Addition to slopes, and share of starts, that rounding errors may make."""


@dataclass(frozen=True, eq=False)
class LimitRows:
    """The limits of k problems as j rows, each of flank load, of power, or of acceleration.

    ``flank`` and ``power`` tell which, (j, 1), ``level`` is what a row allows and ``tilt`` how much more with a slope,
    (j, k); ``wheel`` is the flywheel's part of the share of a slope, (2, j, k), and ``felt`` has what stands against
    the level, alone, by q and by slope, (3, j, n, 3).
    """

    flank: Array
    power: Array
    level: Array
    tilt: Array
    wheel: Array
    felt: Array


class Barriers:
    """The barriers of n cells of widths ``step`` for k problems; ``within`` are the least and the greatest q.

    ``way`` is 1 forwards and -1 backwards, where a sweep enters a cell at its end.
    """

    def __init__(self, rows: LimitRows, steepness: float, step: Array, within: tuple[float, float]) -> None:
        self.rows, self.steepness, self.step, self.range = rows, steepness, step, within

    def parabola(self, cell: int, q: Array, way: int) -> tuple[Line, Array]:
        """A barrier of nearly the steepest slopes, and whether lines may be lower."""
        at = cell, slice(None, None, way)
        step, most = way * self.step[cell], max(way, 0)
        slope = self.slopes(at, np.repeat(q[None], 3, axis=0))[most]
        for _ in range(2):
            slopes = slope[0] + (slope[2] - slope[0]) * SHARES
            slope = self.slopes(at, _along(q, step, slopes))[most]
        room = 2.5 * np.abs(slope[1] - (slope[0] + slope[2]) / 2.0) + ROUNDING
        slopes = slope[0] + way * room + (slope[2] - slope[0]) * SHARES
        curve = _along(q, step, slopes)
        kept = _greatest(way * (self.slopes(at, curve)[most] - slopes)) <= 0.0
        if not kept.all():
            kept |= _passed(self.rows, at, curve, slopes, way).any(axis=0)
        line = np.where(kept, q, inf), np.where(kept, curve[2], inf), way * np.maximum(way * slopes[0], way * slopes[2])
        return line, ~kept | (room * abs(step) > LOOSE * q)

    def resting(self, way: int) -> Line:
        """Lines near which motions at each limit go on, however light the machine, (j, n, k) each.

        A motion below its start in a cell does not pass it.
        """
        at = np.arange(self.step.size), np.arange(3)[::way, None]
        step, shares = way * self.step[:, None], SHARES[..., None]
        level = self._level(at, np.zeros((self.rows.level.shape[0], 1, self.step.size, self.rows.level.shape[1])))
        slope = (level[:, 2:] - level[:, :1]) / step
        level = self._level(at, slope) - shares * step * slope
        start = _greatest(level, 1)[:, None] * (1.0 + ROUNDING)
        passed = _passed(self.rows, at, start + shares * step * slope, slope, way)
        start, slope = start[:, 0], slope[:, 0]
        return np.where(passed, start, inf), start + step * slope, slope

    def _level(self, at: Place, slope: Array) -> Array:
        """The least q up to the greatest one from which on a limit stops a slope, (j, 3, n, k); nan without any."""
        high, floor = np.full((slope.shape[0], 3, *slope.shape[2:]), self.range[1]), self.range[0]
        above = _excess(self.rows, at, high, slope)
        going, low, below = above <= 0.0, np.full(high.shape, np.nan), np.full(high.shape, np.nan)
        for q in np.geomspace(self.range[1], floor, SCANNED)[1:]:
            value = _excess(self.rows, at, np.full(high.shape[1:], q), slope)
            stops = going & (value > 0.0)
            low[stops], below[stops] = q, value[stops]
            going &= ~stops
            high[going], above[going] = q, value[going]
        # Below the floor no motion is possible
        found = _root(lambda q: _excess(self.rows, at, q, slope), (low, below), (high, above))
        return np.where(going, floor, np.where(np.isfinite(low), found, np.nan))

    def falling(self, cell: int, q: Array, reached: Array, way: int) -> Line:
        """Lines from above the motions at each limit towards them, (j, k) each."""
        at, end = (cell, slice(None, None, way)), (cell, 1 + way)
        step = way * self.step[cell]

        def excess(other: Array) -> Array:
            return _excess(self.rows, end, other, (other - q) / step)

        low, high = np.where(reached < q, reached, self.range[0]), np.broadcast_to(q, reached.shape)
        slope = ((_root(excess, (low, excess(low)), (high, excess(high))) - q) / step)[:, None]
        start = high[:, None]
        for _ in range(2):
            own, beside = (
                _excess(self.rows, at, begin + SHARES * step * slope, slope)
                for begin in (start, start * (1.0 + NEARBY))
            )
            raised = np.maximum(_greatest(own / (own - beside), 1), 0.0)[:, None]
            start = start * (1.0 + 1.1 * NEARBY * raised)
        passed = _passed(self.rows, at, start + SHARES * step * slope, slope, way)
        start, slope = start[:, 0], slope[:, 0]
        return np.where(passed, start, inf), start + step * slope, slope

    def slopes(self, at: Place, q: Array) -> tuple[Array, Array]:
        """The least and the greatest q' that all limits allow at places of cells, (..., k); crossed without any."""
        steepness = self.steepness
        most = 2.0 * steepness * (q + np.sqrt(q)) if steepness < inf else np.full(q.shape, inf)
        spare, (low, high) = _left(self.rows, at, q)
        upper = np.where((low >= 0.0) & (high > 0.0), _over(spare, (low, high)), inf)
        lower = np.where((high <= 0.0) & (low < 0.0), -_over(spare, (-high, -low)), -inf)
        return np.maximum(-most, lower.max(axis=0, initial=-inf)), np.minimum(most, upper.min(axis=0, initial=inf))


def _along(start: Array, step: Array, slopes: Array) -> Array:
    """Values along a cell from a start, with slopes at three places that are linear between its ends, (3, k)."""
    return np.asarray(np.maximum(start + step * SHARES * (slopes[0] + slopes) / 2.0, 1e-9))


def _left(rows: LimitRows, at: Place, q: Array) -> tuple[Array, Array]:
    """What each limit leaves at places for values of q, and its shares of q', (j, ..., k) and (2, j, ..., k).

    A slope keeps a limit where its share times q' is not over what is left, for one size of the flywheel's range.  A
    flank load H asks M (1 + s)^3 <= H (s cos(alpha) + q' sin(alpha)/(2 (1 + s))).
    """
    static, by_q, half = rows.felt[(slice(None), slice(None), *at)][..., None]
    between = (1,) * (static.ndim - 2)

    def wide(one: Array) -> Array:
        return one.reshape(*one.shape[:-1], *between, one.shape[-1])

    s, flank = np.sqrt(q), wide(rows.flank)
    near = 1.0 + s
    weight = np.where(flank, near * near * near, np.where(wide(rows.power), s, 1.0))
    spare = wide(rows.level) * np.where(flank, s, 1.0) - (static + by_q * q) * weight
    return spare, (half + wide(rows.wheel)) * weight - wide(rows.tilt) / near


def _excess(rows: LimitRows, at: Place, q: Array, slope: Array) -> Array:
    """What each limit leaves beside a slope, (j, ..., k)."""
    spare, share = _left(rows, at, q)
    return np.maximum(spare - share[0] * slope, spare - share[1] * slope)


def _passed(rows: LimitRows, at: Place, q: Array, slope: Array, way: int) -> Array:
    """Whether each limit lets no motion pass a line upwards, by values at three places, (j, ..., k) each."""
    spare, share = _left(rows, at, q)
    excess = np.maximum(spare - share[0] * slope, spare - share[1] * slope)
    return np.asarray((_greatest(excess, 1) <= 0.0) & np.all(way * share >= 0.0, axis=(0, 2)))


def lowest(line: Line, others: Line) -> Line:
    """Of a line, (k,) each, and others, (j, k), those with the lowest end that have a finite start."""
    start, end, slope = (np.vstack([own, other]) for own, other in zip(line, others, strict=True))
    best = np.argmin(np.where(start < inf, end, inf), axis=0), np.arange(start.shape[1])
    return start[best], end[best], slope[best]


def _greatest(values: Array, axis: int = 0) -> Array:
    """The greatest value over a cell of a function known at three places of an axis.

    It may lie over their parabola by the bend that they show, which for a rising bend ends at the chord.
    """
    first, middle, last = np.moveaxis(values, axis, 0)
    bend = 2.0 * np.maximum(middle - (first + last) / 2.0, 0.0)
    rise = last - first
    vertex = (first + last) / 2.0 + bend + rise**2 / (16.0 * bend)
    return np.where(np.abs(rise) < 4.0 * bend, vertex, np.maximum(first, last))


def _root(function: Callable[[Array], Array], low: tuple[Array, Array], high: tuple[Array, Array]) -> Array:
    """Places near roots, not below them, of functions positive at ``low`` and negative at ``high``, by false position.

    Each end has its values; where that of ``low`` is not positive, the place is ``low``.
    """
    (left, below), (right, above) = low, high
    side = np.zeros(left.shape)
    for _ in range(6):
        middle = (np.sqrt(left) + (np.sqrt(right) - np.sqrt(left)) * below / (below - above)) ** 2
        value = function(middle)
        over = value <= 0.0
        # An end that stays counts half
        left, below = np.where(over, left, middle), np.where(over, np.where(side > 0.0, below / 2.0, below), value)
        right, above = np.where(over, middle, right), np.where(over, value, np.where(side < 0.0, above / 2.0, above))
        side = np.where(over, 1.0, -1.0)
    return np.where(low[1] <= 0.0, low[0], right)


def _over(value: Array, divisor: tuple[Array, Array]) -> Array:
    """The greatest quotient of a value and positive divisors of a range, (2, k): the least if it is positive."""
    return np.asarray(np.where(value >= 0.0, value / divisor[0], value / divisor[1]))
