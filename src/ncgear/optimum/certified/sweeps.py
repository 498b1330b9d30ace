"""A lower limit of flank load and peak power, by sweeps around the turn of the crank.

Let phi be the crank's angle, s = dphi/dphi1, q = s^2, primes by phi, and w the driving shaft's speed.  At a place and a
value of q every limit of the pressure angle, acceleration, power, braking power and flank load is a range of q', since
the crank's torque M = M0 + w^2 (c q + J q'/2) is linear in q and q'.  So every motion that keeps them lies below the
greatest periodic curve with slopes in these ranges (comparison of scalar differential inequalities).  A cycle takes at
least the time along that curve.  Where that exceeds its time, no motion keeps all limits.

The curve is followed from cell to cell below a barrier: a parabola of nearly the greatest possible slopes, or a line.
A line is a barrier where one limit forbids all slopes over the line's, at every place of it.  The limit's own amounts
judge this, which do not divide by the inertia: so light machines, whose motions go to an equilibrium within a cell and
follow it, have barriers too.  One line of each cell follows the equilibrium, others fall towards it.

A barrier is judged at three places of a cell with room for twice the bend that they show: the functions are smooth and
known, and where two limits meet, the least of them is concave.  The jumps of a load are ends of cells.

Both pitch curves may have dents here, and jerk, curvature and other forces are free; so the limit holds for more laws
than the search has.  The flywheel may have any size of a range.
"""

from __future__ import annotations

from collections.abc import Callable
from math import cos, inf, pi, sin
from typing import Any

import numpy as np

from ncgear.frozen import dataclass
from ncgear.numerics.arrays import Array, IndexArray
from ncgear.optimum.certified.demands import Demands
from ncgear.optimum.makeable.places import cell_ends, slider_at
from ncgear.optimum.task import Task
from ncgear.wishes.requirements import TimeWithin

CELLS = 480
"""Cells of a turn: twice as many raise the limit of a baler by a few thousandths."""

NODES = np.array([1e-7, 0.5, 1.0 - 1e-7])
"""Places in a cell where known functions are evaluated, as shares of it: its ends from inside, as loads may jump."""

TURNS = 4
"""Sweeps around the turn each way at most; fewer give a lower limit."""

SETTLED = 1e-7
"""Change of the curve by a sweep under which it counts as settled."""

LEVELS, ROUNDS = 13, 3
"""Levels of a figure that are tried together, and rounds of levels, each between two neighbours of the round before."""

LOWERED, STEPS_DOWN = 0.998, 20
"""Ratio by which the curve is lowered where no slope is possible, and most such steps at a place of a sweep."""

NEARBY = 1e-6
"""Share of q between two slopes that tell how fast a slope changes with q."""

ROUNDING = 1e-7
"""Share of the time of a cycle, and of levels, that rounding errors may make."""

STANDING = 1e-7
"""Way for an angle of the crank, as a share of the stroke, under which the place counts as a dead centre."""


SHARES = np.array([[0.0], [0.5], [1.0]])
"""The same places as shares of a cell from the end where a sweep enters it."""

Place = Any
"""Index of cells and their places in arrays (n, 3)."""

Line = tuple[Array, Array, Array]
"""Lines of a cell: the start, infinite where there is none, the end, and the steepest slope."""

LOOSE = 1e-4
"""Share of q that a cell may add to a curve before lines are tried in its place."""

SCANNED = 12
"""Values of q between the greatest and the least at which the level of a limit is looked for."""


@dataclass(frozen=True, eq=False)
class LinkageValues:
    """The linkage's known functions at three places of each of n cells, shape (n, 3); ``ends_rad`` has shape (n + 1,).

    ``first`` and ``second`` are the displacement's derivatives by the crank's angle, and the crank's torque in N mm is
    ``static`` + w^2 (``by_q`` q + ``by_rate`` q'/2).
    """

    ends_rad: Array
    first: Array
    second: Array
    static: Array
    by_q: Array
    by_rate: Array


