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

from collections.abc import Callable
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

RESOLVED = 0.1
"""Most change of a slope over a cell, as a share of q, for which the slopes at three places tell where a curve ends.
The loads of light machines change slopes faster; a motion then follows its equilibrium, and cells tell nothing."""

NEARBY = 1e-6
"""Share of q between two slopes that tell how fast a slope changes with q."""

ROUNDING = 1e-7
"""Share of the time of a cycle, and of levels, that rounding errors may make."""

STANDING = 1e-7
"""Way for an angle of the crank, as a share of the stroke, under which the place counts as a dead centre."""


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
            lines = np.full((2, self.step.size, limits.count), inf)
            for _ in range(TURNS):
                before = curve.copy()
                self._forwards(limits, curve, lines[0])
                self._backwards(limits, curve, lines[1])
                if np.max(before - curve) < SETTLED:
                    break
            return self._has_time(limits, curve, lines)

    @property
    def _floor(self) -> float:
        return float(1.0 / self.asked.ratio_max**2)

    def _begun(self, limits: SweptLimits) -> Array:
        """The greatest q at the ends of cells before any sweep, shape (n + 1, k)."""
        speed, asked, known = self.task.speed_rad_s, self.asked, self.known
        fastest = np.full(self.step.size + 1, 1.0 / asked.ratio_min**2)
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

    def _forwards(self, limits: SweptLimits, curve: Array, lines: Array) -> None:
        for cell in range(self.step.size):
            self._lower(limits, (cell, 0), curve[cell])
            end, lines[cell] = self._barrier(limits, cell, curve[cell], (0, 2), 1)
            curve[cell + 1] = np.minimum(curve[cell + 1], end)
        curve[0] = curve[-1] = np.minimum(curve[0], curve[-1])

    def _backwards(self, limits: SweptLimits, curve: Array, lines: Array) -> None:
        for cell in range(self.step.size - 1, -1, -1):
            self._lower(limits, (cell, 2), curve[cell + 1])
            end, lines[cell] = self._barrier(limits, cell, curve[cell + 1], (2, 0), 0)
            curve[cell] = np.minimum(curve[cell], end)
        curve[0] = curve[-1] = np.minimum(curve[0], curve[-1])

    def _lower(self, limits: SweptLimits, at: tuple[int, int], q: Array) -> None:
        """Lower the curve at a place as long as no slope is possible there."""
        for _ in range(STEPS_DOWN):
            least, most = self.slopes(limits, at, q)
            above = np.where(np.isfinite(most), most + ROUNDING * np.abs(most), most)
            stuck = (least > above) & (q > 0.5 * self._floor)
            if not stuck.any():
                return
            q[stuck] *= LOWERED

    def _barrier(
        self, limits: SweptLimits, cell: int, q: Array, nodes: tuple[int, int], most: int
    ) -> tuple[Array, Array]:
        """The value at the other end of a cell that no motion passes, and the steepest slope towards it, or infinity.

        ``most`` is 1 for the greatest slope, forwards, and 0 for the least, backwards.
        """
        here, there = nodes
        step = self.step[cell] if most else -self.step[cell]
        sign = 1.0 if most else -1.0
        first = self.slopes(limits, (cell, here), q)[most]
        last = first
        for _ in range(2):
            other = np.maximum(q + step * (first + last) / 2.0, 1e-9)
            last = self.slopes(limits, (cell, there), other)[most]
        middle = self.slopes(limits, (cell, 1), np.maximum(q + step * (3.0 * first + last) / 8.0, 1e-9))[most]
        room = 2.0 * np.abs(middle - (first + last) / 2.0) + ROUNDING
        end = q + step * ((first + last) / 2.0 + sign * room)
        line = (np.maximum if most else np.minimum)(first, last) + sign * room
        bounded = np.isfinite(end) & self._resolved(limits, (cell, here), q, first, most)
        bounded &= self._resolved(limits, (cell, there), other, last, most)
        return np.where(bounded, end, inf), np.where(bounded, line, sign * inf)

    def _resolved(self, limits: SweptLimits, at: tuple[int, int], q: Array, slope: Array, most: int) -> Array:
        """Whether the slope follows from no load of masses, or changes so slowly that a cell's places tell it, (k,)."""
        if self.task.masses is None:
            return np.ones(q.shape, dtype=bool)
        own, beside = (self.slopes_by_loads(limits, at, one)[most] for one in (q, q * (1.0 + NEARBY)))
        changes = np.abs(beside - own) * self.step[at[0]]
        return np.asarray(~np.isfinite(own) | (own != slope) | (changes <= RESOLVED * NEARBY * q))

    def slopes(self, limits: SweptLimits, at: tuple[int, int], q: Array) -> tuple[Array, Array]:
        """The least and the greatest q' that all limits allow at a place of a cell, (k,); crossed without any."""
        asked, speed, known = self.asked, self.task.speed_rad_s, self.known
        most = 2.0 * asked.steepness * (q + np.sqrt(q)) if asked.steepness < inf else np.full(q.shape, inf)
        least = -most
        if asked.acceleration_mm_s2 < inf:
            first, bend = float(known.first[at]), float(known.second[at])
            if abs(first) > STANDING * self.task.linkage.stroke_mm:
                peak = (1.0 + ROUNDING) * asked.acceleration_mm_s2 / speed**2
                ends = 2.0 * (peak - bend * q) / first, 2.0 * (-peak - bend * q) / first
                least, most = np.maximum(least, np.minimum(*ends)), np.minimum(most, np.maximum(*ends))
        lower, upper = self.slopes_by_loads(limits, at, q)
        return np.maximum(least, lower), np.minimum(most, upper)

    def slopes_by_loads(self, limits: SweptLimits, at: tuple[int, int], q: Array) -> tuple[Array, Array]:
        """The same that power, braking power and flank load allow, (k,) each."""
        asked, speed, known = self.asked, self.task.speed_rad_s, self.known
        s, least = np.sqrt(q), np.full(q.shape, -inf)
        torque = known.static[at] + speed**2 * known.by_q[at] * q
        # Each bound takes the size of the flywheel's range that bounds least
        half = speed**2 * (known.by_rate[at] + 1e-3 * limits.flywheel_kg_mm2) / 2.0
        massless = half[1] <= 0.0
        spare = 1000.0 * limits.power_w / (speed * s) - torque
        # Without masses the power is a limit of q, which cells have
        most = np.where(massless, inf, _over(spare, half))
        if asked.braking_w < inf:
            spare = 1000.0 * asked.braking_w / (speed * s) + torque
            least = np.where(massless, -inf, -_over(spare, half))
        if not np.isfinite(limits.flank_load_n_mm).any():
            return least, most
        for sign, angle in zip((1.0, -1.0), self.angles, strict=True):
            upper, lower = self._of_flanks(limits.flank_load_n_mm, sign * torque, half, s, angle)
            if sign < 0.0:
                upper, lower = -lower, -upper
            least, most = np.maximum(least, lower), np.minimum(most, upper)
        return least, most

    def _of_flanks(self, load: Array, torque: Array, half: Array, s: Array, angle: float) -> tuple[Array, Array]:
        """The bounds of q' by the flank load H of flanks that a positive torque presses; infinite without a bound.

        M (1 + s)^3 <= H (s cos(alpha) + q' sin(alpha)/(2 (1 + s))), with M = ``torque`` + ``half`` q'.
        """
        cube = (1.0 + s) ** 3
        spare = load * s * cos(angle) - torque * cube
        share = half * cube - load * sin(angle) / (2.0 * (1.0 + s))
        upper = np.where(share[0] > 0.0, _over(spare, share), inf)
        lower = np.where(share[1] < 0.0, -_over(spare, -share[::-1]), -inf)
        free = ~np.isfinite(load)
        return np.where(free, inf, upper), np.where(free, -inf, lower)

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
        step, begin, end = self.step[:, None], curve[:-1], curve[1:]
        forward, backward = lines
        place = (end - begin - backward * step) / (forward - backward)
        place = np.clip(np.where(np.isfinite(place), place, step), 0.0, step)
        apex = begin + forward * place
        mean = ((begin + apex) * place + (apex + end) * (step - place)) / (2.0 * step)
        most = np.minimum(1.0 / self.asked.ratio_min**2, highest)
        return np.asarray(step / np.sqrt(np.where(np.isfinite(mean), np.minimum(mean, most), most)))


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
