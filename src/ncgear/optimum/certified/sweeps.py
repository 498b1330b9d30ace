"""A lower limit of flank load and peak power, by sweeps around the turn of the crank.

Let phi be the crank's angle, s = dphi/dphi1, q = s^2, primes by phi, and w the driving shaft's speed.  At a place and a
value of q every limit of the pressure angle, acceleration, power, braking power and flank load is a range of q', since
the crank's torque M = M0 + w^2 (c q + J q'/2) is linear in q and q'.  So every motion that keeps them lies below the
greatest periodic curve and above the least one whose slopes stay in these ranges (comparison of scalar differential
inequalities).  A cycle then takes no less time than along the greatest curve, and no more than along the least one.
Where its time is not between both, no motion keeps all limits.

Curves are barriers, cell by cell: a straight line that no motion crosses, because the greatest slope over the whole
box about it, all angles of the cell and all values of q along it, is not over its own.  Ranges of the linkage's own
known functions in a cell are those of five of its angles, widened by their second differences.  Both pitch curves may
be of any convexity here, and jerk, curvature and forces other than these are free; so the limit holds for more laws
than those that are sought.  The flywheel may be any of a range of inertia.
"""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import replace
from math import cos, inf, pi, sin

import numpy as np

from ncgear.frozen import dataclass
from ncgear.numerics.arrays import Array
from ncgear.optimum.certified.demands import Demands
from ncgear.optimum.makeable.places import cell_ends, slider_at
from ncgear.optimum.task import Task
from ncgear.wishes.requirements import TimeWithin

CELLS = 720
"""Cells of a turn: with twice as many the limit of a baler rises by less than half a hundredth."""

INSIDE = np.array([1e-7, 0.25, 0.5, 0.75, 1.0 - 1e-7])
"""Places in a cell where known functions are taken, as shares of it; its ends from inside, where loads may jump."""

TURNS = 3
"""Sweeps around the turn each way; later ones change nothing that counts, and less of them gives a lower limit."""

LEVELS = 17
"""Levels of a figure that are tried at once."""

ROUNDS = 2
"""Rounds of levels, each between two neighbours of the round before."""

LOWERED, STEPS_DOWN = 0.995, 12
"""Ratio by which a curve is lowered where no slope is possible, and how often at a place."""

TIME_ROUNDING = 1e-9
"""Share of the time of a cycle that rounding errors may make."""


@dataclass(frozen=True, eq=False)
class CellRanges:
    """Ranges of the linkage's known functions in n cells, least and greatest value, shape (2, n) each.

    ``first`` and ``second`` are the displacement's derivatives; the crank's torque in N mm is ``static`` + w^2 (``by_q``
    q + ``by_rate`` q'/2).  ``ends_rad`` has shape (n + 1,); ``first_at`` and ``second_at`` are at these ends.
    """

    ends_rad: Array
    first: Array
    second: Array
    static: Array
    by_q: Array
    by_rate: Array
    first_at: Array
    second_at: Array


@dataclass(frozen=True, eq=False)
class SweptLimits:
    """Limits of k problems that are swept at once, shape (k,) each; infinite where free.

    ``flywheel`` has the least and the greatest inertia in kg mm2 that may be added to the crank's, shape (2, k).
    """

    flank_load_n_mm: Array
    power_w: Array
    flywheel_kg_mm2: Array

    @property
    def count(self) -> int:
        """Number of problems."""
        return self.power_w.size