@dataclass(frozen=True, eq=False)
class SweptLimits:
    """Limits of k problems that are swept together, shape (k,) each; infinite where free.

    ``flywheel_kg_mm2`` has the least and the greatest inertia added to the crank's, shape (2, k).
    """

    flank_load_n_mm: Array
    power_w: Array
    flywheel_kg_mm2: Array

    @property
    def count(self) -> int:
        """Number of problems."""
        return self.power_w.size


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


def known_functions(task: Task, asked: Demands, cells: int) -> LinkageValues:
    """The known functions of a machine in about ``cells`` cells."""
    stretches = [one.stretch for one in asked.requirements(TimeWithin)]
    ends = cell_ends(task, np.linspace(0.0, 2.0 * pi, cells, endpoint=False), stretches)
    places = ends[:-1, None] + np.diff(ends)[:, None] * NODES
    at = slider_at(task, places.ravel())
    # Without masses the resistance alone turns the crank
    static = at.torque if task.masses is not None else at.force_n * at.first
    columns = at.first, at.second, static, at.torque_by_q, at.torque_by_rate
    return LinkageValues(
        ends, *(np.broadcast_to(np.asarray(one, dtype=float), places.size).reshape(-1, 3) for one in columns)
    )


class Sweeps:
    """The sweeps of a machine under demands."""

    def __init__(self, task: Task, asked: Demands, cells: int = CELLS) -> None:
        self.task, self.asked = task, asked
        self.known = known_functions(task, asked, cells)
        self.step = np.diff(self.known.ends_rad)
        gears = task.gears
        pushing = gears.rack_angle_rad if gears else asked.rack_angle_rad
        self.angles = pushing, (gears.idle_angle_rad if gears else None) or pushing

    def possible(self, limits: SweptLimits) -> Array:
        """Whether a motion may keep the limits, shape (k,): False is certain."""
        with np.errstate(all="ignore"):
            curve, rows = self._begun(limits), self._rows(limits)
            resting = [(way, self._resting(rows, way, limits.count)) for way in (1, -1)]
            lines = np.zeros((2, 2, self.step.size, limits.count))
            lines[:, 0] = self._cap
            for _ in range(TURNS):
                before = curve.copy()
                for way, calm in resting:
                    self._sweep(rows, way, curve, lines[max(-way, 0)], calm)
                possible = self._has_time(limits, curve, lines)
                # Nothing more is asked of what is certain
                curve[:, np.logical_not(possible)] = LOWERED * self._floor
                if np.max((before - curve)[:, possible], initial=0.0) < SETTLED:
                    break
            return possible

    @property
    def _cap(self) -> float:
        return float(1.0 / self.asked.ratio_min**2)

    @property
    def _floor(self) -> float:
        return float(1.0 / self.asked.ratio_max**2)

    def _begun(self, limits: SweptLimits) -> Array:
        """The greatest q at the ends of cells before any sweep, shape (n + 1, k)."""
        speed, asked, known = self.task.speed_rad_s, self.asked, self.known
        fastest = np.full(self.step.size + 1, self._cap)
        way = np.abs(np.append(known.first[:, 0], known.first[-1, 2]))
        bend = np.abs(np.append(known.second[:, 0], known.second[-1, 2]))
        if asked.speed_mm_s < inf:
            fastest = np.minimum(fastest, (asked.speed_mm_s / (speed * way)) ** 2)
        if asked.acceleration_mm_s2 < inf:
            still = way <= STANDING * self.task.linkage.stroke_mm
            at_rest = (1.0 + ROUNDING) * asked.acceleration_mm_s2 / (speed**2 * bend)
            fastest = np.where(still, np.minimum(fastest, at_rest), fastest)
        highest = self._without_masses(limits)
        beside = np.minimum(np.vstack([highest, highest[-1:]]), np.vstack([highest[:1], highest]))
        return np.asarray(np.minimum(fastest[:, None], beside))

    def _sweep(self, rows: LimitRows, way: int, curve: Array, lines: Array, resting: Line) -> None:
        """Lower a curve from cell to cell, forwards (``way`` 1) or backwards (-1), and its barriers' lines, (2, n, k).

        A line has the value at the end of the cell from which it comes, and its slope.
        """
        for cell in range(self.step.size)[::way]:
            here, there = (cell, cell + 1)[::way]
            self._lower(rows, (cell, 1 - way), curve[here])
            q, (level, reached, slope) = curve[here], (one[:, cell] for one in resting)
            line, loose = self._parabola(rows, cell, q, way)
            line = _lowest(line, (np.where(q <= level, level, inf), reached, slope))
            above = loose & (q > level) & (reached < line[1])
            if above.any():
                line = _lowest(line, self._falling(rows, cell, q, reached, way))
            start, end, slope = line
            bounded = start < inf
            lines[0, cell] = np.where(bounded, start, self._cap)
            lines[1, cell] = np.where(bounded, slope, 0.0)
            curve[there] = np.where(bounded & (end < curve[there]), end, curve[there])
        curve[0] = curve[-1] = np.minimum(curve[0], curve[-1])

    def _lower(self, rows: LimitRows, at: Place, q: Array) -> None:
        """Lower the curve at a place as long as no slope is possible there."""
        stuck = self._stuck(rows, at, q)
        for _ in range(STEPS_DOWN):
            if not stuck.any():
                return
            # Between two values without a possible slope there is none
            stuck = np.logical_and(stuck, self._stuck(rows, at, LOWERED * q))
            q[stuck] *= LOWERED

    def _stuck(self, rows: LimitRows, at: Place, q: Array) -> Array:
        least, most = self._slopes(rows, at, q)
        above = np.where(np.isfinite(most), most + ROUNDING * np.abs(most), most)
        return np.asarray((least > above) & (q > LOWERED * self._floor))

    def _parabola(self, rows: LimitRows, cell: int, q: Array, way: int) -> tuple[Line, Array]:
        """A barrier of nearly the steepest slopes, and whether lines may be lower."""
        at = cell, slice(None, None, way)
        step, most = way * self.step[cell], max(way, 0)
        slope = self._slopes(rows, at, np.repeat(q[None], 3, axis=0))[most]
        for _ in range(2):
            slopes = slope[0] + (slope[2] - slope[0]) * SHARES
            slope = self._slopes(rows, at, _along(q, step, slopes))[most]
        room = 2.5 * np.abs(slope[1] - (slope[0] + slope[2]) / 2.0) + ROUNDING
        slopes = slope[0] + way * room + (slope[2] - slope[0]) * SHARES
        curve = _along(q, step, slopes)
        kept = _greatest(way * (self._slopes(rows, at, curve)[most] - slopes)) <= 0.0
        if not kept.all():
            kept |= _passed(rows, at, curve, slopes, way).any(axis=0)
        line = np.where(kept, q, inf), curve[2], way * np.maximum(way * slopes[0], way * slopes[2])
        return line, ~kept | (room * abs(step) > LOOSE * q)

    def _resting(self, rows: LimitRows, way: int, count: int) -> Line:
        """Lines near which motions at each limit go on, however light the machine, (j, n, k) each.

        A motion below its start in a cell does not pass it.
        """
        at = np.arange(self.step.size), np.arange(3)[::way, None]
        step, shares = way * self.step[:, None], SHARES[..., None]
        level = self._level(rows, at, np.zeros((rows.level.shape[0], 1, self.step.size, count)))
        slope = (level[:, 2:] - level[:, :1]) / step
        level = self._level(rows, at, slope) - shares * step * slope
        start = _greatest(np.moveaxis(level, 1, 0))[:, None] * (1.0 + ROUNDING)
        passed = _passed(rows, at, start + shares * step * slope, slope, way)
        start, slope = start[:, 0], slope[:, 0]
        return np.where(passed, start, inf), start + step * slope, slope

    def _level(self, rows: LimitRows, at: Place, slope: Array) -> Array:
        """The least q up to the greatest one from which on a limit stops a slope, (j, 3, n, k); nan without any."""
        high, floor = np.full((slope.shape[0], 3, *slope.shape[2:]), self._cap), self._floor
        above = _excess(rows, at, high, slope)
        going, low, below = above <= 0.0, np.full(high.shape, np.nan), np.full(high.shape, np.nan)
        for q in np.geomspace(self._cap, floor, SCANNED)[1:]:
            value = _excess(rows, at, np.full(high.shape[1:], q), slope)
            stops = going & (value > 0.0)
            low[stops], below[stops] = q, value[stops]
            going &= ~stops
            high[going], above[going] = q, value[going]
        # Below the floor no motion is possible
        found = _root(lambda q: _excess(rows, at, q, slope), (low, below), (high, above))
        return np.where(going, floor, np.where(np.isfinite(low), found, np.nan))

    def _falling(self, rows: LimitRows, cell: int, q: Array, reached: Array, way: int) -> Line:
        """Lines from above the motions at each limit towards them, (j, k) each."""
        at, end = (cell, slice(None, None, way)), (cell, 1 + way)
        step = way * self.step[cell]

        def excess(other: Array) -> Array:
            return _excess(rows, end, other, (other - q) / step)

        low, high = np.where(reached < q, reached, self._floor), np.broadcast_to(q, reached.shape)
        slope = ((_root(excess, (low, excess(low)), (high, excess(high))) - q) / step)[:, None]
        start = high[:, None]
        for _ in range(2):
            own, beside = (
                _excess(rows, at, one + SHARES * step * slope, slope) for one in (start, start * (1.0 + NEARBY))
            )
            raised = np.maximum(_greatest(np.moveaxis(own / (own - beside), 1, 0)), 0.0)[:, None]
            start = start * (1.0 + 1.1 * NEARBY * raised)
        passed = _passed(rows, at, start + SHARES * step * slope, slope, way)
        start, slope = start[:, 0], slope[:, 0]
        return np.where(passed, start, inf), start + step * slope, slope

    def slopes(self, limits: SweptLimits, at: Place, q: Array) -> tuple[Array, Array]:
        """The least and the greatest q' that all limits allow at places of cells, (..., k); crossed without any."""
        return self._slopes(self._rows(limits), at, q)

    def _slopes(self, rows: LimitRows, at: Place, q: Array) -> tuple[Array, Array]:
        steepness = self.asked.steepness
        most = 2.0 * steepness * (q + np.sqrt(q)) if steepness < inf else np.full(q.shape, inf)
        spare, (low, high) = _left(rows, at, q)
        upper = np.where((low >= 0.0) & (high > 0.0), _over(spare, (low, high)), inf)
        lower = np.where((high <= 0.0) & (low < 0.0), -_over(spare, (-high, -low)), -inf)
        return np.maximum(-most, lower.max(axis=0, initial=-inf)), np.minimum(most, upper.min(axis=0, initial=inf))

    def _rows(self, limits: SweptLimits) -> LimitRows:
        """The limits of acceleration, power, braking power and flank load that are given."""
        asked, known, half = self.asked, self.known, self.task.speed_rad_s**2 / 2.0
        still = np.abs(known.first) <= STANDING * self.task.linkage.stroke_mm
        felt = np.stack([known.static, 2.0 * half * known.by_q, half * known.by_rate])
        pushed = np.stack([np.zeros(known.first.shape), known.second, np.where(still, 0.0, known.first) / 2.0])
        wheel, count = 1e-3 * half * limits.flywheel_kg_mm2, limits.count
        nothing = np.zeros((2, count))
        found: list[tuple[int, bool, bool, Array, Array, Array, Array]] = []
        if asked.acceleration_mm_s2 < inf:
            peak = np.full(count, (1.0 + ROUNDING) * asked.acceleration_mm_s2 / (2.0 * half))
            found += [(sign, False, False, peak, nothing[0], nothing, pushed) for sign in (1, -1)]
        for sign, power_w in ((1, limits.power_w), (-1, np.full(count, asked.braking_w))):
            if np.isfinite(power_w).any():
                found.append((sign, False, True, 1000.0 * power_w / self.task.speed_rad_s, nothing[0], wheel, felt))
        if np.isfinite(limits.flank_load_n_mm).all():
            for sign, angle in zip((1, -1), self.angles, strict=True):
                across, along = limits.flank_load_n_mm * cos(angle), sign * limits.flank_load_n_mm * sin(angle) / 2.0
                found.append((sign, True, False, across, along, wheel, felt))
        rows = len(found)
        return LimitRows(
            np.array([one[1] for one in found]).reshape(rows, 1),
            np.array([one[2] for one in found]).reshape(rows, 1),
            np.array([one[3] for one in found]).reshape(rows, count),
            np.array([one[4] for one in found]).reshape(rows, count),
            np.array([one[0] * one[5][:: one[0]] for one in found]).reshape(rows, 2, count).swapaxes(0, 1),
            np.array([one[0] * one[6] for one in found]).reshape(rows, *felt.shape).swapaxes(0, 1),
        )

    def _without_masses(self, limits: SweptLimits) -> Array:
        """The greatest q in each cell that the power lets be without masses, shape (n, k); infinite with them."""
        known = self.known
        moving = bool(np.any(known.by_rate > 0.0)) or bool(np.any(limits.flywheel_kg_mm2[1] > 0.0))
        torque = np.maximum(np.abs(known.static).min(axis=1) - np.abs(np.diff(known.static, n=2, axis=1))[:, 0], 0.0)
        most = (1000.0 * limits.power_w / (self.task.speed_rad_s * torque[:, None])) ** 2
        driven = np.all(known.static > 0.0, axis=1)[:, None]
        return np.asarray(np.where(driven & (not moving), most, inf))

    def _has_time(self, limits: SweptLimits, curve: Array, lines: Array) -> Array:
        """Whether the time of the cycle, and of stretches of wishes, is enough below a curve, shape (k,)."""
        shortest = self._shortest(curve, lines, self._without_masses(limits))
        room = 1.0 + ROUNDING
        kept = (shortest.sum(axis=0) <= self.task.cycle_rad * room) & np.all(curve >= self._floor / room, axis=0)
        middle = (self.known.ends_rad[1:] + self.known.ends_rad[:-1]) / 2.0
        for one in self.asked.requirements(TimeWithin):
            within = (middle - one.stretch.start_rad) % (2.0 * pi) < one.stretch.end_rad - one.stretch.start_rad
            kept &= shortest[within].sum(axis=0) <= one.most_rad * room
        return np.asarray(kept)

    def _shortest(self, curve: Array, lines: Array, highest: Array) -> Array:
        """The least time in each cell: motions stay below the lines from both ends, and 1/sqrt is convex."""
        step = self.step[:, None]
        (begin, forward), (end, backward) = lines
        place = (end - backward * step - begin) / (forward - backward)
        place = np.clip(np.where(np.isfinite(place), place, step), 0.0, step)
        first, apex, last = (
            np.minimum(begin + forward * at, end + backward * (at - step)) for at in (np.zeros_like(step), place, step)
        )
        mean = ((first + apex) * place + (apex + last) * (step - place)) / (2.0 * step)
        return np.asarray(step / np.sqrt(np.minimum(mean, np.minimum(self._cap, highest))))


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
    return np.asarray((_greatest(np.moveaxis(excess, 1, 0)) <= 0.0) & np.all(way * share >= 0.0, axis=(0, 2)))


