"""What the studio tells of a design, part by part, each as soon as it is computed, as plain values for the page.

There are two chains, which two processes follow side by side: ``motion_answers`` needs no gear, ``gear_answers`` makes
teeth, contact and strength.  Each yields pairs of a name and a content.  Where a part does not exist, the last pair is
``refused`` with the condition and its place; the other chain is not affected.
"""

from __future__ import annotations

from collections.abc import Callable, Iterator, Sequence
from dataclasses import asdict
from functools import partial
from pathlib import Path
from typing import Any

import numpy as np

from ncgear.design.reading.design_file import parsed
from ncgear.drawings.charts.chart import Line
from ncgear.drawings.charts.slider_charts import Quantity
from ncgear.drawings.page.chart_figure import PageChart
from ncgear.drawings.page.chart_svg import Size, drawn
from ncgear.drawings.page.data import paces, page_data, scene_data, shaft_tables
from ncgear.drawings.page.page import stage_name
from ncgear.drawings.page.page_charts import charts_of_pair, motion_charts
from ncgear.drawings.page.scene_svg import scene_svg
from ncgear.drawings.page.tables import comparison_tables, strength_tables, typeset
from ncgear.drawings.scene.scene import Scene, scene_of, scene_of_teeth, scene_without_gears
from ncgear.errors import DesignError, WrongInput
from ncgear.figures.advice.values import Advice
from ncgear.figures.advice.verdict import Known, Verdict, judged
from ncgear.figures.answers.machine import gear_facts
from ncgear.figures.summary.build_summary import designed_contact
from ncgear.figures.tables import Column, Table
from ncgear.figures.terminal import labelled
from ncgear.figures.wished import achieved_lines
from ncgear.project.drive import Drive
from ncgear.studio.best import saved
from ncgear.studio.facts import facts, safety_facts
from ncgear.studio.handles import handles

Answer = tuple[str, Any]

FIRST = (Quantity.VELOCITY, Quantity.ACCELERATION, Quantity.POWER, Quantity.RATIO)
"""The charts that a designer looks at first, which are drawn first."""

CHART: Size = (280.0, 164.0)
"""Size of a chart: two stand side by side beside values and figures at 1280 pixels, with text of 11 pixels or more."""

LIVE_POINTS = 400
"""Points of a line that follows while something is dragged: one for each pixel or two of a chart."""


def motion_answers(text: str, path: Path) -> Iterator[Answer]:
    """Law, motion and power: ``motion``, ``figures`` with the verdict, each ``chart``, ``best`` of all laws."""
    yield from _guarded("design", partial(_motion, text, path))


def gear_answers(text: str, path: Path) -> Iterator[Answer]:
    """The machine and its teeth: ``scene``, ``teeth``, ``strength``, ``verdict``, ``chart`` for each chart of teeth.

    There is a second ``scene`` after the contact, in which the gears have bore and holes.
    Where there are no gears such as the design wants, ``bare`` is the mechanism without them.
    """
    yield from _guarded("design", partial(_gears, text, path))


def _guarded(part: str, answers: Callable[[], Iterator[Answer]]) -> Iterator[Answer]:
    """The answers, and a refusal in the place of those that cannot be given."""
    try:
        for name, content in answers():
            part = name
            yield name, content
    except DesignError as error:
        place = error.location.rpartition(":")[0].rpartition(":")[2] if error.location else ""
        yield (
            "refused",
            {
                "after": part,
                "wrong_input": isinstance(error, WrongInput),
                "problem": error.problem,
                "key": error.key,
                "line": int(place) if place.isdigit() else None,
            },
        )


def _motion(text: str, path: Path) -> Iterator[Answer]:
    loaded = parsed(text, path)
    drive = Drive(loaded.design, loaded=loaded)
    scene = scene_without_gears(drive)
    first = [quantity.key_of(drive.linkage.OUTPUT) for quantity in FIRST]
    charts = sorted(
        motion_charts(drive, scene.loop_rad), key=lambda one: first.index(one.key) if one.key in first else len(first)
    )
    yield (
        "motion",
        {
            "loop": scene.loop_rad,
            "swings": scene.swings,
            "paces": [asdict(pace) for pace in paces(drive.design.operation.speed_rpm)],
            "shafts": shaft_tables(scene),
            "charts": [_live(chart) for chart in charts],
            "handles": handles(drive),
        },
    )
    yield (
        "figures",
        {
            "facts": facts(drive),
            "crank": drive.linkage.UNIFORM,
            "achieved": achieved_lines(drive.achieved, drive.linkage) if drive.achieved else [],
            "tables": [_table(table) for table in comparison_tables(drive)],
            "verdict": _verdict(judged(drive, Known.MOTION)),
        },
    )
    yield from _drawn(scene, charts)
    yield "best", saved(drive.design)


