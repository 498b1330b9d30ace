"""Levels of what a person wishes of the motion: even speeds, speeds at places, and driving angles of stretches.

A wish says what it asks by requirements on stretches of the crank (``ncgear.kinematics.wishes``); here each becomes a
level.  Speeds count by their logarithm, ln(w |x'|) - ln i12, which is linear in the spline, and times by the integral
of i12, the driving angle that a stretch takes.

A hard wish is a limit.  A soft one is a level that costs nothing down to its ``floor``: its weight is the wish's per
share of the speed (the logarithm's small differences) or of the cycle's driving angle, in shares of the goal.
"""

from __future__ import annotations

from collections.abc import Callable, Iterator, Sequence
from math import degrees, exp, inf, log, tanh

from ncgear.frozen import dataclass
from ncgear.kinematics.wishes import (
    ConstantSpeed,
    CrankStretch,
    Dwell,
    EvenSpeed,
    ExtremeSpeed,
    Position,
    SpeedAt,
    SpeedWithin,
    TimeRatio,
    TimeWithin,
    Wish,
    WorkingStroke,
    spread,
)
from ncgear.mechanisms.mechanism import Mechanism
from ncgear.optimum.certified.refusals import shown_above, shown_below
from ncgear.optimum.makeable.levels import Kind, Level, Stretch
from ncgear.optimum.makeable.quantities import Place, Slider, Term, log_speed

WIDEST_TOLERANCE = 0.5
"""Greatest tolerance of an even speed that a design file may ask for."""

EXACT_RAD = 1e-5
"""Tolerance of a driving angle below which the angle itself is held: ten times the margin of the search."""


@dataclass(frozen=True)
class WishedMachine:
    """The mechanism, its driving speed in rad/s, and the driving angle of its cycle in rad."""

    linkage: Mechanism
    speed_rad_s: float
    cycle_rad: float


def of_motion_wishes(machine: WishedMachine, wishes: Sequence[Wish]) -> Iterator[Level]:
    """The levels of all wishes, hard and soft."""
    for wish in wishes:
        if isinstance(wish, ExtremeSpeed):
            yield _extreme(machine, wish)
        for asked in wish.requirements(machine.linkage, machine.cycle_rad):
            match asked:
                case EvenSpeed(stretch, widest):
                    yield _even(machine, wish, stretch, widest)
                case SpeedWithin():
                    yield _speed(machine, wish, asked)
                case TimeWithin():
                    yield from _times(machine, wish, asked)


def _level(
    wish: Wish,
    kind: Kind,
    stretch: CrankStretch,
    sides: Callable[[Place, Slider, Term], tuple[Term, ...]],
    shown: Callable[[float], str],
    most: float = 0.0,
    per_share: float = 1.0,
    target: float = 0.0,
    widest: float = inf,
) -> Level:
    """A hard wish's level of at most ``most``; a soft one's costs from there on, ``per_share`` of it a share."""
    return Level(
        wish.key,
        most if wish.hard else None,
        0.0,
        sides,
        shown,
        kind=kind,
        stretch=Stretch(*stretch),
        target=target,
        widest=widest,
        group="",
        floor=-inf if wish.hard else most,
        share_of_goal=(wish.weight or 0.0) / per_share,
    )


def _extreme(machine: WishedMachine, wish: ExtremeSpeed) -> Level:
    sign = -1.0 if wish.fastest else 1.0
    return Level(
        wish.key,
        None,
        0.0,
        lambda at, slider, _: (sign * log_speed(at, slider, machine.speed_rad_s),),
        lambda level: f"{exp(sign * level):.5g} {wish.output.speed.text}",
        stretch=Stretch(*wish.place(machine.linkage)),
        group="",
        share_of_goal=wish.weight or 0.0,
    )


