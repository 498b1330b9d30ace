"""The best law for a design's machine: certified limit, law and figures, each computed when it is first asked for."""

from __future__ import annotations

from functools import cached_property
from typing import TYPE_CHECKING

from ncgear.design.keys.design import Design
from ncgear.design.keys.optimize import Optimize
from ncgear.errors import DesignError
from ncgear.extras import require
from ncgear.optimum.makeable.wishes import Goal, Wishes
from ncgear.optimum.task import Figures, Task, figures
from ncgear.project.law import law_of
from ncgear.project.wishes import task_of, wishes_of
from ncgear.ratio.laws.uniform import uniform_law
from ncgear.ratio.transmission import Train, single

if TYPE_CHECKING:
    from ncgear.optimum.certified.limit import Bound
    from ncgear.optimum.makeable.law import MakeableLaw


class BestLaw:
    """A design's machine with the best law that its wishes allow.

    Every attribute may raise WrongInput for wishes that contradict each other or the design, and NoSuchMechanism where
    no law keeps the limits.
    """

    def __init__(self, design: Design) -> None:
        self.design = design

    @cached_property
    def wishes(self) -> Wishes:
        """Goal and limits."""
        return wishes_of(self.design)

    @cached_property
    def task(self) -> Task:
        """The machine that the law is for."""
        return task_of(self.design)

    @cached_property
    def bound(self) -> Bound:
        """The limit that no law can go below: an acceleration in mm/s2, a power in W, or the weighted sum of both."""
        from ncgear.optimum.certified import limit

        task, wishes = self.task, self.wishes
        match wishes.goal:
            case Goal.ACCELERATION:
                return limit.least_acceleration(task, wishes.limits)
            case Goal.POWER:
                return limit.least_power(task, wishes.limits)
        assert wishes.weights is not None
        return limit.least_weighted_sum(task, wishes.limits, wishes.weights)

    @cached_property
    def law(self) -> MakeableLaw:
        """The best makeable law; raises WrongInput where the optimiser is not installed."""
        require("casadi", "optimize", "ncgear optimize")
        from ncgear.optimum.makeable.law import makeable_law
        from ncgear.optimum.makeable.search import random_starts, rough_start

        asked, wishes = self.design.optimize or Optimize(), self.wishes
        random = random_starts(wishes.harmonics, asked.starts - 1, asked.seed)
        return makeable_law(self.task, wishes, [rough_start(self.task, wishes, self._roughly), *random])

    @cached_property
    def _roughly(self) -> float:
        """The peak of acceleration in mm/s2 to start from: the one that is allowed, or else what a rough motion has."""
        from ncgear.optimum.certified import limit

        allowed = self.wishes.limits.peak_acceleration_mm_s2
        return allowed if allowed is not None else limit.rough_acceleration(self.task, self.wishes.limits)

    @cached_property
    def train(self) -> Train:
        """The law shared among the pairs of gears."""
        return self.law.train(self.task.lobes)

    @cached_property
    def figures(self) -> Figures:
        """Exact figures of the law."""
        return figures(self.task, self.train, self._mass_kg)

    @cached_property
    def uniform_figures(self) -> Figures:
        """Exact figures of a uniform crank on the same machine."""
        return figures(self.task, single(uniform_law(self.task.lobes)), self._mass_kg)

    @cached_property
    def given_figures(self) -> Figures | None:
        """Exact figures of the design's own law at the same speed; None where that law cannot be made."""
        try:
            return figures(self.task, law_of(self.design).train, self._mass_kg)
        except DesignError:
            return None

    @cached_property
    def limit_points(self) -> list[tuple[float, float]]:
        """Points of the certified limit, each a cap on the power in W and an acceleration in mm/s2.

        Empty where nothing resists the slider.
        """
        from ncgear.optimum.frontier import limit_points

        most = 1.2 * max(self.figures.peak_power_w, self.uniform_figures.peak_power_w)
        return limit_points(self.task, self.wishes.limits, most)

    @property
    def _mass_kg(self) -> float:
        """Mass of the slider, which takes part in every power."""
        return self.wishes.limits.mass_kg

    @property
    def goal(self) -> float:
        """The quantity that the design asks to be least, as the best law has it, in the unit of the bound."""
        found, wishes = self.figures, self.wishes
        match wishes.goal:
            case Goal.ACCELERATION:
                return found.peak_acceleration_mm_s2
            case Goal.POWER:
                return found.peak_power_w
        assert wishes.weights is not None
        return wishes.weights.of(found.peak_acceleration_mm_s2, found.peak_power_w)
