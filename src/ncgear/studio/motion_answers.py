"""The chain of the motion: answers about a law with a mechanism that need no teeth.

The first answers follow the hand, so they compute little; extremes, charts and the verdict come after them.
"""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import asdict
from typing import Any

import numpy as np

from ncgear.design.reading.design_file import LoadedTrain
from ncgear.drawings.charts.chart import Quantity
from ncgear.drawings.page.chart_figure import PageChart
from ncgear.drawings.page.data import MORE_DECIMALS, paces, shaft_tables
from ncgear.drawings.page.motion_charts import cycle_angles_rad, motion_charts, quantities_of
from ncgear.drawings.scene.scene import scene_without_gears
from ncgear.errors import NoSuchMechanism
from ncgear.numerics.arrays import Array, IndexArray, distinct
from ncgear.project.drive import Drive
from ncgear.studio.drawing import drawing_of
from ncgear.studio.handles import handles
from ncgear.studio.messages import Answer, Asked

FIRST = (Quantity.VELOCITY, Quantity.ACCELERATION, Quantity.POWER, Quantity.RATIO)
"""The charts that a designer looks at first; they are drawn first."""

LIVE_POINTS = 400
"""Points of a line that is redrawn during a drag: one for each pixel or two of a chart."""


def motion_answers(drive: Asked) -> Iterator[Answer]:
    """Law, motion, power: ``motion``, ``drawing``, ``figures``, each ``chart``, ``verdict``, ``best`` of all laws."""
    if isinstance(drive, LoadedTrain):
        yield from train_answers(drive)
        return
    try:
        scene = scene_without_gears(drive)
    except NoSuchMechanism:
        # A curve that gives no gear can still be drawn further.
        yield from drawing_of(drive)
        raise
    asked = [
        quantity for quantity in quantities_of(drive) if quantity is not Quantity.POWER or not power_needs_gears(drive)
    ]
    followed = motion_charts(drive, scene.loop_rad, asked, cycle_angles_rad(drive))
    yield (
        "motion",
        {
            "loop": scene.loop_rad,
            "swings": scene.swings,
            "paces": [asdict(pace) for pace in paces(drive.design.operation.speed_rpm)],
            "shafts": shaft_tables(scene),
            "charts": [live(chart) for chart in followed],
            "handles": handles(drive),
        },
    )
    yield from drawing_of(drive)
    from ncgear.figures.advice.verdict import KnownParts, judged
    from ncgear.figures.summary.check_summary import comparison_rows, comparison_tables
    from ncgear.figures.wished import achieved_lines
    from ncgear.studio.told import drawn_charts, facts, saved, table_data, verdict_data

    yield (
        "figures",
        {
            "facts": facts(drive),
            "crank": drive.linkage.UNIFORM,
            "achieved": achieved_lines(drive.achieved, drive.linkage) if drive.achieved else [],
            "tables": [table_data(table) for table in comparison_tables(comparison_rows(drive))],
        },
    )
    first = [quantity.key_of(drive.linkage.OUTPUT) for quantity in FIRST]
    charts = motion_charts(drive, scene.loop_rad)
    yield from drawn_charts(
        sorted(charts, key=lambda quantity: first.index(quantity.key) if quantity.key in first else len(first))
    )
    yield "verdict", verdict_data(judged(drive, KnownParts.MOTION))
    yield "best", saved(drive.design)


def train_answers(loaded: LoadedTrain) -> Iterator[Answer]:
    """``scene``, ``motion``, ``figures`` and ``verdict`` of a train, which are what ``ncgear check`` tells of it."""
    from ncgear.drawings.page.train_page import train_advices, train_facts, train_scene
    from ncgear.figures.trains import checked_conditions, train_answer

    file, train = loaded.file, loaded.file.train.train()
    yield "scene", train_scene(train)
    running = {
        "loop": train.cycle_rad,
        "swings": False,
        "paces": [asdict(pace) for pace in paces(abs(train.speed_rpm))],
    }
    yield "motion", {**running, "shafts": [], "charts": [], "handles": []}
    told = train_answer(file.name, file.description, train, checked_conditions(train), "")
    yield "figures", {"facts": train_facts(told), "crank": "", "achieved": [], "tables": []}
    advices = train_advices(told)
    yield "verdict", {"advices": advices, "good": "" if advices else told.good, "not_judged": told.not_judged}


def power_needs_gears(drive: Drive) -> bool:
    """Whether the power counts the inertia of gears, for which their teeth may be needed."""
    return drive.masses_left_out is None and drive.design.gears is not None


def live(page_chart: PageChart) -> dict[str, Any]:
    """A chart with lines that are redrawn at once; the page draws them on the scales of the last full chart.

    All its lines have samples at the same angles.
    """
    chart, decimals = page_chart.chart, page_chart.decimals + MORE_DECIMALS
    angles_deg = chart.lines[0].x
    places = _thinned(angles_deg)
    return {
        "key": page_chart.key,
        "name": chart.name,
        "unit": chart.unit,
        "decimals": page_chart.decimals,
        "x": np.round(angles_deg[places], 4).tolist(),
        "lines": [
            {"role": str(line.role), "label": line.label, "y": np.round(line.values[places], decimals).tolist()}
            for line in chart.lines
        ],
    }


def _thinned(angles_deg: Array) -> IndexArray:
    """The numbers of some samples; both ends and both sides of every jump stay."""
    step = max(1, len(angles_deg) // LIVE_POINTS)
    jumps = np.nonzero(np.diff(angles_deg) < 1e-6)[0]
    return distinct(np.concatenate([np.arange(0, len(angles_deg), step), jumps, jumps + 1, [len(angles_deg) - 1]]))
