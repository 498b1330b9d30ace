"""The best law for a design's machine: certified limit, law and figures, each computed when first asked for."""

from __future__ import annotations

from collections.abc import Callable, Iterator
from contextlib import contextmanager
from dataclasses import replace
from functools import cached_property, partial
from typing import TYPE_CHECKING, NamedTuple

from ncgear.design.keys.design import Design
from ncgear.design.keys.optimize import Optimize
from ncgear.design.laws.base import LawKeys
from ncgear.design.laws.registry import found_motion
from ncgear.errors import DesignError, NoSuchMechanism
from ncgear.extras import installed, require
from ncgear.frozen import dataclass
from ncgear.numerics.arrays import Array
from ncgear.optimum.flywheels import FlywheelSearch, least_with_any, mean_inertia_kg_mm2
from ncgear.optimum.makeable.wishes import Wishes
from ncgear.optimum.offers import Refused
from ncgear.optimum.task import Figures, Task, figures
from ncgear.project import law_task
from ncgear.project.free_lengths import BestLengths, best_lengths
from ncgear.project.moving import TrainInertia
from ncgear.ratio.transmission import PairsInSeries
from ncgear.shown import Shown
from ncgear.workers import finished

if TYPE_CHECKING:
    from ncgear.optimum.certified.limit import Bound, Motion
    from ncgear.optimum.makeable.law import MakeableLaw


@dataclass(frozen=True)
class Starts:
    """Number of starts of the search for a law, number of starts without a law, and the spread of the goals.

    ``apart`` is the difference of the goal between the worst and the best law found, as a share of the worst law's
    goal.
    """

    count: int
    without_law: int
    apart: float


@dataclass(frozen=True, eq=False)
class BestFlywheel:
    """A flywheel on the driven shaft, the motion of the law found with it, and the limit of the goal with any flywheel.

    Both are None where no law was found with any flywheel of the range.
    """

    inertia_kg_mm2: float
    motion: Motion | None = None
    least_with_any: float | None = None


