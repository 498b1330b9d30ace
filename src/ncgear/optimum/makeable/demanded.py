"""The wishes that the certified limit knows, and the wishes that it does not know."""

from __future__ import annotations

from collections.abc import Callable, Iterator, Mapping, Sequence
from contextlib import suppress
from dataclasses import replace
from heapq import heappop, heappush
from math import atan, cos, inf, log, pi, sin
from typing import Any

from ncgear.errors import NoSuchMechanism, Unanswered
from ncgear.kinematics.crank_stretches import CrankStretch
from ncgear.numerics.bounds import shown_above
from ncgear.numerics.units import RAD_S_PER_RPM
from ncgear.optimum.certified.demands import PEAKS, Demands, WishDemand
from ncgear.optimum.certified.limit import Bound, Motion, least_acceleration, least_of, least_power, problem_of
from ncgear.optimum.certified.motion import ROUNDING
from ncgear.optimum.certified.refusals import LEAST_ROOM, in_demand, refusal, too_little
from ncgear.optimum.certified.sums import PeakWeights, least_weighted_sum, raised
from ncgear.optimum.certified.tree import Budget
from ncgear.optimum.makeable.driving_ranges import Passed, passed_by_all, ranges
from ncgear.optimum.makeable.wishes import Wishes
from ncgear.optimum.task import LOAD_LIMITS, Figures, Task
from ncgear.wishes.requirements import DecelerationWithin, EvenSpeed, Requirement, SpeedWithin, TimeWithin
from ncgear.wishes.wish import DrivingWish, Offer, Wish

Case = Mapping[str, Passed]
"""Laws that begin and end driving ranges at some crank angles, by the keys of the wishes over them."""

NO_CASE: Case = {}

DEMANDS = {figure: name for name, (figure, _) in PEAKS.items()}
"""All figures that the limit knows, and their names among its demands."""

OF_LOADS = {figure: DEMANDS[figure] for figure in LOAD_LIMITS if figure in DEMANDS}
"""The demands on a machine's loads."""


def knows_loads(task: Task, wishes: Wishes) -> bool:
    """Whether the limit covers power and torque: not with a shaft of inertia between two pairs, which moves freely."""
    return wishes.two_stages is None or not any(task.moving.between_inertia_kg_mm2)


def demands_of(task: Task, wishes: Wishes, case: Case = NO_CASE) -> Demands:
    """The demands of hard wishes and limits on the laws of a case that the certified limit covers.

    Raises NoSuchMechanism for a limit of the driven gear's speed that is not over its mean.
    """
    limits = wishes.limits
    _refuse_slow_gear(task, wishes.driven_speed_rad_s)
    every, fastest = _every_law(task, wishes), _least_ratio(task, wishes)
    asked = [
        demand
        for wish in wishes.motion
        if wish.hard
        for requirement in _of_laws(task, wish, every, case)
        for demand in _demands(task, wish, requirement, limits.ratio_max)
    ]
    one_pair, loads_known = wishes.two_stages is None, knows_loads(task, wishes)
    of_loads: dict[str, Any] = {
        name: value * in_demand(task, name)
        for figure, name in OF_LOADS.items()
        if loads_known and (value := getattr(limits, figure)) is not None
    }
    return Demands(
        ratio_min=fastest,
        ratio_max=limits.ratio_max,
        steepness=limits.steepness if one_pair else inf,
        rack_angle_rad=limits.rack_angle_rad,
        convex=wishes.convex and one_pair,
        acceleration_mm_s2=limits.peak_acceleration_mm_s2 or inf,
        speed_mm_s=limits.peak_speed_mm_s or inf,
        power_w=(limits.peak_power_w if loads_known else None) or inf,
        **of_loads,
        wishes=tuple(asked),
    )


def _least_ratio(task: Task, wishes: Wishes) -> float:
    slowest = 0.0 if wishes.driven_speed_rad_s is None else task.speed_rad_s / wishes.driven_speed_rad_s
    return max(wishes.limits.ratio_min, slowest)


def _every_law(task: Task, wishes: Wishes) -> Case:
    """The case of all laws within the ratios, by the keys of hard wishes over driving angles."""
    low, high = _least_ratio(task, wishes), wishes.limits.ratio_max
    return {
        wish.key: passed_by_all(wish.driving, task.cycle_rad, low, high)
        for wish in wishes.motion
        if isinstance(wish, DrivingWish) and wish.driving is not None and wish.hard
    }


