"""The certified limit: the least acceleration, power, weighted sum and other figures that any law can have.

A conic programme finds it (``motion``), and its multipliers prove it (``proof``).  The motion that comes near it keeps
all limits at the places of the grid, and is where the search for a law starts.
"""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass, replace
from functools import reduce
from heapq import heappop, heappush
from math import ceil, inf, pi, radians, sqrt
from operator import add

import numpy as np

from ncgear.errors import NoSuchMechanism
from ncgear.numerics.arrays import Array, IndexArray
from ncgear.optimum.certified.cycle import Cycle, cycle
from ncgear.optimum.certified.demands import Demands, Near, Priced, Ranges
from ncgear.optimum.certified.motion import MOST_ACCELERATION, ROUNDING, MotionProgramme, motion_programme
from ncgear.optimum.certified.problem import Problem
from ncgear.optimum.certified.proof import Linear, least
from ncgear.optimum.certified.ranges import (
    Solved,
    Trials,
    Tried,
    cells_that_matter,
    halves,
    motion_along,
    stretches,
    within_ranges,
)
from ncgear.optimum.certified.refusals import refusal, refuse_ratios, turning_point
from ncgear.optimum.task import Task

PLACES_ROUGH = 960
"""Places where pitch curves need not be convex: what is known between the places is then of first order only."""

PLACES_CURVED = 240
"""Places where they must be; more are added where the driving curve matters."""

PLACES_RAISED = 120
"""Places where ranges are looked for all around the turn."""

FINE_RAD = radians(0.5)
"""Step of the places where the driving curve matters."""

CLOSE = 1.002
"""A motion this close to the limit without the driving curve leaves nothing to gain that is worth the time."""

BISECTED = 1e-4
"""Relative width to which limits are narrowed that no programme gives at once."""

EASED = (1.0, 1.001, 1.01, 1.1)
"""Factors of limits that are just kept, one after the other: at the limit itself a solver may find no motion."""

TOLERANCE = 5e-3
"""Relative width to which the least sum is enclosed."""

MOST_SPLITS = 60


@dataclass(frozen=True, eq=False)
class Motion:
    """s = dphi2/dphi1 at crank angles in rad from 0 on, shape (n,) each: between them it is not told."""

    crank_angle_rad: Array
    turning: Array


@dataclass(frozen=True, eq=False)
class Bound:
    """A least value: no law has less.  ``motion`` keeps the limits at ``places`` places, and comes near the value."""

    value: float
    places: int
    motion: Motion | None

    def times(self, price: float) -> Bound:
        """The bound of a figure times a price."""
        return replace(self, value=price * self.value)


def problem_of(task: Task, asked: Demands, places: int | None = None) -> Problem:
    """The problem on its grid; raises NoSuchMechanism where the ratios alone cannot close the cycle."""
    refuse_ratios(task, asked)
    count = places or (PLACES_CURVED if asked.convex else PLACES_ROUGH)
    return Problem(task, asked, cycle(task, count, asked.places_rad))


def least_acceleration(task: Task, asked: Demands, places: int | None = None, *, proven: bool = True) -> Bound:
    """Least peak of the slider's acceleration in mm/s^2; a demand on acceleration itself is not looked at.

    Where not ``proven``, only the motion is wanted: the value knows the driven curve and not the driving one.
    Raises NoSuchMechanism where no acceleration is enough, with the limits that bind and their nearest values.
    """
    problem = problem_of(task, replace(asked, acceleration_mm_s2=inf), places)

    def least_value(of: Problem, curve: Ranges | Near | None) -> Tried:
        made = of.programme(curve, with_peak=True)
        found = _tried(made, made.acceleration, lambda value: value * made.acceleration_unit_mm_s2)
        if found.value == inf and curve is None and of.is_open:
            # Not under the greatest peak that is looked at, but there may be motions beyond
            free = of.programme()
            value = MOST_ACCELERATION * made.acceleration_unit_mm_s2
            return replace(_tried(free, free.angle, lambda value: value), value=value)
        return found

    return _with_curves(problem, least_value, "acceleration_mm_s2", proven=proven)


