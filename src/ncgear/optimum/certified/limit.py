"""The certified limit: the least acceleration, power and weighted sum of both that any law can have.

Each is enclosed from two sides: no law, however rough, has less, and some motion that keeps all limits, though not a
smooth one, has little more.  The fastest motion under given peaks is also where the search for a smooth law starts.
"""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass
from functools import partial
from heapq import heappop, heappush
from math import inf, sqrt

import numpy as np

from ncgear.errors import NoSuchMechanism, WrongInput
from ncgear.numerics.arrays import Array
from ncgear.optimum.certified.passes import Ceilings
from ncgear.optimum.certified.problem import Problem
from ncgear.optimum.certified.refusals import refusal, refuse_ratios, turning_point
from ncgear.optimum.certified.road import Peaks, Road
from ncgear.optimum.task import Limits, Task

CELLS = 1600
"""Cells of a cycle: on the baler both sides of a bound are then less than 0.05 % apart."""

CELLS_LINKED = 6400
"""Cells when a mass is moved or the pressure angle limited: one side of the enclosure is then of first order only."""


@dataclass(frozen=True)
class Bound:
    """A least value, enclosed: no law has less than ``value``, and some motion, though a rough one, has ``attained``.

    ``attained`` is infinite where no motion was found on this grid of ``cells`` cells.
    """

    value: float
    attained: float
    cells: int

    @property
    def gap(self) -> float:
        """Relative width of the enclosure."""
        return self.attained / self.value - 1.0 if self.value > 0.0 else inf if self.attained > 0.0 else 0.0


def least_acceleration(task: Task, limits: Limits, cells: int | None = None) -> Bound:
    """Least peak of the slider's acceleration in mm/s^2 over the whole cycle, power limited or not.

    A limit on acceleration itself is not looked at.  Raises NoSuchMechanism where no acceleration is enough, with the
    limit that binds and its nearest feasible value.
    """
    problem = prepared(task, limits, cells)
    power = problem.given_peaks.power_w
    return enclosed(problem, lambda value: Peaks(value, power), resting_acceleration(task))


def rough_acceleration(task: Task, limits: Limits) -> float:
    """The peak in mm/s^2 of some motion within the limits.

    Raises NoSuchMechanism as ``least_acceleration`` does, and where limits are so narrow that the grid has no motion.
    """
    found = least_acceleration(task, limits).attained
    if found == inf:
        raise _too_narrow()
    return found


def _too_narrow() -> NoSuchMechanism:
    return NoSuchMechanism(
        "no motion within these limits was found, though none is certain to be too narrow; a wider range of the "
        "ratio, a larger pressure angle or a longer working stroke is needed",
        key="optimize.limits",
    )


def least_power(task: Task, limits: Limits, cells: int | None = None) -> Bound:
    """Least peak power in W, acceleration limited or not; a limit on power itself is not looked at.

    At constant driving speed the peak of the driving torque is this power over omega, with a moving mass or without.
    Raises NoSuchMechanism as ``least_acceleration`` does.
    """
    problem = prepared(task, limits, cells)
    acceleration = problem.given_peaks.acceleration_mm_s2
    return enclosed(problem, lambda value: Peaks(acceleration, value), mean_power(problem))


def prepared(task: Task, limits: Limits, cells: int | None) -> Problem:
    """The problem on its grid; raises NoSuchMechanism where the ratios alone cannot close the cycle."""
    refuse_ratios(task, limits)
    linked = limits.mass_kg > 0.0 or limits.pressure_angle_rad is not None
    return Problem(task, limits, cells or (CELLS_LINKED if linked else CELLS))


def enclosed(problem: Problem, peaks: Callable[[float], Peaks], guess: float) -> Bound:
    """The least value whose peaks close the cycle, from both sides."""
    least, open_from = certified(problem, peaks, guess)
    reached = turning_point(lambda value: problem.is_reached(peaks(value)), open_from)
    return Bound(least, inf if reached is None else reached[1], problem.cells)


def certified(problem: Problem, peaks: Callable[[float], Peaks], guess: float) -> tuple[float, float]:
    """A value that is certainly too little for any law, and one just above it that may be enough."""
    found = turning_point(lambda value: problem.is_open(peaks(value)), guess)
    if found is None:
        raise refusal(problem, peaks(inf))
    return found


def resting_acceleration(task: Task) -> float:
    """Least acceleration in mm/s^2 for the stroke and back in the cycle's time if nothing else binds: 16 H / T^2.

    Each stroke then takes 2 sqrt(H / A): evenly faster for half of it, evenly slower for the other.
    """
    return 16.0 * task.linkage.stroke_mm / task.cycle_s**2


def mean_power(problem: Problem) -> float:
    """Mean power in W over the cycle, which no peak is below; or the order of power that moves the mass, if more."""
    task = problem.task
    moving = problem.limits.mass_kg * task.linkage.stroke_mm**2 / task.cycle_s**2 / 1000.0
    return max(task.work_n_mm, moving, 1e-9) / 1000.0 / task.cycle_s


