"""Where no law keeps the limits: which of the limits binds, and its nearest value at which a law may keep them all.

As a limit is eased, the least driving angle in which the others can be kept never grows: the nearest value is where it
comes down to that which the cycle has.
"""

from __future__ import annotations

from collections.abc import Callable, Iterator, Sequence
from dataclasses import replace
from math import atan, ceil, degrees, exp, floor, inf, log, log10, pi, tan
from typing import NamedTuple

from ncgear.errors import NoSuchMechanism
from ncgear.optimum.certified.demands import Demands, SpeedRange, SpeedSpread, StretchTime
from ncgear.optimum.certified.problem import Problem
from ncgear.optimum.task import Task

FINE = 1e-5
"""Relative width of the interval to which a nearest value is narrowed: it is shown with five digits."""

DOUBLINGS = 60.0
"""Doublings of a guess beyond which nothing is looked for."""

BEYOND = 10.0
"""What counts as the excess of a value with which no time at all would be enough."""


def turning_point(excess: Callable[[float], float], guess: float, fine: float = FINE) -> tuple[float, float] | None:
    """A value whose excess is over zero and a higher one, at most ``fine`` apart, with none; the excess never grows.

    It may be infinite.  The first value is 0 where there is no excess down to 2^-60 of the guess, which must be
    positive.  None where there is some up to 2^60 times the guess.
    """
    from scipy.optimize import brentq

    known: dict[float, float] = {}

    def at(logarithm: float) -> float:
        """The excess at guess * exp(logarithm)."""
        if logarithm not in known:
            known[logarithm] = min(max(excess(guess * exp(logarithm)), -BEYOND), BEYOND)
        return known[logarithm]

    def ends() -> tuple[float, float]:
        high = min(place for place, over in known.items() if over <= 0.0)
        return max(place for place, over in known.items() if over > 0.0 and place < high), high

    upwards = at(0.0) > 0.0
    most, step = DOUBLINGS * log(2.0), fine / 2.0
    while (at(step if upwards else -step) > 0.0) == upwards:
        if step >= most:
            return None if upwards else (0.0, guess * 2.0**-DOUBLINGS)
        step = min(max(log(2.0), 2.0 * step), most)
    low, high = ends()
    while high > low + fine:
        near = brentq(at, low, high, xtol=fine / 8.0)
        for side in (-fine / 3.0, fine / 3.0):
            at(near + side)
        low, high = ends()
    return guess * exp(low), guess * exp(high)


DIGITS = 5
"""Significant digits of a nearest value; it is rounded to the side that is allowed."""


LEAST_ROOM = 1e-9
"""Share of the mean ratio by which a limit must differ from it: a mean that is written with ten digits differs by less.

The bounds themselves hold down to 1e-12; below that, rounding decides whether there is a law.
"""


class TooTight(NoSuchMechanism):
    """The refusal of limits that certainly no law keeps together."""


def refuse_ratios(task: Task, asked: Demands) -> None:
    """Refuse ratios that cannot close the cycle, or a stretch of it in its time; raises NoSuchMechanism."""
    _refuse_ratio(2.0 * pi, task.cycle_rad, asked, "the cycle")
    for stretch in asked.times:
        crank, most = stretch.end_rad - stretch.start_rad, stretch.at_most_rad
        rest, least = 2.0 * pi - crank, task.cycle_rad - most
        if asked.ratio_min * crank > most:
            said = _at_one_ratio(f"least ratio of {asked.ratio_min:g}", crank, asked.ratio_min * crank)
            offers = [stretch.shown(asked.ratio_min * crank), f"a ratio_min of at most {shown_below(most / crank)}"]
            said = f"{said} at most {degrees(most):.5g}"
        elif asked.ratio_max * rest < least:
            said = _at_one_ratio(f"greatest ratio of {asked.ratio_max:g}", rest, asked.ratio_max * rest)
            own = stretch.shown(task.cycle_rad - asked.ratio_max * rest)
            offers = [own, *stretch.instead, f"a ratio_max of at least {shown_above(least / rest)}"]
            said = f"{said} at least {degrees(least):.5g}"
        else:
            continue
        raise TooTight(f"{said} deg of them; {_any_of(offers)}", key=stretch.key)


