"""Where a condition that only ever turns from false to true, as a quantity grows, does so.

What to say where no law keeps the limits: which of them binds, and the nearest value at which one does.

The certified limit: the least acceleration, the least power and the least weighted sum that any law can have.
"""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass, replace
from math import ceil, degrees, floor, inf, log10, pi, sqrt

from ncgear.errors import NoSuchMechanism
from ncgear.optimum.certified.problem import Problem
from ncgear.optimum.certified.road import Peaks
from ncgear.optimum.task import Limits, Task

FINE = 1e-7
"""Relative width of the interval in which the turn is left."""

DOUBLINGS = 60


def turning_point(holds: Callable[[float], bool], guess: float) -> tuple[float, float] | None:
    """A value at which the condition fails and a higher one, 1e-7 apart, at which it holds.

    The first is 0 where the condition never fails down to 2^-60 of the guess, which must be positive.  None where it
    does not hold up to 2^60 times the guess.
    """
    low, high = guess, guess
    if holds(guess):
        low = _first(lambda value: not holds(value), guess, 0.5)
        if not low:
            return 0.0, guess * 2.0**-DOUBLINGS
        high = 2.0 * low
    else:
        high = _first(holds, guess, 2.0)
        if not high:
            return None
        low = high / 2.0
    while high > low * (1.0 + FINE):
        middle = sqrt(low * high)
        low, high = (low, middle) if holds(middle) else (middle, high)
    return low, high


def _first(wanted: Callable[[float], bool], guess: float, factor: float) -> float:
    """The first of guess * factor, guess * factor^2, ... that is wanted; 0 if none of sixty is."""
    value = guess
    for _ in range(DOUBLINGS):
        value *= factor
        if wanted(value):
            return value
    return 0.0


DIGITS = 5
"""Significant digits of a nearest value; it is rounded to the side that is allowed."""


def refuse_ratios(task: Task, limits: Limits) -> None:
    """Refuse ratios that cannot close the cycle or a given working stroke; raises NoSuchMechanism."""
    out, working = task.linkage.working_angle_rad, limits.working_rad
    if working is None:
        _refuse_ratio(2.0 * pi, task.cycle_rad, limits, "the cycle")
        return
    if not working < task.cycle_rad:
        raise NoSuchMechanism(
            f"a working stroke of {working:.5g} rad in a cycle of {task.cycle_rad:.5g} rad; less than a cycle is right",
            key="optimize.limits.working_angle_rad",
        )
    _refuse_ratio(out, working, limits, "the working stroke")
    _refuse_ratio(2.0 * pi - out, task.cycle_rad - working, limits, "the return")


def refuse(problem: Problem, peaks: Peaks) -> NoSuchMechanism:
    """Why no law has these peaks, of which those that are searched for are infinite.

    Without a limit on either peak an even crank keeps what ``refuse_ratios`` lets pass, so one of them binds.
    """
    power = _least(problem, lambda value: Peaks(inf, value), peaks.power_w)
    if power > peaks.power_w:
        text = f"{peaks.power_w:g} W is too little at any acceleration; at least {shown_above(power)} W"
        return _refusal("peak_power_w", text, problem, replace(peaks, acceleration_mm_s2=inf))
    acceleration, given = peaks.acceleration_mm_s2, f"{peaks.acceleration_mm_s2:g} mm/s^2 is too little at"
    least = _least(problem, lambda value: Peaks(value, inf), acceleration)
    if least > acceleration:
        text = f"{given} any power; at least {shown_above(least)} mm/s^2"
        return _refusal("peak_acceleration_mm_s2", text, problem, replace(peaks, power_w=inf))
    least = _least(problem, lambda value: Peaks(value, peaks.power_w), acceleration)
    power = _least(problem, lambda value: Peaks(acceleration, value), peaks.power_w)
    text = f"{given} {peaks.power_w:g} W; at least {shown_above(least)} mm/s^2, or {shown_above(power)} W"
    return _refusal("peak_acceleration_mm_s2", text, problem, peaks)


def _refuse_ratio(crank_rad: float, driving_rad: float, limits: Limits, stretch: str) -> None:
    mean = driving_rad / crank_rad
    if limits.ratio_min > mean:
        raise NoSuchMechanism(
            f"at {limits.ratio_min:g} throughout, {stretch} takes {limits.ratio_min * crank_rad:.5g} rad of the "
            f"driving gear, and it has {driving_rad:.5g}; at most {shown_below(mean)} is right",
            key="optimize.limits.ratio_min",
        )
    if limits.ratio_max < mean:
        raise NoSuchMechanism(
            f"at {limits.ratio_max:g} throughout, {stretch} takes {limits.ratio_max * crank_rad:.5g} rad of the "
            f"driving gear, and it has {driving_rad:.5g}; at least {shown_above(mean)} is right",
            key="optimize.limits.ratio_max",
        )


def _refusal(key: str, text: str, problem: Problem, peaks: Peaks) -> NoSuchMechanism:
    return NoSuchMechanism(f"{text}{_or_steeper(problem, peaks)} can be enough", key=f"optimize.limits.{key}")


def _or_steeper(problem: Problem, peaks: Peaks) -> str:
    """The least pressure angle that would do in place of more power or acceleration, where there is one."""
    given = problem.limits.pressure_angle_rad
    if given is None or not problem.under(replace(problem.limits, pressure_angle_rad=None)).is_open(peaks):
        return ""

    def holds(narrowing: float) -> bool:
        """Whether an angle does whose distance from a right angle is divided by ``narrowing``."""
        wider = pi / 2.0 - (pi / 2.0 - given) / narrowing
        return problem.under(replace(problem.limits, pressure_angle_rad=wider)).is_open(peaks)

    found = turning_point(holds, 1.0)
    if found is None:
        return ""
    enough = shown_above(90.0 - (90.0 - degrees(given)) / found[1])
    return f", or a pressure angle of {enough} deg beside the rack's own,"


def _least(problem: Problem, peaks: Callable[[float], Peaks], given: float) -> float:
    """Least value that is not certainly too low; 0 where nothing was given."""
    if given == inf:
        return 0.0
    found = turning_point(lambda value: problem.is_open(peaks(value)), given)
    if found is None:
        raise ArithmeticError("no peak is enough, though an evenly turning crank keeps all other limits")
    return found[1]


def shown_above(value: float) -> str:
    """The value rounded up to five digits."""
    return _rounded(value, ceil)


def shown_below(value: float) -> str:
    """The value rounded down to five digits."""
    return _rounded(value, floor)


def _rounded(value: float, to: Callable[[float], int]) -> str:
    scale = 10.0 ** (DIGITS - 1 - floor(log10(value)))
    return f"{to(value * scale) / scale:.{DIGITS + 1}g}"


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
