"""Refusals where no law keeps the limits: the binding limit, and its nearest value at which a law may keep them all.

As a limit is eased, the least driving angle for keeping the others never grows: at the nearest value it falls to the
driving angle of the cycle.
"""

from __future__ import annotations

from collections.abc import Callable, Sequence
from dataclasses import replace
from math import atan, degrees, exp, inf, log, pi, tan
from typing import Any

from ncgear.errors import NoSuchMechanism
from ncgear.numerics.bounds import shown_above, shown_below
from ncgear.optimum.certified.cycle import cycle
from ncgear.optimum.certified.demands import PEAKS, Demands, WishDemand
from ncgear.optimum.certified.problem import LimitProblem
from ncgear.optimum.offers import Refused
from ncgear.optimum.task import Task
from ncgear.wishes.requirements import EvenSpeed, TimeWithin
from ncgear.wishes.wish import Offer

FINE = 1e-5
"""Relative width of the final interval of a nearest value, which is shown with five digits."""

DOUBLINGS = 60.0
"""Doublings of a guess beyond which nothing is looked for."""

BEYOND = 10.0
"""The excess of a value for which no time would be enough."""


def turning_point(
    excess: Callable[[float], float], guess: float, fine: float = FINE, step: float = log(2.0)
) -> tuple[float, float] | None:
    """A value with an excess and a higher value without, at most ``fine`` apart; the excess never grows with the value.

    The excess may be infinite.  The guess must be positive and should be right to a share of ``step``.  The first value
    is 0 where there is no excess down to 2^-60 of the guess.  None where there is one up to 2^60 times the guess.
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
    most = DOUBLINGS * log(2.0)
    while (at(step if upwards else -step) > 0.0) == upwards:
        if step >= most:
            return None if upwards else (0.0, guess * 2.0**-DOUBLINGS)
        step = min(2.0 * step, most)
    low, high = ends()
    while high > low + fine:
        if known[low] == BEYOND:
            at((low + high) / 2.0)
            low, high = ends()
            continue
        near = brentq(at, low, high, xtol=fine / 8.0)
        for side in (-fine / 3.0, fine / 3.0):
            # Beside the interval rounding may decide, and the values there are known.
            at(min(max(near + side, low), high))
        low, high = ends()
    return guess * exp(low), guess * exp(high)


NOT_CONVEX = Offer("pitch curves that are not convex", (("optimize.limits.convex", False),))

LEAST_ROOM = 1e-9
"""Least difference of a limit from the mean ratio, as a share of it: a mean written with ten digits differs by less.
The bounds themselves hold down to 1e-12; below that, rounding decides whether there is a law."""


def _too_tight(said: str, offers: Sequence[Offer], key: str) -> Refused:
    """The refusal of limits that certainly no law keeps together; each offer alone can be enough."""
    return Refused(said, offers, key, _can_be_enough, each=True, found=False)


def _can_be_enough(said: str, offers: Sequence[Offer]) -> str:
    if not offers:
        return said
    told = ", or ".join(map(str, offers))
    return f"{said}; {told}, can be enough" if ", or " in told else f"{said}; {told} can be enough"


def refuse_ratios(task: Task, asked: Demands) -> None:
    """Refuse ratios that cannot close the cycle, or a stretch of it in its time; raises NoSuchMechanism."""
    _refuse_ratio(2.0 * pi, task.cycle_rad, asked, "the cycle")
    for wish in asked.wishes:
        if not isinstance(wish.asked, TimeWithin):
            continue
        (start, end), most = wish.asked.stretch, wish.asked.most_rad
        crank = end - start
        rest, least = 2.0 * pi - crank, task.cycle_rad - most
        if asked.ratio_min * crank > most:
            said = _at_one_ratio(f"least ratio of {asked.ratio_min:g}", crank, asked.ratio_min * crank)
            offers = [wish.shown(asked.ratio_min * crank), _ratio("ratio_min", "most", shown_below(most / crank))]
            said = f"{said} at most {degrees(most):.5g}"
        elif asked.ratio_max * rest < least:
            said = _at_one_ratio(f"greatest ratio of {asked.ratio_max:g}", rest, asked.ratio_max * rest)
            own = wish.shown(task.cycle_rad - asked.ratio_max * rest)
            offers = [own, *wish.instead, _ratio("ratio_max", "least", shown_above(least / rest))]
            said = f"{said} at least {degrees(least):.5g}"
        else:
            continue
        raise _too_tight(f"{said} deg of them", offers, wish.key)


def _ratio(name: str, side: str, enough: str) -> Offer:
    return Offer(f"a {name} of at {side} {enough}", ((f"optimize.limits.{name}", float(enough)),))


def _at_one_ratio(ratio: str, crank_rad: float, driving_rad: float) -> str:
    taken = f"{degrees(crank_rad):.5g} deg of the crank take {degrees(driving_rad):.5g} deg of the driving gear"
    return f"at the {ratio} throughout, {taken}, and the wish asks for"


def _key_and_unit(task: Task, name: str) -> tuple[str, str]:
    """The dotted key of a demand, and its unit at this key, in units of the output."""
    key, unit = PEAKS[name]
    if name == "acceleration_mm_s2":
        told = task.linkage.OUTPUT.acceleration
        key, unit = f"peak_acceleration_{told.ending}", f"{told.text[:-1]}^2"
    if name == "speed_mm_s":
        key, unit = f"peak_speed_{task.linkage.OUTPUT.speed.ending}", task.linkage.OUTPUT.speed.text
    return f"optimize.limits.{key}", unit


def in_demand(task: Task, name: str) -> float:
    """The factor from a limit's unit in a design file to the demand's unit: power in W, torque in N mm, and so on."""
    # Swing of energy = J w^2 times the coefficient of fluctuation; 1 N mm is 1000 kg mm^2/s^2
    swing = task.speed_rad_s**2 * task.speed_fluctuation / 1000.0
    return {"torque_n_mm": 1000.0, "fluctuation_n_mm": swing}.get(name, 1.0)


def too_little(task: Task, name: str, value: float, enough: float) -> Refused:
    """The refusal of a demand whose least value with the others is known."""
    said = f"{_said(task, name, value)} is too little with the other limits"
    return _too_tight(said, [_enough(task, name, enough, "at least ")], _key_and_unit(task, name)[0])


def refusal(problem: LimitProblem) -> Refused:
    """The error with the reason why no law keeps the demands: the binding peaks, then curves and wishes.

    It names a peak that is too low for any values of the others, with its nearest value; else each binding peak.
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
            return _too_tight(said, _offers(kept, [name]), _key_and_unit(task, name)[0])
    # Of two, each alone can be kept
    binding = [name for name in given if len(given) == 2 or problem.under(**{name: inf}).is_open] or list(given)
    names = sorted(binding, key=lambda name: name != "acceleration_mm_s2")
    said = " and ".join(_said(task, name, given[name]) for name in names)
    return _too_tight(f"{said} are too little together", _offers(problem, names), _key_and_unit(task, names[0])[0])


