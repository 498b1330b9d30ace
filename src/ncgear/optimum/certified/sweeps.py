"""A lower limit of flank load and peak power, by sweeps around the turn of the crank.

Let phi be the crank's angle, s = dphi/dphi1, q = s^2, primes by phi, and w the driving shaft's speed.  At a place and a
value of q every limit of the pressure angle, acceleration, power, braking power and flank load is a range of q', since
the crank's torque M = M0 + w^2 (c q + J q'/2) is linear in q and q'.  So every motion that keeps them lies below the
greatest periodic curve with slopes in these ranges (comparison of scalar differential inequalities).  A cycle takes at
least the time along that curve.  Where that exceeds its time, no motion keeps all limits.

The curve is followed from cell to cell as a barrier: its slope is the greatest possible one at both ends of a cell,
linear between them, and a little more.  The addition is twice the distance of the greatest slope in the middle of the
cell from that line: the greatest slope is the least of smooth functions of known quantities, and concave where two of
them meet.  The jumps of a load are ends of cells.

Both pitch curves may have dents here, and jerk, curvature and other forces are free; so the limit holds for more laws
than the search has.  The flywheel may have any size of a range.
"""

from __future__ import annotations

from collections.abc import Callable, Sequence
from typing import Any
from functools import partial
from math import cos, inf, pi, sin

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
"""Lines of a cell: the start, infinite where there is none, the end, and the steepest slope, (k,) each."""

LOOSE = 1e-4
"""Share of q that a cell may add to a curve before lines are tried in its place."""