def cell_ranges(task: Task, asked: Demands, cells: int = CELLS) -> CellRanges:
    """The ranges of a machine in about so many cells."""
    stretches = [one.asked.stretch for one in asked.wishes if isinstance(one.asked, TimeWithin)]
    knots = np.linspace(0.0, 2.0 * pi, cells, endpoint=False)
    ends = cell_ends(task, knots, stretches)
    width = np.diff(ends)
    places = ends[:-1, None] + width[:, None] * INSIDE
    at = slider_at(task, np.clip(places.ravel(), 0.0, 2.0 * pi * (1.0 - 1e-12)))
    # Without masses only the resistance turns the crank
    static = at.torque if task.masses is not None else at.force_n * at.first
    columns = [at.first, at.second, static, at.torque_by_q, at.torque_by_rate]
    ranges = [_range(np.broadcast_to(np.asarray(one, dtype=float), places.size).reshape(places.shape)) for one in columns]
    beside = slider_at(task, np.clip(ends, 0.0, 2.0 * pi * (1.0 - 1e-12)))
    return CellRanges(ends, *ranges, np.asarray(beside.first), np.asarray(beside.second))


def _range(values: Array) -> Array:
    """Least and greatest value in each cell, shape (2, n), from values at five places, shape (n, 5)."""
    room = np.abs(np.diff(values, n=2, axis=1)).max(axis=1)
    return np.stack([values.min(axis=1) - room, values.max(axis=1) + room])


