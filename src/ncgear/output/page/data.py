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


def page_data(scene: Scene, charts: Sequence[Chart], drawings: Sequence[Drawn]) -> dict[str, Any]:
    """All that moves; raises ValueError as the charts do."""
    grids = _Grids()
    shown = [_chart(chart, drawing, grids) for chart, drawing in zip(charts, drawings, strict=True)]
    return {
        "cycle_deg": degrees(scene.loop_rad),
        "scene": scene_data(scene),
        "grids": grids.found,
        "charts": shown,
    }


def _chart(chart: Chart, drawing: Drawn, grids: _Grids) -> dict[str, Any]:
    return {
        "key": chart.key,
        "angle": chart.angle,
        "decimals": chart.decimals,
        "angle_deg": drawing.angle_deg,
        "x": drawing.x,
        "values": drawing.values,
        "y": drawing.y,
        "lines": [_line(line, chart.decimals + MORE_DECIMALS, grids) for line in chart.lines],
    }


def _line(line: Line, decimals: int, grids: _Grids) -> dict[str, Any]:
    return {"grid": grids.number(line), "values": _rounded(line.values, decimals)}


class _Grids:
    """The angles of all lines, each set of them once."""

    def __init__(self) -> None:
        self.found: list[dict[str, Any]] = []
        self._numbers: dict[bytes, int] = {}

    def number(self, line: Line) -> int:
        """Place of the line's angles among all."""
        content = line.angle_deg.tobytes()
        if content not in self._numbers:
            self._numbers[content] = len(self.found)
            deg = _rounded(line.angle_deg, ANGLE_DECIMALS)
            self.found.append({"period_deg": line.period_deg, "deg": deg})
        return self._numbers[content]


def _rounded(values: Array, decimals: int) -> list[float]:
    rounded: list[float] = np.round(values, decimals).tolist()
    return rounded
