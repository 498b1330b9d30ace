"""Levels of what a person wishes of the motion: even speeds, speeds at places, and driving angles of stretches.

A wish says what it asks by requirements on stretches of the crank (``ncgear.kinematics.wishes``); here each becomes a
level.  Speeds count by their logarithm, ln(w |x'|) - ln i12, which is linear in the spline, and times by the integral
of i12, the driving angle that a stretch takes.

A hard wish is a limit.  A soft one is a level that costs nothing down to its ``floor``: its weight is the wish's per
share of the speed (the logarithm's small differences) or of the cycle's driving angle, in shares of the goal.
"""

from __future__ import annotations

from collections.abc import Callable, Iterator, Sequence
from dataclasses import replace
from math import degrees, exp, inf, log, tanh

from ncgear.kinematics.wishes import (
    ConstantSpeed,
    CrankStretch,
    DecelerationWithin,
    DrivingRange,
    Dwell,
    EvenSpeed,
    ExtremeSpeed,
    GentleSpeed,
    GentleStretch,
    Position,
    SpeedAt,
    SpeedWithin,
    TimeRatio,
    TimeWithin,
    Wish,
    WorkingStroke,
)
from ncgear.numerics.bounds import shown_above, shown_below
from ncgear.optimum.makeable.levels import Level, LevelKind
from ncgear.optimum.makeable.quantities import Place, Slider, Term, acceleration, log_speed
from ncgear.optimum.offers import Offer
from ncgear.optimum.task import Task

EXACT_RAD = 1e-5
"""Tolerance of a driving angle below which the angle itself is held: ten times the margin of the search."""


def of_motion_wishes(task: Task, wishes: Sequence[Wish]) -> Iterator[Level]:
    """The levels of all wishes, hard and soft."""
    for wish in wishes:
        if isinstance(wish, ExtremeSpeed):
            yield _extreme(task, wish)
        for asked in wish.requirements(task.linkage, task.cycle_rad):
            match asked:
                case EvenSpeed(stretch, widest):
                    yield _even(task, wish, stretch, widest)
                case SpeedWithin():
                    yield _speed(task, wish, asked)
                case DecelerationWithin():
                    yield _deceleration(task, wish, asked)
                case TimeWithin():
                    # Those of a gentle stretch only say where it is, so that a soft one counts by its bound alone
                    yield from _times(
                        task, replace(wish, weight=None) if isinstance(wish, GentleStretch) else wish, asked
                    )


def _level(
    wish: Wish,
    kind: LevelKind,
    stretch: CrankStretch,
    sides: Callable[[Place, Slider, Term], tuple[Term, ...]],
    shown: Callable[[float], Offer],
    most: float = 0.0,
    per_share: float = 1.0,
    target: float = 0.0,
) -> Level:
    """A hard wish's level of at most ``most``; a soft one's costs from there on, ``per_share`` of it a share."""
    return Level(
        wish.key,
        most if wish.hard else None,
        0.0,
        sides,
        shown,
        kind=kind,
        stretch=stretch,
        target=target,
        group="",
        floor=-inf if wish.hard else most,
        share_of_goal=(wish.weight or 0.0) / per_share,
    )


def _extreme(task: Task, wish: ExtremeSpeed) -> Level:
    sign = -1.0 if wish.fastest else 1.0
    return Level(
        wish.key,
        None,
        0.0,
        lambda at, slider, _: (sign * log_speed(at, slider, task.speed_rad_s),),
        lambda level: Offer(f"{exp(sign * level):.5g} {wish.output.speed.text}"),
        stretch=wish.place(task.linkage),
        group="",
        share_of_goal=wish.weight or 0.0,
    )


def _even(task: Task, wish: Wish, stretch: CrankStretch, widest: float) -> Level:
    """Twice the tolerance is the spread of the logarithm, but for its third power."""
    return _level(
        wish,
        LevelKind.SPREAD,
        stretch,
        lambda at, slider, _: (log_speed(at, slider, task.speed_rad_s),),
        lambda level: evenness_offer(wish, level),
        most=log(widest),
        per_share=2.0,
    )


def _speed(task: Task, wish: Wish, asked: SpeedWithin) -> Level:
    least, most = asked.least_mm_s, asked.most_mm_s

    def sides(at: Place, slider: Slider, _: Term) -> tuple[Term, ...]:
        speed = log_speed(at, slider, task.speed_rad_s)
        over = (speed - log(most),) if most < inf else ()
        return (*over, log(least) - speed) if least > 0.0 else over

    return _level(wish, LevelKind.PEAK, asked.stretch, sides, lambda level: speed_offer(wish, asked, level))


def _deceleration(task: Task, wish: Wish, asked: DecelerationWithin) -> Level:
    """Deceleration over ``most_mm_s2``, less one; the speed falls where acceleration is against velocity.

    One level for both strokes.  x' has the sign of the stroke at every place, since those at dead centres are moved in.
    """

    def sides(at: Place, slider: Slider, _: Term) -> tuple[Term, ...]:
        forwards = slider.first / abs(slider.first)
        return (-forwards * acceleration(at, slider, task.speed_rad_s) / asked.most_mm_s2 - 1.0,)

    return _level(
        wish, LevelKind.PEAK, asked.stretch, sides, lambda level: deceleration_offer(wish, asked, 1.0 + level)
    )