class Sweeps:
    """The sweeps of a machine under demands."""

    def __init__(self, task: Task, asked: Demands, cells: int = CELLS) -> None:
        self.task, self.asked = task, asked
        self.on = cell_ranges(task, asked, cells)
        self.step = np.diff(self.on.ends_rad)
        gears = task.gears
        pushing = gears.rack_angle_rad if gears else asked.rack_angle_rad
        idle = (gears.idle_angle_rad if gears else None) or pushing
        self.angles = pushing, idle

    def possible(self, limits: SweptLimits) -> Array:
        """Whether a motion may keep the limits, shape (k,): False is certain."""
        low, high = self._begun(limits)
        slopes: dict[str, Array] = {}
        alive = np.ones(limits.count, dtype=bool)
        for _ in range(TURNS):
            before = high.copy(), low.copy()
            slopes = self._swept(limits, low, high)
            alive = np.all(low <= high, axis=0) & np.all(np.isfinite(high) & np.isfinite(low), axis=0)
            moved = max(np.max(np.abs(high - before[0])[:, alive], initial=0.0), np.max(np.abs(low - before[1])[:, alive], initial=0.0))
            if not alive.any() or moved < 1e-6:
                break
        return np.asarray(alive & self._has_time(low, high, slopes))

    def _begun(self, limits: SweptLimits) -> tuple[Array, Array]:
        """Least and greatest q at the ends of cells before any sweep, shape (n + 1, k) each."""
        speed, asked = self.task.speed_rad_s, self.asked
        least, most = 1.0 / asked.ratio_max**2, 1.0 / asked.ratio_min**2
        fastest = np.full(self.on.ends_rad.size, most)
        way, bend = np.abs(self.on.first_at), np.abs(self.on.second_at)
        with np.errstate(divide="ignore"):
            if asked.speed_mm_s < inf:
                fastest = np.minimum(fastest, (asked.speed_mm_s / (speed * way)) ** 2)
            if asked.acceleration_mm_s2 < inf:
                still = way <= 1e-9 * self.task.linkage.stroke_mm
                fastest = np.where(still, np.minimum(fastest, asked.acceleration_mm_s2 / (speed**2 * bend)), fastest)
        high = np.repeat(fastest[:, None], limits.count, axis=1)
        return np.full_like(high, least), high

    def _swept(self, limits: SweptLimits, low: Array, high: Array) -> dict[str, Array]:
        """Lower the greatest curve and raise the least one, each forwards and backwards; gives slopes along them."""
        cells = self.step.size
        shape = cells, limits.count
        top = {"forward": np.empty(shape), "backward": np.empty(shape), "up": np.empty(shape), "down": np.empty(shape)}
        for cell in range(cells):
            self._lowered(limits, cell, low, high)
            rise, slope = self._barrier(limits, cell, high[cell], upper=True, forward=True)
            high[cell + 1] = np.minimum(high[cell + 1], rise)
            top["forward"][cell] = slope
            rise, slope = self._barrier(limits, cell, low[cell], upper=False, forward=True)
            low[cell + 1] = np.maximum(low[cell + 1], rise)
            top["up"][cell] = slope
        high[0] = high[-1] = np.minimum(high[0], high[-1])
        low[0] = low[-1] = np.maximum(low[0], low[-1])
        for cell in range(cells - 1, -1, -1):
            rise, slope = self._barrier(limits, cell, high[cell + 1], upper=True, forward=False)
            high[cell] = np.minimum(high[cell], rise)
            top["backward"][cell] = slope
            rise, slope = self._barrier(limits, cell, low[cell + 1], upper=False, forward=False)
            low[cell] = np.maximum(low[cell], rise)
            top["down"][cell] = slope
        high[0] = high[-1] = np.minimum(high[0], high[-1])
        low[0] = low[-1] = np.maximum(low[0], low[-1])
        return top

    def _lowered(self, limits: SweptLimits, cell: int, low: Array, high: Array) -> None:
        """Lower the greatest curve at a place where no slope is possible just below it."""
        for _ in range(STEPS_DOWN):
            under = LOWERED * high[cell]
            least, most = self.slopes(limits, cell, under, high[cell])
            stuck = (least > most) & (high[cell] >= low[cell])
            if not stuck.any():
                return
            high[cell] = np.where(stuck, under, high[cell])

    def _barrier(
        self, limits: SweptLimits, cell: int, q: Array, *, upper: bool, forward: bool
    ) -> tuple[Array, Array]:
        """The value at the other end of a cell that no motion passes, from a value at one end, and the line's slope.

        Infinite, or nothing, where no line was found that holds.
        """
        step = self.step[cell] if forward else -self.step[cell]
        greatest = upper is forward
        none = np.full(q.shape, inf if upper else -inf)
        other = q
        for _ in range(2):
            least, most = self.slopes(limits, cell, np.minimum(q, other), np.maximum(q, other))
            slope = most if greatest else least
            other = np.where(np.isfinite(slope), q + step * slope, q)
            other = np.clip(other, 1e-9, 1e9)
        # A little more room, so that the box about the line that is told holds the line
        other = other + (1.0 if upper else -1.0) * 1e-3 * np.abs(other - q)
        other = np.maximum(other, 1e-9)
        least, most = self.slopes(limits, cell, np.minimum(q, other), np.maximum(q, other))
        slope, line = (most if greatest else least), (other - q) / step
        holds = (slope <= line * (1.0 + 1e-12)) if greatest else (slope >= line * (1.0 - 1e-12) - 1e-15)
        holds = np.where(np.abs(line) > 0.0, holds, slope <= 0.0 if greatest else slope >= 0.0)
        return np.where(holds, other, none), np.where(holds, line, inf if greatest else -inf)

    def slopes(self, limits: SweptLimits, cell: int, low: Array, high: Array) -> tuple[Array, Array]:
        """Bounds of q' over a cell and all q in a range, shape (k,): the least and the greatest that any limit lets be.

        The least is over the greatest where no motion has such a q there.
        """
        asked, speed, on = self.asked, self.task.speed_rad_s, self.on
        slow, fast = np.sqrt(low), np.sqrt(high)
        most = np.full(low.shape, inf)
        least = -most
        if asked.steepness < inf:
            most = 2.0 * asked.steepness * (high + fast)
            least = -most
        if asked.acceleration_mm_s2 < inf:
            first, bend = on.first[:, cell], on.second[:, cell]
            if first[0] > 0.0 or first[1] < 0.0:
                peak = asked.acceleration_mm_s2 / speed**2
                part = np.stack([bend[0] * low, bend[0] * high, bend[1] * low, bend[1] * high])
                ends = 2.0 * np.stack([-peak - part.max(axis=0), peak - part.min(axis=0)])
                tried = np.stack([ends[0] / first[0], ends[0] / first[1], ends[1] / first[0], ends[1] / first[1]])
                most, least = np.minimum(most, tried.max(axis=0)), np.maximum(least, tried.min(axis=0))
        rate = on.by_rate[:, cell, None] + 1e-3 * limits.flywheel_kg_mm2
        carried = np.stack([on.by_q[i, cell] * q for i in (0, 1) for q in (low, high)])
        torque = np.stack(
            [on.static[0, cell] + speed**2 * carried.min(axis=0), on.static[1, cell] + speed**2 * carried.max(axis=0)]
        )
        half = speed**2 * np.maximum(rate, 0.0) / 2.0
        has_mass = half[0] > 0.0
        power = limits.power_w
        spare = 1000.0 * power / (speed * slow) - torque[0]
        most = np.where(has_mass, np.minimum(most, _over(spare, half)), np.where(spare < 0.0, -inf, most))
        if asked.braking_w < inf:
            spare = 1000.0 * asked.braking_w / (speed * slow) + torque[1]
            least = np.where(has_mass, np.maximum(least, -_over(spare, half)), np.where(spare < 0.0, inf, least))
        return self._of_flanks(limits, (low, high), (slow, fast), torque, half, least, most)

    def _of_flanks(
        self,
        limits: SweptLimits,
        q: tuple[Array, Array],
        s: tuple[Array, Array],
        torque: Array,
        half: Array,
        least: Array,
        most: Array,
    ) -> tuple[Array, Array]:
        """The bounds with the limit of the flank load.

        |M| (1 + s)^3 <= H (s cos(alpha) +- q'/(2 (1 + s)) sin(alpha)), plus where M is positive.
        """
        load = limits.flank_load_n_mm
        limited = np.isfinite(load)
        if not limited.any():
            return least, most
        load = np.where(limited, load, 0.0)
        cube = [(1.0 + one) ** 3 for one in s]
        for sign, angle in zip((1.0, -1.0), self.angles, strict=True):
            turned = torque if sign > 0.0 else -torque[::-1]
            borne = np.stack([one * c for one in (turned[0],) for c in cube]).min(axis=0)
            spare = load * s[1] * cos(angle) - borne
            lever = [load * sin(angle) / (2.0 * (1.0 + one)) for one in s]
            share = np.stack([half[0] * cube[0] - lever[0], half[1] * cube[1] - lever[1]])
            # share is over zero: sign q' <= spare / share; under zero: sign q' >= -spare / |share|
            above, below = share[0] > 0.0, share[1] < 0.0
            upper = np.where(above & limited, _over(spare, np.where(share > 0.0, share, 1.0)), inf)
            lower = np.where(below & limited, -_over(spare, np.where(share < 0.0, -share, 1.0)[::-1]), -inf)
            if sign > 0.0:
                most, least = np.minimum(most, upper), np.maximum(least, lower)
            else:
                most, least = np.minimum(most, -lower), np.maximum(least, -upper)
        return least, most

    def _has_time(self, low: Array, high: Array, slopes: dict[str, Array]) -> Array:
        """Whether the time of the cycle, and of stretches that wishes name, can be kept by curves between both."""
        with np.errstate(all="ignore"):
            shortest = self._shortest(high, slopes["forward"], slopes["backward"])
            longest = self._longest(low, slopes["up"], slopes["down"])
        cycle, room = self.task.cycle_rad, 1.0 + TIME_ROUNDING
        kept = (shortest.sum(axis=0) <= cycle * room) & (longest.sum(axis=0) * room >= cycle)
        middle = (self.on.ends_rad[1:] + self.on.ends_rad[:-1]) / 2.0
        for one in self.asked.requirements(TimeWithin):
            start, end = one.stretch.start_rad, one.stretch.end_rad
            within = (middle - start) % (2.0 * pi) < end - start
            kept &= shortest[within].sum(axis=0) <= one.most_rad * room
            kept &= longest[within].sum(axis=0) * room >= one.least_rad
        return np.asarray(kept)

    def _shortest(self, high: Array, forward: Array, backward: Array) -> Array:
        """The least time in each cell: no motion is above the lines from both ends, and 1/sqrt is convex."""
        step, begin, end = self.step[:, None], high[:-1], high[1:]
        top = _crossing(step, begin, end, forward, backward)
        return np.asarray(step / np.sqrt(top))

    def _longest(self, low: Array, forward: Array, backward: Array) -> Array:
        """The greatest time in each cell: no motion is below the least of both ends and of where the lines meet."""
        step, begin, end = self.step[:, None], low[:-1], low[1:]
        place = np.clip((end - begin - backward * step) / (forward - backward), 0.0, step)
        place = np.where(np.isfinite(place), place, 0.0)
        bottom = np.where(np.isfinite(forward), begin + forward * place, np.minimum(begin, end))
        floor = 1.0 / self.asked.ratio_max**2
        bottom = np.maximum(np.where(np.isfinite(forward) & np.isfinite(backward), bottom, floor), floor)
        return np.asarray(step / np.sqrt(np.minimum(np.minimum(begin, end), bottom)))


