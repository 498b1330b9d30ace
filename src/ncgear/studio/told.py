"""Tables, advices and drawn charts as plain values for the page."""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from typing import Any

from ncgear.drawings.page.chart_figure import PageChart
from ncgear.drawings.page.chart_svg import Size, drawn
from ncgear.drawings.page.data import chart_data
from ncgear.figures.advice.values import Advice
from ncgear.figures.advice.verdict import Verdict
from ncgear.figures.tables import Table
from ncgear.studio.answers import Answer

CHART: Size = (280.0, 164.0)
"""Size of a chart: two stand side by side beside values and figures at 1280 pixels, with text of 11 pixels or more."""


def drawn_charts(charts: Sequence[PageChart]) -> Iterator[Answer]:
    """Each chart as the report has it: its drawing, its scales, its lines."""
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
    """The advices, and what is said of the whole."""
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
