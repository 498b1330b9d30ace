"""A flywheel on the driven shaft as an unknown: the best law with each size of it, and the best size.

The flywheel's moment of inertia adds to the crank's, so the search for a law with each size is the usual search.  Two
optima can lie side by side, one for small flywheels and one for large flywheels.  Laws are therefore followed from the
least flywheel up and from the greatest down, each from its neighbour's law and from the law at the first size, and the
best law of each size counts.
"""

from __future__ import annotations

from bisect import bisect_left
from collections.abc import Callable
from dataclasses import replace
from math import inf
from typing import TYPE_CHECKING

import numpy as np

from ncgear.dynamics.crank_load import reduced_inertia
from ncgear.errors import NoSuchMechanism
from ncgear.frozen import dataclass
from ncgear.numerics.jet import Jet
from ncgear.optimum.certified.limit import Motion, least_acceleration, least_mean_power_w, least_of, least_power
from ncgear.optimum.makeable.demanded import bound_of_stroke, demands_of, start_motion
from ncgear.optimum.makeable.wishes import Goal, Wishes
from ncgear.optimum.task import Figures, Task, figures

if TYPE_CHECKING:
    from ncgear.optimum.makeable.law import MakeableLaw

SIZES = 11
"""Sizes that are tried first, from the least flywheel to the greatest."""

FOLLOWED = 4
"""Laws of each size, about: up and down, each from two starts."""

KNOTS = 60
"""Knots of the laws of the search, a third of a second each: 180 knots gain about as much with every flywheel."""

CLOSER = 6
"""Sizes that are tried beside the best size, and again towards the smallest size with about the same goal."""

DIGITS = 4
"""Digits of a size between others, which a workshop can read."""

AS_GOOD = 2e-4
"""Largest distance from the best goal, over the greatest goal of all sizes: the smallest such flywheel is taken."""

TURN_PLACES = 360
"""Places of the crank for the mean inertia, which only sets a scale."""

LEAST_SHARE = 1e-3
"""Least inertia of the crank, as a share of the greatest flywheel, that counts in the choice of sizes."""


@dataclass(frozen=True, eq=False)
class FlywheelLaw:
    """The best law of few knots that was found with a flywheel on the driven shaft."""

    flywheel_kg_mm2: float
    law: MakeableLaw

    @property
    def goal(self) -> float:
        """The goal in the law's units; it grows with the goal of the file."""
        return self.law.goal


def mean_inertia_kg_mm2(task: Task) -> float:
    """The mean over the crank's angle of the inertia of all that moves with the crank, about its axis."""
    angle = Jet.variable(np.linspace(0.0, 2.0 * np.pi, TURN_PLACES, endpoint=False), 2)
    whole, _ = reduced_inertia(task.linkage.moving_masses(angle, task.moving), task.moving)
    return float(np.mean(whole))


def with_flywheel(task: Task, flywheel_kg_mm2: float) -> Task:
    """The machine with an additional flywheel on its driven shaft."""
    moving = task.moving
    return replace(task, masses=replace(moving, crank_inertia_kg_mm2=moving.crank_inertia_kg_mm2 + flywheel_kg_mm2))


