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
from typing import NamedTuple

import numpy as np

from ncgear.frozen import dataclass
from ncgear.numerics.arrays import Array, IndexArray
from ncgear.optimum.certified.barriers import Barriers, LimitRows, Line, Place, lowest
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
    stretches = [requirement.stretch for requirement in asked.requirements(TimeWithin)]
    ends = cell_ends(task, np.linspace(0.0, 2.0 * pi, cells, endpoint=False), stretches)
    places = ends[:-1, None] + np.diff(ends)[:, None] * NODES
    at = slider_at(task, places.ravel())
    # Without masses the resistance alone turns the crank
    static = at.torque if task.masses is not None else at.force_n * at.first
    columns = at.first, at.second, static, at.torque_by_q, at.torque_by_rate
    return LinkageValues(
        ends, *(np.broadcast_to(np.asarray(column, dtype=float), places.size).reshape(-1, 3) for column in columns)
    )


class _Limit(NamedTuple):
    """A limit to one side, ``sign`` 1 upwards or -1 downwards; the rest is a row of ``LimitRows`` before the sign."""

    sign: int
    flank: bool
    power: bool
    level: Array
    tilt: Array
    wheel: Array
    felt: Array


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
            curve, barriers = self._begun(limits), self._barriers(limits)
            resting = [(way, barriers.resting(way)) for way in (1, -1)]
            lines = np.zeros((2, 2, self.step.size, limits.count))
            lines[:, 0] = self._cap
            for _ in range(TURNS):
                before = curve.copy()
                for way, calm in resting:
                    self._sweep(barriers, way, curve, lines[max(-way, 0)], calm)
                possible = self._has_time(curve, lines)
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
        return np.repeat(fastest[:, None], limits.count, axis=1)

    def _sweep(self, barriers: Barriers, way: int, curve: Array, lines: Array, resting: Line) -> None:
        """Lower a curve from cell to cell, forwards (``way`` 1) or backwards (-1), and its barriers' lines, (2, n, k).

        A line has the value at the end of the cell from which it comes, and its slope.
        """
        for cell in range(self.step.size)[::way]:
            here, there = (cell, cell + 1)[::way]
            self._lower(barriers, (cell, 1 - way), curve[here])
            q, (level, reached, slope) = curve[here], (values[:, cell] for values in resting)
            line, loose = barriers.parabola(cell, q, way)
            line = lowest(line, (np.where(q <= level, level, inf), reached, slope))
            above = loose & (q > level) & (reached < line[1])
            if above.any():
                line = lowest(line, barriers.falling(cell, q, reached, way))
            start, end, slope = line
            bounded = start < inf
            lines[0, cell] = np.where(bounded, start, self._cap)
            lines[1, cell] = np.where(bounded, slope, 0.0)
            curve[there] = np.where(bounded & (end < curve[there]), end, curve[there])
        curve[0] = curve[-1] = np.minimum(curve[0], curve[-1])

    def _lower(self, barriers: Barriers, at: Place, q: Array) -> None:
        """Lower the curve at a place as long as no slope is possible there."""
        stuck = self._stuck(barriers, at, q)
        for _ in range(STEPS_DOWN):
            if not stuck.any():
                return
            # Between two values without a possible slope there is none
            stuck = np.logical_and(stuck, self._stuck(barriers, at, LOWERED * q))
            q[stuck] *= LOWERED

    def _stuck(self, barriers: Barriers, at: Place, q: Array) -> Array:
        least, most = barriers.slopes(at, q)
        above = np.where(np.isfinite(most), most + ROUNDING * np.abs(most), most)
        return np.asarray((least > above) & (q > LOWERED * self._floor))

    def slopes(self, limits: SweptLimits, at: Place, q: Array) -> tuple[Array, Array]:
        """The least and the greatest q' that all limits allow at places of cells, (..., k); crossed without any."""
        return self._barriers(limits).slopes(at, q)

    def _barriers(self, limits: SweptLimits) -> Barriers:
        """The limits of acceleration, power, braking power and flank load that are given."""
        asked, known, half = self.asked, self.known, self.task.speed_rad_s**2 / 2.0
        still = np.abs(known.first) <= STANDING * self.task.linkage.stroke_mm
        felt = np.stack([known.static, 2.0 * half * known.by_q, half * known.by_rate])
        pushed = np.stack([np.zeros(known.first.shape), known.second, np.where(still, 0.0, known.first) / 2.0])
        wheel, count = 1e-3 * half * limits.flywheel_kg_mm2, limits.count
        nothing, found = np.zeros((2, count)), list[_Limit]()
        if asked.acceleration_mm_s2 < inf:
            peak = np.full(count, (1.0 + ROUNDING) * asked.acceleration_mm_s2 / (2.0 * half))
            found += [_Limit(sign, False, False, peak, nothing[0], nothing, pushed) for sign in (1, -1)]
        for sign, power_w in ((1, limits.power_w), (-1, np.full(count, asked.braking_w))):
            if np.isfinite(power_w).any():
                level = 1000.0 * power_w / self.task.speed_rad_s
                found.append(_Limit(sign, False, True, level, nothing[0], wheel, felt))
        if np.isfinite(limits.flank_load_n_mm).all():
            for sign, angle in zip((1, -1), self.angles, strict=True):
                across, along = limits.flank_load_n_mm * cos(angle), sign * limits.flank_load_n_mm * sin(angle) / 2.0
                found.append(_Limit(sign, True, False, across, along, wheel, felt))
        rows = len(found)
        own = LimitRows(
            np.array([barrier.flank for barrier in found]).reshape(rows, 1),
            np.array([barrier.power for barrier in found]).reshape(rows, 1),
            np.array([barrier.level for barrier in found]).reshape(rows, count),
            np.array([barrier.tilt for barrier in found]).reshape(rows, count),
            np.array([barrier.sign * barrier.wheel[:: barrier.sign] for barrier in found])
            .reshape(rows, 2, count)
            .swapaxes(0, 1),
            np.array([barrier.sign * barrier.felt for barrier in found]).reshape(rows, *felt.shape).swapaxes(0, 1),
        )
        return Barriers(own, self.asked.steepness, self.step, (self._floor, self._cap))

    def _has_time(self, curve: Array, lines: Array) -> Array:
        """Whether the time of the cycle, and of stretches of wishes, is enough below a curve, shape (k,)."""
        shortest = self._shortest(lines)
        room = 1.0 + ROUNDING
        kept = (shortest.sum(axis=0) <= self.task.cycle_rad * room) & np.all(curve >= self._floor / room, axis=0)
        middle = (self.known.ends_rad[1:] + self.known.ends_rad[:-1]) / 2.0
        for requirement in self.asked.requirements(TimeWithin):
            within = (middle - requirement.stretch.start_rad) % (
                2.0 * pi
            ) < requirement.stretch.end_rad - requirement.stretch.start_rad
            kept &= shortest[within].sum(axis=0) <= requirement.most_rad * room
        return np.asarray(kept)

    def _shortest(self, lines: Array) -> Array:
        """The least time in each cell: motions stay below the lines from both ends, and 1/sqrt is convex."""
        step = self.step[:, None]
        (begin, forward), (end, backward) = lines
        place = (end - backward * step - begin) / (forward - backward)
        place = np.clip(np.where(np.isfinite(place), place, step), 0.0, step)
        first, apex, last = (
            np.minimum(begin + forward * at, end + backward * (at - step)) for at in (np.zeros_like(step), place, step)
        )
        mean = ((first + apex) * place + (apex + last) * (step - place)) / (2.0 * step)
        return np.asarray(step / np.sqrt(np.fmin(mean, self._cap)))


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
