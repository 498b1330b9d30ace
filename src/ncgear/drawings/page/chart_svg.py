"""A chart drawn as an SVG element that takes its colours from the page, and where its data lie in it.

A chart as it stands on the page: its drawing, its cursor, and its extreme values in words.
"""

from __future__ import annotations

import re
from collections.abc import Callable
from dataclasses import dataclass
from io import StringIO
from typing import Any

import matplotlib as mpl
import numpy as np
from markupsafe import Markup
from matplotlib.axes import Axes
from matplotlib.backends.backend_svg import FigureCanvasSVG
from matplotlib.figure import Figure
from matplotlib.ticker import MaxNLocator, MultipleLocator

from ncgear.drawings.page.charts import OTHER, OWN, UNIFORM, Chart, Line
from ncgear.drawings.plots.canvas import mark_joints

WIDTH, HEIGHT = 430.0, 190.0
"""Size of a chart in SVG units, which are CSS pixels where it is not scaled."""

MARGINS = {"left": 46.0 / WIDTH, "right": 1.0 - 12.0 / WIDTH, "bottom": 38.0 / HEIGHT, "top": 1.0 - 16.0 / HEIGHT}

POINTS_PER_INCH = 72
"""What matplotlib reckons with in SVG, so that its display coordinates are SVG units."""

TEXT_SIZE = 11.0

COLORS = {
    "#a10001": "var(--driving)",
    "#a10002": "var(--driven)",
    "#a10003": "var(--uniform)",
    "#a10004": "var(--ink)",
    "#a10005": "var(--grid)",
    "#8a8a8a": "var(--joint)",
}
"""Colours that stand for those of the page, which differ in light, dark and print."""

OWN_COLOR, OTHER_COLOR, UNIFORM_COLOR, INK, GRID = list(COLORS)[:5]

STYLES: dict[str, dict[str, Any]] = {
    OWN: {"color": OWN_COLOR, "linewidth": 2.0, "zorder": 3.0},
    OTHER: {"color": OTHER_COLOR, "linewidth": 1.2, "zorder": 2.5},
    UNIFORM: {"color": UNIFORM_COLOR, "linewidth": 1.3, "linestyle": (0, (5, 2.5)), "zorder": 3.5},
}

SETTINGS: dict[Any, Any] = {
    "svg.fonttype": "none",
    "svg.hashsalt": "ncgear",
    "path.simplify": True,
    "path.simplify_threshold": 0.1,
}
"""Text stays text, names of clip paths depend on the picture alone, and points that cannot be seen are left out."""

NO_METADATA = dict.fromkeys(("Date", "Creator", "Format", "Type"))


@dataclass(frozen=True)
class Drawn:
    """An SVG element, and the places of the angle's ends and of the quantity's in it, in its own units."""

    svg: str
    angle_deg: tuple[float, float]
    x: tuple[float, float]
    values: tuple[float, float]
    y: tuple[float, float]


def drawn(chart: Chart) -> Drawn:
    """The chart; the same chart gives the same text."""
    with mpl.rc_context(SETTINGS):
        made = Figure(figsize=(WIDTH / POINTS_PER_INCH, HEIGHT / POINTS_PER_INCH), dpi=POINTS_PER_INCH)
        FigureCanvasSVG(made)
        axes = made.subplots(gridspec_kw=MARGINS)
        _draw(axes, chart)
        text = StringIO()
        made.savefig(text, format="svg", metadata=NO_METADATA)
        (left, right), (low, high) = axes.get_xlim(), axes.get_ylim()
        corners = axes.transData.transform([(left, low), (right, high)])
    (x0, y0), (x1, y1) = corners.tolist()
    svg = for_page(text.getvalue(), chart.key)
    return Drawn(svg, (left, right), (x0, x1), (low, high), (HEIGHT - y0, HEIGHT - y1))


def _draw(axes: Axes, chart: Chart) -> None:
    for line in chart.lines:
        axes.plot(*_repeated(line, chart.end_deg), **STYLES[line.role])
    mark_joints(axes, chart.joints_deg)
    axes.set_xlim(0.0, chart.end_deg)
    axes.margins(y=0.08)
    _dress(axes, chart)


def _repeated(line: Line, end_deg: float) -> tuple[np.ndarray, np.ndarray]:
    """The line, which may be shorter than the chart, as often as it fits."""
    starts = np.arange(round(end_deg / line.period_deg)) * line.period_deg
    return (starts[:, None] + line.angle_deg).ravel(), np.tile(line.values, starts.size)