def least_acceleration_roughly(task: Task, asked: Demands) -> float:
    """The least peak of acceleration in mm/s^2 as ``least_acceleration`` gives it, with the driving curve left free.

    It is certain, a few percent lower at most on balers, and takes a tenth of the time.
    """
    problem = problem_of(task, replace(asked, acceleration_mm_s2=inf), None)
    made = problem.programme(with_peak=True)
    value = least(made.programme, made.acceleration).value
    if value == inf and not problem.is_open:
        raise refusal(problem)
    return min(value, MOST_ACCELERATION) * made.acceleration_unit_mm_s2


def least_power(task: Task, asked: Demands, places: int | None = None, *, proven: bool = True) -> Bound:
    """Least peak power of the motor in W; a demand on it is not looked at.

    Where not ``proven``, the driving curve is left free.
    With masses the limit is a relaxation, see ``motion``.  Raises NoSuchMechanism as ``least_acceleration`` does.
    """
    mean_w = task.work_n_mm / 1000.0 / task.cycle_s * (1.0 - ROUNDING)
    if task.masses is not None:
        found = least_of(task, asked, "power_w", places)
        return replace(found, value=max(found.value, mean_w))

    def least_value(of: Problem, curve: Ranges | Near | None) -> Tried:
        made = of.programme(curve)
        return _tried(made, made.power_squared, lambda value: sqrt(max(value, 0.0)) * made.power_unit_w)

    found = _with_curves(problem_of(task, replace(asked, power_w=inf), places), least_value, "power_w", proven=proven)
    return replace(found, value=max(found.value, mean_w))


def least_of(task: Task, asked: Demands, name: str, places: int | None = None) -> Bound:
    """Least value of one demand, by its name in ``Demands``, with which the others can be kept.

    The driving curve is left free, and with masses the limit is a relaxation; ``raised`` gives a higher one beside a
    law.  Raises NoSuchMechanism as ``least_acceleration`` does.
    """
    problem = problem_of(task, asked, places).under(**{name: inf})
    found = turning_point(lambda value: problem.under(**{name: value}).excess, _mean_power_w(task), BISECTED)
    if found is None:
        raise refusal(problem)
    certain, enough = found
    for factor in EASED:
        made = problem.under(**{name: enough * factor}).programme(with_peak=True)
        near = _tried(made, made.acceleration, lambda value: value).q
        if near is not None:
            break
    return Bound(certain, problem.on.count, None if near is None else _motion(problem.on, near))


def _mean_power_w(task: Task) -> float:
    """Mean power over the cycle in W, or the order of what moves the masses, if more; as a first guess of any limit."""
    moving = task.moving.slider_kg * task.linkage.stroke_mm**2 / task.cycle_s**3 / 1e6
    return max(abs(task.work_n_mm) / 1000.0 / task.cycle_s, moving, 1e-3)


LeastValue = Callable[[Problem, Ranges | Near | None], Tried]
"""The least value of a goal of motions within ranges or near a motion."""


def _tried(made: MotionProgramme, goal: Linear, figure: Callable[[float], float]) -> Tried:
    """The least of a goal in a programme, as the figure that it stands for, and the motion."""
    answer = least(made.programme, goal)
    q = None if answer.near is None else _q(made.q, answer.near)
    return Tried(answer.value if answer.value in (inf, -inf) else figure(answer.value), q)


def _with_curves(problem: Problem, least_value: LeastValue, name: str, *, proven: bool = True) -> Bound:
    """The least value of a goal, a demand by its name, with the driving curve convex where both curves must be."""
    problem, trials, without = _solved(problem, least_value, name)
    if not problem.asked.convex:
        return Bound(without.value, problem.on.count, _motion(problem.on, without.q))
    found = motion_along(trials, without)
    if found.value > CLOSE * without.value:
        extra = _finer(problem.on, cells_that_matter(problem.on, without.q, found.q))
        places = [*problem.asked.places_rad, *extra]
        problem = replace(problem, on=cycle(problem.task, PLACES_CURVED, places))
        problem, trials, without = _solved(problem, least_value, name)
        found = motion_along(trials, without)
    value = without.value
    if proven and found.value > CLOSE * value:
        parts = stretches(problem.on, without.q, found.q)
        value = within_ranges(trials, parts, without, found, problem.asked.ratio_max)
    return Bound(value, problem.on.count, _motion(problem.on, found.q))


