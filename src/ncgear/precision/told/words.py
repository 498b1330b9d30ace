"""Measured points in words: times, errors, rates, and whether the choice is the knee."""

from __future__ import annotations

from ncgear.precision.knee import SAME_TIME, Found, Knee, knee
from ncgear.precision.rates import rates
from ncgear.precision.study import Measured, Method, Point


def time_text(point: Point) -> str:
    """Time to three digits, in the unit that suits it."""
    for unit, size in (("s", 1.0), ("ms", 1e-3)):
        if point.seconds >= size:
            return f"{point.seconds / size:.3g} {unit}"
    return f"{point.seconds / 1e-6:.3g} µs"


def error_text(point: Point) -> str:
    """Error to two digits."""
    return f"{point.error:.1e}" if point.error else "0"


def level_text(method: Method, point: Point) -> str:
    """Level with its word, a dash where there is none."""
    if not method.level:
        return "-"
    counted = method.level.split()[0].endswith("s")
    return f"{point.level:g} {method.level}" if counted else f"{method.level} {point.level:g}"


def named(one: Found) -> str:
    """A method with its level, where it has one."""
    method, point = one
    return f"{method.name}, {level_text(method, point)}" if method.level else method.name


def rates_text(found: Measured) -> str:
    """Fitted rates of convergence beside the theory's; empty where theory tells none."""
    told = [f"{rate.method} {rate.fitted:.2f} (theory {rate.theory:g})" for rate in rates(found)]
    return f"Order of convergence, fitted above rounding: {', '.join(told)}." if told else ""


def verdict_text(found: Measured) -> str:
    """Whether the choice is the knee, in a word or a few."""
    told = knee(found)
    if told.is_chosen:
        return "yes"
    if told.chosen[1].error > told.error:
        return "no: not exact enough"
    slower = f"{told.slowness:.2g} times the time of {named(told.quickest)}"
    return f"among adaptive methods; {slower}" if _among_adaptive(found) else f"no: {slower}"


def choice_text(found: Measured) -> str:
    """What ncgear does and why, and what the measured points say of it."""
    told = knee(found)
    said = f"ncgear uses {named(told.chosen)}: {found.study.because}."
    return " ".join([said, _knee_text(found, told), *_neighbours(told)])


def _among_adaptive(found: Measured) -> bool:
    return found.chosen[0].unaided and knee(found, unaided=True).is_chosen


def _knee_text(found: Measured, told: Knee) -> str:
    bound = f"an error of at most {told.error:.1e}"
    if told.is_chosen:
        return f"That is the knee: with {bound}, no other point is quicker by a factor of {SAME_TIME:g}."
    if told.chosen[1].error > told.error:
        return (
            f"That is not the knee: its error is larger than {told.error:.1e}, which {_costs(told.quickest)} reaches."
        )
    quicker = f"{_costs(told.quickest)} has {bound} too, {told.slowness:.2g} times as fast"
    if _among_adaptive(found):
        return (
            f"That is the knee among methods that find by themselves how fine they must be; {quicker}, with its number "
            "of points chosen by the exact result."
        )
    return f"That is not the knee: {quicker}."


def _neighbours(told: Knee) -> list[str]:
    sides = (
        ("cheaper", told.cheaper, "Nothing quicker was measured"),
        ("dearer", told.dearer, "Nothing is more exact"),
    )
    return [f"Next {side}: {_beside(told, one)}." if one else f"{none}." for side, one, none in sides]


def _beside(told: Knee, one: Found) -> str:
    """A neighbour's factors of time and error on the chosen point."""
    here, there = told.chosen[1], one[1]
    error = f"{there.error / here.error:.2g} times the error" if here.error else f"an error of {error_text(there)}"
    return f"{named(one)}, {there.seconds / here.seconds:.2g} times the time and {error}"


def _costs(one: Found) -> str:
    return f"{named(one)} ({time_text(one[1])})"