TOLERANCE = 5e-3
"""Relative width to which the least sum is enclosed."""

NEAR = 1.002
"""Acceleration, over its least bound, that counts as the least where power is free: a grid attains its bounds within
this factor."""

FINEST = 0.1
"""Relative width, in tolerances, of an interval of powers that is not split further: the gap left is the grid's own."""

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


def least_weighted_sum(
    task: Task, limits: Limits, weights: Weights, cells: int | None = None, tolerance: float = TOLERANCE
) -> Bound:
    """Least weighted sum of the peaks; limits on the two peaks themselves are not looked at.

    The least acceleration A*(P) never grows with P, so that between P1 and P2 the sum is no less than A*(P2) and P1
    give.  Intervals are split, the lowest first, until the lowest is within ``tolerance`` of the best motion found.
    Raises NoSuchMechanism as ``least_acceleration`` does.
    """
    problem = prepared(task, limits, cells or CELLS)
    lowest, least, rich = _ends(problem)
    if rich.power_w == inf:
        raise _too_narrow()
    highest, attained = rich.power_w, weights.of(rich.acceleration_mm_s2, rich.power_w)
    # Beyond the highest power acceleration gains nothing, so its own interval needs no splitting.
    above = weights.of(least, highest)
    intervals = [(weights.of(least, lowest), lowest, highest, least)]
    for _ in range(MOST_SPLITS):
        floor, start, end, beyond = heappop(intervals)
        floor = min(floor, above)
        finest = end <= start * (1.0 + FINEST * tolerance)
        if Bound(floor, attained, problem.cells).gap <= tolerance or floor >= above or finest:
            break
        middle = sqrt(start * end)
        found = enclosed(problem, partial(Peaks, power_w=middle), beyond)
        heappush(intervals, (weights.of(found.value, start), start, middle, found.value))
        heappush(intervals, (weights.of(beyond, middle), middle, end, beyond))
        attained = min(attained, weights.of(found.attained, middle))
    return Bound(floor, attained, problem.cells)


def _ends(problem: Problem) -> tuple[float, float, Peaks]:
    """Power and acceleration below which no law works, and peaks of a motion with next to the least acceleration."""
    lowest = enclosed(problem, lambda value: Peaks(inf, value), mean_power(problem)).value
    least = enclosed(problem, lambda value: Peaks(value, inf), resting_acceleration(problem.task)).value
    near = least * NEAR
    return lowest, least, Peaks(near, enclosed(problem, lambda value: Peaks(near, value), mean_power(problem)).attained)


@dataclass(frozen=True, eq=False)
class FastestMotion:
    """The fastest motion at places of the cycle, both dead centres among them; arrays of shape (n + 1,).

    ``slope`` is s = dphi2/dphi1 = 1/i12; without a limited pressure angle it may jump at the
    dead centres, and has there the value before them.  ``driving_rad`` is the driving angle that the motion takes, the
    cycle at most; ``working_rad`` is the part of it in the working stroke.
    """

    crank_angle_rad: Array
    travel_mm: Array
    speed_mm_s: Array
    slope: Array
    driving_rad: float
    working_rad: float


def fastest_motion(task: Task, limits: Limits, cells: int | None = None) -> FastestMotion:
    """The fastest motion under the limits' peaks; raises NoSuchMechanism where it is too slow for the cycle."""
    problem = prepared(task, limits, cells)
    ceilings = problem.ceilings(problem.given_peaks)
    if ceilings is None or not problem.is_open(problem.given_peaks):
        raise refusal(problem, problem.given_peaks)
    out, back = problem.least_durations_s(problem.given_peaks, ceilings)
    return FastestMotion(
        crank_angle_rad=problem.road.crank_angle_rad,
        travel_mm=problem.road.travel_mm,
        speed_mm_s=np.sqrt(2.0 * ceilings.energy_mm2_s2),
        slope=_slope(problem.road, task, ceilings),
        driving_rad=(out + back) * task.speed_rad_s,
        working_rad=out * task.speed_rad_s,
    )


def _slope(road: Road, task: Task, ceilings: Ceilings) -> Array:
    """s = v / (omega x'); at a dead centre from the acceleration beside it, v^2 / x'^2 being a / x''."""
    moving = road.slope_mm_rad > 0.0
    slope = np.empty(moving.shape)
    energy, omega = ceilings.energy_mm2_s2, task.speed_rad_s
    np.divide(np.sqrt(2.0 * energy), omega * road.slope_mm_rad, out=slope, where=moving)
    for place, cell in ((0, 0), (road.extended, road.extended - 1), (-1, -1)):
        acceleration = abs(np.diff(energy)[cell]) / road.length_mm[cell]
        slope[place] = np.sqrt(acceleration / road.bend_mm_rad2[place]) / omega
    return slope
