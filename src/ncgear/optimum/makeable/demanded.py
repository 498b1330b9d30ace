"""What of the wishes the certified limit knows, and what it does not."""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import replace
from math import inf

from ncgear.errors import NoSuchMechanism
from ncgear.kinematics.wishes import CrankStretch, EvenSpeed, SpeedWithin, TimeWithin, Wish
from ncgear.optimum.certified.demands import Demands, SpeedRange, SpeedSpread, StretchTime
from ncgear.optimum.certified.limit import (
    Bound,
    Motion,
    Weights,
    least_acceleration,
    least_of,
    least_power,
    least_weighted_sum,
)
from ncgear.optimum.certified.refusals import shown_above
from ncgear.optimum.makeable.wishes import Wishes
from ncgear.optimum.task import Task

OF_LOADS = {"braking_power_w": "braking_w", "rms_torque_n_m": "torque_n_mm", "flywheel_kg_mm2": "fluctuation_n_mm"}
"""Figures of a machine's loads that the limit knows, and their names among its demands."""


def demands_of(task: Task, wishes: Wishes) -> Demands:
    """The demands of hard wishes and limits, as far as the certified limit knows them."""
    limits = wishes.limits
    slowest = 0.0 if wishes.driven_speed_rad_s is None else task.speed_rad_s / wishes.driven_speed_rad_s
    asked = [
        one
        for wish in wishes.motion
        if wish.hard
        for requirement in wish.requirements(task.linkage, task.cycle_rad)
        for one in _demands(wish, requirement, task.cycle_rad)
    ]
    one_pair = wishes.two_stages is None
    return Demands(
        ratio_min=max(limits.ratio_min, slowest),
        ratio_max=limits.ratio_max,
        steepness=limits.steepness if one_pair else inf,
        rack_angle_rad=limits.rack_angle_rad,
        convex=wishes.convex and one_pair,
        acceleration_mm_s2=limits.peak_acceleration_mm_s2 or inf,
        power_w=limits.peak_power_w or inf,
        **{name: _of_load(task, figure, getattr(limits, figure)) for figure, name in OF_LOADS.items()},
        times=tuple(one for one in asked if isinstance(one, StretchTime)),
        even_speeds=tuple(one for one in asked if isinstance(one, SpeedSpread)),
        speeds=tuple(one for one in asked if isinstance(one, SpeedRange)),
    )


def _of_load(task: Task, figure: str, value: float | None) -> float:
    """The demand that a limit of a load is: N mm for torques, and for the energy that a flywheel takes."""
    if value is None:
        return inf
    return value * _unit(task, figure)


def _unit(task: Task, figure: str) -> float:
    """What one unit of a figure is in the unit of its demand."""
    match figure:
        case "rms_torque_n_m":
            return 1000.0
        case "flywheel_kg_mm2":
            # Swing of energy = J w^2 times the coefficient of fluctuation; 1 N mm is 1000 kg mm^2/s^2
            return task.speed_rad_s**2 * task.speed_fluctuation / 1000.0
    return 1.0


def _demands(
    wish: Wish, asked: SpeedWithin | EvenSpeed | TimeWithin, cycle_rad: float
) -> Iterator[StretchTime | SpeedSpread | SpeedRange]:
    match asked:
        case SpeedWithin(stretch, least, most):
            yield SpeedRange(wish.key, stretch.start_rad, stretch.end_rad, least, most)
        case EvenSpeed(stretch, spread):
            yield SpeedSpread(wish.key, stretch.start_rad, stretch.end_rad, spread)
        case TimeWithin(stretch, least, most):
            if most < inf:
                yield _time(wish, stretch, most)
            if least > 0.0:
                yield _time(wish, stretch.rest, cycle_rad - least)


def _time(wish: Wish, stretch: CrankStretch, at_most_rad: float) -> StretchTime:
    return StretchTime(wish.key, stretch.start_rad, stretch.end_rad, at_most_rad)


def certified_limit(task: Task, wishes: Wishes) -> Bound | None:
    """The limit of a goal, in the goal's unit; None for a goal that no limit is known of.

    Raises NoSuchMechanism where certainly no law keeps the limits.
    """
    asked, prices = demands_of(task, wishes), wishes.prices
    priced = {name: price for name, price in vars(prices).items() if price}
    if set(priced) == {"peak_acceleration_mm_s2", "peak_power_w"}:
        weights = Weights(prices.peak_acceleration_mm_s2, prices.peak_power_w)
        return least_weighted_sum(task, asked, weights)
    found = [bound for name, price in priced.items() if (bound := _alone(task, asked, name, price)) is not None]
    if not found:
        return None
    # No law has less of any figure than alone, and so none has a lower sum
    return replace(found[0], value=sum(bound.value for bound in found))


def _alone(task: Task, asked: Demands, name: str, price: float) -> Bound | None:
    """The limit of one figure times its price; None where no limit of it is known."""
    if name == "peak_acceleration_mm_s2":
        found = least_acceleration(task, asked)
        _refuse_under(found, asked.acceleration_mm_s2, name, "mm/s^2")
        return found.times(price)
    if name == "peak_power_w":
        found = least_power(task, asked)
        _refuse_under(found, asked.power_w, name, "W")
        return found.times(price)
    if name in OF_LOADS:
        return least_of(task, asked, OF_LOADS[name]).times(price / _unit(task, name))
    return None


def _refuse_under(bound: Bound, given: float, name: str, unit: str) -> None:
    """Refuse a limit on the goal's own figure that is under the least value; raises NoSuchMechanism."""
    if given < bound.value:
        raise NoSuchMechanism(
            f"{given:g} {unit} is too little with the other limits; at least {shown_above(bound.value)} {unit} can be "
            "enough",
            key=f"optimize.limits.{name}",
        )


def start_motion(task: Task, wishes: Wishes, bound: Bound | None = None) -> Motion:
    """Where the search for a law starts: the motion of the certified limit, or of that of acceleration.

    Raises NoSuchMechanism where certainly no law keeps the limits.
    """
    if bound is None or bound.motion is None:
        bound = least_acceleration(task, demands_of(task, wishes), proven=False)
    motion = bound.motion
    if motion is None:
        raise NoSuchMechanism("no motion was found that keeps the limits, nor a proof that none does", key="optimize")
    return motion


NOT_COVERED = {
    "peak_jerk_mm_s3": "jerk",
    "curvature_turns": "least radius or undercut",
}


def not_covered(wishes: Wishes) -> list[str]:
    """The limits, in words, that restrict the law and that the certified limit does not know."""
    found = [said for name, said in NOT_COVERED.items() if getattr(wishes, name) is not None]
    limits = wishes.limits
    loads = {"bearing_force_n": "bearing force", "shaking_force_n": "shaking force", "tooth_force_n": "tooth force"}
    found += [said for name, said in loads.items() if getattr(limits, name) is not None]
    if wishes.two_stages is not None:
        found.append("curves and pressure angles of the two pairs")
    soft = [wish for wish in wishes.motion if not wish.hard]
    return [*found, *(["soft wishes"] if soft else [])]
