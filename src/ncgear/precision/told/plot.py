"""Time against error of a study's methods."""

from __future__ import annotations

from collections.abc import Sequence
from itertools import cycle
from textwrap import fill

from matplotlib.axes import Axes

from ncgear.drawings.plots.canvas import DRIVEN, DRIVING, HIGHLIGHT, INK, REFERENCE, SMALL, Margins, dress, figure, png
from ncgear.precision.rates import least_error
from ncgear.precision.study import Measured, Point

WIDTH_IN, HEIGHT_IN = 8.2, 4.4
KEY_IN = 2.45
"""Room for the key beside the axes."""

LINE = 42
"""Letters that fit along the scale of errors."""

COLORS = (DRIVING, DRIVEN, HIGHLIGHT, "#009E73", "#E69F00", "#56B4E9", REFERENCE)
MARKERS = ("o", "s", "D", "^", "v", "P", "X")
"""Told apart by form as well as by colour."""


def speed_against_error(found: Measured) -> bytes:
    """PNG with both scales logarithmic, one line per method, and a ring around the point that ncgear works at."""
    made = figure(WIDTH_IN, HEIGHT_IN, found.study.title)
    made.subplots_adjust(**Margins(left=1.0, right=KEY_IN, top=0.45).shares(WIDTH_IN, HEIGHT_IN))
    axes = made.add_subplot()
    # A scale of logarithms has no zero: what has no error at all stands below the least one.
    foot = (least_error(found) or 1.0) / 3.0
    styles = zip(cycle(COLORS), cycle(MARKERS))
    for method, row, (color, marker) in zip(found.study.methods, found.points, styles, strict=False):
        axes.plot(*_scaled(row, foot), color=color, marker=marker, markersize=4.5, linewidth=1.3, label=method.name)
    _ring(axes, found.chosen[1], foot)
    axes.set(xscale="log", yscale="log")
    dress(axes, "time in ms", fill(f"error ({found.study.unit})", LINE))
    axes.legend(loc="upper left", bbox_to_anchor=(1.01, 1.0), frameon=False, fontsize=SMALL, borderaxespad=0.0)
    return png(made)


def _ring(axes: Axes, chosen: Point, foot: float) -> None:
    axes.plot(
        *_scaled([chosen], foot),
        marker="o",
        markersize=13.0,
        markerfacecolor="none",
        markeredgecolor=INK,
        markeredgewidth=1.4,
        linestyle="none",
        zorder=5,
        label="what ncgear does",
    )


def _scaled(points: Sequence[Point], foot: float) -> tuple[list[float], list[float]]:
    """Milliseconds and errors."""
    return [1000.0 * point.seconds for point in points], [max(point.error, foot) for point in points]