Limit = Callable[[Place, Array], tuple[Array, Array]]
"""What a limit leaves at places for values of q, and its shares of q' with both ends of the flywheel's range."""


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
            curve = self._begun(limits)
            kinds = self._limits(limits)
            resting = {way: [self._resting(one, way, limits.count) for one in kinds] for way in (1, -1)}
            lines = np.empty((2, 2, self.step.size, limits.count))
            lines[:, 0], lines[:, 1] = self._cap, 0.0
            for _ in range(TURNS):
                before = curve.copy()
                for way in (1, -1):
                    self._sweep(limits, way, curve, lines[max(-way, 0)], resting[way])
                if np.max(before - curve) < SETTLED:
                    break
            return self._has_time(limits, curve, lines)

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

    def _sweep(self, limits: SweptLimits, way: int, curve: Array, lines: Array, resting: list[Array]) -> None:
        """Lower a curve from cell to cell, forwards (``way`` 1) or backwards (-1); ``lines`` are the barriers, (2, n, k).

        A line has the value at the end of the cell from which it comes, and its slope.
        """
        kinds = self._limits(limits)
        for cell in range(self.step.size)[::way]:
            here, there = (cell, cell + 1)[::way]
            step = way * self.step[cell]
            self._lower(limits, (cell, 1 - way), curve[here])
            q = curve[here]
            line, loose = self._parabola(limits, kinds, cell, q, way)
            for number, kind in enumerate(kinds):
                level, steady = resting[number][:, cell]
                line = _lower_of(line, (np.where(q <= level, level, inf), level + step * steady, steady))
                above = loose & (q > level) & (level + step * steady < line[1])
                if above.any():
                    line = _lower_of(line, self._falling(kind, cell, q, level + step * steady, way))
            start, end, slope = line
            bounded = start < inf
            lines[0, cell] = np.where(bounded, start, self._cap)
            lines[1, cell] = np.where(bounded, slope, 0.0)
            curve[there] = np.where(bounded, np.minimum(curve[there], end), curve[there])
        curve[0] = curve[-1] = np.minimum(curve[0], curve[-1])

    def _lower(self, limits: SweptLimits, at: Place, q: Array) -> None:
        """Lower the curve at a place as long as no slope is possible there."""
        stuck = self._stuck(limits, at, q)
        for _ in range(STEPS_DOWN):
            if not stuck.any():
                return
            # Between two values without a possible slope there is none
            stuck &= self._stuck(limits, at, LOWERED * q)
            q[stuck] *= LOWERED

    def _stuck(self, limits: SweptLimits, at: Place, q: Array) -> Array:
        least, most = self.slopes(limits, at, q)
        above = np.where(np.isfinite(most), most + ROUNDING * np.abs(most), most)
        return np.asarray((least > above) & (q > 0.5 * self._floor))

    def _parabola(
        self, limits: SweptLimits, kinds: Sequence[Limit], cell: int, q: Array, way: int
    ) -> tuple[Line, Array]:
        """A barrier of nearly the steepest slopes, and whether lines may be tighter."""
        at = cell, slice(None, None, way)
        step, most = way * self.step[cell], max(way, 0)
        slope = self.slopes(limits, at, np.repeat(q[None], 3, axis=0))[most]
        for _ in range(3):
            slopes = slope[0] + (slope[2] - slope[0]) * SHARES
            slope = self.slopes(limits, at, _along(q, step, slopes))[most]
        room = 2.5 * np.abs(slope[1] - (slope[0] + slope[2]) / 2.0) + ROUNDING
        slopes = slope[0] + way * room + (slope[2] - slope[0]) * SHARES
        curve = _along(q, step, slopes)
        most_now = self.slopes(limits, at, curve)[most]
        kept = _greatest(way * (most_now - slopes)) <= 0.0
        for kind in kinds:
            kept |= self._passed(kind, at, curve, slopes, way)
        loose = ~kept | (room * abs(step) > LOOSE * q)
        return (np.where(kept, q, inf), curve[2], way * np.maximum(way * slopes[0], way * slopes[2])), loose

    def _passed(self, kind: Limit, at: Place, q: Array, slope: Array, way: int) -> Array:
        """Whether a limit lets no motion pass a line upwards, by values at three places, (3, ..., k) each."""
        spare, share = kind(at, q)
        excess = np.maximum(spare - share[0] * slope, spare - share[1] * slope)
        return np.asarray((_greatest(excess) <= 0.0) & np.all(way * share >= 0.0, axis=(0, 1)))

    def _resting(self, kind: Limit, way: int, count: int) -> Array:
        """Lines near which motions at a limit go on, however light the machine: starts, or infinity, and slopes, (2, n, k).

        A motion below its start in a cell does not pass it.
        """
        at = np.s_[np.arange(self.step.size), np.arange(3)[::way, None]]
        step = way * self.step[:, None]
        slope = np.zeros((self.step.size, count))
        level = self._level(kind, at, slope)
        slope = (level[2] - level[0]) / step
        level = self._level(kind, at, slope) - SHARES[..., None] * step * slope
        start = _greatest(level) * (1.0 + ROUNDING)
        passed = self._passed(kind, at, start + SHARES[..., None] * step * slope, np.repeat(slope[None], 3, axis=0), way)
        return np.stack([np.where(passed, start, inf), np.where(passed, slope, 0.0)])

    def _level(self, kind: Limit, at: Place, slope: Array) -> Array:
        """The greatest q from which a limit stops a slope, up to the greatest q, (3, n, k)."""

        def excess(q: Array) -> Array:
            spare, share = kind(at, q)
            return np.maximum(spare - share[0] * slope, spare - share[1] * slope)

        shape = (3, *slope.shape)
        high, low = np.full(shape, self._cap), np.full(shape, self._floor)
        found = excess(high) <= 0.0
        above, below = excess(high), np.full(shape, np.nan)
        going = found.copy()
        for q in np.geomspace(self._cap, self._floor, 12)[1:]:
            value = excess(np.full(shape, q))
            stops = going & (value > 0.0)
            low[stops], below[stops] = q, value[stops]
            going &= ~stops
            high[going], above[going] = q, value[going]
        # Below the floor no motion is possible
        low[going] = high[going]
        return np.where(found, _root(excess, low, high, below, above), np.nan)

    def _falling(self, kind: Limit, cell: int, q: Array, resting: Array, way: int) -> Line:
        """A line from above the motions at a limit towards them: its start, or infinity, and its slope, (k,) each."""
        at, end = (cell, slice(None, None, way)), (cell, 1 + way)
        step = way * self.step[cell]

        def excess(other: Array) -> Array:
            spare, share = kind(end, other)
            slope = (other - q) / step
            return np.maximum(spare - share[0] * slope, spare - share[1] * slope)

        low = np.where(resting < q, resting, self._floor)
        slope = (_root(excess, low, q.copy(), excess(low), excess(q)) - q) / step
        start = q
        for _ in range(2):
            lines = [one + SHARES * step * slope for one in (start, start * (1.0 + NEARBY))]
            below, above = (self._excess(kind, at, one, slope) for one in lines)
            start = start + 1.1 * np.maximum(_greatest(below / (below - above)), 0.0) * NEARBY * start
        passed = self._passed(kind, at, start + SHARES * step * slope, np.repeat(slope[None], 3, axis=0), way)
        return np.where(passed, start, inf), start + step * slope, slope

    def _excess(self, kind: Limit, at: Place, q: Array, slope: Array) -> Array:
        spare, share = kind(at, q)
        return np.maximum(spare - share[0] * slope, spare - share[1] * slope)

    def slopes(self, limits: SweptLimits, at: Place, q: Array) -> tuple[Array, Array]:
        """The least and the greatest q' that all limits allow at places of cells, (..., k); crossed without any."""
        asked = self.asked
        most = 2.0 * asked.steepness * (q + np.sqrt(q)) if asked.steepness < inf else np.full(q.shape, inf)
        least = -most
        for kind in self._limits(limits):
            spare, share = kind(at, q)
            most = np.minimum(most, np.where((share[0] >= 0.0) & (share[1] > 0.0), _over(spare, share), inf))
            share = -share[::-1]
            least = np.maximum(least, np.where((share[0] >= 0.0) & (share[1] > 0.0), -_over(spare, share), -inf))
        return least, most

    def _limits(self, limits: SweptLimits) -> list[Limit]:
        """What each limit leaves at places of cells and values of q, (..., k), and its shares of q', (2, ..., k).

        A slope keeps a limit where its share times q' is not over what is left, with one size of the flywheel's range.
        """
        asked, speed, known = self.asked, self.task.speed_rad_s, self.known
        still = STANDING * self.task.linkage.stroke_mm

        def torque(at: Place, q: Array) -> tuple[Array, Array]:
            """The crank's torque, and half its share of q' with the ends of the flywheel's range."""
            half = speed**2 * (known.by_rate[at][..., None] + 1e-3 * wheels(q)) / 2.0
            return known.static[at][..., None] + speed**2 * known.by_q[at][..., None] * q, half

        def wheels(q: Array) -> Array:
            return limits.flywheel_kg_mm2.reshape(2, *[1] * (q.ndim - 1), -1)

        def acceleration(sign: float, at: Place, q: Array) -> tuple[Array, Array]:
            first = known.first[at][..., None] * np.ones(q.shape)
            spare = (1.0 + ROUNDING) * asked.acceleration_mm_s2 / speed**2 - sign * known.second[at][..., None] * q
            return spare, np.stack([sign * np.where(np.abs(first) > still, first, 0.0) / 2.0] * 2)

        def power(sign: float, most_w: Array | float, at: Place, q: Array) -> tuple[Array, Array]:
            s, (static, half) = np.sqrt(q), torque(at, q)
            return 1000.0 * most_w / speed - sign * static * s, (half * s)[:: int(sign)] * sign

        def flank(sign: float, angle: float, at: Place, q: Array) -> tuple[Array, Array]:
            # M (1 + s)^3 <= H (s cos(alpha) + q' sin(alpha)/(2 (1 + s))), with M = torque + half q'
            s, (static, half) = np.sqrt(q), torque(at, q)
            load, cube = limits.flank_load_n_mm, (1.0 + s) ** 3
            share = half * cube - load * sin(angle) / (2.0 * (1.0 + s))
            return load * s * cos(angle) - sign * static * cube, share[:: int(sign)] * sign

        kinds: list[Limit] = []
        if asked.acceleration_mm_s2 < inf:
            kinds += [partial(acceleration, sign) for sign in (1.0, -1.0)]
        if np.isfinite(limits.power_w).any():
            kinds.append(partial(power, 1.0, limits.power_w))
        if asked.braking_w < inf:
            kinds.append(partial(power, -1.0, asked.braking_w))
        if np.isfinite(limits.flank_load_n_mm).all():
            kinds += [partial(flank, sign, angle) for sign, angle in zip((1.0, -1.0), self.angles, strict=True)]
        return kinds

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