class BestLaw(law_task.SoughtMachine, Shown):
    """A design's machine with the best law that its wishes allow.

    Every attribute may raise WrongInput for wishes that contradict each other or the design, and NoSuchMechanism where
    no law keeps the limits.  The law is the best of all laws found from ``starts`` starts; the first start is the
    motion of the certified limit.  ``scheduler`` and ``processes`` say where the laws of other starts are computed, as
    in ``ncgear.workers``.  ``on_programme`` is called with the numbers of programmes solved and at most to be solved
    while the limit is raised towards the law, and ``on_flywheel_law`` and ``on_length_law`` with the number of laws
    searched for while the flywheel or lengths of the mechanism are free.
    """

    def __init__(
        self,
        design: Design,
        starts: int = 1,
        scheduler: str | None = None,
        processes: int | None = None,
        on_programme: Callable[[int, int], None] = lambda solved, most: None,
        on_flywheel_law: Callable[[int], None] = lambda laws: None,
        on_length_law: Callable[[int], None] = lambda laws: None,
    ) -> None:
        super().__init__(design)
        self.settings = starts, scheduler, processes, on_programme, on_flywheel_law, on_length_law
        self._starts, self._where = starts, (scheduler, processes)
        self._on_programme, self._on_flywheel_law = on_programme, on_flywheel_law
        self._on_length_law = on_length_law

    @cached_property
    def flywheel(self) -> BestFlywheel | None:
        """The best flywheel on the driven shaft, with the gears as given; None where the design asks for none.

        If no flywheel has a law, it is the greatest flywheel, with which the limits are refused.
        """
        return self._flywheel_of(self._linked)

    def _flywheel_of(self, design: Design) -> BestFlywheel | None:
        """The best flywheel of a design with its given lengths."""
        asked = design.free_flywheel
        if asked is None:
            return None
        require("casadi", "optimize", "ncgear optimize")
        bare = law_task.with_driven_flywheel(design, 0.0)
        task, wishes = law_task.task_of(bare, law_task.inertia_as_given(bare)), law_task.wishes_of(bare)
        search = FlywheelSearch(task, wishes, self._on_flywheel_law)
        try:
            best = search.best(asked.least, asked.most)
        except NoSuchMechanism:
            return BestFlywheel(asked.most)
        return BestFlywheel(best.flywheel_kg_mm2, best.law.motion, least_with_any(task, wishes))

    @cached_property
    def lengths(self) -> BestLengths | None:
        """The best lengths of the mechanism, with the gears as given; None where the design asks for none.

        Where the flywheel is free too, both are searched together, starting from the best flywheel with the given
        lengths.
        """
        if not self.given.free_lengths:
            return None
        begun = self._flywheel_of(self.given)
        if begun is None:
            return best_lengths(self.given, None, self._on_length_law)
        given = law_task.with_driven_flywheel(self.given, begun.inertia_kg_mm2)
        return best_lengths(given, begun.motion, self._on_length_law)

    @property
    def _linked(self) -> Design:
        """The design with the best lengths, if it asks for them."""
        return self.given if self.lengths is None else self.lengths.design

    @cached_property
    def design(self) -> Design:
        """The design with the best lengths and the best flywheel, if it asks for them."""
        chosen = self.flywheel
        return self._linked if chosen is None else law_task.with_driven_flywheel(self._linked, chosen.inertia_kg_mm2)

    @cached_property
    def wishes(self) -> Wishes:
        """Goal and limits with the chosen mechanism."""
        return law_task.wishes_of(self._linked)

    @cached_property
    def begun(self) -> Begun:
        """The machine with its gears as given, its certified limit, and the start of the search for a law.

        If no law keeps the limits with these gears, other laws have other gears.  The gears of the law that comes
        nearest are tried until they settle, and only then the limits are refused.
        """
        inertia = law_task.inertia_as_given(self.design)
        for _ in range(MOST_ROUNDS):
            try:
                return self._begun_with(inertia)
            except NoSuchMechanism as refused:
                last, made = refused, self._inertia_of_nearest(inertia)
            if made is None:
                break
            inertia = made
        raise last

    def _begun_with(self, inertia: TrainInertia) -> Begun:
        from ncgear.optimum.makeable.demanded import start_motion

        task = law_task.task_of(self.design, inertia)
        bound = self._bound_of(task)
        with self._offering(task):
            return Begun(inertia, task, bound, self.known_motion or start_motion(task, self.wishes, bound))

    @property
    def known_motion(self) -> Motion | None:
        """A motion with which the search for a law begins; None where it begins with that of the limit."""
        chosen = self.flywheel or self.lengths
        return None if chosen is None else chosen.motion

    def _inertia_of_nearest(self, used: TrainInertia) -> TrainInertia | None:
        """The inertia of the gears of the law that comes nearest to keeping the limits.

        None where this law is already in use, and where there is no such law or its gears cannot be made.
        """
        if self.design.masses is None or not installed("casadi"):
            return None
        from ncgear.optimum.makeable.law import nearest_law

        task = law_task.task_of(self.design, used)
        try:
            made = law_task.inertia_with(self.design, motion_keys(nearest_law(task, self.wishes)))
        except DesignError:
            return None
        return made if _change(task, used, made) > SETTLED else None

    @property
    def task(self) -> Task:
        """The machine that is built: its masses include the gears that the best law makes."""
        return self._settled.task

    @cached_property
    def bound(self) -> Bound | None:
        """A lower limit of the goal for all laws of the machine as built, in the unit of the goal.

        None for a goal without a known limit; ``limit`` is higher for some goals.
        """
        begun = self.begun
        return begun.bound if self.task is begun.task else self._bound_of(self.task)

    @property
    def asked(self) -> Optimize:
        """Goal and limits as the design file asks for them."""
        return self.given.optimize or Optimize()

    @property
    def wishes_of_limit(self) -> Wishes:
        """The wishes and limits that the certified limit is for: all that are part of its proof."""
        return self.wishes

    def _bound_of(self, task: Task) -> Bound | None:
        from ncgear.optimum.makeable.demanded import certified_limit

        with self._offering(task):
            return certified_limit(task, self.wishes_of_limit)

    @cached_property
    def limit(self) -> Bound | None:
        """The highest known limit for the best law, in the unit of the goal; None where there is none."""
        from ncgear.optimum.makeable.demanded import raised_limit

        if self.bound is None:
            return None
        return raised_limit(
            self.task, self.wishes_of_limit, self.bound, self.figures, self.law.motion, self._on_programme
        )

    @contextmanager
    def _offering(self, task: Task) -> Iterator[None]:
        """A context that adds to refusals other wishes that work, checked by trying them."""
        try:
            yield
        except Refused as refused:
            from ncgear.project.offered import with_what_was_found

            # Offers are tried with the chosen lengths and flywheel
            held = {"lengths": None, "driven_flywheel_kg_mm2": None}
            asked = (self.design.optimize or Optimize()).model_copy(update=held)
            design = self.design.model_copy(update={"optimize": asked})
            raise with_what_was_found(design, task, self.wishes, refused, _has_law) from refused

    @property
    def gap(self) -> float | None:
        """The share by which the law's goal lies above the limit; None without a limit, and with soft wishes."""
        bound = self.limit
        return None if bound is None or bound.value <= 0.0 or self.soft else self.goal / bound.value - 1.0

    @property
    def not_covered(self) -> list[str]:
        """The limits, in words, that restrict the law but are not part of the bound."""
        from ncgear.optimum.makeable.demanded import not_covered

        teeth = ["teeth that hold"] if self.asked.limits.teeth_hold else []
        return [*not_covered(self.task, self.wishes_of_limit), *teeth]

    @property
    def law(self) -> MakeableLaw:
        """The best makeable law; raises WrongInput where the optimiser is not installed."""
        return self._settled.law

    @cached_property
    def _settled(self) -> Settled:
        """The law found with the inertia of its own gears, to SETTLED of everything that turns with the crank."""
        require("casadi", "optimize", "ncgear optimize")
        from ncgear.optimum.makeable.law import makeable_law

        begun, design = self.begun, self.design
        law, task, inertia = self._laws[self._costs.index(min(self._costs))], begun.task, begun.inertia
        if design.masses is None:
            return Settled(law, task)
        for _ in range(MOST_ROUNDS):
            made = law_task.inertia_with(design, motion_keys(law))
            change = _change(task, inertia, made)
            if not change:
                return Settled(law, task)
            inertia, task = made, law_task.task_of(design, made)
            if change <= SETTLED:
                return Settled(law, task)
            with self._offering(task):
                law = makeable_law(task, self.wishes, law.motion)
        raise NoSuchMechanism(
            f"the law and the inertia of its gears do not settle: after {MOST_ROUNDS} laws the gears still change by "
            f"{change:.2g} of all that turns with the crank; give masses.driven_gear_kg_mm2, or lighter gears",
            key="optimize",
        )

    @cached_property
    def _laws(self) -> list[MakeableLaw]:
        """The laws found from all starts with the gears as given, the law of the usual start first."""
        require("casadi", "optimize", "ncgear optimize")
        from ncgear.optimum.makeable.law import makeable_law

        begun = self.begun
        with self._offering(begun.task):
            usual = makeable_law(begun.task, self.wishes, begun.start)
        if self._starts == 1:
            return [usual]
        search = partial(_found_from, self.design, begun.inertia, begun.start)
        others = dict(finished(search, range(1, self._starts), *self._where))
        found = [others[number] for number in sorted(others)]
        return [usual, *(replace(usual, **settings._asdict()) for settings in found if settings is not None)]

    @property
    def starts(self) -> Starts:
        """The results of the search from all its starts."""
        most = max(self._costs)
        apart = most - min(self._costs)
        return Starts(self._starts, self._starts - len(self._costs), apart / abs(most) if apart else 0.0)

    @property
    def _costs(self) -> list[float]:
        """The goal of every law found; for the law of the usual start with the costs of soft wishes."""
        return [law.cost(self._laws[0].goal) for law in self._laws]

    @cached_property
    def train(self) -> PairsInSeries:
        """The law shared among the pairs of gears."""
        return self.law.train(self.task.lobes)

    @cached_property
    def figures(self) -> Figures:
        """Exact figures of the law."""
        return figures(self.task, self.train)

    @property
    def sizing(self) -> PairsInSeries:
        """The law found: the uniform crank's round gears have its centre distance, as in a simulation."""
        return self.train

    @cached_property
    def limit_points(self) -> list[tuple[float, float]]:
        """Points of the certified limit, each a cap on the power in W and an acceleration in mm/s2.

        Empty where no load acts on the slider.
        """
        from ncgear.optimum.frontier import limit_points

        most = 1.2 * max(self.figures.peak_power_w, self.uniform_figures.peak_power_w)
        return limit_points(self.task, self.wishes, most)

    @property
    def goal(self) -> float:
        """The quantity that the design minimises, for the best law, in the unit of the bound."""
        return self.wishes.prices.of(self.figures)


