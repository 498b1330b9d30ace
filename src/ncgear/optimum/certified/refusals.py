"""Where no law keeps the limits: which of the limits binds, and its nearest value at which a law keeps them all.

Bisection finds this value: as a limit is eased, whether laws can keep them all turns only once, from no to yes.
"""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import replace
from math import ceil, degrees, floor, inf, log10, pi, sqrt

from ncgear.errors import NoSuchMechanism
from ncgear.optimum.certified.problem import Problem
from ncgear.optimum.certified.road import Peaks
from ncgear.optimum.task import Limits, Task

FINE = 1e-7
"""Relative width of the interval to which the turning point is narrowed."""

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


LEAST_ROOM = 1e-9
"""Share of the mean ratio by which a limit must differ from it: a mean that is written with ten digits differs by less.

The bounds themselves hold down to 1e-12; below that, rounding decides whether there is a law.
"""


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


def refusal(problem: Problem, peaks: Peaks) -> NoSuchMechanism:
    """The error that says why no law has these peaks; a peak that is searched for is infinite.

    Without limits on the peaks an evenly turning crank keeps all that ``refuse_ratios`` lets pass, so a peak binds.
    """
    power = _least(problem, lambda value: Peaks(inf, value), peaks.power_w)
    if power > peaks.power_w:
        text = f"{peaks.power_w:g} W is too little at any acceleration; at least {shown_above(power)} W"
        return _too_little("peak_power_w", text, problem, replace(peaks, acceleration_mm_s2=inf))
    acceleration, given = peaks.acceleration_mm_s2, f"{peaks.acceleration_mm_s2:g} mm/s^2 is too little at"
    least = _least(problem, lambda value: Peaks(value, inf), acceleration)
    if least > acceleration:
        text = f"{given} any power; at least {shown_above(least)} mm/s^2"
        return _too_little("peak_acceleration_mm_s2", text, problem, replace(peaks, power_w=inf))
    least = _least(problem, lambda value: Peaks(value, peaks.power_w), acceleration)
    power = _least(problem, lambda value: Peaks(acceleration, value), peaks.power_w)
    text = f"{given} {peaks.power_w:g} W; at least {shown_above(least)} mm/s^2, or {shown_above(power)} W"
    return _too_little("peak_acceleration_mm_s2", text, problem, peaks)


def _refuse_ratio(crank_rad: float, driving_rad: float, limits: Limits, stretch: str) -> None:
    mean = driving_rad / crank_rad
    for key, given in (("ratio_min", limits.ratio_min), ("ratio_max", limits.ratio_max)):
        if abs(given - mean) <= LEAST_ROOM * mean:
            side = f"under {shown_below(mean)}" if key == "ratio_min" else f"over {shown_above(mean)}"
            raise NoSuchMechanism(
                f"{given:.12g} leaves nothing to choose: the mean ratio of {stretch} is {mean:.6g}, so the ratio would "
                f"be constant; {side} is right",
                key=f"optimize.limits.{key}",
            )
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


def _too_little(key: str, text: str, problem: Problem, peaks: Peaks) -> NoSuchMechanism:
    return NoSuchMechanism(f"{text}{_or_steeper(problem, peaks)} can be enough", key=f"optimize.limits.{key}")


def _or_steeper(problem: Problem, peaks: Peaks) -> str:
    """The least pressure angle, the rack's own included, that would do in place of more power or acceleration.

    Empty where none under a right angle does.
    """

    def is_open(angle_rad: float | None) -> bool:
        return replace(problem, limits=replace(problem.limits, pressure_angle_rad=angle_rad)).is_open(peaks)

    given, rack = problem.limits.pressure_angle_rad, problem.limits.rack_angle_rad
    if given is None or not is_open(pi / 2.0 - rack if rack else None):
        return ""
    # The angle's distance from a right angle is divided by a factor that is sought.
    found = turning_point(lambda narrowing: is_open(pi / 2.0 - (pi / 2.0 - given) / narrowing), 1.0)
    if found is None:
        return ""
    enough = 90.0 - (90.0 - degrees(given)) / found[1] + degrees(rack)
    of_rack = f" (of which the rack has {degrees(rack):.6g})" if rack else ""
    return f", or a pressure angle of {shown_above(enough)} deg{of_rack},"


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
