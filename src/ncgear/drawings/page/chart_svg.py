"""Draws a chart of the page: an SVG element in the colours of the page.

Matplotlib draws the chart, as it does for every picture.  Its SVG then loses its own fonts, sizes and names, and its
colours become variables of the page's style sheet, which differ in light, dark and print.
"""

from __future__ import annotations

import re
from collections.abc import Sequence
from io import StringIO
from typing import Any

import matplotlib as mpl
from matplotlib.axes import Axes
from matplotlib.backends.backend_svg import FigureCanvasSVG
from matplotlib.figure import Figure
from matplotlib.ticker import MaxNLocator, MultipleLocator

from ncgear.drawings.charts.chart import Chart, Role
from ncgear.drawings.charts.drawer import DASHED, Look, draw
from ncgear.drawings.page.chart_figure import DRIVING, ChartFigure, PageChart
from ncgear.drawings.plots.canvas import JOINT

Size = tuple[float, float]
"""Width and height of a chart in SVG units, which are CSS pixels where it is not scaled."""

OF_REPORT: Size = (330.0, 170.0)
"""Size of a chart on the narrowest page, a phone's, with text of 11 pixels; on wider pages it grows."""

POINTS_PER_INCH = 72
"""The resolution of matplotlib's SVG files: with it, display coordinates are SVG units."""

TEXT_SIZE = 11.0

MINUS = "\u2212"

DIGIT_WIDTH, WIDTHS = 0.64, {MINUS: 0.84, "+": 0.84, ".": 0.32}
"""Widths of the letters of a number as shares of the size of text, from DejaVu Sans and Verdana: no usual font of pages
is wider."""

NUMBERS_OFF = 8.0
"""Gap between a vertical scale and its numbers: room for half of a dragged point (``handles.js``)."""

BESIDE_NUMBERS, LEAST_LEFT, LEAST_RIGHT = NUMBERS_OFF + 6.0, 46.0, 12.0
"""Widths of a gap, a tick and an edge beside a number, and least widths beside a chart: most charts are alike."""

OWN_COLOR, UNIFORM_COLOR, INK, GRID, WRITTEN_COLOR = (f"#a1000{number}" for number in range(1, 6))

COLORS = {
    OWN_COLOR: "var(--driving)",
    UNIFORM_COLOR: "var(--uniform)",
    INK: "var(--ink)",
    GRID: "var(--grid)",
    WRITTEN_COLOR: "var(--highlight)",
    JOINT: "var(--joint)",
}
"""Colours that stand for the colours of the page while matplotlib draws; the last colour is for joints."""

SETTINGS: dict[Any, Any] = {
    "svg.fonttype": "none",
    "svg.hashsalt": "ncgear",
    "path.simplify": True,
    "path.simplify_threshold": 0.1,
}
"""Text stays text, names of clip paths depend on the picture alone, and points that nobody can see are left out."""

NO_METADATA = dict.fromkeys(("Date", "Creator", "Format", "Type"))


def _dress(axes: Axes, chart: Chart, _: str) -> None:
    """Put few numbers, a faint grid, and no frame on sides without a scale; the unit is in the chart's heading."""
    axes.set_xlim(0.0, chart.end)
    axes.margins(y=0.08)
    axes.patch.set_visible(False)
    axes.figure.patch.set_visible(False)
    axes.xaxis.set_major_locator(MultipleLocator(60.0 * max(round(chart.end / 360.0), 1)))
    axes.yaxis.set_major_locator(MaxNLocator(5, min_n_ticks=3))
    axes.tick_params(labelsize=TEXT_SIZE, labelcolor=INK, color=UNIFORM_COLOR, length=3.0)
    # In full: a power of ten by itself above the scale would lie over its highest number.
    axes.yaxis.set_major_formatter(lambda value, _: f"{value + 0.0:.12g}".replace("-", MINUS))
    axes.tick_params(axis="y", pad=NUMBERS_OFF)
    axes.grid(True, color=GRID, linewidth=0.8)
    axes.set_axisbelow(True)
    for name, spine in axes.spines.items():
        spine.set_visible(name in ("left", "bottom"))
        spine.set_color(UNIFORM_COLOR)