def _dress(axes: Axes, chart: Chart) -> None:
    axes.patch.set_visible(False)
    axes.figure.patch.set_visible(False)
    axes.xaxis.set_major_locator(MultipleLocator(60.0 * max(round(chart.end_deg / 360.0), 1)))
    axes.yaxis.set_major_locator(MaxNLocator(5, min_n_ticks=3))
    axes.tick_params(labelsize=TEXT_SIZE, labelcolor=INK, color=UNIFORM_COLOR, length=3.0)
    axes.set_xlabel(chart.angle_name, size=TEXT_SIZE, color=INK)
    axes.set_title(chart.unit, size=TEXT_SIZE, color=INK, loc="left", pad=4.0, x=-34.0 / WIDTH)
    axes.grid(True, color=GRID, linewidth=0.8)
    axes.set_axisbelow(True)
    for name, spine in axes.spines.items():
        spine.set_visible(name in ("left", "bottom"))
        spine.set_color(UNIFORM_COLOR)


def for_page(document: str, key: str) -> str:
    """The ``svg`` element of a document: colours of the page, its fonts, and no name that another element may have.

    Without a name space: within HTML there is none to be told, and nothing then looks like an address.
    """
    steps: list[Callable[[str], str]] = [
        lambda text: text[text.index("<svg") :],
        lambda text: re.sub(r"<style.*?</style>", "", text, flags=re.DOTALL),
        lambda text: re.sub(r' xmlns(:\w+)?="[^"]*"', "", text).replace("xlink:href", "href"),
        lambda text: re.sub(r'<svg width="[^"]*" height="[^"]*"', '<svg aria-hidden="true" focusable="false"', text),
        lambda text: re.sub(r"font-family: [^;\"]*;? ?", "", text),
        lambda text: re.sub(r"\s*\n\s*", " ", text).replace("> <", "><"),
        _with_colors,
        lambda text: _with_own_names(text, key),
    ]
    for step in steps:
        document = step(document)
    return document.strip()


def _with_colors(text: str) -> str:
    for color, variable in COLORS.items():
        text = text.replace(color, variable)
    return text


def _with_own_names(text: str, key: str) -> str:
    """Only what is referred to keeps its name, with the chart's key before it."""
    referred = set(re.findall(r'(?:url\(|href=")#([\w.-]+)', text))
    text = re.sub(r' id="([\w.-]+)"', lambda found: f' id="{key}-{found[1]}"' if found[1] in referred else "", text)
    return re.sub(r'((?:url\(|href=")#)', rf"\g<1>{key}-", text)


END = "</svg>"


@dataclass(frozen=True)
class ChartFigure:
    """A chart, its drawing, and the markup of both drawing and cursor."""

    chart: Chart
    drawing: Drawn

    @property
    def svg(self) -> Markup:
        """The drawing with a line and a dot for each of its lines, which the page's script puts in their places.

        The drawing is made of numbers and of words of this package only.
        """
        first = self.drawing.svg.removesuffix(END)
        places = reversed(list(enumerate(self.chart.lines)))
        dots = "".join(f'<circle class="{line.role}" data-line="{place}" r="3.6"/>' for place, line in places)
        low, high = self.drawing.y
        return Markup(f'{first}<g class="cursor"><line y1="{low:g}" y2="{high:g}"/>{dots}</g>{END}')

    @property
    def own(self) -> int:
        """Place of this design's line among the chart's."""
        return [line.role for line in self.chart.lines].index(OWN)

    @property
    def uniform(self) -> int | None:
        """Place of the uniform crank's line; None where there is none."""
        roles = [line.role for line in self.chart.lines]
        return roles.index(UNIFORM) if UNIFORM in roles else None

    @property
    def extremes(self) -> str:
        """Least and greatest value of this design's line and where they are."""
        line = self.chart.lines[self.own]
        places, decimals = (int(np.argmin(line.values)), int(np.argmax(line.values))), self.chart.decimals
        texts = [f"{line.values[place]:.{decimals}f} at {line.angle_deg[place]:.0f}\u00b0" for place in places]
        return " to ".join(texts).replace("-", "\u2212")


def figure(chart: Chart) -> ChartFigure:
    """The chart, drawn."""
    return ChartFigure(chart, drawn(chart))
