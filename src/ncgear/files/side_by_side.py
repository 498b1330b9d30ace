"""Designs side by side as files: their figures, a table of them, and their motions as lines of the same charts."""

from __future__ import annotations

from matplotlib.axes import Axes

from ncgear.drawings.charts.chart import Quantity, motion_chart
from ncgear.drawings.charts.drawer import COLUMN_IN, CONTACT_COLUMN, DASHED, align, angle_scale
from ncgear.drawings.plots import canvas
from ncgear.drawings.plots.canvas import Style
from ncgear.figures.numbers import json_text
from ncgear.figures.side_by_side import SideBySide, side_by_side_columns, side_by_side_figures
from ncgear.figures.tables import rows_text

CHARTS = (Quantity.DISPLACEMENT, Quantity.VELOCITY, Quantity.ACCELERATION, Quantity.POWER)

STYLES: tuple[Style, ...] = tuple(
    {"color": color, "linewidth": 1.5, "linestyle": dashes}
    for dashes in ("-", DASHED)
    for color in (canvas.DRIVING, canvas.DRIVEN, canvas.HIGHLIGHT, canvas.REFERENCE)
)
"""A line style for each design."""

IN_A_LINE, LINE_IN = 4, 0.2
"""Names in a line of the legend, and the height of a line in inches."""


def draw_side_by_side(axes: Axes, found: SideBySide, quantity: Quantity) -> float:
    """Draw a quantity of several designs onto axes; returns where the longest cycle ends, in degrees.

    It draws only designs whose output is of the first design's kind: a turning output has no place on a scale in mm.
    """
    end, label = 0.0, ""
    angular = found.drives[0].linkage.OUTPUT.angular
    for name, drive, style in zip(found.names, found.drives, STYLES, strict=False):
        if drive.linkage.OUTPUT.angular is not angular:
            continue
        chart = motion_chart(quantity, drive.linkage, drive.motion)
        axes.plot(chart.own.x, chart.own.values, label=name, **style)
        end, label = max(end, chart.end), label or f"{quantity.name_of(drive.linkage.OUTPUT)}\nin {chart.unit}"
    canvas.dress(axes, "", label)
    return end


def side_by_side_png(found: SideBySide) -> bytes:
    """PNG of all charts below one another; power is drawn only where a design has a load."""
    drives = found.drives
    charts = CHARTS if any(drive.motion.driving_power_w.any() for drive in drives) else CHARTS[:-1]
    lines = -(-len(drives) // IN_A_LINE)
    top = canvas.Margins().top + LINE_IN * (lines - 1)
    size = COLUMN_IN, CONTACT_COLUMN.row_in * 1.3 * len(charts) + CONTACT_COLUMN.rest_in + LINE_IN * (lines - 1)
    made = canvas.figure(*size, "side by side")
    spaces = {**canvas.Margins(left=CONTACT_COLUMN.left_in, top=top).shares(*size), "hspace": CONTACT_COLUMN.gap}
    column = list(made.subplots(len(charts), 1, sharex=True, gridspec_kw=spaces))
    ends = [draw_side_by_side(axes, found, chart) for axes, chart in zip(column, charts, strict=True)]
    angle_scale(column, ends[0])
    canvas.legend_above(column[0], IN_A_LINE)
    align(column, COLUMN_IN)
    return canvas.png(made)


def side_by_side_files(found: SideBySide) -> dict[str, bytes]:
    """The files by their names."""
    return {
        "compare.json": json_text(side_by_side_figures(found)).encode(),
        "compare.csv": rows_text(*side_by_side_columns(found)).encode(),
        "compare.png": side_by_side_png(found),
    }