def _at_one_ratio(ratio: str, crank_rad: float, driving_rad: float) -> str:
    taken = f"{degrees(crank_rad):.5g} deg of the crank take {degrees(driving_rad):.5g} deg of the driving gear"
    return f"at the {ratio} throughout, {taken}, and the wish asks for"


class Peak(NamedTuple):
    """A demand that can be given too low: its name among the limits of a design file, and its unit there."""

    name: str
    unit: str

    @property
    def key(self) -> str:
        """Its dotted key."""
        return f"optimize.limits.{self.name}"


PEAKS = {
    "power_w": Peak("peak_power_w", "W"),
    "acceleration_mm_s2": Peak("peak_acceleration_mm_s2", "mm/s^2"),
    "braking_w": Peak("braking_power_w", "W of braking power"),
    "torque_n_mm": Peak("rms_torque_n_m", "N m of r.m.s. torque"),
    "fluctuation_n_mm": Peak("flywheel_kg_mm2", "kg mm^2 of flywheel"),
}
"""By their names among the demands."""


def in_demand(task: Task, name: str) -> float:
    """What one unit of a limit in a design file is in the unit of the demand: power in W, torque in N mm, and so on."""
    match name:
        case "torque_n_mm":
            return 1000.0
        case "fluctuation_n_mm":
            # Swing of energy = J w^2 times the coefficient of fluctuation; 1 N mm is 1000 kg mm^2/s^2
            return task.speed_rad_s**2 * task.speed_fluctuation / 1000.0
    return 1.0


def too_little(task: Task, name: str, value: float, enough: float) -> TooTight:
    """The refusal of a demand whose least value with the others is known."""
    return TooTight(
        f"{_said(task, name, value)} is too little with the other limits; "
        f"{_any_of([f'at least {_enough(task, name, enough)}'])}",
        key=PEAKS[name].key,
    )


def refusal(problem: Problem) -> TooTight:
    """The error that says why no law keeps the demands: the peaks that bind, then curves and wishes.

    For a peak that is too low whatever the others are, its nearest value with the others as they are, if there is one;
    else for each peak that binds its nearest value.
    """
    asked, task = problem.asked, problem.task
    given = {name: getattr(asked, name) for name in PEAKS if getattr(asked, name) < inf}
    free = problem.under(**dict.fromkeys(given, inf))
    if not free.is_open:
        return _of_curves_and_wishes(free)
    for name, value in given.items():
        if not free.under(**{name: value}).is_open:
            other = {"power_w": " at any acceleration", "acceleration_mm_s2": " at any power"}.get(name, "")
            kept = problem if problem.under(**{name: inf}).is_open else free.under(**{name: value})
            said = f"{_said(task, name, value)} is too little{other}"
            return TooTight(f"{said}; {_any_of(_offers(kept, [name]))}", key=PEAKS[name].key)
    # Of two, each alone can be kept
    binding = [name for name in given if len(given) == 2 or problem.under(**{name: inf}).is_open] or list(given)
    names = sorted(binding, key=lambda name: name != "acceleration_mm_s2")
    said = " and ".join(_said(task, name, given[name]) for name in names)
    return TooTight(f"{said} are too little together; {_any_of(_offers(problem, names))}", key=PEAKS[names[0]].key)


def _offers(problem: Problem, names: Sequence[str]) -> list[str]:
    """What would do instead of peaks that are too low: each of them higher, or something else."""
    enough = [_enough(problem.task, name, value) for name in names if (value := _least(problem, name)) < inf]
    return [*([f"at least {', or '.join(enough)}"] if enough else []), *_other_curves(problem), *_other_wishes(problem)]


def _any_of(offers: Sequence[str]) -> str:
    """Offers as the end of a sentence."""
    said = ", or ".join(offers)
    return f"{said}, can be enough" if ", or " in said else f"{said} can be enough"


def _said(task: Task, name: str, value: float) -> str:
    return f"{value / in_demand(task, name):.10g} {PEAKS[name].unit}"


def _enough(task: Task, name: str, value: float) -> str:
    return f"{shown_above(value / in_demand(task, name))} {PEAKS[name].unit}"


def _least(problem: Problem, name: str) -> float:
    """Least value of a demand that is not certainly too low; infinite where there is none."""
    value = problem.least_peak(name)
    if value > 0.0:
        return value
    found = turning_point(lambda value: problem.under(**{name: value}).excess, getattr(problem.asked, name))
    return inf if found is None else found[1]


