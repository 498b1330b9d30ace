"""Constraints and objectives for the designs of a sweep, and the best designs by them.

A design dominates another if it is no worse in any objective and better in one.  The Pareto set has the designs that
no design dominates.  Objectives count to ``DIGITS`` digits: equal figures differ by rounding, and a design that is
better by rounding alone is no other choice.
"""

from __future__ import annotations

import operator
import re
from collections.abc import Callable, Iterable, Sequence
from difflib import get_close_matches
from math import isfinite
from typing import Any

import numpy as np

from ncgear.design.reading.text import plain_number, quoted
from ncgear.errors import WrongInput
from ncgear.frozen import dataclass
from ncgear.numerics.arrays import Array, IndexArray, Mask
from ncgear.screening.designs import Designs

DIGITS = 9
"""Digits of objectives that count; rounding errors of a screening change the thirteenth (benchmarks/screening.md)."""

KEEP, OBJECTIVE = "--keep-if", "--objective"

MOST_OBJECTIVES = 4
"""Objectives beyond which nearly every design is in the Pareto set."""

FEW = 64
"""Number of designs up to which all pairs are compared, without further halving."""

COMPARISONS: dict[str, Callable[[Array, float], Any]] = {
    "<=": operator.le,
    ">=": operator.ge,
    "==": operator.eq,
    "!=": operator.ne,
    "<": operator.lt,
    ">": operator.gt,
}

SENTENCE = re.compile(r"\s*([A-Za-z_][\w.]*)\s*(<=|>=|==|!=|<|>)\s*(\S+)\s*")


@dataclass(frozen=True)
class Constraint:
    """A figure or key, a comparison, and a number."""

    name: str
    comparison: str
    number: float

    def kept(self, designs: Designs) -> Mask:
        """Whether each design keeps it; false for an unknown figure."""
        values = designs.column(self.name)
        return COMPARISONS[self.comparison](values, self.number) & ~np.isnan(values)


@dataclass(frozen=True)
class Objective:
    """A figure that is minimized or maximized."""

    name: str
    greatest: bool = False

    def cost(self, designs: Designs) -> Array:
        """The minimized value, shape (n,), to ``DIGITS`` digits."""
        return rounded_to(designs.column(self.name), DIGITS) * (-1.0 if self.greatest else 1.0)


@dataclass(frozen=True)
class Wanted:
    """Constraints and objectives."""

    constraints: tuple[Constraint, ...]
    objectives: tuple[Objective, ...]

    def kept(self, designs: Designs) -> Mask:
        """Which designs are made and keep all constraints."""
        kept = designs.made
        for constraint in self.constraints:
            kept = kept & constraint.kept(designs)
        return kept

    def costs(self, designs: Designs) -> Array:
        """The minimized values, shape (n, objectives)."""
        costs = [objective.cost(designs) for objective in self.objectives]
        return np.array(costs).reshape(len(costs), len(designs.numbers)).T

    def of(self, names: Iterable[str]) -> Wanted:
        """The constraints and objectives on these columns alone."""
        known = set(names)
        return Wanted(
            tuple(constraint for constraint in self.constraints if constraint.name in known),
            tuple(objective for objective in self.objectives if objective.name in known),
        )


def constraint_of(text: str, names: Sequence[str]) -> Constraint:
    """``check.peak_power_w < 9000``; raises WrongInput for anything but a known name, a comparison and a number."""
    found = SENTENCE.fullmatch(text)
    number = plain_number(found[3]) if found else None
    if found is None or number is None or not isfinite(number):
        form = "a name, one of < <= > >= == != and a number, as check.peak_power_w < 9000, are right"
        raise WrongInput(f"{quoted(text)} given; {form}", key=KEEP)
    return Constraint(_known(found[1], names, KEEP), found[2], float(number))


def objective_of(text: str, names: Sequence[str]) -> Objective:
    """An objective from a figure's name: minimized, or maximized with ``max:`` or a minus before it.

    Raises WrongInput for an unknown name.
    """
    for start, greatest in (("max:", True), ("min:", False), ("-", True), ("", False)):
        if text.startswith(start):
            return Objective(_known(text.removeprefix(start), names, OBJECTIVE), greatest)
    raise AssertionError


