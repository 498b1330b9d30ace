"""A chart as a value: one quantity over the driving angle or over the displacement, in one or several lines.

The pictures of a build, the report, the moving picture and a notebook all draw this value, each with its own look
(``drawer.Look``).  The other modules of this folder build charts of the slider, of the contact between the teeth, and
of simulations.
"""

from __future__ import annotations

from dataclasses import field
from enum import StrEnum
from math import floor, log10
from typing import TYPE_CHECKING

import numpy as np

from ncgear.frozen import dataclass
from ncgear.numerics.arrays import Array

if TYPE_CHECKING:
    from ncgear.ratio.transmission import Transmission

EMPTY = np.empty(0)
NO_STRETCHES = np.empty((0, 2))
"""Empty arrays: places along the axis, and stretches of it."""


class Role(StrEnum):
    """The role of a line in its chart; a look says how each role is drawn."""

    OWN = "own"
    """This design. Every chart has one such line."""

    OTHER = "other"
    """A second line of this design, for example the back flanks beside the pushing flanks."""

    WRITTEN = "written"
    """This design as written in its files, beside the exact design."""

    MEAN = "mean"
    """The mean of this design's values: a level line."""

    LIMIT = "limit"
    """An upper limit of this design's values: a level line."""

    UNIFORM = "uniform"
    """The reference for this design: the uniform crank, circular gears, or the law without elasticity."""


DRIVING_ANGLE = "driving angle phi1 in deg"
"""The label of the usual horizontal axis."""


@dataclass(frozen=True, eq=False)
class ChartLine:
    """Values in the chart's unit at places ``x`` along its horizontal axis, both of shape (n,)."""

    role: Role
    label: str
    x: Array
    values: Array


@dataclass(frozen=True, eq=False)
class Chart:
    """Lines of one quantity in one unit, from 0 to ``end`` of the horizontal axis, whose label is ``across``.

    Lines that cover only the first ``period`` of a longer axis are repeated when they are drawn.  ``joints_deg`` (shape
    (k,)) are the joints of the law, which are marked; ``apart_deg`` (shape (k, 2)) are the stretches in which no
    pushing flanks touch.  With ``names_extreme``, the largest value of this design is named.  With ``counts``, the
    values are whole numbers and drawn in steps.  ``axis_label`` is the label of the vertical axis where it differs from
    the name with the unit.
    """

    name: str
    unit: str
    lines: tuple[ChartLine, ...]
    end: float
    period: float | None = None
    joints_deg: Array = field(default_factory=lambda: EMPTY)
    apart_deg: Array = field(default_factory=lambda: NO_STRETCHES)
    names_extreme: bool = False
    counts: bool = False
    axis_label: str = ""
    across: str = DRIVING_ANGLE

    @property
    def own(self) -> ChartLine:
        """This design's line."""
        return next(line for line in self.lines if line.role is Role.OWN)


def decimals_of(largest: float, digits: int) -> int:
    """Number of decimals that shows a largest value with so many significant digits; 0 for a value of 0."""
    return max(0, digits - 1 - floor(log10(largest))) if largest > 0.0 else 0


def joints_up_to(transmission: Transmission, end_rad: float) -> Array:
    """Driving angles in rad at which pieces of the law meet, shape (n,), greater than 0 and up to an end.

    They include the joints between periods.  A law of one piece has none.
    """
    starts = [piece.start_rad for piece in transmission.pieces]
    if len(starts) == 1:
        return EMPTY
    period = transmission.lobes.driving_period_rad
    cycles = np.arange(round(end_rad / period)) * period
    repeated: Array = (cycles[:, None] + np.array(starts)).ravel()
    return repeated[1:]