def _offers(problem: LimitProblem, names: Sequence[str]) -> list[Offer]:
    """Offers instead of peaks that are too low: each of them higher, or other changes."""
    least = [(name, value) for name in names if (value := _least(problem, name)) < inf]
    enough = [
        _enough(problem.task, name, value, "" if place else "at least ") for place, (name, value) in enumerate(least)
    ]
    return [*enough, *_other_curves(problem), *_other_wishes(problem)]


def _said(task: Task, name: str, value: float) -> str:
    return f"{value / in_demand(task, name):.10g} {_key_and_unit(task, name)[1]}"


def _enough(task: Task, name: str, value: float, before: str) -> Offer:
    (key, unit), enough = _key_and_unit(task, name), shown_above(value * (1.0 + EDGE) / in_demand(task, name))
    return Offer(f"{before}{enough} {unit}", ((key, float(enough)),))


EDGE = 1e-4
"""Share by which a named value of a peak exceeds the least value, at which a programme has no interior and the solver
may find no motion.  On the baler a third of it is enough."""


def _least(problem: LimitProblem, name: str) -> float:
    """Least value of a demand that is not certainly too low; infinite where all values are."""
    value = problem.least_peak(name)
    if value > 0.0:
        return value
    found = turning_point(lambda value: problem.under(**{name: value}).excess, getattr(problem.asked, name))
    return inf if found is None else found[1]