def _lowest(line: Line, others: Line) -> Line:
    """Of a line, (k,) each, and others, (j, k), those with the lowest end that have a finite start."""
    start, end, slope = (np.vstack([own, other]) for own, other in zip(line, others, strict=True))
    best = np.argmin(np.where(start < inf, end, inf), axis=0), np.arange(start.shape[1])
    return start[best], end[best], slope[best]


def _greatest(values: Array) -> Array:
    """The greatest value over a cell of a function known at three places, (3, ...), with twice the bend they show."""
    first, middle, last = values
    bend = 2.0 * np.abs(middle - (first + last) / 2.0)
    rise = last - first
    vertex = (first + last) / 2.0 + bend + rise**2 / (16.0 * bend)
    return np.where(np.abs(rise) < 4.0 * bend, vertex, np.maximum(first, last))


def _root(function: Callable[[Array], Array], low: tuple[Array, Array], high: tuple[Array, Array]) -> Array:
    """Places near roots, not below them, of functions positive at ``low`` and negative at ``high``, by false position.

    Each end has its values.
    """
    (left, below), (right, above) = low, high
    side = np.zeros(left.shape)
    for _ in range(5):
        middle = left + (right - left) * below / (below - above)
        value = function(middle)
        over = value <= 0.0
        # An end that stays counts half
        left, below = np.where(over, left, middle), np.where(over, np.where(side > 0.0, below / 2.0, below), value)
        right, above = np.where(over, middle, right), np.where(over, value, np.where(side < 0.0, above / 2.0, above))
        side = np.where(over, 1.0, -1.0)
    return right


