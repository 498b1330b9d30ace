"""Charts on axes of matplotlib, in a look that the caller chooses, and columns of charts as PNG."""

from __future__ import annotations

from collections.abc import Callable, Mapping, Sequence

import numpy as np
from matplotlib.axes import Axes

from ncgear.drawings.charts.chart import DRIVING_ANGLE, Chart, ChartLine, Role
from ncgear.drawings.plots import canvas
from ncgear.drawings.plots.canvas import Style
from ncgear.figures.numbers import fixed, to_digits
from ncgear.frozen import dataclass
from ncgear.numerics.arrays import Array

DASHED = (0, (5, 2.5))


@dataclass(frozen=True)
class Look:
    """The way in which charts are drawn: the style of each role, and a function that finishes the axes.

    ``label_break`` separates a quantity and its unit at the vertical axis.  Where ``marks_extremes`` is false, no
    largest value is named, even if the chart asks for it.  ``finish`` gets the axes, the chart and its vertical label.
    """

    styles: Mapping[Role, Style]
    label_break: str = " "
    marks_extremes: bool = True
    finish: Callable[[Axes, Chart, str], None] = lambda axes, _, label: canvas.dress(axes, "", label)

    def label(self, chart: Chart) -> str:
        """The label of the vertical axis."""
        return chart.axis_label or f"{chart.name}{self.label_break}in {chart.unit}"


MOTION_LINES: dict[Role, Style] = {
    Role.OWN: {"color": canvas.DRIVING, "linewidth": 2.0},
    # The uniform crank is drawn on top: where the two agree, both show.
    Role.UNIFORM: {"color": canvas.REFERENCE, "linewidth": 1.2, "linestyle": DASHED},
    Role.MEAN: {"color": canvas.INK, "linewidth": 0.9, "linestyle": (0, (1.5, 1.5))},
}

MOTION_LOOK = Look(MOTION_LINES)
LOAD_LOOK = Look(MOTION_LINES, label_break="\n")
TIME_LOOK = Look(
    {
        Role.OWN: {"color": canvas.DRIVING, "linewidth": 1.6},
        Role.UNIFORM: {"color": canvas.REFERENCE, "linewidth": 1.1, "linestyle": DASHED},
    },
    label_break="\n",
)
CONTACT_LOOK = Look(
    {
        Role.OWN: {"color": canvas.DRIVING, "linewidth": 1.6},
        Role.OTHER: {"color": canvas.REFERENCE, "linewidth": 1.1},
        Role.WRITTEN: {"color": canvas.HIGHLIGHT, "linewidth": 0.8, "zorder": 1.9},
    },
    label_break="\n",
)


def _dress_with_legend(axes: Axes, _: Chart, label: str) -> None:
    canvas.dress(axes, "", label)
    canvas.legend_above(axes)


STRENGTH_LOOK = Look(
    {
        Role.OWN: {"color": canvas.DRIVING, "linewidth": 1.4},
        Role.OTHER: {"color": canvas.DRIVEN, "linewidth": 1.1},
        Role.LIMIT: {"color": canvas.INK, "linewidth": 1.0, "linestyle": (0, (1.5, 1.5))},
    },
    label_break="\n",
    # The lines of each chart have names of their own.
    finish=_dress_with_legend,
)

AT_JOINTS: Style = {"color": canvas.JOINT, "linewidth": 0.8, "linestyle": (0, (1.5, 2.5)), "zorder": 0.8}
APART: Style = {"color": canvas.HIGHLIGHT, "alpha": 0.25, "linewidth": 0.0}

MOST_JOINTS = 12
"""Most joints that are marked; the marks of more, for example of a table, would look like a grid."""


def draw(axes: Axes, chart: Chart, look: Look) -> None:
    """Draw a chart with its joints and stretches without contact, and name its largest value if the chart asks for it.

    The caller sets the limits of the horizontal axis and the legend with ``angle_scale``.
    """
    steps: Style = {"drawstyle": "steps-mid"} if chart.counts else {}
    for line in chart.lines:
        x, values = _repeated(line, chart)
        axes.plot(x, values, label=line.label, **look.styles[line.role], **steps)
    if chart.joints_deg.size <= MOST_JOINTS:
        for number, joint in enumerate(chart.joints_deg):
            axes.axvline(joint, label=None if number else "joints of the law", **AT_JOINTS)
    if chart.apart_deg.size:
        spans = [(start, end - start) for start, end in chart.apart_deg]
        whole = axes.get_xaxis_transform()
        axes.broken_barh(spans, (0.0, 1.0), transform=whole, label="pushing flanks apart", **APART)
    if chart.counts:
        most = int(max(line.values.max() for line in chart.lines))
        axes.set_yticks(range(most + 1))
        axes.set_ylim(-0.2, most + 0.2)
    look.finish(axes, chart, look.label(chart))
    idle = not chart.own.values.any()
    if look.marks_extremes and (chart.names_extreme or idle):
        axes.set_xlim(0.0, chart.end)
        mark_extreme(axes, chart.own, chart.unit)


def _repeated(line: ChartLine, chart: Chart) -> tuple[Array, Array]:
    """Places and values of a line, repeated as often as its period fits into the chart."""
    if chart.period is None:
        return line.x, line.values
    starts = np.arange(round(chart.end / chart.period)) * chart.period
    return (starts[:, None] + line.x).ravel(), np.tile(line.values, starts.size)


