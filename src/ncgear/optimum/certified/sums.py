"""The certified limit of weighted sums of figures, and limits that are raised towards a law."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import replace
from functools import reduce
from heapq import heappop, heappush
from math import inf, pi, sqrt
from operator import add

import numpy as np

from ncgear.frozen import dataclass
from ncgear.optimum.certified import limit
from ncgear.optimum.certified.demands import Demands, NearMotion, Priced, Ranges
from ncgear.optimum.certified.motion import MOST_ACCELERATION, MotionProgramme
from ncgear.optimum.certified.problem import LimitProblem, motion_programme
from ncgear.optimum.certified.proof import Linear, least
from ncgear.optimum.certified.ranges import halves
from ncgear.optimum.certified.tree import Budget, Effort, FigureRanges, Solved, Trials, TriedMotion, proven, whole_tree
from ncgear.optimum.task import Task

PLACES_RAISED = 120
"""Places for ranges all around the turn; twice as many where these bring the limit no nearer."""

CLOSE_ENOUGH = 0.99
"""Share of the law from which more places are useless."""

EARLY = 1.0 / 3.0
"""Share of the programmes that the first grid may use, so that enough of them are left for the finer grid."""

TOLERANCE = 5e-3
"""Relative width to which the least sum is enclosed."""

MOST_SPLITS = 60


@dataclass(frozen=True)
class PeakWeights:
    """Costs of 1 mm/s^2 of peak acceleration and of 1 W of peak power; both positive."""

    per_mm_s2: float
    per_w: float


def least_weighted_sum(
    task: Task, asked: Demands, weights: PeakWeights, places: int | None = None, tolerance: float = TOLERANCE
) -> limit.Bound:
    """Least weighted sum of both peaks; demands on the two peaks themselves are ignored.

    The programme has the square of the power P.  Between P1 and P2 the chord, (P^2 + P1 P2)/(P1 + P2), is at most P.
    Intervals of powers are split, the interval with the lowest sum first, until it is within ``tolerance`` of the best
    sum found.  The driving curve is left free.  Raises NoSuchMechanism as ``least_acceleration`` does.
    """
    free = replace(asked, acceleration_mm_s2=inf, power_w=inf)
    problem = limit.problem_of(task, free, places)
    if task.masses is not None:
        return _sum_with_masses(problem, weights, tolerance)
    least_w = limit.least_power(task, free, places, proven=False).value
    fastest = limit.least_acceleration(task, free, places, proven=False)
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
        # Beyond the greatest peak of the search, and where the solver is rough, only the sum of both alone is certain
        beyond = weights.per_mm_s2 * MOST_ACCELERATION * made.acceleration_unit_mm_s2 + weights.per_w * low
        heappush(queue, (max(min(answer.value, beyond), alone), low, high))
        if answer.near is not None and answer.value < inf:
            peak = float(answer.near[made.acceleration.columns[0, 0]]) * made.acceleration_unit_mm_s2
            power = unit * sqrt(max(float(answer.near[made.power_squared.columns[0, 0]]), 0.0))
            total = weights.per_mm_s2 * peak + weights.per_w * power
            if total < best:
                best, motion = total, limit.motion_of(problem.on, limit.q_of(made.q, answer.near))

    add(least_w, top)
    for _ in range(MOST_SPLITS):
        value, low, high = queue[0]
        if value >= best * (1.0 - tolerance):
            break
        heappop(queue)
        middle = sqrt(low * high) if low > 0.0 else high / 2.0
        add(low, middle)
        add(middle, high)
    return limit.Bound(queue[0][0], problem.on.count, motion)


def _sum_with_masses(problem: LimitProblem, weights: PeakWeights, tolerance: float) -> limit.Bound:
    """The least sum by intervals of powers with known least accelerations at their ends."""
    task, asked = problem.task, problem.asked
    low = limit.least_of(task, asked, "power_w").value

    def acceleration(power_w: float) -> limit.Bound:
        made = problem.under(power_w=power_w).programme(with_peak=True)
        found = limit.tried(made, made.acceleration, lambda value: value)
        near = None if found.q is None else limit.motion_of(problem.on, found.q)
        return limit.Bound(min(found.value, MOST_ACCELERATION) * made.acceleration_unit_mm_s2, problem.on.count, near)

    free = acceleration(inf)
    powers, found = [low], [acceleration(low * (1.0 + limit.BISECTED))]
    while powers[-1] < 1e3 * low and found[-1].value > free.value * (1.0 + tolerance):
        powers.append(powers[-1] * (1.0 + 4.0 * tolerance))
        found.append(acceleration(powers[-1]))
    # The acceleration never grows with the power: between two powers the sum is no less than its ends give
    ends = [*found[1:], free]
    sums = [
        weights.per_mm_s2 * max(end.value, 0.0) + weights.per_w * power for power, end in zip(powers, ends, strict=True)
    ]
    best = int(np.argmin(sums))
    return limit.Bound(sums[best], problem.on.count, ends[best].motion)


# Numbers beyond all size prove nothing, and are no fault
@np.errstate(over="ignore", invalid="ignore")
def raised(
    task: Task,
    asked: Demands,
    prices: Mapping[str, float],
    law: Mapping[str, float],
    motion: limit.Motion,
    budget: Budget,
) -> tuple[float, Effort]:
    """A certain least sum of priced figures, by their names in ``Demands``, and the effort of its proof.

    Ranges of q all around the turn, and of the figures, are narrowed and divided from a law's figures and motion.  Both
    pitch curves must be convex, or their tangent limited.  Raises NoSuchMechanism where the demands cannot be kept.
    """
    whole = sum(price * law[name] for name, price in prices.items())
    value, effort = _raised_on(PLACES_RAISED, task, asked, prices, law, motion, budget)
    if not effort.ended or value >= CLOSE_ENOUGH * whole or budget.used > EARLY * budget.most:
        return value, effort
    # A programme of twice the places takes twice as long
    more = Budget((budget.most - budget.used) // 2, budget.tell)
    finer, last = _raised_on(2 * PLACES_RAISED, task, asked, prices, law, motion, more)
    solved = effort.programmes + last.programmes
    return max(value, finer), replace(last if finer > value else effort, programmes=solved)


def _raised_on(
    places: int,
    task: Task,
    asked: Demands,
    prices: Mapping[str, float],
    law: Mapping[str, float],
    motion: limit.Motion,
    budget: Budget,
) -> tuple[float, Effort]:
    problem = limit.problem_of(task, asked, places)
    trials, whole = _trials(problem, prices), sum(price * law[name] for name, price in prices.items())
    without = trials.least(None, dict.fromkeys(prices, (0.0, inf)), whole).value
    if without >= whole:
        return whole, Effort(1, 1, problem.on.count, True)
    angle = problem.on.crank_angle_rad
    turning = np.interp(angle, motion.crank_angle_rad, motion.turning, period=2.0 * pi)
    of_law = Solved(whole, turning**2)
    tree, box = whole_tree(trials, halves(problem.on), without, of_law, asked, budget)
    return proven(tree, box, whole, tree.lacking(of_law, law))


def _trials(problem: LimitProblem, prices: Mapping[str, float]) -> Trials:
    def programme(
        curve: Ranges | NearMotion | None, figures: FigureRanges, below: float
    ) -> tuple[MotionProgramme, Linear]:
        others = sum(price * figures[name][0] for name, price in prices.items())
        priced = [
            Priced(name, figures[name][0], min(figures[name][1], (below - others) / price + figures[name][0]))
            for name, price in prices.items()
        ]
        made = motion_programme(problem.task, problem.on, problem.asked, curve, priced=priced)
        total = reduce(add, (made.figures[name] * (price / below) for name, price in prices.items()))
        made.programme.positive(1.0 - total)
        return made, total

    def least_value(curve: Ranges | NearMotion | None, figures: FigureRanges, below: float) -> TriedMotion:
        made, total = programme(curve, figures, below)
        # No figure is negative
        return limit.tried(made, total, lambda value: max(value, 0.0) * below)

    return Trials(problem.on, least_value, lambda *motions: programme(*motions)[0], prices)
