"""Power against acceleration: the limit at each cap on the power, and the laws that can be made."""

from __future__ import annotations

from dataclasses import replace
from math import inf
from typing import TYPE_CHECKING, Any

import numpy as np

from ncgear.errors import NoSuchMechanism
from ncgear.frozen import dataclass
from ncgear.numerics.units import RAD_S_PER_RPM
from ncgear.optimum.certified import limit
from ncgear.optimum.makeable.demanded import demands_of, knows_loads, start_motion
from ncgear.optimum.makeable.wishes import Goal, Wishes
from ncgear.optimum.task import Figures, Task, figures

if TYPE_CHECKING:
    from ncgear.optimum.family import FamilyOptimum

BEYOND = 1.02
"""Factor of the frontier's ends over the least power, and over the power from which acceleration gains nothing."""

WITHIN_REACH = 1.1
"""The first cap of the limit's curve, over the least power: towards that power, accelerations grow without bound."""

LIMIT_POINTS = 16
"""Points of the limit's curve: enough for a smooth curve, and computed in a second or two."""

FAMILY_STARTS = 8
"""Starts of the family's search at each cap: few are enough, because a law found at a cap counts at all higher caps."""


FAMILY_SEED = 0
"""Seed of these starts, which are at random."""


@dataclass(frozen=True)
class LawPoint:
    """The certified limit under a cap on the power, and the best makeable law with its exact figures."""

    cap_w: float
    limit_mm_s2: float
    law: Figures


@dataclass(frozen=True)
class FamilyPoint:
    """The family's best law under a cap on the power, if any; ``motion`` is the design file's block that makes it."""

    cap_w: float
    peak_power_w: float | None
    peak_acceleration_mm_s2: float | None
    motion: dict[str, Any] | None = None


def caps_w(task: Task, wishes: Wishes, count: int) -> list[float]:
    """Caps on the power over the frontier, in even ratios; raises NoSuchMechanism where no law keeps the limits."""
    least = _best_figures(task, _free(wishes, Goal.POWER)).peak_power_w
    most = _best_figures(task, _free(wishes, Goal.ACCELERATION)).peak_power_w
    return [float(cap) for cap in np.geomspace(BEYOND * least, BEYOND * max(most, least), count)]


def limit_points(task: Task, wishes: Wishes, most_w: float) -> list[tuple[float, float]]:
    """The certified limit alone: caps on the power in W up to ``most_w``, and least accelerations in mm/s2.

    Empty without resistance, and where the limit does not include the power.  The driving curve is left free, so these
    limits are a little lower than the limit at a law's own power.
    """
    if not knows_loads(task, wishes):
        return []
    free = replace(demands_of(task, _free(wishes, Goal.ACCELERATION)), power_w=inf, acceleration_mm_s2=inf)
    least_w = WITHIN_REACH * limit.least_power(task, free, proven=False).value
    if not 0.0 < least_w < most_w:
        return []
    caps, problem = np.geomspace(least_w, most_w, LIMIT_POINTS).tolist(), limit.problem_of(task, free)
    return [(cap, limit.least_acceleration_roughly(problem.under(power_w=cap))) for cap in caps]


def law_point(task: Task, wishes: Wishes, cap_w: float) -> LawPoint:
    """One point of the limit and of the makeable laws; raises NoSuchMechanism where no law is found."""
    free = _free(wishes, Goal.ACCELERATION)
    capped = replace(free, limits=replace(free.limits, peak_power_w=cap_w))
    bound = limit.least_acceleration(task, demands_of(task, capped))
    return LawPoint(cap_w, bound.value, _best_figures(task, capped, bound))


def family_point(task: Task, cap_w: float) -> FamilyPoint:
    """One point of the published family, with the better of both bases of its return."""
    # Its search comes from scipy.optimize, which loads slowly
    from ncgear.optimum.family import LawFamily, PeakGoal, best_of_family

    found = []
    for inverse in (False, True):
        family = LawFamily(task, inverse)
        try:
            found.append(best_of_family(family, PeakGoal.ACCELERATION, cap_w, seed=FAMILY_SEED, starts=FAMILY_STARTS))
        except NoSuchMechanism:
            continue
    if not found:
        return FamilyPoint(cap_w, None, None)
    best = min(found, key=lambda optimum: optimum.peak(PeakGoal.ACCELERATION))
    return FamilyPoint(cap_w, best.peak(PeakGoal.POWER), best.peak(PeakGoal.ACCELERATION), motion_of(best))


def motion_of(best: FamilyOptimum) -> dict[str, Any]:
    """A law of the family as the motion of a design file; v2 closes the stroke."""
    asked = best.request
    assert asked.law_speed_rad_s is not None
    return {
        "law": "three_segment_stroke",
        "solve_for": "v2",
        "law_speed_rpm": asked.law_speed_rad_s / RAD_S_PER_RPM,
        **{f"theta{number}_rad": getattr(asked, f"theta{number}_rad") for number in (1, 2, 3, 4)},
        "v1_mm_s": asked.v1,
        "a1_mm_s2": asked.a1,
        "return": {
            "basis": "inverse_ratio" if best.inverse else "ratio",
            "e": "least_acceleration" if best.constant is None else best.constant,
        },
    }


def _best_figures(task: Task, wishes: Wishes, bound: limit.Bound | None = None) -> Figures:
    from ncgear.optimum.makeable.law import makeable_law

    law = makeable_law(task, wishes, start_motion(task, wishes, bound))
    return figures(task, law.train(task.lobes))


def _free(wishes: Wishes, goal: Goal) -> Wishes:
    """The wishes without limits on the two peaks themselves."""
    limits = replace(wishes.limits, peak_power_w=None, peak_acceleration_mm_s2=None)
    return replace(wishes, goal=goal, weights=None, limits=limits)