def _gears(text: str, path: Path) -> Iterator[Answer]:
    loaded = parsed(text, path)
    drive = Drive(loaded.design, loaded=loaded)
    try:
        scene = scene_of_teeth(drive)
    except DesignError:
        yield "bare", _shown(scene_without_gears(drive), gears=False)
        raise
    has_gears = drive.design.gears is not None
    yield "scene", _shown(scene, gears=has_gears)
    if not has_gears:
        return
    pairs = [(stage_name(pair), pair) for pair in drive.by_stage]
    drive.require_sound_pairs()
    yield (
        "teeth",
        {
            "facts": [fact for _, pair in pairs for fact in typeset(gear_facts(pair), pair.stage)],
            "tables": [_contact_table(stage, pair) for stage, pair in pairs],
        },
    )
    yield "scene", _shown(scene_of(drive), gears=True)
    strong = [_table(table) for _, pair in pairs for table in strength_tables(pair)]
    yield "strength", {"facts": safety_facts(drive.by_stage), "tables": strong}
    yield "verdict", _verdict(judged(drive, Known.TEETH))
    for _, pair in pairs:
        yield from _drawn(scene, charts_of_pair(pair, {}, pair.designed_contact.placement.cycle_rad))


def _shown(scene: Scene, *, gears: bool) -> dict[str, Any]:
    return {"svg": scene_svg(scene), "data": scene_data(scene), "gears": gears}


def _live(page_chart: PageChart) -> dict[str, Any]:
    """A chart for lines that follow at once; the page draws them on the scales of the last drawn chart."""
    chart = page_chart.chart
    return {
        "key": page_chart.key,
        "name": chart.name,
        "unit": chart.unit,
        "decimals": page_chart.decimals,
        "lines": [_thinned(line) for line in chart.lines],
    }


def _thinned(line: Line) -> dict[str, Any]:
    step = max(1, len(line.x) // LIVE_POINTS)
    # Both ends and both sides of every jump stay.
    jumps = np.nonzero(np.diff(line.x) < 1e-6)[0]
    places = np.unique(np.concatenate([np.arange(0, len(line.x), step), jumps, jumps + 1, [len(line.x) - 1]]))
    return {
        "role": str(line.role),
        "label": line.label,
        "x": np.round(line.x[places], 4).tolist(),
        "y": [float(f"{value:.6g}") for value in line.values[places]],
    }


def _drawn(scene: Scene, charts: Sequence[PageChart]) -> Iterator[Answer]:
    """Each chart as the report has it: its drawing, its scales, its lines."""
    for chart in charts:
        figure = drawn(chart, CHART)
        data = page_data(scene, [figure])
        lines = [{"label": line.label, "role": str(line.role)} for line in chart.chart.lines]
        yield (
            "chart",
            {
                **data["charts"][0],
                "grids": data["grids"],
                "svg": str(figure.svg),
                "name": chart.chart.name,
                "unit": chart.chart.unit,
                "extremes": figure.extremes,
                "labels": lines,
            },
        )


def _contact_table(stage: str, pair: Drive) -> dict[str, Any]:
    found = designed_contact(pair.designed_contact, pair.contact_extremes)
    plain = {key: value for key, value in found.items() if not isinstance(value, list)}
    rows = tuple(labelled(plain))
    return _table(
        Table(f"Contact of the teeth{f', {stage}' if stage else ''}", (Column(""), Column("as designed")), rows)
    )


def _table(table: Table) -> dict[str, Any]:
    return {
        "title": table.title,
        "columns": [[column.label, column.unit] for column in table.columns],
        "rows": [{"cells": row.cells, "span": row.span, "note": row.note} for row in table.html_rows],
        "notes": list(table.notes),
    }


def _verdict(verdict: Verdict) -> dict[str, Any]:
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
