"""A chart as it stands on the page: its drawing, its cursor, and its extreme values in words."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from markupsafe import Markup

from ncgear.output.page.chart import OWN, UNIFORM, Chart
from ncgear.output.page.svg import Drawn, drawn

END = "</svg>"


@dataclass(frozen=True)
class Figure:
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


def figure(chart: Chart) -> Figure:
    """The chart, drawn."""
    return Figure(chart, drawn(chart))
