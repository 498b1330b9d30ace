"""The certified limit: the least acceleration, power and other figures that any law can have.

A conic programme finds it (``motion``), and its multipliers prove it (``proof``).  The motion near it keeps all limits
at the places of the grid, and the search for a law starts there.
"""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import replace
from math import ceil, inf, radians, sqrt

import numpy as np

from ncgear.errors import NoSuchMechanism
from ncgear.frozen import dataclass
from ncgear.numerics.arrays import Array, IndexArray
from ncgear.optimum.certified.cycle import CrankCycle, cycle
from ncgear.optimum.certified.demands import Demands, NearMotion, Ranges
from ncgear.optimum.certified.motion import MOST_ACCELERATION, ROUNDING, MotionProgramme
from ncgear.optimum.certified.problem import LimitProblem
from ncgear.optimum.certified.proof import Linear, least
from ncgear.optimum.certified.ranges import cells_that_matter, rows_of_places
from ncgear.optimum.certified.refusals import refusal, refuse_ratios, turning_point
from ncgear.optimum.certified.rows import needs_times
from ncgear.optimum.certified.tree import Effort, Solved, Trials, TriedMotion, bisected, motion_along
from ncgear.optimum.task import Task

PLACES_ROUGH = 960
"""Places where pitch curves need not be convex: the relations between places are then of first order only."""

PLACES_CURVED = 240
"""Places where pitch curves must be convex; more are added where the driving curve matters."""

FINE_RAD = radians(0.5)
"""Step of the places where the driving curve matters."""

CLOSE = 1.002
"""Ratio of a motion to the limit without the driving curve up to which a further search is not worth its time."""

BISECTED = 1e-4
"""Relative width to which limits are narrowed that no single programme gives."""

EASED = (1.0, 1.001, 1.01, 1.1)
"""Factors on limits that can just be kept, tried in order: at the limit itself a solver may find no motion."""


@dataclass(frozen=True, eq=False)
class Motion:
    """s = dphi2/dphi1 at crank angles in rad from 0 on, shape (n,) each, and unknown between them."""

    crank_angle_rad: Array
    turning: Array


@dataclass(frozen=True, eq=False)
class Bound:
    """A least value: no law has less.  ``motion`` keeps the limits at ``places`` places, and is near the value.

    ``reach`` is about the value of a motion that keeps all relations: no proof raises the limit beyond it.  It is
    infinite where unknown.  ``effort`` is the work that raised the value towards a law; None where it was not
    raised.
    """

    value: float
    places: int
    motion: Motion | None
    reach: float = inf
    effort: Effort | None = None

    def times(self, price: float) -> Bound:
        """The bound of a figure times a price."""
        return replace(self, value=price * self.value, reach=price * self.reach)


def problem_of(task: Task, asked: Demands, places: int | None = None) -> LimitProblem:
    """The problem on its grid; raises NoSuchMechanism where the ratios alone cannot close the cycle."""
    refuse_ratios(task, asked)
    count = places or (PLACES_CURVED if asked.convex else PLACES_ROUGH)
    return LimitProblem(task, asked, cycle(task, count, asked.places_rad))


def least_acceleration(task: Task, asked: Demands, places: int | None = None, *, proven: bool = True) -> Bound:
    """Least peak of the slider's acceleration in mm/s^2; a demand on acceleration itself is ignored.

    Without ``proven``, only the motion is wanted: the value includes the driven curve and not the driving curve.
    Raises NoSuchMechanism where no acceleration is enough, with the limits that bind and their nearest values.
    """
    problem = problem_of(task, replace(asked, acceleration_mm_s2=inf), places)

    def least_value(of: LimitProblem, curve: Ranges | NearMotion | None) -> TriedMotion:
        made = of.programme(curve, with_peak=True)
        found = tried(made, made.acceleration, lambda value: value * made.acceleration_unit_mm_s2)
        if found.value == inf and curve is None and of.is_open:
            # Not under the greatest peak of the search, but there may be motions beyond
            free = of.programme()
            value = MOST_ACCELERATION * made.acceleration_unit_mm_s2
            return replace(tried(free, free.angle, lambda value: value), value=value)
        return found

    return _with_curves(problem, least_value, "acceleration_mm_s2", proven=proven)


def least_acceleration_roughly(problem: LimitProblem) -> float:
    """The least peak of acceleration in mm/s^2 as ``least_acceleration`` gives it, with the driving curve left free.

    It is certain, at most a few percent lower on balers, and takes a tenth of the time.
    """
    problem = problem.under(acceleration_mm_s2=inf)
    made = problem.programme(with_peak=True)
    value = least(made.programme, made.acceleration).value
    if value == inf and not problem.is_open:
        raise refusal(problem)
    return min(value, MOST_ACCELERATION) * made.acceleration_unit_mm_s2


def least_mean_power_w(task: Task) -> float:
    """The mean power over a cycle in W minus possible rounding: no peak power is under it."""
    return task.work_n_mm / 1000.0 / task.cycle_s * (1.0 - ROUNDING)


