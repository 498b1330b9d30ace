"""A design as plain values for the page: charts, tables, advice, facts, and the gain of the best law."""

from __future__ import annotations

from collections.abc import Iterable, Iterator, Sequence
from typing import Any

from ncgear.design.keys.design import Design
from ncgear.drawings.page.chart_figure import PageChart
from ncgear.drawings.page.chart_svg import Size, drawn
from ncgear.drawings.page.data import chart_data
from ncgear.drawings.page.tables import typeset
from ncgear.errors import DesignError
from ncgear.figures.advice.values import Advice
from ncgear.figures.advice.verdict import Verdict
from ncgear.figures.answers.answer import difference
from ncgear.figures.answers.machine import compared_rows, machine_facts, safeties
from ncgear.figures.numbers import fixed, to_digits
from ncgear.figures.tables import Table
from ncgear.project.drive import Drive
from ncgear.studio.messages import Answer

CHART: Size = (280.0, 164.0)
"""Size of a chart: two fit side by side beside values and figures at 1280 pixels, with text of 11 pixels or more."""


def drawn_charts(charts: Sequence[PageChart]) -> Iterator[Answer]:
    """Each chart as in the report: its drawing, its scales, its lines."""
    for chart in charts:
        figure = drawn(chart, CHART)
        data = chart_data([figure])
        lines = [{"label": line.label, "role": str(line.role)} for line in chart.chart.lines]
        yield (
            "chart",
            {
                **data["charts"][0],
                "grids": data["grids"],
                "svg": str(figure.svg),
                "name": figure.heading,
                "extremes": figure.extremes,
                "labels": lines,
            },
        )


def table_data(table: Table) -> dict[str, Any]:
    """A table."""
    return {
        "title": table.title,
        "columns": [[column.label, column.unit] for column in table.columns],
        "rows": [{"cells": row.cells, "span": row.span, "note": row.note} for row in table.html_rows],
        "notes": list(table.notes),
    }


def verdict_data(verdict: Verdict) -> dict[str, Any]:
    """The pieces of advice, and the sentence about the whole."""
    return {
        "advices": [_advice(row.of, advice) for row in verdict.rows for advice in row.advices],
        "good": "" if verdict.warnings else verdict.good,
        "not_judged": verdict.not_judged,
        "table": verdict.table,
    }


def _advice(stage: str, advice: Advice) -> dict[str, Any]:
    return {
        "stage": stage,
        "what": advice.what,
        "meaning": advice.meaning,
        "matters": advice.matters,
        "remedies": [
            {
                "text": remedy.text,
                "changes": {change.key: change.value for change in remedy.changes},
                "words": [str(change) for change in remedy.changes],
                "command": remedy.command,
            }
            for remedy in advice.remedies
        ],
    }


def facts(drive: Drive) -> list[list[str]]:
    """Name and text of each figure; the peaks come first, with the peaks of the crank and the differences."""
    compared = {row.name: row.texts for row in compared_rows(drive)}
    rows = {name: (text,) for name, text in machine_facts(drive)} | compared
    ordered = dict.fromkeys([*compared, *rows])
    return [[name, *(text for _, text in typeset((name, row) for row in rows[name]))] for name in ordered]


def safety_facts(pairs: Iterable[Drive]) -> list[tuple[str, str]]:
    """Name and text of the least safety against each kind of damage, for each pair; none where no load is known."""
    return [
        fact
        for pair in pairs
        for damage, safety, wanted in safeties(pair) or ()
        for fact in typeset([(f"safety against {damage}, {wanted} wanted", safety)], pair.of)
    ]


NEAR = 0.01
"""Share by which a law may lie above the limit and still count as the best: laws of 180 knots miss it by as much."""


def saved(design: Design) -> dict[str, str] | None:
    """``words`` on the button of the best law, and the same ``in_full`` with figures and units.

    None where nothing can be said beforehand: no law is searched for the mechanism, no limit of its goal is known, the
    wishes contradict each other, lengths or the flywheel are free, or the extra of the optimiser is not installed.
    """
    from ncgear.figures.answers.best_law import GOALS
    from ncgear.figures.best_law import unit_of_goal
    from ncgear.optimum.makeable.wishes import Goal
    from ncgear.project.best_law import BestLaw

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