class FlywheelSearch:
    """The laws found so far, by the flywheel; ``task`` is the machine without it, with the ``wishes`` for its laws.

    ``tell`` is called with the number of laws searched for so far.
    """

    def __init__(self, task: Task, wishes: Wishes, tell: Callable[[int], None] = lambda laws: None) -> None:
        self.task, self.wishes = task, replace(wishes, knots=min(wishes.knots, KNOTS))
        self.found: dict[float, FlywheelLaw] = {}
        self._tell, self._searched = tell, 0

    def of_sizes(self, least_kg_mm2: float, most_kg_mm2: float, count: int = SIZES) -> list[FlywheelLaw]:
        """The best laws by size, in even ratios of the whole inertia; raises NoSuchMechanism without any law."""
        own = max(mean_inertia_kg_mm2(self.task), LEAST_SHARE * most_kg_mm2)
        sizes = (np.geomspace(own + least_kg_mm2, own + most_kg_mm2, count) - own).tolist()
        sizes[0], sizes[-1] = least_kg_mm2, most_kg_mm2
        for order in (sizes, sizes[::-1]):
            first: Motion | None = None
            last: Motion | None = None
            for size in order:
                if last is not first:
                    self._tried(size, first)
                last = self._tried(size, last or self._begun(size)) or last
                first = first or last
        if not self.found:
            raise NoSuchMechanism("no law was found with any flywheel of the range", key="optimize.limits")
        return [self.found[size] for size in sorted(self.found)]

    def best(self, least_kg_mm2: float, most_kg_mm2: float) -> FlywheelLaw:
        """The smallest flywheel whose law is as good as the best; raises NoSuchMechanism where no law is found."""
        # Loads slowly
        from scipy.optimize import minimize_scalar

        known = self.of_sizes(least_kg_mm2, most_kg_mm2)
        if len(known) > 1:
            at = min(range(len(known)), key=lambda number: known[number].goal)
            low, high = known[max(at - 1, 0)], known[min(at + 1, len(known) - 1)]
            unit = max(high.flywheel_kg_mm2, 1.0)
            minimize_scalar(
                lambda share: self._between(share * unit),
                bounds=(low.flywheel_kg_mm2 / unit, high.flywheel_kg_mm2 / unit),
                method="bounded",
                options={"maxiter": CLOSER},
            )
        return self._smallest()

    def _smallest(self) -> FlywheelLaw:
        goals = [result.goal for result in self.found.values()]
        enough = min(goals) + AS_GOOD * max(goals)
        for _ in range(CLOSER):
            sizes = sorted(self.found)
            first = next(number for number, size in enumerate(sizes) if self.found[size].goal <= enough)
            if first == 0:
                break
            self._between((sizes[first - 1] + sizes[first]) / 2.0)
        return next(self.found[size] for size in sorted(self.found) if self.found[size].goal <= enough)

    def _between(self, size_kg_mm2: float) -> float:
        """The goal with another size, from the laws of the sizes on both sides; infinite where no law is found."""
        sizes = sorted(self.found)
        size_kg_mm2 = float(f"{size_kg_mm2:.{DIGITS}g}")
        place = bisect_left(sizes, size_kg_mm2)
        for neighbour in sizes[max(place - 1, 0) : place + 1]:
            self._tried(size_kg_mm2, self.found[neighbour].law.motion)
        return self.found[size_kg_mm2].goal if size_kg_mm2 in self.found else inf

    def _tried(self, size_kg_mm2: float, start: Motion | None) -> Motion | None:
        """The motion of the law found from a start, or None; the law is kept if it is the best of its size."""
        from ncgear.optimum.makeable.law import kept_law

        if start is None:
            return None
        self._searched += 1
        self._tell(self._searched)
        law = kept_law(with_flywheel(self.task, size_kg_mm2), self.wishes, start)
        if law is None:
            return None
        known = self.found.get(size_kg_mm2)
        if known is None or law.goal < known.goal:
            self.found[size_kg_mm2] = FlywheelLaw(size_kg_mm2, law)
        return law.motion

    def _begun(self, size_kg_mm2: float) -> Motion | None:
        """The start of the first search; None where certainly no law keeps the limits with this flywheel."""
        try:
            return start_motion(with_flywheel(self.task, size_kg_mm2), self.wishes)
        except NoSuchMechanism:
            return None


def least_with_any(task: Task, wishes: Wishes) -> float:
    """A lower bound of the goal for all laws with any flywheel on the driven shaft, in the goal's unit.

    The work of a cycle does not depend on the flywheel, so no peak power is under the mean power, no r.m.s. torque
    under the mean torque, and limits in closed form hold for all.  Where no load is limited, the motion does not depend
    on the flywheel, so limits of acceleration and speed hold for all, too.  The bound of all other figures is zero.
    """
    prices = wishes.prices
    free = replace(demands_of(task, wishes), power_w=inf, braking_w=inf, fluctuation_n_mm=inf, torque_n_mm=inf)
    least = least_by_work(task, wishes)
    if jerk := bound_of_stroke("peak_jerk_mm_s3", prices.peak_jerk_mm_s3, task, free):
        least += jerk.value
    if prices.peak_acceleration_mm_s2:
        least += prices.peak_acceleration_mm_s2 * least_acceleration(task, free).value
    if prices.peak_speed_mm_s:
        least += prices.peak_speed_mm_s * least_of(task, free, "speed_mm_s").value
    return least


OF_TEETH = ("tooth_force_n", "flank_load_n_mm", "center_distance_mm")
"""Figures of the gears whose limits depend on the motion only by the work of a cycle."""


def least_by_work(task: Task, wishes: Wishes) -> float:
    """The part of the goal that the work of a cycle alone asks for: mean power, mean torque, forces of teeth."""
    prices, power_w = wishes.prices, least_mean_power_w(task)
    least = prices.peak_power_w * power_w + prices.rms_torque_n_m * abs(power_w) / task.speed_rad_s
    asked = demands_of(task, wishes)
    of_teeth = (bound_of_stroke(name, getattr(prices, name), task, asked) for name in OF_TEETH)
    return least + sum(bound.value for bound in of_teeth if bound is not None)


@dataclass(frozen=True)
class FlywheelPoint:
    """A flywheel on the driven shaft, the certified least power with it, and the law of least power that was found."""

    flywheel_kg_mm2: float
    limit_w: float
    law: Figures


def flywheel_points(
    task: Task, wishes: Wishes, least_kg_mm2: float, most_kg_mm2: float, count: int, tell: Callable[[int], None]
) -> list[FlywheelPoint]:
    """Least power by flywheel with laws of few knots, power unlimited; raises NoSuchMechanism without a law."""
    limits = replace(wishes.limits, peak_power_w=None)
    search = FlywheelSearch(task, replace(wishes, goal=Goal.POWER, weights=None, limits=limits), tell)
    points = []
    for point in search.of_sizes(least_kg_mm2, most_kg_mm2, count):
        wheeled = with_flywheel(task, point.flywheel_kg_mm2)
        limit = least_power(wheeled, demands_of(wheeled, search.wishes))
        points.append(FlywheelPoint(point.flywheel_kg_mm2, limit.value, figures(wheeled, point.law.train(task.lobes))))
    return points