def _solved(problem: Problem, least_value: LeastValue, name: str) -> tuple[Problem, Trials, Solved]:
    """The least value without the driving curve, and its motion; raises NoSuchMechanism where there is none.

    Where demands are so tight that no motion is found, of the problem with demands that are a little easier: what is
    certain of that problem is certain of this one.
    """
    for factor in EASED:
        easier = problem.eased(factor)
        trials = _trials(easier, least_value, name)
        tried = trials.least(None)
        if tried.value == inf:
            raise refusal(easier)
        if tried.q is not None:
            return easier, trials, Solved(tried.value, tried.q)
    raise NoSuchMechanism("the certified limit of these limits could not be computed", key="optimize.limits")


def _trials(problem: Problem, least_value: LeastValue, name: str) -> Trials:
    """What the search for ranges asks of the programmes."""

    def extremes(ranges: Ranges | None, place: int, below: float) -> tuple[float, float]:
        made = problem.under(**{name: below}).programme(ranges)
        q = made.q[place : place + 1]
        return least(made.programme, q).value, -least(made.programme, -q).value

    return Trials(problem.on, lambda curve: least_value(problem, curve), extremes)


def _q(q: Linear, variables: Array) -> Array:
    """q at the places, never zero."""
    values: Array = np.maximum(variables[q.columns[0]], 1e-9)
    return values


def _motion(on: Cycle, q: Array) -> Motion:
    return Motion(on.crank_angle_rad, np.sqrt(q))


def _finer(on: Cycle, cells: IndexArray) -> list[float]:
    """Crank angles that cut cells into steps of FINE_RAD."""
    angles: list[float] = []
    for cell in cells.tolist():
        parts = max(1, ceil(float(on.step_rad[cell]) / FINE_RAD))
        angles += [float(on.crank_angle_rad[cell] + on.step_rad[cell] * part / parts) for part in range(1, parts)]
    return angles


@dataclass(frozen=True)
class Weights:
    """What 1 mm/s^2 of peak acceleration and 1 W of peak power cost; both positive."""

    per_mm_s2: float
    per_w: float


def least_weighted_sum(
    task: Task, asked: Demands, weights: Weights, places: int | None = None, tolerance: float = TOLERANCE
) -> Bound:
    """Least weighted sum of both peaks; demands on the two peaks themselves are not looked at.

    The programme knows the square of the power P.  Between P1 and P2 the chord, (P^2 + P1 P2)/(P1 + P2), is at most P.
    Intervals of powers are split, the one with the lowest sum first, until it is within ``tolerance`` of the best sum
    found.  The driving curve is left free.  Raises NoSuchMechanism as ``least_acceleration`` does.
    """
    free = replace(asked, acceleration_mm_s2=inf, power_w=inf)
    problem = problem_of(task, free, places)
    if task.masses is not None:
        return _sum_with_masses(problem, weights, tolerance)
    least_w = least_power(task, free, places, proven=False).value
    fastest = least_acceleration(task, free, places, proven=False)
    # At the places no motion within the ratios has more power
    top = problem.programme().power_unit_w / asked.ratio_min
    best, motion = inf, fastest.motion
    alone = weights.per_mm_s2 * fastest.value + weights.per_w * least_w
    queue: list[tuple[float, float, float]] = []

    def add(low: float, high: float) -> None:
        nonlocal best, motion
        made = motion_programme(task, problem.on, free, powers_w=(low, high), with_peak=True)
        unit, span = made.power_unit_w, low + high
        goal = weights.per_mm_s2 * made.acceleration_unit_mm_s2 * made.acceleration
        goal = goal + (weights.per_w * unit**2 / span) * made.power_squared + weights.per_w * low * high / span
        answer = least(made.programme, goal)
        # Beyond the greatest peak that is looked at, and where the solver is rough, the sum of both alone is certain
        beyond = weights.per_mm_s2 * MOST_ACCELERATION * made.acceleration_unit_mm_s2 + weights.per_w * low
        heappush(queue, (max(min(answer.value, beyond), alone), low, high))
        if answer.near is not None and answer.value < inf:
            peak = float(answer.near[made.acceleration.columns[0, 0]]) * made.acceleration_unit_mm_s2
            power = unit * sqrt(max(float(answer.near[made.power_squared.columns[0, 0]]), 0.0))
            total = weights.per_mm_s2 * peak + weights.per_w * power
            if total < best:
                best, motion = total, _motion(problem.on, _q(made.q, answer.near))

    add(least_w, top)
    for _ in range(MOST_SPLITS):
        value, low, high = queue[0]
        if value >= best * (1.0 - tolerance):
            break
        heappop(queue)
        middle = sqrt(low * high) if low > 0.0 else high / 2.0
        add(low, middle)
        add(middle, high)
    return Bound(queue[0][0], problem.on.count, motion)