def _crossing(step: Array, begin: Array, end: Array, forward: Array, backward: Array) -> Array:
    """The mean over a cell of the lesser of two lines, one from each end."""
    place = (end - begin - backward * step) / (forward - backward)
    place = np.clip(np.where(np.isfinite(place), place, step), 0.0, step)
    apex = np.where(np.isfinite(forward), begin + forward * place, end - backward * (step - place))
    apex = np.where(np.isfinite(apex), apex, inf)
    return np.asarray(((begin + apex) * place + (apex + end) * (step - place)) / (2.0 * step))


def _over(value: Array, divisor: Array) -> Array:
    """The greatest of a value over divisors of a range, all positive: the least divisor where the value is positive."""
    with np.errstate(divide="ignore", invalid="ignore"):
        return np.asarray(np.where(value >= 0.0, value / divisor[0], value / divisor[1]))


def least_flank_load(
    sweeps: Sweeps, power_w: Array, flywheel_kg_mm2: Array, most_n_mm: Array, share: float = 0.3
) -> Array:
    """For k caps of the power and ranges of the flywheel a flank load in N mm that no law is under, shape (k,).

    It is looked for between a ``share`` of ``most_n_mm``, such as the load of a law that was found, and all of it.
    """

    def made(levels: Array, problem: Array) -> SweptLimits:
        return SweptLimits(levels, power_w[problem], flywheel_kg_mm2[:, problem])

    return _bisected(sweeps, made, share * most_n_mm, most_n_mm)


