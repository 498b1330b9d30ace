"""Power against acceleration: what is possible at each cap on the power, and what makeable laws reach."""

from __future__ import annotations

from dataclasses import dataclass, replace
from functools import partial
from typing import Any

import numpy as np

from ncgear.errors import NoSuchMechanism
from ncgear.numerics.units import RAD_S_PER_RPM
from ncgear.optimum.certified.limit import (
    CELLS,
    Bound,
    certified,
    least_acceleration,
    least_power,
    prepared,
    resting_acceleration,
    rough_acceleration,
)
from ncgear.optimum.certified.road import Peaks
from ncgear.optimum.family import Family, FamilyOptimum, Peak, best_of_family
from ncgear.optimum.makeable.wishes import Goal, Wishes
from ncgear.optimum.task import Figures, Limits, Task, figures

BEYOND = 1.02
"""The frontier runs from just over the least power to just over the power at which acceleration gains nothing more."""

WITHIN_REACH = 1.1
"""The first cap of the limit's curve, over the least power: towards that power, accelerations grow without bound."""

LIMIT_POINTS = 30
"""Points of the limit's curve: enough for a smooth curve, and computed in half a second."""

FAMILY_STARTS = 8
"""Starts of the family's search at each cap: few are enough, because a law found at one cap counts at higher ones."""


@dataclass(frozen=True)
class LawPoint:
    """The certified limit under a cap on the power, and the best makeable law with its exact figures."""

    cap_w: float
    bound: Bound
    law: Figures


@dataclass(frozen=True)
class FamilyPoint:
    """The best law found of the three-segment family under a cap on the power; None where none was found.

    ``motion`` is the block of a design file that makes it.
    """

    cap_w: float
    peak_power_w: float | None
    peak_acceleration_mm_s2: float | None
    motion: dict[str, Any] | None = None


def caps_w(task: Task, wishes: Wishes, count: int) -> list[float]:
    """``count`` caps on the power from one end of the frontier to the other, in even ratios.

    Raises NoSuchMechanism where no law keeps the wishes' other limits.
    """
    least = _best_figures(task, _free(wishes, Goal.POWER)).peak_power_w
    most = _best_figures(task, _free(wishes, Goal.ACCELERATION)).peak_power_w
    return [float(cap) for cap in np.geomspace(BEYOND * least, BEYOND * max(most, least), count)]


def limit_points(task: Task, limits: Limits, most_w: float) -> list[tuple[float, float]]:
    """The certified limit alone: caps on the power in W and least accelerations in mm/s2, up to ``most_w``.

    The caps begin a tenth over the least power at any acceleration; there are none where nothing resists.  The grid has
    1600 cells whatever the limits are: a coarser grid also gives a limit, only a lower one.
    """
    free = replace(limits, peak_power_w=None, peak_acceleration_mm_s2=None)
    least = WITHIN_REACH * least_power(task, free).value
    if not 0.0 < least < most_w:
        return []
    problem = prepared(task, free, CELLS)
    points: list[tuple[float, float]] = []
    guess = resting_acceleration(task)
    for cap in np.geomspace(most_w, least, LIMIT_POINTS).tolist():
        guess, _ = certified(problem, partial(Peaks, power_w=cap), guess)
        points.append((cap, guess))
    return points[::-1]


def law_point(task: Task, wishes: Wishes, cap_w: float) -> LawPoint:
    """One point of the limit and of the makeable laws; raises NoSuchMechanism where no law is found."""
    free = _free(wishes, Goal.ACCELERATION)
    capped = replace(free, limits=replace(free.limits, peak_power_w=cap_w))
    return LawPoint(cap_w, least_acceleration(task, capped.limits), _best_figures(task, capped))


def family_point(task: Task, cap_w: float, seed: int) -> FamilyPoint:
    """One point of the published family, with the better of both bases of its return."""
    found = []
    for inverse in (False, True):
        family = Family(task.linkage, task.resistance, task.speed_rad_s, inverse, task.lobes)
        try:
            found.append(best_of_family(family, Peak.ACCELERATION, cap_w, seed=seed, starts=FAMILY_STARTS))
        except NoSuchMechanism:
            continue
    if not found:
        return FamilyPoint(cap_w, None, None)
    best = min(found, key=lambda optimum: optimum.peak(Peak.ACCELERATION))
    return FamilyPoint(cap_w, best.peak(Peak.POWER), best.peak(Peak.ACCELERATION), motion_of(best))


def motion_of(best: FamilyOptimum) -> dict[str, Any]:
    """A law of the family as the motion of a design file; v2 is what closes the stroke."""
    asked = best.request
    assert asked.law_speed_rad_s is not None
    return {
        "law": "three_segment_stroke",
        "solve_for": "v2",
        "law_speed_rpm": asked.law_speed_rad_s / RAD_S_PER_RPM,
        **{f"theta{number}_rad": getattr(asked, f"theta{number}_rad") for number in (1, 2, 3, 4)},
        "v1_mm_s": asked.v1_mm_s,
        "a1_mm_s2": asked.a1_mm_s2,
        "return": {"basis": "inverse_ratio" if best.inverse else "ratio", "e": "least_acceleration"},
    }


def _best_figures(task: Task, wishes: Wishes) -> Figures:
    """Exact figures of the best makeable law from the fastest rough motion."""
    from ncgear.optimum.makeable.law import makeable_law
    from ncgear.optimum.makeable.search import rough_start

    law = makeable_law(task, wishes, [rough_start(task, wishes, rough_acceleration(task, wishes.limits))])
    return figures(task, law.train(task.lobes), wishes.limits.mass_kg)


def _free(wishes: Wishes, goal: Goal) -> Wishes:
    """The wishes without limits on the two peaks themselves."""
    limits = replace(wishes.limits, peak_power_w=None, peak_acceleration_mm_s2=None)
    return replace(wishes, goal=goal, weights=None, limits=limits)