def mark_extreme(axes: Axes, line: ChartLine, unit: str) -> None:
    """Mark and name the value largest in size, beside the point and clear of all curves where there is room.

    The axes have their horizontal limits and all their curves already.  Where all values are 0, the axes say so.
    """
    place = int(np.argmax(np.abs(line.values)))
    x, y = float(line.x[place]), float(line.values[place])
    if y == 0.0:
        axes.set_ylim(0.0, 1.0)
        axes.text(
            0.5, 0.5, "zero throughout", transform=axes.transAxes, size=canvas.NORMAL, color=canvas.INK, ha="center"
        )
        return
    axes.margins(y=0.16)
    axes.autoscale_view(scalex=False)
    # Marks of joints have no points to read
    curves = [line for line in axes.lines if line.get_color() != canvas.JOINT and np.size(line.get_xdata()) > 0]
    axes.plot(x, y, "o", color=canvas.DRIVING, markersize=4.5)
    text = f"{to_digits(y, 4)} {unit} at {fixed(x, 0)}\u00b0".replace("-", "\u2212")
    note = axes.annotate(
        text, (x, y), xytext=(0.0, 0.0), textcoords="offset points", size=canvas.SMALL, color=canvas.INK
    )
    # If no place is clear, the note covers a curve with white: a line through digits would change the number.
    note.set_bbox({"facecolor": axes.get_facecolor(), "edgecolor": "none", "alpha": 0.85, "pad": 0.8})
    note.set_zorder(5.0)
    up = 1.0 if y > 0.0 else -1.0
    canvas.place_note(axes, note, [(across, along, up * away) for across, along, away in NOTE_PLACES], curves)


NOTE_PLACES = (
    ("center", 0.0, 5.0),
    *(
        (side, sign * along, 5.0)
        for along in (-2.0, 12.0, 26.0, 40.0)
        for side, sign in (("left", 1.0), ("right", -1.0))
    ),
    ("left", 9.0, 0.0),
    ("right", -9.0, 0.0),
    ("left", 9.0, -9.0),
    ("right", -9.0, -9.0),
    ("center", 0.0, -18.0),
)
"""Places of a note about a highest point, the best first: its alignment with the point, and the distances in points
from the point along the axis and upwards.  For a lowest point, upwards becomes downwards."""


def angle_scale(column: Sequence[Axes], end_deg: float) -> None:
    """Draw the scale in degrees below the lowest axes, and the legend above the highest."""
    # A cycle of n turns of the driving gear has marks n times as far apart.
    step = 45 * max(round(end_deg / 360.0), 1)
    column[-1].set_xticks(np.arange(0.0, end_deg + 1.0, step))
    across_scale(column, end_deg, DRIVING_ANGLE)


def across_scale(column: Sequence[Axes], end: float, label: str) -> None:
    """Draw the scale below the lowest axes, and the legend above the highest."""
    column[-1].set_xlim(0.0, end)
    column[-1].set_xlabel(label, size=canvas.NORMAL, color=canvas.INK)
    canvas.legend_above(column[0])


def align(column: Sequence[Axes], width_in: float) -> None:
    """Make the labels of the vertical scales, of one line or two, end at the same place in all rows."""
    for axes in column:
        axes.yaxis.set_label_coords(-0.55 / (width_in * axes.get_position().width), 0.5)


@dataclass(frozen=True)
class ColumnSizes:
    """Sizes in inches of a column of charts: height of a row, height of the rest, and room for vertical labels.

    ``gap`` is the space between rows as a share of their height.
    """

    row_in: float
    rest_in: float
    left_in: float
    gap: float


COLUMN_IN = 8.2
"""Width in inches of a picture of charts below one another."""

MOTION_COLUMN = ColumnSizes(row_in=2.0, rest_in=1.2, left_in=0.85, gap=0.12)
SIMULATION_COLUMN = ColumnSizes(row_in=1.9, rest_in=1.4, left_in=1.0, gap=0.14)
CONTACT_COLUMN = ColumnSizes(row_in=1.5, rest_in=1.3, left_in=1.0, gap=0.16)
STRENGTH_COLUMN = ColumnSizes(row_in=2.2, rest_in=1.4, left_in=1.0, gap=0.22)


def column_png(charts: Sequence[Chart], title: str, look: Look, sizes: ColumnSizes) -> bytes:
    """PNG of charts below one another over the same driving angle or speed, with one legend above them."""
    size = COLUMN_IN, sizes.row_in * len(charts) + sizes.rest_in
    made = canvas.figure(*size, title)
    spaces = {**canvas.Margins(left=sizes.left_in).shares(*size), "hspace": sizes.gap}
    column = list(made.subplots(len(charts), 1, sharex=True, squeeze=False, gridspec_kw=spaces)[:, 0])
    for axes, chart in zip(column, charts, strict=True):
        draw(axes, chart, look)
    if charts[0].across == DRIVING_ANGLE:
        angle_scale(column, charts[0].end)
    else:
        across_scale(column, charts[0].end, charts[0].across)
    align(column, COLUMN_IN)
    return canvas.png(made)


def beside_png(pairs: Sequence[tuple[Chart, Chart]], title: str) -> bytes:
    """PNG with a row for each pair of charts, the left one over the driving angle, the right one over displacement."""
    size = 10.2, 5.6
    made = canvas.figure(*size, title)
    spaces = {**canvas.Margins().shares(*size), "hspace": 0.12, "wspace": 0.06}
    grid = made.subplots(len(pairs), 2, sharex="col", sharey="row", squeeze=False, gridspec_kw=spaces)
    left = list(grid[:, 0])
    for row, pair in zip(grid, pairs, strict=True):
        for axes, chart in zip(row, pair, strict=True):
            draw(axes, chart, MOTION_LOOK)
        # Both have one vertical scale, on which the left chart has made room for its note.
        row[1].margins(y=row[0].margins()[1])
        row[1].set_ylabel("")
    angle_scale(left, pairs[0][0].end)
    align(left, size[0])
    grid[-1, 1].set_xlabel(pairs[-1][1].across, size=canvas.NORMAL, color=canvas.INK)
    return canvas.png(made)