def _of_laws(task: Task, wish: Wish, every: Case, case: Case) -> Sequence[Requirement]:
    """Requirements of a wish on the laws of a case; over driving angles, the bound where all are in the range."""
    if not isinstance(wish, DrivingWish) or wish.driving is None:
        return wish.requirements(task.linkage, task.cycle_rad)
    return case[wish.key].requirements(wish) if wish.key in case else every[wish.key].bound(wish)


def _refuse_slow_gear(task: Task, limit_rad_s: float | None) -> None:
    mean = task.speed_rad_s * 2.0 * pi / task.cycle_rad
    if limit_rad_s is not None and limit_rad_s <= mean * (1.0 + LEAST_ROOM):
        raise NoSuchMechanism(
            f"{limit_rad_s / RAD_S_PER_RPM:g} r/min leaves nothing to choose: the mean speed of the driven gear is "
            f"{shown_above(mean * (1.0 + LEAST_ROOM) / RAD_S_PER_RPM)} r/min; over that is right",
            key="optimize.limits.driven_speed_rpm",
        )


def _demands(task: Task, wish: Wish, asked: Requirement, ratio_max: float) -> Iterator[WishDemand]:
    def offer(missed: float) -> Offer:
        return wish.offer(asked, missed, task.cycle_rad)

    def time(stretch: CrankStretch, most_rad: float) -> WishDemand:
        return WishDemand(wish.key, TimeWithin(stretch, most_rad=most_rad), lambda other: offer(other - most_rad))

    match asked:
        case SpeedWithin() | EvenSpeed():
            yield WishDemand(wish.key, asked, lambda factor: offer(log(factor)))
        case DecelerationWithin():
            yield WishDemand(wish.key, asked, lambda factor: offer(factor - 1.0))
        case TimeWithin(stretch, least, most):
            if most < inf:
                yield time(stretch, most)
            if least > 0.0:
                longest = time(stretch.rest, task.cycle_rad - least)
                yield replace(longest, instead=wish.instead(task.linkage, ratio_max))


def certified_limit(task: Task, wishes: Wishes) -> Bound | None:
    """The limit of a goal in its unit, if known; raises NoSuchMechanism where certainly no law remains."""
    return _limit(task, wishes, demands_of(task, wishes))


def _limit(task: Task, wishes: Wishes, asked: Demands) -> Bound | None:
    prices, priced = wishes.prices, _known_prices(task, wishes)
    alone = [
        bound for name, price in vars(prices).items() if price and (bound := bound_of_stroke(name, price, task, asked))
    ]
    if set(priced) == {"peak_acceleration_mm_s2", "peak_power_w"}:
        _refuse_together(task, asked)
        weights = PeakWeights(prices.peak_acceleration_mm_s2, prices.peak_power_w)
        found = [least_weighted_sum(task, asked, weights), *alone]
    else:
        if not priced:
            _refuse_together(task, asked)
        found = [*(_alone(task, asked, name, price) for name, price in priced.items()), *alone]
    if prices.tangent_rad and wishes.two_stages is None:
        found += filter(None, [_least_tangent(task, asked, prices.tangent_rad)])
    if not found:
        return None
    if len(found) == 1:
        return found[0]
    # No law has less of any figure than its own limit, and so none has a lower sum
    return replace(found[0], value=sum(bound.value for bound in found), reach=inf)


def _known_prices(task: Task, wishes: Wishes) -> dict[str, float]:
    known = DEMANDS if knows_loads(task, wishes) else ("peak_acceleration_mm_s2", "peak_speed_mm_s")
    return {name: price for name, price in vars(wishes.prices).items() if price and name in known}


OF_WAY = {"peak_speed_mm_s": (2.0, 1), "peak_acceleration_mm_s2": (16.0, 2), "peak_jerk_mm_s3": (96.0, 3)}
"""Least peaks of any motion to and fro by any mechanism: a number times stroke over a power of the cycle time.

A periodic motion whose n-th derivative is at most m swings by at most 2 K m/w^n with w = 2 pi/T and K = pi/2, pi^2/8
and pi^3/24 (J. Favard, 1937)."""


def least_of_way(figure: str, stroke_mm: float, cycle_s: float) -> float:
    """The least peak of a figure in ``OF_WAY`` over a stroke in mm or rad and back, in mm or rad and s."""
    number, order = OF_WAY[figure]
    return number * stroke_mm / cycle_s**order


