"""The least weighted sum of acceleration and power, enclosed by branch and bound."""

from __future__ import annotations

from dataclasses import dataclass
from heapq import heappop, heappush
from math import inf, sqrt

from ncgear.errors import WrongInput
from ncgear.optimum.certified.limit import CELLS, Bound, enclosed, mean_power, prepared, resting_acceleration
from ncgear.optimum.certified.problem import Problem
from ncgear.optimum.certified.road import Peaks
from ncgear.optimum.task import Limits, Task

TOLERANCE = 5e-3
"""Relative width in which the least sum is enclosed where none is asked for."""

NEAR = 1.002
"""The acceleration that counts as the least where power is not to be spared, over the bound of the least: a grid
attains its bounds to this with power free."""

FINEST = 0.1
"""Relative width of an interval of powers, in tolerances, that is not split further: what gap is left is the grid's."""

MOST_SPLITS = 2000


@dataclass(frozen=True)
class Weights:
    """What 1 mm/s^2 of peak acceleration and 1 W of peak power cost: w1/A_ref and w2/P_ref; both positive."""

    per_mm_s2: float
    per_w: float

    def __post_init__(self) -> None:
        for key, value in (("acceleration_mm_s2", self.per_mm_s2), ("power_w", self.per_w)):
            if not 0.0 < value < inf:
                raise WrongInput(f"1/{value:g} given; a positive number is needed", key=f"optimize.weights.{key}")

    def of(self, acceleration_mm_s2: float, power_w: float) -> float:
        """The weighted sum."""
        return self.per_mm_s2 * acceleration_mm_s2 + self.per_w * power_w


@dataclass(frozen=True)
class WeightedBound:
    """The enclosed least sum, and the peaks of a rough motion that has its ``attained`` value."""

    sum: Bound
    peaks: Peaks


def least_weighted_sum(
    task: Task, limits: Limits, weights: Weights, cells: int | None = None, tolerance: float = TOLERANCE
) -> WeightedBound:
    """Least weighted sum of the peaks; limits on the two peaks themselves are not looked at.

    The least acceleration A*(P) never grows with P, so that between P1 and P2 the sum is no less than that of A*(P2)
    and P1.  Intervals are split, the lowest first, until the lowest is within ``tolerance`` of the best motion found.
    Raises NoSuchMechanism as ``least_acceleration`` does.
    """
    problem = prepared(task, limits, cells or CELLS)
    lowest, least, rich = _ends(problem)
    highest = rich.power_w
    best = _better(WeightedBound(Bound(0.0, inf, problem.cells), Peaks()), rich, weights)
    # Beyond the highest power acceleration gains nothing, so its own interval needs no splitting.
    intervals = [(weights.of(least, lowest), lowest, highest, least)]
    for _ in range(MOST_SPLITS):
        floor, start, end, beyond = heappop(intervals)
        floor = min(floor, weights.of(least, highest))
        best = WeightedBound(Bound(floor, best.sum.attained, problem.cells), best.peaks)
        if (
            best.sum.gap <= tolerance
            or floor >= weights.of(least, highest)
            or end <= start * (1.0 + FINEST * tolerance)
        ):
            break
        middle = sqrt(start * end)
        found = _least_acceleration(problem, middle, beyond)
        heappush(intervals, (weights.of(found.value, start), start, middle, found.value))
        heappush(intervals, (weights.of(beyond, middle), middle, end, beyond))
        best = _better(best, Peaks(found.attained, middle), weights)
    return best


def _better(best: WeightedBound, peaks: Peaks, weights: Weights) -> WeightedBound:
    attained = weights.of(peaks.acceleration_mm_s2, peaks.power_w)
    if attained >= best.sum.attained:
        return best
    return WeightedBound(Bound(best.sum.value, attained, best.sum.cells), peaks)


def _ends(problem: Problem) -> tuple[float, float, Peaks]:
    """Power and acceleration below which no law works, and peaks of a motion with next to the least acceleration."""
    lowest = enclosed(problem, lambda value: Peaks(inf, value), mean_power(problem)).value
    least = enclosed(problem, lambda value: Peaks(value, inf), resting_acceleration(problem.task)).value
    near = least * NEAR
    return lowest, least, Peaks(near, enclosed(problem, lambda value: Peaks(near, value), mean_power(problem)).attained)


def _least_acceleration(problem: Problem, power_w: float, guess: float) -> Bound:
    return enclosed(problem, lambda value: Peaks(value, power_w), guess)
