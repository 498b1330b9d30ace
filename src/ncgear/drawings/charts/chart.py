"""A chart as a value: one quantity over the driving angle or over the displacement, in one or several lines.

The pictures of a build, the report, the moving picture and a notebook all draw this value, each with its own look
(``drawer.Look``).  Here are the charts of the output's motion, load, power and ratio, beside the uniform law at the
same speed; ``teeth_charts`` builds charts of the contact between the teeth and of their strength.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import field, replace
from enum import Enum, StrEnum
from math import degrees, floor, log10
from typing import TYPE_CHECKING

import numpy as np

from ncgear.frozen import dataclass
from ncgear.kinematics.motion import OutputMotion
from ncgear.mechanisms.mechanism import Mechanism, Output, Unit
from ncgear.numerics.arrays import Array

if TYPE_CHECKING:
    from ncgear.dynamics.history import Slide
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


class Quantity(Enum):
    """A column of the motion table that a chart shows."""

    DISPLACEMENT = "displacement"
    VELOCITY = "velocity"
    ACCELERATION = "acceleration"
    LOAD = "load"
    POWER = "driving_power_w"
    RATIO = "ratio"

    def name_of(self, output: Output) -> str:
        """The name of the quantity for an output."""
        match self:
            case Quantity.LOAD:
                return output.load_name
            case Quantity.POWER:
                return "driving power"
            case Quantity.RATIO:
                return RATIO_NAME
        return str(self.value)

    def unit_of(self, output: Output) -> Unit:
        """The unit in which the quantity of an output is drawn."""
        acceleration = output.acceleration
        return {
            Quantity.DISPLACEMENT: output.place,
            Quantity.VELOCITY: output.speed,
            Quantity.ACCELERATION: acceleration._replace(text=acceleration.text.replace("s2", "s\u00b2")),
            Quantity.LOAD: output.load,
            Quantity.POWER: WATT,
            Quantity.RATIO: NO_UNIT,
        }[self]

    def key_of(self, output: Output) -> str:
        """The quantity's name in tables and on the page, which ends in its unit."""
        name = output.load_name if self is Quantity.LOAD else self.value
        if self is Quantity.POWER:
            return "power_w"
        ending = self.unit_of(output).ending
        return f"{name}_{ending}" if ending else name

    def values(self, motion: OutputMotion | Slide, output: Output) -> Array:
        """The values in the unit of ``unit_of``, shape (n,); a motion in time has no load, power and ratio."""
        return getattr(motion, self.value) * self.unit_of(output).factor


RATIO_NAME = "ratio i\u2081\u2082"

WATT, NO_UNIT = Unit("w", "W"), Unit("", "")

MOTION = (Quantity.DISPLACEMENT, Quantity.VELOCITY, Quantity.ACCELERATION)
LOAD = (Quantity.LOAD, Quantity.POWER)


def motion_chart(
    quantity: Quantity,
    linkage: Mechanism,
    own: OutputMotion,
    uniform: OutputMotion | None = None,
    joints_deg: Array = EMPTY,
) -> Chart:
    """A quantity of a motion over the driving angle, beside the uniform law unless it is None.

    ``joints_deg`` (shape (k,)) are the joints of the law, which are marked.
    """
    output = linkage.OUTPUT
    lines = [ChartLine(Role.OWN, "this design", np.degrees(own.phi1_rad), quantity.values(own, output))]
    if uniform is not None:
        angle, values = np.degrees(uniform.phi1_rad), quantity.values(uniform, output)
        lines.append(ChartLine(Role.UNIFORM, f"{linkage.UNIFORM}, same speed", angle, values))
    counted = ", with masses" if quantity is Quantity.POWER and own.power_with_masses_w is not None else ""
    return Chart(
        quantity.name_of(output) + counted,
        quantity.unit_of(output).text,
        tuple(lines),
        degrees(own.phi1_rad[-1]),
        joints_deg=joints_deg,
        names_extreme=quantity is not Quantity.DISPLACEMENT,
    )


def over_displacement(chart: Chart, output: Output, motions: Sequence[OutputMotion]) -> Chart:
    """A chart of motions over their displacement instead of the driving angle, without marks.

    ``motions`` are the motions of the chart's lines, in their order.
    """
    places = [Quantity.DISPLACEMENT.values(motion, output) for motion in motions]
    lines = tuple(replace(line, x=x) for line, x in zip(chart.lines, places, strict=True))
    end = max(float(x.max()) for x in places)
    return replace(
        chart,
        lines=lines,
        end=end,
        joints_deg=EMPTY,
        names_extreme=False,
        across=f"displacement in {output.place.text}",
    )