def _even(machine: WishedMachine, wish: Wish, stretch: CrankStretch, widest: float) -> Level:
    """Twice the tolerance is the spread of the logarithm, but for its third power."""
    return _level(
        wish,
        Kind.SPREAD,
        stretch,
        lambda at, slider, _: (log_speed(at, slider, machine.speed_rad_s),),
        evenness_in_words,
        most=log(widest),
        per_share=2.0,
        widest=log(spread(WIDEST_TOLERANCE)),
    )


def _speed(machine: WishedMachine, wish: Wish, asked: SpeedWithin) -> Level:
    least, most = asked.least_mm_s, asked.most_mm_s

    def sides(at: Place, slider: Slider, _: Term) -> tuple[Term, ...]:
        speed = log_speed(at, slider, machine.speed_rad_s)
        over = (speed - log(most),) if most < inf else ()
        return (*over, log(least) - speed) if least > 0.0 else over

    def shown(level: float) -> str:
        return speed_in_words(wish, asked, level)

    return _level(wish, Kind.PEAK, asked.stretch, sides, shown)


def evenness_in_words(level: float) -> str:
    """The tolerance of a speed whose greatest value is exp(level) times the least."""
    return f"a tolerance of {shown_above(tanh(level / 2.0))} of the speed"


def speed_in_words(wish: Wish, asked: SpeedWithin, level: float) -> str:
    """What a wish would have to ask for so that speeds beyond its bounds by a factor of exp(level) were within them."""
    least, most = asked.least_mm_s, asked.most_mm_s
    place, unit = wish.output.place, wish.output.speed.text
    match wish:
        case ConstantSpeed():
            return f"a tolerance of {shown_above((1.0 + wish.tolerance) * exp(level) - 1.0)} of the speed"
        case SpeedAt():
            bounds = [f"at least {shown_below(least * exp(-level))} {unit}"] if least > 0.0 else []
            bounds += [f"at most {shown_above(most * exp(level))} {unit}"] if most < inf else []
            return f"{' and '.join(bounds)} at {place.factor * wish.at_mm:g} {place.text}"
    raise TypeError(f"{type(wish).__name__} asks for no speed")


def _times(machine: WishedMachine, wish: Wish, asked: TimeWithin) -> Iterator[Level]:
    """A driving angle held, or bounded from above and from below."""
    cycle, middle = machine.cycle_rad, (asked.least_rad + asked.most_rad) / 2.0
    if asked.most_rad - asked.least_rad < 2.0 * EXACT_RAD:
        yield _time(wish, asked, Kind.DEVIATION, 1.0, middle, cycle)
        return
    if asked.most_rad < inf:
        yield _time(wish, asked, Kind.INTEGRAL, 1.0, asked.most_rad, cycle)
    if asked.least_rad > 0.0:
        yield _time(wish, asked, Kind.INTEGRAL, -1.0, -asked.least_rad, cycle)


def _time(wish: Wish, asked: TimeWithin, kind: Kind, sign: float, target: float, cycle: float) -> Level:
    return _level(
        wish,
        kind,
        asked.stretch,
        lambda *_: (sign,),
        lambda level: time_in_words(wish, level, sign, cycle),
        per_share=cycle,
        target=target,
    )


def time_in_words(wish: Wish, level: float, sign: float, cycle: float) -> str:
    """What a wish would have to ask for so that a driving angle in rad by which it is missed were none."""
    match wish:
        case TimeRatio():
            working = cycle * wish.at_least / (1.0 + wish.at_least) - level
            return f"at least {shown_below(working / (cycle - working))} times the time of the return"
        case WorkingStroke():
            return f"a tolerance of {shown_above(degrees(wish.tolerance_rad + level))} deg"
        case Dwell():
            return f"a dwell of {shown_below(degrees(wish.for_rad - level))} deg"
        case Position():
            shown = shown_above if sign > 0.0 else shown_below
            place, angle = wish.output.place, shown(degrees(wish.phi1_rad + sign * level))
            return f"{place.factor * wish.at_mm:g} {place.text} passed at {angle} deg"
    raise TypeError(f"{type(wish).__name__} asks for no time")
