"""Where no law keeps the limits: which of the limits binds, and its nearest value at which a law may keep them all.

Bisection finds this value: as a limit is eased, whether laws can keep them all turns only once, from no to yes.
"""

from __future__ import annotations

from collections.abc import Callable
from math import ceil, degrees, floor, inf, log10, pi, sqrt, tan

from ncgear.errors import NoSuchMechanism
from ncgear.optimum.certified.demands import Demands
from ncgear.optimum.certified.problem import Problem
from ncgear.optimum.task import Task

FINE = 1e-6
"""Relative width of the interval to which a nearest value is narrowed: it is shown with five digits."""

DOUBLINGS = 60


def turning_point(holds: Callable[[float], bool], guess: float, fine: float = FINE) -> tuple[float, float] | None:
    """A value at which the condition fails and a higher one, ``fine`` apart, at which it holds.

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
    while high > low * (1.0 + fine):
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


def refuse_ratios(task: Task, asked: Demands) -> None:
    """Refuse ratios that cannot close the cycle, or a stretch of it in its time; raises NoSuchMechanism."""
    _refuse_ratio(2.0 * pi, task.cycle_rad, asked, "the cycle")
    for stretch in asked.times:
        crank, most = stretch.end_rad - stretch.start_rad, stretch.at_most_rad
        if asked.ratio_min * crank > most:
            raise NoSuchMechanism(
                f"at the least ratio of {asked.ratio_min:g} throughout, the stretch of this wish takes "
                f"{asked.ratio_min * crank:.5g} rad of the driving gear, and it has {most:.5g}; at most "
                f"{shown_below(most / crank)} is right",
                key=stretch.key,
            )


PEAKS = {
    "power_w": ("peak_power_w", "W"),
    "acceleration_mm_s2": ("peak_acceleration_mm_s2", "mm/s^2"),
    "braking_w": ("braking_power_w", "W of braking power"),
    "torque_n_mm": ("rms_torque_n_m", "N mm of r.m.s. torque"),
    "fluctuation_n_mm": ("flywheel_kg_mm2", "N mm of fluctuating energy"),
}
"""Demands that can be given too low: their names in design files, and their units."""


def refusal(problem: Problem) -> NoSuchMechanism:
    """The error that says why no law keeps the demands: the peaks that bind, then curves and wishes.

    For a peak that is too low whatever the others are, its nearest value; else for each peak the nearest with the
    others as they are.
    """
    asked = problem.asked
    given = {name: getattr(asked, name) for name in PEAKS if getattr(asked, name) < inf}
    free = problem.under(**dict.fromkeys(given, inf))
    if not free.is_open:
        return _of_curves_and_wishes(free)
    for name, value in given.items():
        enough = _least(free, name, value)
        if enough > value:
            other = {"power_w": " at any acceleration", "acceleration_mm_s2": " at any power"}.get(name, "")
            text = f"{value:g} {PEAKS[name][1]} is too little{other}; at least {shown_above(enough)} {PEAKS[name][1]}"
            return _too_little(name, text, free.under(**{name: value}))
    names = sorted(given, key=lambda name: name != "acceleration_mm_s2")
    said = " and ".join(f"{given[name]:g} {PEAKS[name][1]}" for name in names)
    each = [f"{shown_above(_least(problem, name, given[name]))} {PEAKS[name][1]}" for name in names]
    return _too_little(names[0], f"{said} are too little together; at least {', or '.join(each)}", problem)


def _least(problem: Problem, name: str, given: float) -> float:
    """Least value of a demand that is not certainly too low."""
    found = turning_point(lambda value: problem.under(**{name: value}).is_open, given)
    return inf if found is None else found[1]


def _of_curves_and_wishes(problem: Problem) -> NoSuchMechanism:
    """The refusal where no peak is enough: convex curves, the pressure angle or a wish leave no law."""
    asked = problem.asked
    for kind in ("times", "even_speeds", "speeds"):
        for wish in getattr(asked, kind):
            others = tuple(one for one in getattr(asked, kind) if one is not wish)
            if problem.under(**{kind: others}).is_open:
                problem_said = "no law keeps this wish with the other limits; without it there may be one"
                return NoSuchMechanism(f"{problem_said}{_or_otherwise(problem)}", key=wish.key or "wishes")
    return NoSuchMechanism(
        "no law keeps the limits of ratio and curves and the wishes together" + _or_otherwise(problem),
        key="optimize.limits",
    )


def _too_little(name: str, text: str, problem: Problem) -> NoSuchMechanism:
    return NoSuchMechanism(f"{text}{_or_otherwise(problem)} can be enough", key=f"optimize.limits.{PEAKS[name][0]}")


def _or_otherwise(problem: Problem) -> str:
    """What of the curves would do instead: the least pressure angle, or curves that are not convex; else empty."""
    asked, said = problem.asked, ""
    if asked.steepness < inf:

        def is_open(angle_rad: float) -> bool:
            return problem.under(steepness=tan(angle_rad)).is_open

        given, rack = asked.tangent_rad, asked.rack_angle_rad
        widest = pi / 2.0 - rack if rack else pi / 2.0 - 1e-6
        if given < widest and is_open(widest):
            # The angle's distance from a right angle is divided by a factor that is sought
            found = turning_point(lambda narrowing: is_open(pi / 2.0 - (pi / 2.0 - given) / narrowing), 1.0)
            if found is not None:
                enough = 90.0 - (90.0 - degrees(given)) / found[1] + degrees(rack)
                of_rack = f" (of which the rack has {degrees(rack):.6g})" if rack else ""
                said += f", or a pressure angle of {shown_above(enough)} deg{of_rack},"
    if asked.convex and problem.under(convex=False).is_open:
        said += ", or pitch curves that are not convex" + ("" if said else ",")
    return said


def _refuse_ratio(crank_rad: float, driving_rad: float, limits: Demands, stretch: str) -> None:
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


def shown_above(value: float) -> str:
    """The value rounded up to five digits."""
    return _rounded(value, ceil)


def shown_below(value: float) -> str:
    """The value rounded down to five digits."""
    return _rounded(value, floor)


def _rounded(value: float, to: Callable[[float], int]) -> str:
    scale = 10.0 ** (DIGITS - 1 - floor(log10(value)))
    return f"{to(value * scale) / scale:.{DIGITS + 1}g}"
