"""What the best law would save: the certified limit of what is to be least, beside the design as it is."""

from __future__ import annotations

from ncgear.design.keys.design import Design
from ncgear.errors import DesignError
from ncgear.figures.answers.answer import difference
from ncgear.figures.answers.best_law import GOALS
from ncgear.figures.best_law import unit_of_goal
from ncgear.figures.numbers import fixed, to_digits
from ncgear.optimum.makeable.wishes import Goal
from ncgear.project.best_law import BestLaw

NEAR = 0.01
"""Share of the limit that a law may lie above it and count as the best: laws of 180 knots lack as much themselves."""


def saved(design: Design) -> dict[str, str] | None:
    """``words`` that stand on the button of the best law, and the same ``in_full`` with figures and units.

    None where nothing can be said beforehand: no law is sought for the mechanism, no limit of its goal is known, the
    wishes contradict each other, lengths or the flywheel are free, or the extra of the optimiser is not installed.
    """
    best = BestLaw(design)
    if design.free_flywheel is not None or design.free_lengths:
        # The search for them takes too long here
        return None
    try:
        bound, given = best.begun.bound, best.given_figures
    except DesignError:
        return None
    if bound is None or given is None:
        return None
    goal, unit = best.wishes.goal, unit_of_goal(best)
    least, own = bound.value, best.wishes.prices.of(given)
    name = GOALS.get(goal, goal.value).removeprefix("least").strip("_ ").replace("_", " ")
    figures = (
        f"{to_digits(own, 4)} now, no law below {to_digits(least, 4)}{'' if goal is Goal.WEIGHTED else f' {unit}'}"
    )
    if own < least:
        return {"words": f"{name} {difference(least, own)}", "in_full": f"{name}: {figures} keeps every wish and limit"}
    if own <= (1.0 + NEAR) * least:
        return {"words": f"{name} within {fixed(100.0 * NEAR, 0)} % of the limit", "in_full": f"{name}: {figures}"}
    return {"words": f"{name} up to {difference(least, own)}", "in_full": f"{name}: {figures}"}
