"""A chart of the report as a value: a quantity over a driving angle, in one or several lines."""

from __future__ import annotations

from dataclasses import dataclass
from math import floor, log10

import numpy as np

from ncgear.numerics.arrays import Array

DIGITS = 4
"""Significant digits of the largest value of a line, which set the decimals of all of them."""

OWN, OTHER, UNIFORM = "own", "other", "uniform"
"""Roles of a line: this design, a second line of it, and the uniform crank."""

DRIVING = "driving"
"""The angle that the page is driven by: that of the driving shaft."""


@dataclass(frozen=True, eq=False)
class Line:
    """Values at rising angles in degrees, both of shape (n,), which repeat after ``period_deg``.

    ``name`` tells the line from the others of its chart.
    """

    role: str
    name: str
    angle_deg: Array
    values: Array
    period_deg: float


@dataclass(frozen=True, eq=False)
class Chart:
    """Lines of one quantity in ``unit``; the first one is this design's own.

    ``angle`` is the key of the angle that it is drawn over, which goes from 0 to ``end_deg``; ``joints_deg`` (shape
    (k,)) are marked; ``key`` is unique in the page.  Raises ValueError for a value that is not finite.
    """

    key: str
    name: str
    unit: str
    lines: tuple[Line, ...]
    end_deg: float
    joints_deg: Array
    angle: str = DRIVING
    angle_name: str = "driving angle in deg"

    def __post_init__(self) -> None:
        for line in self.lines:
            if not np.isfinite(line.values).all():
                raise ValueError(f"{self.name} holds a value that is not finite")

    @property
    def decimals(self) -> int:
        """Digits after the point with which all lines are read out."""
        largest = max(float(np.max(np.abs(line.values))) for line in self.lines)
        return decimals_of(largest)


def decimals_of(largest: float) -> int:
    """Digits after the point that show a largest value with four significant ones; none for 0."""
    return max(0, DIGITS - 1 - floor(log10(largest))) if largest > 0.0 else 0
