"""Levels of a person's wishes of the motion: even speeds, speeds at places, and driving angles of stretches.

A wish has requirements on stretches of the crank (``ncgear.wishes.requirements``); here each becomes a level.  Speeds
count by their logarithm, ln(w |x'|) - ln i12, which is linear in the spline, and times by the integral of i12, the
driving angle that a stretch takes.

A hard wish is a limit.  A soft wish is a level that costs nothing down to its ``floor``.  Its weight is the weight of
the wish per share of the speed (the logarithm's small differences) or of the cycle's driving angle, in shares of the
goal.
"""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from dataclasses import replace
from math import exp, inf, log

from ncgear.optimum.makeable.levels import LevelKind, Sides, WishLevel
from ncgear.optimum.makeable.quantities import RatioPlace, Slider, Term, acceleration, log_speed
from ncgear.optimum.task import Task
from ncgear.wishes.requirements import DecelerationWithin, EvenSpeed, PushedSpeed, Requirement, SpeedWithin, TimeWithin
from ncgear.wishes.wish import DrivingWish, Offer, Wish

EXACT_RAD = 1e-5
"""Tolerance of a driving angle below which the angle itself is held: ten times the margin of the search."""


def of_motion_wishes(task: Task, wishes: Sequence[Wish]) -> Iterator[WishLevel]:
    """The levels of all wishes, hard and soft."""
    for wish in wishes:
        for pushed in wish.pushed(task.linkage):
            yield _pushed(task, wish, pushed)
        for asked in wish.requirements(task.linkage, task.cycle_rad):
            match asked:
                case EvenSpeed():
                    yield _even(task, wish, asked)
                case SpeedWithin():
                    yield _speed(task, wish, asked)
                case DecelerationWithin():
                    yield _deceleration(task, wish, asked)
                case TimeWithin():
                    # The times of a driving range only place it, so that a soft wish counts by its bound alone
                    yield from _times(
                        task, replace(wish, weight=None) if isinstance(wish, DrivingWish) else wish, asked
                    )


def _level(
    task: Task,
    wish: Wish,
    asked: Requirement,
    kind: LevelKind,
    sides: Sides,
    most: float = 0.0,
    per_share: float = 1.0,
    target: float = 0.0,
) -> WishLevel:
    """The level of a wish: a hard wish keeps it to ``most``; a soft wish costs from there, by ``per_share``."""
    return WishLevel(
        wish.key,
        most if wish.hard else None,
        0.0,
        sides,
        lambda level: wish.offer(asked, level, task.cycle_rad),
        kind=kind,
        stretch=asked.stretch,
        target=target,
        group="",
        floor=-inf if wish.hard else most,
        share_of_goal=(wish.weight or 0.0) / per_share,
    )


def _pushed(task: Task, wish: Wish, pushed: PushedSpeed) -> WishLevel:
    sign = -1.0 if pushed.fastest else 1.0
    return WishLevel(
        wish.key,
        None,
        0.0,
        lambda at, slider, _: (sign * log_speed(at, slider, task.speed_rad_s),),
        lambda level: Offer(f"{exp(sign * level):.5g} {wish.output.speed.text}"),
        stretch=pushed.stretch,
        group="",
        share_of_goal=wish.weight or 0.0,
    )


def _even(task: Task, wish: Wish, asked: EvenSpeed) -> WishLevel:
    """Twice the tolerance is the spread of the logarithm, but for its third power."""

    def sides(at: RatioPlace, slider: Slider, _: Term) -> tuple[Term, ...]:
        return (log_speed(at, slider, task.speed_rad_s),)

    return _level(task, wish, asked, LevelKind.SPREAD, sides, most=log(asked.spread), per_share=2.0)


def _speed(task: Task, wish: Wish, asked: SpeedWithin) -> WishLevel:
    least, most = asked.least_mm_s, asked.most_mm_s

    def sides(at: RatioPlace, slider: Slider, _: Term) -> tuple[Term, ...]:
        speed = log_speed(at, slider, task.speed_rad_s)
        over = (speed - log(most),) if most < inf else ()
        return (*over, log(least) - speed) if least > 0.0 else over

    return _level(task, wish, asked, LevelKind.PEAK, sides)


def _deceleration(task: Task, wish: Wish, asked: DecelerationWithin) -> WishLevel:
    """Deceleration over ``most_mm_s2``, less 1, in both strokes; no place stands at a dead centre."""

    def sides(at: RatioPlace, slider: Slider, _: Term) -> tuple[Term, ...]:
        forwards = slider.first / abs(slider.first)
        return (-forwards * acceleration(at, slider, task.speed_rad_s) / asked.most_mm_s2 - 1.0,)

    return _level(task, wish, asked, LevelKind.PEAK, sides)


def _times(task: Task, wish: Wish, asked: TimeWithin) -> Iterator[WishLevel]:
    """A driving angle held, or bounded from above and from below."""
    least, most, cycle = asked.least_rad, asked.most_rad, task.cycle_rad
    if most - least < 2.0 * EXACT_RAD:
        held = (least + most) / 2.0
        yield _level(task, wish, asked, LevelKind.DEVIATION, lambda *_: (1.0,), per_share=cycle, target=held)
        return
    if most < inf:
        yield _level(task, wish, asked, LevelKind.INTEGRAL, lambda *_: (1.0,), per_share=cycle, target=most)
    if least > 0.0:
        yield _level(task, wish, asked, LevelKind.INTEGRAL, lambda *_: (-1.0,), per_share=cycle, target=-least)
