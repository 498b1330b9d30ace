"""Lengths of the mechanism as unknowns: the best law with each, and the best lengths.

For given lengths the usual search finds a law, from the law of the nearest tried lengths.  Each length is first tried
alone at the ends of its range, then the best of these together (all corners where no law was found).  Then COBYQA (T.
M. Ragonneau, Z. Zhang) follows the goal by quadratic models within the ranges; it needs no derivatives.
"""

from __future__ import annotations

from collections.abc import Callable, Sequence
from dataclasses import replace
from itertools import product
from typing import TYPE_CHECKING, NamedTuple

import numpy as np

from ncgear.errors import DesignError, NoSuchMechanism
from ncgear.frozen import dataclass
from ncgear.numerics.arrays import Array
from ncgear.optimum.certified.limit import Motion
from ncgear.optimum.certified.motion import ROUNDING
from ncgear.optimum.flywheels import AS_GOOD, DIGITS, KNOTS, least_by_work
from ncgear.optimum.makeable.demanded import OF_WAY, least_of_way, start_motion
from ncgear.optimum.makeable.wishes import Wishes
from ncgear.optimum.task import Task, figures

if TYPE_CHECKING:
    from ncgear.optimum.makeable.law import MakeableLaw

Values = tuple[float, ...]
"""A value of every unknown."""

FIRST_STEP, LAST_STEP = 0.25, 0.01
"""First and last radius of COBYQA's trust region, as shares of the ranges."""

MOST_TRIED = 15
"""Machines that COBYQA tries at most, for each unknown."""


class Unknown(NamedTuple):
    """The range of an unknown, and its value as given, which may be outside."""

    least: float
    most: float
    given: float


@dataclass(frozen=True, eq=False)
class TriedLaw:
    """The best law of few knots found with some values of the unknowns, and its cost in the goal's unit."""

    values: Values
    law: MakeableLaw
    cost: float


