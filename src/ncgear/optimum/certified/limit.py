"""The certified limit: the least acceleration, the least power and the least weighted sum that any law can have."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass
from math import inf

from ncgear.optimum.certified.ceilings import Peaks
from ncgear.optimum.certified.problem import Problem
from ncgear.optimum.certified.refusals import refuse, refuse_ratios
from ncgear.optimum.certified.search import turning_point
from ncgear.optimum.task import Limits, Task

CELLS = 1600
"""Cells of a cycle: on the baler both sides of a bound are then less than 0.05 % apart."""

CELLS_LINKED = 6400
"""Cells when a mass is moved or the pressure angle limited: one side of the enclosure is then of first order only."""


@dataclass(frozen=True)
class Bound:
    """A least value, enclosed: no law has less than ``value``, and a motion, if a rough one, has ``attained``.

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
    """A value that is too little for any law, and one just above it of which that is not known."""
    found = turning_point(lambda value: problem.is_open(peaks(value)), guess)
    if found is None:
        raise refuse(problem, peaks(inf))
    return found


def resting_acceleration(task: Task) -> float:
    """Least acceleration in mm/s^2 for the stroke and back in the cycle's time if nothing else binds: 16 H / T^2.

    Each stroke then takes 2 sqrt(H / A): evenly faster for half of it, evenly slower for the other.
    """
    return 16.0 * task.linkage.stroke_mm / task.cycle_s**2


def mean_power(problem: Problem) -> float:
    """Mean power in W over the cycle, which no peak is below; with little of it, the scale of moving the mass."""
    task = problem.task
    moving = problem.limits.mass_kg * task.linkage.stroke_mm**2 / task.cycle_s**2 / 1000.0
    return max(task.work_n_mm, moving, 1e-9) / 1000.0 / task.cycle_s