OF_STROKE: dict[str, Callable[[Task, Demands], float]] = {
    "peak_jerk_mm_s3": lambda task, asked: least_of_way("peak_jerk_mm_s3", task.linkage.stroke_mm, task.cycle_s),
    "tooth_force_n": lambda task, asked: (
        0.0 if task.gears is None else max(task.work_n_mm, 0.0) / task.gears.rolled_mm(task.lobes)
    ),
    "flank_load_n_mm": lambda task, asked: _least_flank_load_n_mm(task, asked.steepness),
    "center_distance_mm": lambda task, asked: _least_center_distance_mm(task, asked.steepness),
}
"""Least values of figures in closed form, whatever the other limits are.

The force between teeth does the work of the cycle along the way that the teeth go across the line of centres, and
never more than its size times this way."""


def _least_flank_load_n_mm(task: Task, steepness: float) -> float:
    """The least peak of the flank load in N mm under a limit of the pitch curves' tangent t; zero without one.

    The driven torque is the load times (cos alpha +- t sin alpha) i^2/(1 + i)^3, and 16 i^2 is at most (1 + i)^4.  So
    over a turn of the crank, in which i has a known mean, the work is at most the load's peak times a known number.
    """
    if task.gears is None or steepness == inf:
        return 0.0
    angles = task.gears.rack_angle_rad, task.gears.idle_angle_rad or 0.0
    lever = max(cos(angle) + steepness * sin(angle) for angle in angles)
    return 16.0 * max(task.work_n_mm, 0.0) / ((2.0 * pi + task.cycle_rad) * lever)


def _least_center_distance_mm(task: Task, steepness: float) -> float:
    """The least centre distance in mm of gears of a size: curves are longer than the way across by 1/cos(t) at most."""
    size = task.gears
    if size is None or size.teeth is None or size.module_mm is None:
        return 0.0
    apart = replace(size, teeth=None, center_distance_mm=1.0).rolled_mm(task.lobes)
    return size.rolled_mm(task.lobes) * cos(atan(steepness)) / apart


def bound_of_stroke(name: str, price: float, task: Task, asked: Demands) -> Bound | None:
    """The limit in closed form of one figure times its price, without a motion; None where none is known."""
    value = OF_STROKE[name](task, asked) if name in OF_STROKE else 0.0
    return Bound(price * value * (1.0 - ROUNDING), 0, None) if value > 0.0 else None


def _least_tangent(task: Task, asked: Demands, price: float) -> Bound | None:
    """The limit of the pitch curves' angle times its price: the least steepness that keeps all other demands.

    None where the programme excludes no angle: it lacks the upper bounds of times that a time ratio needs.
    """
    _refuse_together(task, asked)
    found = least_of(task, asked, "steepness", guess=1.0)
    return replace(found, value=price * atan(found.value)) if found.value > 0.0 else None


CLOSE = 1.01
"""A law this close to its limit is left there: laws of 180 knots lack up to a hundredth themselves."""

MOST_CASES = 60
"""Most cases of driving ranges: each takes half a second, or two seconds where curves must be convex."""

MOST_PROGRAMMES = 2400
"""Most programmes for raising a limit towards a law: less than a minute on one processor."""


def raised_limit(
    task: Task,
    wishes: Wishes,
    bound: Bound,
    law: Figures,
    motion: Motion,
    tell: Callable[[int, int], None] = lambda used, most: None,
) -> Bound:
    """The limit of a goal, raised towards the figures of a law from the law's motion, where it is not close to them.

    Cases of driving ranges raise it, and ranges of q all around the turn where both curves must be convex or the
    pressure angle is limited. ``tell`` receives the number of solved cases or programmes, and the most that will be
    solved.
    """
    asked = demands_of(task, wishes)
    priced = _known_prices(task, wishes)
    reached = sum(price * getattr(law, name) for name, price in priced.items())
    bound = replace(bound, value=max(bound.value, _by_cases(task, wishes, bound.value, reached, tell)))
    bounded = asked.convex or asked.steepness < inf
    if not bounded or not min(reached, bound.reach) > CLOSE * bound.value:
        return bound
    units = {name: in_demand(task, DEMANDS[name]) for name in priced}
    prices = {DEMANDS[name]: price / units[name] for name, price in priced.items()}
    figures = {DEMANDS[name]: units[name] * getattr(law, name) for name in priced}
    value, effort = raised(task, asked, prices, figures, motion, Budget(MOST_PROGRAMMES, tell))
    return replace(bound, value=max(bound.value, value), effort=effort)