def _over(value: Array, divisor: tuple[Array, Array]) -> Array:
    """The greatest quotient of a value and positive divisors of a range, (2, k): the least if it is positive."""
    return np.asarray(np.where(value >= 0.0, value / divisor[0], value / divisor[1]))


def least_flank_load(
    sweeps: Sweeps, power_w: Array, flywheel_kg_mm2: Array, most_n_mm: Array, share: float = 0.3
) -> Array:
    """A lower bound of the flank load in N mm for k caps of the power and ranges of the flywheel, shape (k,).

    It is searched between a ``share`` of ``most_n_mm`` and all of it; zero where none of that range is certain.
    """

    def made(levels: Array, problem: IndexArray) -> SweptLimits:
        return SweptLimits(levels, power_w[problem], flywheel_kg_mm2[:, problem])

    return _bisected(sweeps, made, share * most_n_mm, most_n_mm)


def least_power(sweeps: Sweeps, flywheel_kg_mm2: Array, most_w: Array, share: float = 0.3) -> Array:
    """For k ranges of the flywheel a peak power in W that no law is under, shape (k,), as ``least_flank_load`` does."""

    def made(levels: Array, problem: IndexArray) -> SweptLimits:
        return SweptLimits(np.full(levels.size, inf), levels, flywheel_kg_mm2[:, problem])

    return _bisected(sweeps, made, share * most_w, most_w)


def _bisected(sweeps: Sweeps, made: Callable[[Array, IndexArray], SweptLimits], low: Array, high: Array) -> Array:
    """The greatest certainly impossible level of each problem; zero where no tried level is."""
    low, high, certain = low.copy(), high.copy(), np.zeros(low.size)
    problems = np.repeat(np.arange(low.size), LEVELS)
    for _ in range(ROUNDS):
        levels = np.array([np.geomspace(a, b, LEVELS) for a, b in zip(low, high, strict=True)])
        possible = sweeps.possible(made(levels.ravel(), problems)).reshape(levels.shape)
        for row, own in enumerate(possible):
            # Levels below an impossible one are impossible too
            last = int(np.max(np.nonzero(~own)[0], initial=-1))
            if last >= 0:
                certain[row] = low[row] = levels[row, last]
            high[row] = levels[row, min(last + 1, LEVELS - 1)]
    return certain * (1.0 - ROUNDING)
