"""The best law for a design's machine: certified limit, law and figures, each computed when it is first asked for."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import replace
from functools import cached_property, partial
from typing import TYPE_CHECKING, NamedTuple

from ncgear.design.keys.design import Design
from ncgear.errors import DesignError, NoSuchMechanism
from ncgear.extras import installed, require
from ncgear.frozen import dataclass
from ncgear.numerics.arrays import Array
from ncgear.optimum.makeable.wishes import Wishes
from ncgear.optimum.task import Figures, Task, figures
from ncgear.project.law import law_of
from ncgear.project.wishes import task_of, wishes_of
from ncgear.ratio.laws.uniform import uniform_law
from ncgear.ratio.transmission import Train, single
from ncgear.shown import Shown
from ncgear.workers import finished

if TYPE_CHECKING:
    from ncgear.optimum.certified.limit import Bound, Motion
    from ncgear.optimum.makeable.law import MakeableLaw


@dataclass(frozen=True)
class Starts:
    """How many starts the search for a law had, from how many of them it found none, and how far goals are apart.

    ``apart`` is what the best law found has less of the goal than the worst, as a share of the worst's.
    """

    count: int
    without_law: int
    apart: float


class BestLaw(Shown):
    """A design's machine with the best law that its wishes allow.

    Every attribute may raise WrongInput for wishes that contradict each other or the design, and NoSuchMechanism where
    no law keeps the limits.  The law is the best of those found from ``starts`` starts, of which the first is the
    motion of the certified limit; ``scheduler`` and ``processes`` say where the others are computed, as in
    ``ncgear.workers``.  ``on_programme`` is called with the numbers of programmes solved and at most to be solved while
    the limit is raised towards the law.
    """

    def __init__(
        self,
        design: Design,
        starts: int = 1,
        scheduler: str | None = None,
        processes: int | None = None,
        on_programme: Callable[[int, int], None] = lambda solved, most: None,
    ) -> None:
        self.design = design
        self._starts, self._where = starts, (scheduler, processes)
        self._on_programme = on_programme

    @cached_property
    def wishes(self) -> Wishes:
        """Goal and limits."""
        return wishes_of(self.design)

    @cached_property
    def task(self) -> Task:
        """The machine that the law is for."""
        return task_of(self.design)

    @cached_property
    def bound(self) -> Bound | None:
        """A limit that no law can go below, in the unit of the goal; None for a goal that no limit is known of.

        It needs no law; ``limit`` is higher for some goals.
        """
        from ncgear.optimum.certified.refusals import TooTight
        from ncgear.optimum.makeable.demanded import certified_limit

        try:
            return certified_limit(self.task, self.wishes)
        except TooTight as refused:
            raise self._with_what_was_found(refused) from refused

    @cached_property
    def limit(self) -> Bound | None:
        """The highest limit that is known beside the best law, in the unit of the goal; None where there is none."""
        from ncgear.optimum.makeable.demanded import raised_limit

        if self.bound is None:
            return None
        return raised_limit(self.task, self.wishes, self.bound, self.figures, self.law.motion, self._on_programme)

    def _with_what_was_found(self, refused: NoSuchMechanism) -> NoSuchMechanism:
        """The refusal, and values of limits with which laws were found; as it was where the optimiser is missing."""
        if not installed("casadi"):
            return refused
        from ncgear.optimum.makeable.law import found_instead

        found = found_instead(self.task, self.wishes)
        if not found:
            return refused
        said = "a law was found with" if len(found) == 1 else "laws were found with each of these:"
        return NoSuchMechanism(f"{refused.problem}; {said} {', '.join(map(str, found))}", key=refused.key)

    @property
    def not_covered(self) -> list[str]:
        """The limits, in words, that restrict the law and that the bound does not know."""
        from ncgear.optimum.makeable.demanded import not_covered

        return not_covered(self.wishes)

    @cached_property
    def law(self) -> MakeableLaw:
        """The best makeable law; raises WrongInput where the optimiser is not installed."""
        return min(self._laws, key=lambda law: law.goal)

    @cached_property
    def _laws(self) -> list[MakeableLaw]:
        """The laws found from all starts, that of the usual one first."""
        require("casadi", "optimize", "ncgear optimize")
        from ncgear.optimum.makeable.demanded import start_motion
        from ncgear.optimum.makeable.law import makeable_law

        start = start_motion(self.task, self.wishes, self.bound)
        usual = makeable_law(self.task, self.wishes, start)
        if self._starts == 1:
            return [usual]
        others = dict(finished(partial(_found_from, self.design, start), range(1, self._starts), *self._where))
        found = [others[number] for number in sorted(others)]
        return [usual, *(replace(usual, **one._asdict()) for one in found if one is not None)]

    @property
    def starts(self) -> Starts:
        """What the search found from all its starts."""
        goals = [law.goal for law in self._laws]
        apart = max(goals) - min(goals)
        return Starts(self._starts, self._starts - len(goals), apart / abs(max(goals)) if apart else 0.0)

    @cached_property
    def train(self) -> Train:
        """The law shared among the pairs of gears."""
        return self.law.train(self.task.lobes)

    @cached_property
    def figures(self) -> Figures:
        """Exact figures of the law."""
        return figures(self.task, self.train)

    @cached_property
    def uniform_figures(self) -> Figures:
        """Exact figures of a uniform crank on the same machine."""
        return figures(self.task, single(uniform_law(self.task.lobes)))

    @cached_property
    def given_figures(self) -> Figures | None:
        """Exact figures of the design's own law at the same speed; None where that law cannot be made."""
        try:
            return figures(self.task, law_of(self.design).train)
        except DesignError:
            return None

    @cached_property
    def limit_points(self) -> list[tuple[float, float]]:
        """Points of the certified limit, each a cap on the power in W and an acceleration in mm/s2.

        Empty where nothing resists the slider.
        """
        from ncgear.optimum.frontier import limit_points

        most = 1.2 * max(self.figures.peak_power_w, self.uniform_figures.peak_power_w)
        return limit_points(self.task, self.wishes, most)

    @property
    def goal(self) -> float:
        """The quantity that the design asks to be least, as the best law has it, in the unit of the bound."""
        return self.wishes.prices.of(self.figures)


class _Found(NamedTuple):
    """What differs between laws from several starts, and can be sent from process to process."""

    ratio: Array
    second: Array | None
    reached: Array


def _found_from(design: Design, start: Motion, number: int) -> _Found | None:
    """The law from another start, computed in a process of its own; None where none is found."""
    from ncgear.optimum.makeable.law import law_from

    law = law_from(task_of(design), wishes_of(design), start, number)
    return None if law is None else _Found(law.ratio, law.second, law.reached)