def objectives_of(texts: Sequence[str], names: Sequence[str]) -> tuple[Objective, ...]:
    """Objectives; without any, least acceleration and least power."""
    starts = ("check.peak_acceleration_cycle_", "check.peak_power_w")
    objectives = [objective_of(text, names) for text in texts]
    if not objectives:
        return tuple(Objective(name) for start in starts for name in names if name.startswith(start))
    if len({objective.name for objective in objectives}) < len(objectives):
        raise WrongInput("a figure is given twice; keep one", key=OBJECTIVE)
    if len(objectives) > MOST_OBJECTIVES:
        problem = f"{len(objectives)} given; {MOST_OBJECTIVES} or fewer are right, or nearly every design is a best one"
        raise WrongInput(problem, key=OBJECTIVE)
    return tuple(objectives)


def _known(name: str, names: Sequence[str], option: str) -> str:
    """The name of a column from its name or the last part of it."""
    full = [full_name for full_name in names if full_name == name or full_name.endswith(f".{name}")]
    if name in full:
        return name
    if len(full) == 1:
        return full[0]
    close = get_close_matches(name, names, n=1) or get_close_matches(
        name, [full_name.rpartition(".")[2] for full_name in names], n=1
    )
    hint = f"did you mean {close[0]}?" if close else f"one of {', '.join(names)} is right"
    raise WrongInput(f"no figure {quoted(name)}; {hint}", key=option)


def rounded_to(values: Array, digits: int) -> Array:
    """Values rounded to ``digits`` significant digits; NaN and zero stay."""
    with np.errstate(divide="ignore", invalid="ignore"):
        size = np.floor(np.log10(np.abs(values)))
    factor = 10.0 ** (digits - 1 - np.where(np.isfinite(size), size, 0.0))
    return np.round(values * factor) / factor


def non_dominated(costs: Array) -> IndexArray:
    """The rows of ``costs``, shape (n, m), that no other row dominates, in rising order; the first of equal rows.

    Rows in rising order are halved repeatedly: no row of the second half dominates a row of the first (H. T. Kung, F.
    Luccio and F. P. Preparata, "On finding the maxima of a set of vectors", Journal of the ACM 22, 1975).
    """
    order = np.lexsort((np.arange(len(costs)), *costs.T[::-1]))
    return np.sort(_front(costs, order)) if order.size else order


def _front(costs: Array, rising: IndexArray) -> IndexArray:
    """The rows of ``rising``, whose costs rise from the first objective on, that no row of them dominates."""
    if costs.shape[1] < 2:
        return rising[:1]
    if costs.shape[1] == 2:
        least = np.minimum.accumulate(costs[rising, 1])
        return rising[np.concatenate([[True], least[1:] < least[:-1]])]
    if rising.size <= FEW:
        rows = costs[rising]
        beaten = np.tril((rows[:, None] >= rows[None]).all(axis=2), -1).any(axis=1)
        return rising[~beaten]
    half = rising.size // 2
    first, second = _front(costs, rising[:half]), _front(costs, rising[half:])
    return np.concatenate([first, second[~_reached(costs[first, 1:], costs[second, 1:])]])


def _reached(first: Array, second: Array) -> Mask:
    """Which rows of ``second`` are nowhere less than some row of ``first``, shapes (k, m) and (n, m)."""
    if first.shape[1] == 2:
        rising = np.argsort(first[:, 0], kind="stable")
        least = np.concatenate([[np.inf], np.minimum.accumulate(first[rising, 1])])
        return least[np.searchsorted(first[rising, 0], second[:, 0], side="right")] <= second[:, 1]
    reached = np.zeros(len(second), dtype=bool)
    for row in first:
        left = np.nonzero(~reached)[0]
        reached[left] = (second[left] >= row).all(axis=1)
    return reached


def best_rows(costs: Array, count: int) -> IndexArray:
    """At most ``count`` rows of ``costs``, shape (n, m), the best first.

    With several objectives the rank comes first: rank 0 is the Pareto set, rank 1 that of the others, and so on.  Rows
    of a rank are in the order of the first objective, then of the next objectives, then of the rows.  Without
    objectives the rows are spread evenly.
    """
    if not costs.shape[1]:
        return np.unique(np.linspace(0, len(costs) - 1, min(count, len(costs))).astype(np.intp))
    left, found = np.arange(len(costs)), list[IndexArray]()
    if costs.shape[1] == 1:
        return np.lexsort((left, costs[:, 0]))[:count]
    while left.size and sum(map(len, found)) < count:
        rank = non_dominated(costs[left])
        rows = left[rank]
        found.append(rows[np.lexsort((rows, *costs[rows].T[::-1]))])
        left = np.delete(left, rank)
    return np.concatenate([*found, np.empty(0, dtype=np.intp)])[:count]