def _lower_of(line: Line, other: Line) -> Line:
    """The one of two lines with the lower end; without a finite start it is none."""
    better = (other[0] < inf) & ((other[1] < line[1]) | ~(line[0] < inf))
    start, end, slope = (np.where(better, new, old) for new, old in zip(other, line, strict=True))
    return start, end, slope


def _greatest(values: Array) -> Array:
    """The greatest value over a cell of a function known at three places, (3, ...), with twice the bend they show."""
    first, middle, last = values
    bend = 2.0 * np.abs(middle - (first + last) / 2.0)
    rise = last - first
    vertex = (first + last) / 2.0 + bend + rise**2 / (16.0 * bend)
    return np.where(np.abs(rise) < 4.0 * bend, vertex, np.maximum(first, last))


def _root(function: Callable[[Array], Array], low: Array, high: Array, below: Array, above: Array) -> Array:
    """Values near a root, not under it, of functions that are positive at ``low`` and negative at ``high``."""
    kept = 0
    side = np.zeros(low.shape)
    for _ in range(5):
        middle = low + (high - low) * below / (below - above)
        value = function(middle)
        over = value <= 0.0
        low, below = np.where(over, low, middle), np.where(over, np.where(side > 0, below / 2.0, below), value)
        high, above = np.where(over, middle, high), np.where(over, value, np.where(side < 0, above / 2.0, above))
        side = np.where(over, 1.0, -1.0)
    return high


def _over(value: Array, divisor: Array) -> Array:
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