def least_power(sweeps: Sweeps, flywheel_kg_mm2: Array, most_w: Array, share: float = 0.3) -> Array:
    """For k ranges of the flywheel a peak power in W that no law is under, shape (k,), as ``least_flank_load`` does."""

    def made(levels: Array, problem: Array) -> SweptLimits:
        return SweptLimits(np.full(levels.size, inf), levels, flywheel_kg_mm2[:, problem])

    return _bisected(sweeps, made, share * most_w, most_w)


def _bisected(sweeps: Sweeps, made: Callable[[Array, Array], SweptLimits], low: Array, high: Array) -> Array:
    """The greatest level that is certainly impossible of each problem; zero where none of those tried is."""
    low, high, certain = low.copy(), high.copy(), np.zeros(low.size)
    problems = np.repeat(np.arange(low.size), LEVELS)
    for _ in range(ROUNDS):
        levels = np.array([np.geomspace(a, b, LEVELS) for a, b in zip(low, high, strict=True)])
        possible = sweeps.possible(made(levels.ravel(), problems)).reshape(levels.shape)
        for row, own in enumerate(possible):
            # Levels below an impossible one are impossible too
            last = int(np.max(np.nonzero(~own)[0], initial=-1))
            if last >= 0:
                certain[row] = max(certain[row], levels[row, last])
                low[row] = levels[row, last]
            high[row] = levels[row, min(last + 1, LEVELS - 1)]
    return certain


def without_wishes(asked: Demands) -> Demands:
    """The demands without what wishes ask for: fewer demands, and a limit that holds as well."""
    return replace(asked, wishes=())