def _by_cases(task: Task, wishes: Wishes, known: float, law: float, tell: Callable[[int, int], None]) -> float:
    """The least limit of all cases of driving ranges, halved where it is least until it is close to a law.

    ``known`` is the limit of all laws. The value never exceeds the law's, since the law is in one of the cases.
    """
    every = _every_law(task, wishes)
    left: list[tuple[float, int, Case]] = [(known, 0, every)] if every else []
    for number in range(1, MOST_CASES, 2):
        if not left or left[0][0] * CLOSE > law:
            break
        value, _, case = heappop(left)
        key = max(case, key=lambda key: case[key].width)
        for place, part in enumerate(case[key].halves()):
            narrower = {**case, key: part}
            heappush(left, (max(value, _limit_in(task, wishes, narrower)), number + place, narrower))
        tell(number + 1, MOST_CASES)
    return min(left[0][0], law) if left else known


def _limit_in(task: Task, wishes: Wishes, case: Case) -> float:
    """The limit of the laws of a case: infinite where it certainly has no law, minus infinity where unknown."""
    try:
        bound = _limit(task, wishes, demands_of(task, wishes, case))
    except Unanswered:
        return -inf
    except NoSuchMechanism:
        return inf
    return -inf if bound is None else bound.value


def _alone(task: Task, asked: Demands, name: str, price: float) -> Bound:
    """The limit of one figure times its price; raises NoSuchMechanism where the figure is limited to less."""
    demand = DEMANDS[name]
    alone = {"acceleration_mm_s2": least_acceleration, "power_w": least_power}.get(demand)
    bound = least_of(task, asked, demand) if alone is None else alone(task, asked)
    given = getattr(asked, demand)
    if given < bound.value:
        raise too_little(task, demand, given, bound.value)
    return bound.times(price / in_demand(task, demand))


def _refuse_together(task: Task, asked: Demands) -> None:
    """Refuse limits that cannot be kept together if no goal's least value shows it; raises NoSuchMechanism."""
    problem = problem_of(task, asked)
    if not problem.is_open:
        raise refusal(problem)


def start_motion(task: Task, wishes: Wishes, bound: Bound | None = None) -> Motion:
    """The start of the search for a law: the motion of the certified limit, or of the limit of acceleration.

    Soft wishes over driving angles count as hard here where some motion may keep them: from the crank angles of the
    best law without these wishes, the search does not find the crank angles of the law that keeps them.  Raises
    NoSuchMechanism where certainly no law keeps the limits.
    """
    soft = [number for number in ranges(wishes) if not wishes.motion[number].hard]
    if soft:
        hard = (replace(wish, weight=None) if number in soft else wish for number, wish in enumerate(wishes.motion))
        with suppress(NoSuchMechanism):
            bound = certified_limit(task, replace(wishes, motion=tuple(hard)))
    if bound is None or bound.motion is None:
        bound = least_acceleration(task, demands_of(task, wishes), proven=False)
    motion = bound.motion
    if motion is None:
        raise NoSuchMechanism("no motion was found that keeps the limits, nor a proof that none does", key="optimize")
    return motion


NOT_COVERED = {
    "peak_jerk_mm_s3": "jerk",
    "curvature_turns": "least radius or undercut",
    "acceleration_harmonics_mm_s2": "harmonics of the acceleration",
    "center_distance_mm": "the distance of the axes",
}


def not_covered(task: Task, wishes: Wishes) -> list[str]:
    """Words for the restrictions of the law that the certified limit does not cover."""
    found = [said for name, said in NOT_COVERED.items() if getattr(wishes, name) is not None]
    limits = wishes.limits
    loads = {"bearing_force_n": "bearing force", "shaking_force_n": "shaking force", "tooth_force_n": "tooth force"}
    loads |= {"flank_load_n_mm": "flank load", "torque_harmonics_n_m": "harmonics of the torque"}
    found += [said for name, said in loads.items() if getattr(limits, name) is not None]
    if wishes.two_stages is not None:
        found.append("curves and pressure angles of the two pairs")
    if not knows_loads(task, wishes):
        found.append("power and torque with the inertia of the shaft between")
    return found
