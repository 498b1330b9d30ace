"""Charts of the output's motion, load, power and ratio, beside the uniform law at the same speed."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import replace
from enum import Enum
from math import degrees
from typing import TYPE_CHECKING

import numpy as np

from ncgear.drawings.charts.chart import EMPTY, Chart, ChartLine, Role
from ncgear.kinematics.motion import OutputMotion
from ncgear.mechanisms.mechanism import Mechanism, Output, Unit
from ncgear.numerics.arrays import Array

if TYPE_CHECKING:
    from ncgear.dynamics.history import Slide


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
        values: Array = getattr(motion, self.value) * self.unit_of(output).factor
        return values


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
