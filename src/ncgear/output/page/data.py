"""What the page's script gets to know, as plain values for JSON: the law, and the lines of the charts."""

from __future__ import annotations

from collections.abc import Sequence
from math import degrees
from typing import Any

import numpy as np

from ncgear.drive import Drive
from ncgear.numerics.arrays import Array
from ncgear.numerics.units import RAD_S_PER_RPM
from ncgear.output.joints import joints_up_to
from ncgear.output.page.chart import Chart, Line
from ncgear.output.page.motion_charts import turns_of
from ncgear.output.page.sampling import split_angles
from ncgear.output.page.svg import Drawn
from ncgear.ratio.transmission import Transmission

ANGLE_DECIMALS = 10
"""Of angles in degrees: far below the 1e-6 rad to which the page shows the driven angle."""

MORE_DECIMALS = 3
"""Decimals of the tables beyond those that are shown."""


def page_data(drive: Drive, charts: Sequence[Chart], drawings: Sequence[Drawn]) -> dict[str, Any]:
    """All that moves; raises ValueError as the charts do."""
    grids = _Grids()
    shown = [_chart(chart, drawing, grids) for chart, drawing in zip(charts, drawings, strict=True)]
    return {
        "cycle_deg": 360.0 * turns_of(drive.transmission.lobes),
        "speed_deg_s": degrees(drive.design.operation.speed_rpm * RAD_S_PER_RPM),
        "law": _law(drive.transmission),
        "between": _law(drive.by_stage[0].pair.transmission) if len(drive.by_stage) > 1 else None,
        "grids": grids.found,
        "charts": shown,
    }


def _law(transmission: Transmission) -> dict[str, Any]:
    """phi2 over one cycle of the slider with its slope, from which the page interpolates by cubic Hermite pieces."""
    cycle = transmission.cycle_rad
    angle = split_angles(cycle, joints_up_to(transmission, cycle).tolist())
    driven = transmission.driven_angle(angle, 1)
    return {
        "period_deg": degrees(cycle),
        "driven_period_deg": 360.0,
        "deg": _rounded(np.degrees(angle), ANGLE_DECIMALS),
        "driven_deg": _rounded(np.degrees(driven.value), ANGLE_DECIMALS),
        "slope": _rounded(driven.derivative(1), ANGLE_DECIMALS),
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