def deceleration_offer(wish: Wish, asked: DecelerationWithin, factor: float) -> Offer:
    """What a wish would have to ask for so that decelerations so many times the one that it asks for were kept."""
    told, most = wish.output.acceleration, shown_above(factor * asked.most_mm_s2)
    values = ((f"{wish.key}.deceleration_at_most_{told.ending}", float(most)),)
    return Offer(f"a deceleration of at most {most} {told.text}", values)


def evenness_offer(wish: Wish, level: float) -> Offer:
    """The tolerance of a speed whose greatest value is exp(level) times the least."""
    return _tolerance(wish, tanh(level / 2.0))


def _tolerance(wish: Wish, share: float) -> Offer:
    tolerance = shown_above(share)
    return Offer(f"a tolerance of {tolerance} of the speed", ((f"{wish.key}.tolerance", float(tolerance)),))


def speed_offer(wish: Wish, asked: SpeedWithin, level: float) -> Offer:
    """What a wish would have to ask for so that speeds beyond its bounds by a factor of exp(level) were within them."""
    least, most = asked.least_mm_s, asked.most_mm_s
    place, unit = wish.output.place, wish.output.speed
    match wish:
        case ConstantSpeed():
            return _tolerance(wish, (1.0 + wish.tolerance) * exp(level) - 1.0)
        case SpeedAt():
            bounds = {"at least": shown_below(least * exp(-level))} if least > 0.0 else {}
            bounds |= {"at most": shown_above(most * exp(level))} if most < inf else {}
            said = " and ".join(f"{bound} {speed} {unit.text}" for bound, speed in bounds.items())
            keys = {bound: f"{wish.key}.{bound.replace(' ', '_')}_{unit.ending}" for bound in bounds}
            values = tuple((keys[bound], float(speed)) for bound, speed in bounds.items())
            return Offer(f"{said} at {place.factor * wish.at_mm:g} {place.text}", values)
        case GentleSpeed():
            top = shown_above(most * exp(level))
            return Offer(
                f"a speed of at most {top} {unit.text}", ((f"{wish.key}.speed_at_most_{unit.ending}", float(top)),)
            )
    raise TypeError(f"{type(wish).__name__} asks for no speed")


def _times(task: Task, wish: Wish, asked: TimeWithin) -> Iterator[Level]:
    """A driving angle held, or bounded from above and from below."""
    cycle, middle = task.cycle_rad, (asked.least_rad + asked.most_rad) / 2.0
    if asked.most_rad - asked.least_rad < 2.0 * EXACT_RAD:
        yield _time(wish, asked, LevelKind.DEVIATION, 1.0, middle, cycle)
        return
    if asked.most_rad < inf:
        yield _time(wish, asked, LevelKind.INTEGRAL, 1.0, asked.most_rad, cycle)
    if asked.least_rad > 0.0:
        yield _time(wish, asked, LevelKind.INTEGRAL, -1.0, -asked.least_rad, cycle)


def _time(wish: Wish, asked: TimeWithin, kind: LevelKind, sign: float, target: float, cycle: float) -> Level:
    return _level(
        wish,
        kind,
        asked.stretch,
        lambda *_: (sign,),
        lambda level: time_offer(wish, level, sign, cycle),
        per_share=cycle,
        target=target,
    )


def time_offer(wish: Wish, level: float, sign: float, cycle: float) -> Offer:
    """What a wish would have to ask for so that a driving angle in rad by which it is missed were none."""
    match wish:
        case TimeRatio():
            working = cycle * wish.at_least / (1.0 + wish.at_least) - level
            name, number = "at_least", shown_below(working / (cycle - working))
            said = f"at least {number} times the time of the return"
        case WorkingStroke():
            name, number = "tolerance_deg", shown_above(degrees(wish.tolerance_rad + level))
            said = f"a tolerance of {number} deg"
        case Dwell():
            name, number = "for_deg", shown_below(degrees(wish.for_rad - level))
            said = f"a dwell of {number} deg"
        case Position():
            shown, place = shown_above if sign > 0.0 else shown_below, wish.output.place
            name, number = "phi1_deg", shown(degrees(wish.phi1_rad + sign * level))
            said = f"{place.factor * wish.at_mm:g} {place.text} passed at {number} deg"
        case GentleStretch(driving=DrivingRange(start, end, _)):
            # Its start is passed too late by the level, or its end too early
            angles = {"from": shown_above(degrees(start + level)), "to": shown_below(degrees(end - level))}
            said = " ".join(f"{name} {number}" for name, number in angles.items())
            return Offer(
                f"a stretch {said} deg",
                tuple((f"{wish.key}.{name}_phi1_deg", float(number)) for name, number in angles.items()),
            )
        case _:
            raise TypeError(f"{type(wish).__name__} asks for no time")
    return Offer(said, ((f"{wish.key}.{name}", float(number)),))