def least_power(task: Task, asked: Demands, places: int | None = None, *, proven: bool = True) -> Bound:
    """Least peak power of the motor in W; a demand on it is ignored.

    Without ``proven``, the driving curve is left free.
    With masses the limit is a relaxation, see ``motion``.  Raises NoSuchMechanism as ``least_acceleration`` does.
    """
    mean_w = least_mean_power_w(task)
    if task.masses is not None:
        found = least_of(task, asked, "power_w", places)
        return replace(found, value=max(found.value, mean_w))

    def least_value(of: LimitProblem, curve: Ranges | NearMotion | None) -> TriedMotion:
        made = of.programme(curve)
        return tried(made, made.power_squared, lambda value: sqrt(max(value, 0.0)) * made.power_unit_w)

    found = _with_curves(problem_of(task, replace(asked, power_w=inf), places), least_value, "power_w", proven=proven)
    return replace(found, value=max(found.value, mean_w))


def least_of(task: Task, asked: Demands, name: str, places: int | None = None, guess: float | None = None) -> Bound:
    """Least value of a demand, by its name in ``Demands``, with which the other demands can be kept.

    The driving curve is left free, and with masses the limit is a relaxation. The search begins at a guess, else at
    about the mean power. Raises NoSuchMechanism as ``least_acceleration`` does.
    """
    problem = problem_of(task, asked, places).under(**{name: inf})
    # The mean power, or about the power that moves the masses, if more
    moving = task.moving.slider_kg * task.linkage.stroke_mm**2 / task.cycle_s**3 / 1e6
    guess = guess or max(abs(task.work_n_mm) / 1000.0 / task.cycle_s, moving, 1e-3)
    found = turning_point(lambda value: problem.under(**{name: value}).excess, guess, BISECTED)
    if found is None:
        raise refusal(problem)
    certain, enough = found
    for factor in EASED:
        made = problem.under(**{name: enough * factor}).programme(with_peak=True)
        near = tried(made, made.acceleration, lambda value: value).q
        if near is not None:
            break
    return Bound(certain, problem.on.count, None if near is None else motion_of(problem.on, near))


LeastValue = Callable[[LimitProblem, Ranges | NearMotion | None], TriedMotion]
"""The least value of a goal of motions within ranges or near a motion."""


def tried(made: MotionProgramme, goal: Linear, figure: Callable[[float], float]) -> TriedMotion:
    """The least of a goal in a programme, as the figure that it stands for, and the motion."""
    answer = least(made.programme, goal)
    q = None if answer.near is None else q_of(made.q, answer.near)
    return TriedMotion(answer.value if answer.value in (inf, -inf) else figure(answer.value), q)


def _with_curves(problem: LimitProblem, least_value: LeastValue, name: str, *, proven: bool = True) -> Bound:
    """The least value of a goal, a demand by its name, with the driving curve convex where both curves must be."""
    problem, trials, without = _solved(problem, least_value, name)
    if not problem.asked.convex:
        # Where a longer time eases no row, the motion keeps all relations
        reach = inf if needs_times(problem.task, problem.asked) else without.value
        return Bound(without.value, problem.on.count, motion_of(problem.on, without.q), reach)
    found = motion_along(trials, without)
    if found.value > CLOSE * without.value:
        extra = _finer(problem.on, cells_that_matter(problem.on, without.q, found.q))
        places = [*problem.asked.places_rad, *extra]
        problem = replace(problem, on=cycle(problem.task, PLACES_CURVED, places))
        problem, trials, without = _solved(problem, least_value, name)
        found = motion_along(trials, without)
    value = without.value
    if proven and found.value > CLOSE * value:
        parts = rows_of_places(cells_that_matter(problem.on, without.q, found.q), problem.on.count)
        value = bisected(trials, parts, without.value, found, problem.asked)
    # The motion ignores upper bounds of times, and ignores the curve where no motion along it was found
    known = found is not without and not needs_times(problem.task, problem.asked)
    return Bound(value, problem.on.count, motion_of(problem.on, found.q), found.value if known else inf)


def _solved(problem: LimitProblem, least_value: LeastValue, name: str) -> tuple[LimitProblem, Trials, Solved]:
    """The least value without the driving curve, and its motion; raises NoSuchMechanism where there is none.

    Where no motion is found, slightly easier demands are tried: their certain limit holds for this problem too.
    """
    for factor in EASED:
        easier = problem.eased(factor)
        trials = _trials(easier, least_value, name)
        found = trials.least(None, {}, inf)
        if found.value == inf:
            raise refusal(easier)
        if found.q is not None:
            return easier, trials, Solved(found.value, found.q)
    raise NoSuchMechanism("the certified limit of these limits could not be computed", key="optimize.limits")


def _trials(problem: LimitProblem, least_value: LeastValue, name: str) -> Trials:
    return Trials(
        problem.on,
        lambda curve, figures, below: least_value(problem, curve),
        lambda ranges, figures, below: problem.under(**{name: below}).programme(ranges),
        {},
    )


def q_of(q: Linear, variables: Array) -> Array:
    """q at the places, never zero."""
    return np.maximum(variables[q.columns[0]], 1e-9)


def motion_of(on: CrankCycle, q: Array) -> Motion:
    """The motion that has the values ``q`` at the places of a cycle."""
    return Motion(on.crank_angle_rad, np.sqrt(q))


def _finer(on: CrankCycle, cells: IndexArray) -> list[float]:
    """Crank angles that cut cells into steps of FINE_RAD."""
    angles: list[float] = []
    for cell in cells.tolist():
        parts = max(1, ceil(float(on.step_rad[cell]) / FINE_RAD))
        angles += [float(on.crank_angle_rad[cell] + on.step_rad[cell] * part / parts) for part in range(1, parts)]
    return angles