class LengthSearch:
    """The laws found so far, by the values of the unknowns.

    ``machine`` makes machine and wishes of values, or raises a DesignError; ``tell`` takes the number of searches.
    """

    def __init__(
        self,
        unknowns: Sequence[Unknown],
        machine: Callable[[Values], tuple[Task, Wishes]],
        tell: Callable[[int], None] = lambda laws: None,
    ) -> None:
        self.unknowns, self.found = unknowns, dict[Values, TriedLaw | None]()
        self._machine, self._tell = machine, tell
        self._least = np.array([unknown.least for unknown in unknowns])
        self._width = np.array([unknown.most - unknown.least for unknown in unknowns])

    def best(self, start: Motion | None = None) -> TriedLaw:
        """The best of all tried laws; the law with the given values where no other law is better.

        ``start`` is a motion with the values as given.  Raises NoSuchMechanism where no law is found.
        """
        # Loads slowly
        from scipy.optimize import Bounds, minimize

        given = self._rounded(self._shares([unknown.given for unknown in self.unknowns]))
        first = self._tried(given, start)
        self._tried(tuple(self._best_alone(given, number) for number in range(len(given))))
        if not self._laws:
            for corner in product(*((unknown.least, unknown.most) for unknown in self.unknowns)):
                self._tried(corner)
        if self._laws:
            minimize(
                lambda shares: self._cost(self._rounded(shares)),
                self._shares(self._cheapest.values),
                method="COBYQA",
                bounds=Bounds(np.zeros(self._width.size), np.ones(self._width.size)),
                options={
                    "initial_tr_radius": FIRST_STEP,
                    "final_tr_radius": LAST_STEP,
                    "maxfev": MOST_TRIED * self._width.size,
                },
            )
        if not self._laws:
            raise NoSuchMechanism("no law was found with any lengths of the ranges", key="optimize.lengths")
        cheapest = self._cheapest
        return cheapest if first is None or cheapest.cost < (1.0 - AS_GOOD) * first.cost else first

    def _best_alone(self, given: Values, number: int) -> float:
        """The best of an unknown's given value and both ends of its range, with the given values of all others."""
        unknown = self.unknowns[number]
        tried = [
            self._tried((*given[:number], value, *given[number + 1 :]))
            for value in (given[number], unknown.least, unknown.most)
        ]
        laws = [law for law in tried if law is not None]
        return min(laws, key=lambda law: law.cost).values[number] if laws else given[number]

    @property
    def _laws(self) -> list[TriedLaw]:
        return [law for law in self.found.values() if law is not None]

    @property
    def _cheapest(self) -> TriedLaw:
        return min(self._laws, key=lambda law: law.cost)

    def _shares(self, values: Sequence[float]) -> Array:
        """Places of values in their ranges, 0 to 1, shape (unknowns,)."""
        return np.clip((np.array(values) - self._least) / self._width, 0.0, 1.0)

    def _rounded(self, shares: Array) -> Values:
        """Values at places in their ranges, with digits that a workshop can read; ends and given values stay."""
        made = []
        for unknown, value in zip(self.unknowns, (self._least + self._width * shares).tolist(), strict=True):
            exact = next(
                (end for end in (unknown.least, unknown.most, unknown.given) if abs(end - value) < 1e-9 * abs(end)),
                None,
            )
            short = float(f"{value:.{DIGITS}g}")
            made.append(min(max(short, unknown.least), unknown.most) if exact is None else exact)
        return tuple(made)

    def _cost(self, values: Values) -> float:
        """The cost of the best law; without a law the cost of the worst law found, since a model needs a number."""
        tried = self._tried(values)
        return max(law.cost for law in self._laws) if tried is None else tried.cost

    def _tried(self, values: Values, start: Motion | None = None) -> TriedLaw | None:
        if values not in self.found:
            self._tell(len(self.found) + 1)
            self.found[values] = self._law(values, start)
        return self.found[values]

    def _law(self, values: Values, start: Motion | None) -> TriedLaw | None:
        """The law found from a start, from the law of the nearest values, or from the motion of the limit."""
        from ncgear.optimum.makeable.law import kept_law

        try:
            task, wishes = self._machine(values)
            few = replace(wishes, knots=min(wishes.knots, KNOTS))
            begun = start or self._near(values)
            law = None if begun is None else kept_law(task, few, begun)
            law = law or kept_law(task, few, start_motion(task, few))
            if law is None:
                return None
            goal = wishes.prices.of(figures(task, law.train(task.lobes)))
        except DesignError:
            return None
        # Soft wishes cost shares of the goal
        soft = law.cost(law.goal) / law.goal if law.goal > 0.0 else 1.0
        return TriedLaw(values, law, goal * soft)

    def _near(self, values: Values) -> Motion | None:
        place = self._shares(values)

        def apart(law: TriedLaw) -> float:
            return float(np.linalg.norm(self._shares(law.values) - place))

        return min(self._laws, key=apart).law.motion if self._laws else None


def least_with_any_lengths(task: Task, wishes: Wishes, least_stroke_mm: float | None) -> float:
    """A lower bound of the goal for all laws with any lengths of the mechanism, in the goal's unit.

    With a fixed stroke the work of a cycle is known, which bounds mean power, tooth force and flank load;
    ``least_stroke_mm`` is None then, and else the least of all strokes in mm or rad.  For any mechanism, peaks of
    speed, acceleration and jerk of the output have a least value.  The bound of all other figures is zero.
    """
    prices, held = vars(wishes.prices), least_stroke_mm is None
    stroke_mm = task.linkage.stroke_mm if least_stroke_mm is None else least_stroke_mm
    least = (1.0 - ROUNDING) * sum(prices[name] * least_of_way(name, stroke_mm, task.cycle_s) for name in OF_WAY)
    return float(least) + (least_by_work(task, wishes) if held else 0.0)