def _of_curves_and_wishes(problem: LimitProblem) -> Refused:
    """The refusal where no peak is enough; a wish that cannot be kept alone comes before wishes together."""
    wishes, bare = problem.asked.in_order, problem.under(wishes=())
    for wish in wishes:
        alone = bare.under(wishes=(wish,))
        if bare.is_open and not alone.is_open:
            free = _without(problem, wish)
            kept, free = (problem, free) if free.is_open else (alone, bare)
            offers = [*_nearest_wish(free, wish), *_other_curves(kept)]
            return _too_tight("no law keeps this wish", offers, wish.key or "wishes")
    instead = _other_wishes(problem)
    offers = [*instead, *_other_curves(problem)]
    if instead:
        said, key = "no law keeps this wish with the other wishes", instead[0].key or "wishes"
    else:
        said, key = "no law keeps the limits of ratio and curves and the wishes together", "optimize.limits"
    return _too_tight(said, offers, key)


def _without(problem: LimitProblem, wish: WishDemand) -> LimitProblem:
    return problem.under(wishes=tuple(other for other in problem.asked.wishes if other is not wish))


def _other_wishes(problem: LimitProblem) -> list[Offer]:
    """For each wish whose removal may allow a law, the nearest possible wish, with its key."""
    free = ((wish, _without(problem, wish)) for wish in problem.asked.in_order)
    return [said for wish, without in free if without.is_open for said in _nearest_wish(without, wish)]


def _nearest_wish(free: LimitProblem, wish: WishDemand) -> list[Offer]:
    """The nearest wish that can be kept with all demands of ``free``, in words; empty where there is none."""

    def nearest(guess: float) -> float:
        return 1.0 + _eased(free, lambda more: {"wishes": (*free.asked.wishes, wish.eased(1.0 + more))}, guess)

    match wish.asked:
        case TimeWithin(stretch):
            eased = free.least_time(*stretch)
        case EvenSpeed(_, spread):
            eased = nearest(max(spread - 1.0, LEAST_EASE))
        case _:
            eased = nearest(LEAST_EASE)
    return [] if eased == inf else [replace(wish.shown(eased), key=wish.key)]


def _eased(problem: LimitProblem, demands: Callable[[float], dict[str, Any]], guess: float) -> float:
    """The least value whose demands can be kept, to a share of EASED; infinite where there is none."""

    def turned(on: LimitProblem, guess: float, step: float) -> tuple[float, float] | None:
        return turning_point(lambda value: on.under(**demands(value)).excess, guess, EASED, step)

    few = problem.under(**demands(guess))
    few = replace(few, on=cycle(few.task, FEW_PLACES, few.asked.places_rad))
    near = turned(few, guess, log(2.0)) if few.on.count < problem.on.count else None
    found = turned(problem, near[1], EASED) if near is not None and near[0] > 0.0 else turned(problem, guess, log(2.0))
    return inf if found is None else found[1]


EASED = 1e-3
"""Relative width of the final interval of the nearest value of a wish or of the pressure angle."""

FEW_PLACES = 200
"""Places of the first search for an interval."""

LEAST_EASE = 0.01
"""Start of the search for a spread or a range of speeds, as a share of the speed."""


def _other_curves(problem: LimitProblem) -> list[Offer]:
    """Offers of other curves: the least pressure angle, or curves that are not convex."""
    asked, said = problem.asked, list[Offer]()
    if asked.steepness < inf:
        rack = asked.rack_angle_rad
        widest = pi / 2.0 - rack if rack else pi / 2.0 - 1e-6
        if asked.tangent_rad < widest and problem.under(steepness=tan(widest)).is_open:
            steep = _eased(problem, lambda value: {"steepness": value}, asked.steepness)
            if steep < inf:
                enough = degrees(atan(steep) + rack)
                of_rack = f" (of which the rack has {degrees(rack):.6g})" if rack else ""
                shown = shown_above(enough)
                values = (("optimize.limits.pressure_angle_deg", float(shown)),)
                said.append(Offer(f"a pressure angle of {shown} deg{of_rack}", values))
    if asked.convex and problem.under(convex=False).is_open:
        said.append(NOT_CONVEX)
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
    for key, given, beyond, enough in (
        ("ratio_min", limits.ratio_min, limits.ratio_min > mean, f"at most {shown_below(mean)}"),
        ("ratio_max", limits.ratio_max, limits.ratio_max < mean, f"at least {shown_above(mean)}"),
    ):
        if beyond:
            raise NoSuchMechanism(
                f"at {given:g} throughout, {stretch} takes {given * crank_rad:.5g} rad of the driving gear, and it has "
                f"{driving_rad:.5g}; {enough} is right",
                key=f"optimize.limits.{key}",
            )