SETTLED = 1e-7
"""Greatest difference between the inertia of a law's gears and the inertia with which it was found, over everything
that the crank turns.  Figures and limit are told for the final gears, and a law is much nearer to its optimum than
this."""

MOST_ROUNDS = 12
"""Most laws that are found in sequence; two or three are usual."""


class _WithoutOffers(BestLaw):
    """The same for designs that are only tried: their errors offer no other wishes."""

    @contextmanager
    def _offering(self, task: Task) -> Iterator[None]:
        yield


def _has_law(design: Design) -> bool:
    """Whether a law is found for a design; with masses, all limits hold with the settled inertia of its gears."""
    try:
        _ = _WithoutOffers(design).law
    except DesignError:
        return False
    return True


class Begun(NamedTuple):
    """The start of the search: the inertia of the gears, the task, the limit, and a motion to start from."""

    inertia: TrainInertia
    task: Task
    bound: Bound | None
    start: Motion


class Settled(NamedTuple):
    """A law, and the machine with the gears of this law."""

    law: MakeableLaw
    task: Task


def motion_keys(law: MakeableLaw) -> LawKeys:
    """A law as the keys of a design's motion."""
    return found_motion(law.ratio.tolist(), None if law.second is None else law.second.tolist())


def _change(task: Task, used: TrainInertia, made: TrainInertia) -> float:
    """Difference of the gears from the gears in use, over the mean inertia of everything that the crank turns."""
    between = sum(used.between_kg_mm2) - sum(made.between_kg_mm2)
    apart = max(abs(between), abs(used.driven_kg_mm2 - made.driven_kg_mm2))
    if not apart:
        return 0.0
    return apart / mean_inertia_kg_mm2(task)


class _Found(NamedTuple):
    """The part of a law from one of several starts that can be sent between processes."""

    ratio: Array
    second: Array | None
    reached: Array


def _found_from(design: Design, inertia: TrainInertia, start: Motion, number: int) -> _Found | None:
    """The law from another start, computed in a separate process; None where none is found."""
    from ncgear.optimum.makeable.law import law_from

    law = law_from(law_task.task_of(design, inertia), law_task.wishes_of(design), start, number)
    return None if law is None else _Found(law.ratio, law.second, law.reached)
