"""A chart of the page and its drawing: the SVG element, the cursor, the scales, the extremes."""

from __future__ import annotations

import numpy as np
from markupsafe import Markup

from ncgear.drawings.charts.chart import Chart, Role, decimals_of
from ncgear.figures.numbers import fixed
from ncgear.frozen import dataclass

END = "</svg>"

DIGITS = 4
"""Significant digits of the largest value of a line; all lines of the chart have the decimals that follow from it."""

ALIKE = 1e-9
"""Largest difference of values that count as equal, as a share of the chart's largest value: above rounding errors and
below every shown digit."""

DRIVING, BETWEEN = "driving", "between"
"""The shafts whose angle can be the horizontal axis: the driving shaft, and the first shaft between two stages."""


def shaft_of(stage: int) -> str:
    """The name of the shaft that drives a stage, from 1 on; scripts of the page know it by that name."""
    return DRIVING if stage == 1 else BETWEEN if stage == 2 else f"{BETWEEN}-{stage - 1}"


@dataclass(frozen=True, eq=False)
class PageChart:
    """A chart with its ``key``, unique in the page, and the shaft whose angle is its horizontal axis.

    The page names the values of the first line beside the chart.  Raises ValueError for a value that is not finite.
    """

    key: str
    chart: Chart
    shaft: str = DRIVING

    def __post_init__(self) -> None:
        for line in self.chart.lines:
            if not np.isfinite(line.values).all():
                raise ValueError(f"{self.chart.name} holds a value that is not finite")

    @property
    def period_deg(self) -> float:
        """The angle in deg after which the lines repeat."""
        return self.chart.end if self.chart.period is None else self.chart.period

    @property
    def decimals(self) -> int:
        """Decimals with which the page shows the values of all lines."""
        largest = max(float(np.max(np.abs(line.values))) for line in self.chart.lines)
        return decimals_of(largest, DIGITS)


@dataclass(frozen=True)
class ChartFigure:
    """A chart of the page, its SVG element, and the places of its scales in it.

    The horizontal scale runs from ``x[0]`` to ``x[1]`` in SVG units and over ``angle_deg``; the vertical scale runs
    from ``y[0]`` to ``y[1]`` and over ``values``.
    """

    page_chart: PageChart
    drawing: str
    angle_deg: tuple[float, float]
    x: tuple[float, float]
    values: tuple[float, float]
    y: tuple[float, float]

    @property
    def svg(self) -> Markup:
        """The drawing with a cursor line and a dot for each line; the page's script puts them in their places.

        The drawing holds only numbers and words of this package.
        """
        places = reversed(list(enumerate(self.page_chart.chart.lines)))
        dots = "".join(f'<circle class="{line.role}" data-line="{place}" r="3.6"/>' for place, line in places)
        low, high = self.y
        cursor = f'<g class="cursor"><line y1="{low:g}" y2="{high:g}"/>{dots}</g>'
        return Markup(f"{self.drawing.removesuffix(END)}{cursor}{END}")

    @property
    def heading(self) -> str:
        """The name of the chart with its unit, which has no room at the scale beside the numbers."""
        chart = self.page_chart.chart
        return f"{chart.name} in {chart.unit}" if chart.unit else chart.name

    @property
    def uniform(self) -> int | None:
        """Place of the uniform crank's line; None where there is none."""
        roles = [line.role for line in self.page_chart.chart.lines]
        return roles.index(Role.UNIFORM) if Role.UNIFORM in roles else None

    @property
    def extremes(self) -> str:
        """Words for the least and greatest value of the first line, with their angles where they differ."""
        line, decimals = self.page_chart.chart.lines[0], self.page_chart.decimals
        # The first of several places, which rounding errors tell apart.
        alike = ALIKE * float(np.max(np.abs(line.values)))
        places = [int(np.argmax(values >= values.max() - alike)) for values in (-line.values, line.values)]
        values = [fixed(line.values[place], decimals) for place in places]
        texts = [f"{value} at {fixed(line.x[place], 0)}\u00b0" for value, place in zip(values, places, strict=True)]
        told = " to ".join(texts) if values[0] != values[1] else f"{values[0]} throughout"
        return told.replace("-", "\u2212")