PAGE_LOOK = Look(
    {
        Role.OWN: {"color": OWN_COLOR, "linewidth": 2.0, "zorder": 3.0},
        Role.OTHER: {"color": UNIFORM_COLOR, "linewidth": 1.2, "zorder": 2.5},
        Role.WRITTEN: {"color": WRITTEN_COLOR, "linewidth": 1.2, "zorder": 2.5},
        Role.LIMIT: {"color": INK, "linewidth": 1.0, "linestyle": (0, (1.5, 1.5)), "zorder": 2.4},
        Role.UNIFORM: {"color": UNIFORM_COLOR, "linewidth": 1.3, "linestyle": DASHED, "zorder": 3.5},
    },
    marks_extremes=False,
    finish=_dress,
)


def all_drawn(page_charts: Sequence[PageChart]) -> list[ChartFigure]:
    """Many drawn charts."""
    return [drawn(page_chart) for page_chart in page_charts]


def drawn(page_chart: PageChart, size: Size = OF_REPORT) -> ChartFigure:
    """The drawn chart; the same chart gives the same text."""
    width, height = size
    with mpl.rc_context(SETTINGS):
        made = Figure(figsize=(width / POINTS_PER_INCH, height / POINTS_PER_INCH), dpi=POINTS_PER_INCH)
        FigureCanvasSVG(made)
        axes = made.subplots()
        draw(axes, page_chart.chart, PAGE_LOOK)
        of = "driving angle" if page_chart.shaft == DRIVING else "angle of the shaft between"
        axes.set_xlabel(f"{of} in deg", size=TEXT_SIZE, color=INK)
        # The numbers of the scales have room in any font
        beside, below = (
            [_width(text) for text in scale.get_major_formatter().format_ticks(list(scale.get_majorticklocs()))]
            for scale in (axes.yaxis, axes.xaxis)
        )
        left, right = max(LEAST_LEFT, max(beside) + BESIDE_NUMBERS), max(LEAST_RIGHT, max(below) / 2.0)
        made.subplots_adjust(left / width, 38.0 / height, 1.0 - right / width, 1.0 - 8.0 / height)
        text = StringIO()
        made.savefig(text, format="svg", metadata=NO_METADATA)
        (left, right), (low, high) = axes.get_xlim(), axes.get_ylim()
        corners = axes.transData.transform([(left, low), (right, high)])
    (x0, y0), (x1, y1) = corners.tolist()
    svg = for_page(text.getvalue(), page_chart.key)
    return ChartFigure(page_chart, svg, (left, right), (x0, x1), (low, high), (height - y0, height - y1))


def _width(text: str) -> float:
    """Width of a number in SVG units, in the widest font of a page's text."""
    return TEXT_SIZE * sum(WIDTHS.get(letter, DIGIT_WIDTH) for letter in text)


def for_page(document: str, key: str) -> str:
    """The ``svg`` element of a document, with the colours and fonts of the page, and names that no other element has.

    It has no name space: HTML needs none, and so nothing looks like an address.
    """
    text = document[document.index("<svg") :]
    text = re.sub(r"<style.*?</style>", "", text, flags=re.DOTALL)
    text = re.sub(r' xmlns(:\w+)?="[^"]*"', "", text).replace("xlink:href", "href")
    text = re.sub(r'<svg width="[^"]*" height="[^"]*"', '<svg aria-hidden="true" focusable="false"', text)
    text = re.sub(r"font-family: [^;\"]*;? ?", "", text)
    text = re.sub(r"\s*\n\s*", " ", text).replace("> <", "><")
    for color, variable in COLORS.items():
        text = text.replace(color, variable)
    # Only elements that others refer to keep their name, with the chart's key before it.
    referred = set(re.findall(r'(?:url\(|href=")#([\w.-]+)', text))
    text = re.sub(r' id="([\w.-]+)"', lambda found: f' id="{key}-{found[1]}"' if found[1] in referred else "", text)
    return re.sub(r'((?:url\(|href=")#)', rf"\g<1>{key}-", text).strip()
