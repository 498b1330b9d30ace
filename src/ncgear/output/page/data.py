"""What the page's script gets to know, as plain values for JSON: the scene, and the lines of the charts."""

from __future__ import annotations

from collections.abc import Sequence
from math import degrees
from typing import Any

import numpy as np

from ncgear.numerics.arrays import Array
from ncgear.output.page.chart import Chart, Line
from ncgear.output.page.scene_data import scene_data
from ncgear.output.page.svg import Drawn
from ncgear.scene.scene import Scene

ANGLE_DECIMALS = 9
"""Of angles in degrees: a sixtieth of the distance by which samples stand aside of a jump."""

MORE_DECIMALS = 3
"""Decimals of the tables beyond those that are shown."""


Numbers = dict[tuple[bytes, float], int]
"""Places of all sets of angles, with the period of each, in the order in which they first occur."""


def page_data(scene: Scene, charts: Sequence[Chart], drawings: Sequence[Drawn]) -> dict[str, Any]:
    """All that moves, every set of angles once; raises ValueError as the charts do."""
    grids = {_angles(line): line for chart in charts for line in chart.lines}
    numbers = {angles: number for number, angles in enumerate(grids)}
    return {
        "cycle_deg": degrees(scene.loop_rad),
        "scene": scene_data(scene),
        "grids": [_grid(line) for line in grids.values()],
        "charts": [_chart(chart, drawing, numbers) for chart, drawing in zip(charts, drawings, strict=True)],
    }


def _angles(line: Line) -> tuple[bytes, float]:
    return line.angle_deg.tobytes(), line.period_deg


def _grid(line: Line) -> dict[str, Any]:
    return {"period_deg": line.period_deg, "deg": _rounded(line.angle_deg, ANGLE_DECIMALS)}


def _chart(chart: Chart, drawing: Drawn, numbers: Numbers) -> dict[str, Any]:
    return {
        "key": chart.key,
        "angle": chart.angle,
        "decimals": chart.decimals,
        "angle_deg": drawing.angle_deg,
        "x": drawing.x,
        "values": drawing.values,
        "y": drawing.y,
        "lines": [
            {"grid": numbers[_angles(line)], "values": _rounded(line.values, chart.decimals + MORE_DECIMALS)}
            for line in chart.lines
        ],
    }


def _rounded(values: Array, decimals: int) -> list[float]:
    rounded: list[float] = np.round(values, decimals).tolist()
    return rounded