def _of_curves_and_wishes(problem: Problem) -> TooTight:
    """The refusal where no peak is enough: convex curves, the pressure angle or a wish leave no law."""
    wishes = list(_wishes(problem.asked))
    bare = problem.under(**dict.fromkeys(WISHES, ()))
    alone = [bare.under(**{kind: (wish,)}) for kind, wish in wishes]
    for (kind, wish), only in zip(wishes, alone, strict=True):
        if bare.is_open and not only.is_open:
            kept = problem if _without(problem, kind, wish).is_open else only
            offers = [*_other_wishes(kept), *_other_curves(kept)]
            return TooTight(f"no law keeps this wish; {_any_of(offers)}", key=wish.key or "wishes")
    for kind, wish in wishes:
        if _without(problem, kind, wish).is_open:
            offers = [*_other_wishes(problem), *_other_curves(problem)]
            said = "no law keeps this wish with the other wishes"
            return TooTight(f"{said}; {_any_of(offers)}", key=wish.key or "wishes")
    offers = _other_curves(problem)
    return TooTight(
        "no law keeps the limits of ratio and curves and the wishes together"
        + (f"; {_any_of(offers)}" if offers else ""),
        key="optimize.limits",
    )


WISHES = ("times", "even_speeds", "speeds")
"""The demands that wishes of the motion ask for."""


def _wishes(asked: Demands) -> Iterator[tuple[str, StretchTime | SpeedSpread | SpeedRange]]:
    return ((kind, wish) for kind in WISHES for wish in getattr(asked, kind))


def _without(problem: Problem, kind: str, wish: StretchTime | SpeedSpread | SpeedRange) -> Problem:
    """The problem without one of its wishes."""
    return problem.under(**{kind: tuple(one for one in getattr(problem.asked, kind) if one is not wish)})


def _other_wishes(problem: Problem) -> list[str]:
    """For each wish without which there may be a law, the nearest that could be asked for, with its key."""
    said = []
    for kind, wish in _wishes(problem.asked):
        free = _without(problem, kind, wish)
        if free.is_open and (nearest := _nearest_wish(free, kind, wish)):
            said.append(f"{nearest} ({wish.key})" if wish.key else nearest)
    return said


def _nearest_wish(free: Problem, kind: str, wish: StretchTime | SpeedSpread | SpeedRange) -> str:
    """The nearest wish that can be kept, in words, with all that ``free`` asks for; empty where there is none."""
    others = getattr(free.asked, kind)

    def nearest(eased: Callable[[float], StretchTime | SpeedSpread | SpeedRange], guess: float) -> float:
        found = turning_point(lambda value: free.under(**{kind: (*others, eased(value))}).excess, guess)
        return inf if found is None else found[1]

    match wish:
        case StretchTime():
            return wish.shown(free.least_time(wish.start_rad, wish.end_rad))
        case SpeedSpread():
            over = nearest(lambda more: replace(wish, spread=1.0 + more), max(wish.spread - 1.0, LEAST_EASE))
            return wish.shown(1.0 + over) if over < inf else ""
        case SpeedRange():
            over = nearest(lambda more: wish.wider(1.0 + more), LEAST_EASE)
            return wish.shown(1.0 + over) if over < inf else ""


LEAST_EASE = 0.01
"""Where the search for a spread or a range of speeds begins, as a share of the speed."""


def _other_curves(problem: Problem) -> list[str]:
    """What of the curves would do instead: the least pressure angle, or curves that are not convex."""
    asked, said = problem.asked, []
    if asked.steepness < inf:
        rack = asked.rack_angle_rad
        widest = pi / 2.0 - rack if rack else pi / 2.0 - 1e-6
        if asked.tangent_rad < widest and problem.under(steepness=tan(widest)).is_open:
            found = turning_point(lambda steep: problem.under(steepness=steep).excess, asked.steepness)
            if found is not None:
                enough = degrees(atan(found[1]) + rack)
                of_rack = f" (of which the rack has {degrees(rack):.6g})" if rack else ""
                said.append(f"a pressure angle of {shown_above(enough)} deg{of_rack}")
    if asked.convex and problem.under(convex=False).is_open:
        said.append("pitch curves that are not convex")
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
    if value == 0.0:
        return "0"
    scale = 10.0 ** (DIGITS - 1 - floor(log10(abs(value))))
    return f"{to(value * scale) / scale:.{DIGITS + 1}g}"
