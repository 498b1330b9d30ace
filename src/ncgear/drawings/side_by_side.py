"""Designs side by side as lines of one chart: displacement, velocity, acceleration and power over the driving angle."""

from __future__ import annotations

from collections.abc import Sequence

from matplotlib.axes import Axes

from ncgear.drawings.charts.drawer import COLUMN_IN, DASHED, MOTION_COLUMN, align, angle_scale
from ncgear.drawings.charts.slider_charts import Quantity, motion_chart
from ncgear.drawings.plots.canvas import DRIVEN, DRIVING, HIGHLIGHT, REFERENCE, Margins, Style, dress, figure, png
from ncgear.figures.side_by_side import SideBySide
from ncgear.project.drive import Drive

CHARTS = (Quantity.DISPLACEMENT, Quantity.VELOCITY, Quantity.ACCELERATION, Quantity.POWER)

STYLES: tuple[Style, ...] = tuple(
    {"color": color, "linewidth": 1.5, "linestyle": dashes}
    for dashes in ("-", DASHED)
    for color in (DRIVING, DRIVEN, HIGHLIGHT, REFERENCE)
)
"""One for each design."""


def drawn_together(drives: Sequence[Drive]) -> list[Drive]:
    """The drives whose output moves as that of the first: one that turns has no place on a scale in mm."""
    return [drive for drive in drives if drive.linkage.OUTPUT.angular == drives[0].linkage.OUTPUT.angular]


def draw_side_by_side(axes: Axes, drives: Sequence[Drive], quantity: Quantity) -> float:
    """Draw a quantity of several drives onto axes; returns where the longest cycle ends, in degrees."""
    end, label = 0.0, ""
    for drive, style in zip(drawn_together(drives), STYLES, strict=False):
        chart = motion_chart(quantity, drive.linkage, drive.motion)
        axes.plot(chart.own.x, chart.own.values, label=drive.design.name, **style)
        end, label = max(end, chart.end), label or f"{quantity.name_of(drive.linkage.OUTPUT)}\nin {chart.unit}"
    dress(axes, "", label)
    return end


def side_by_side_png(found: SideBySide) -> bytes:
    """All charts below one another."""
    size = COLUMN_IN, MOTION_COLUMN.row_in * len(CHARTS) + MOTION_COLUMN.rest_in
    made = figure(*size, "")
    spaces = {**Margins(left=MOTION_COLUMN.left_in).shares(*size), "hspace": MOTION_COLUMN.gap}
    column = list(made.subplots(len(CHARTS), 1, sharex=True, gridspec_kw=spaces))
    ends = [draw_side_by_side(axes, found.drives, chart) for axes, chart in zip(column, CHARTS, strict=True)]
    angle_scale(column, ends[0])
    align(column, COLUMN_IN)
    return png(made)