def _sum_with_masses(problem: Problem, weights: Weights, tolerance: float) -> Bound:
    """The least sum by intervals of powers at each of whose ends the least acceleration is known."""
    task, asked = problem.task, problem.asked
    low = least_of(task, asked, "power_w").value

    def acceleration(power_w: float) -> Bound:
        under = problem.under(power_w=power_w)
        made = under.programme(with_peak=True)
        answer = least(made.programme, made.acceleration)
        near = None if answer.near is None else _motion(problem.on, _q(made.q, answer.near))
        return Bound(min(answer.value, MOST_ACCELERATION) * made.acceleration_unit_mm_s2, problem.on.count, near)

    free = acceleration(inf)
    powers, found = [low], [acceleration(low * (1.0 + BISECTED))]
    while powers[-1] < 1e3 * low and found[-1].value > free.value * (1.0 + tolerance):
        powers.append(powers[-1] * (1.0 + 4.0 * tolerance))
        found.append(acceleration(powers[-1]))
    # The acceleration never grows with the power: between two powers the sum is no less than its ends give
    ends = [*found[1:], free]
    sums = [
        weights.per_mm_s2 * max(end.value, 0.0) + weights.per_w * power for power, end in zip(powers, ends, strict=True)
    ]
    best = int(np.argmin(sums))
    return Bound(sums[best], problem.on.count, ends[best].motion)


def raised(task: Task, asked: Demands, prices: dict[str, float], law: float, places: int = PLACES_RAISED) -> float:
    """A certain least sum of priced figures, by their names in ``Demands``, from the sum that a law has.

    Ranges of q all around the turn, and of the figures, are narrowed: with masses, sums that are far above the limits
    of single figures are shown to be out of reach.  Both pitch curves must be convex.  Raises NoSuchMechanism where
    the demands themselves cannot be kept.
    """
    problem = problem_of(task, asked, places)
    motion = least_acceleration(task, asked, places, proven=False).motion
    assert motion is not None
    known = dict.fromkeys(prices, 0.0)

    def programme(curve: Ranges | Near | None, below: float) -> tuple[MotionProgramme, Linear]:
        others = sum(price * known[name] for name, price in prices.items())
        priced = [
            Priced(name, price, known[name], (below - others) / price + known[name]) for name, price in prices.items()
        ]
        made = motion_programme(task, problem.on, asked, curve, priced=priced)
        total = reduce(add, (made.figures[name] * (price / below) for name, price in prices.items()))
        made.programme.positive(1.0 - total)
        return made, total

    def least_value(curve: Ranges | Near | None) -> Tried:
        for name in prices:
            made, _ = programme(curve, law)
            known[name] = max(known[name], least(made.programme, made.figures[name]).value)
        made, total = programme(curve, law)
        return _tried(made, total, lambda value: value * law)

    def extremes(ranges: Ranges | None, place: int, below: float) -> tuple[float, float]:
        made, _ = programme(ranges, below)
        q = made.q[place : place + 1]
        return least(made.programme, q).value, -least(made.programme, -q).value

    trials = Trials(problem.on, least_value, extremes)
    without = least_value(None)
    q = np.interp(problem.on.crank_angle_rad, motion.crank_angle_rad, motion.turning, period=2.0 * pi) ** 2
    if not without.value < law:
        return law
    return within_ranges(trials, halves(problem.on), Solved(without.value, q), Solved(law, q), asked.ratio_max)
