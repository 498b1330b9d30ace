"""Charts of the slider's motion, force, power and ratio, beside the uniform crank at the same speed."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, replace
from math import degrees

import numpy as np

from ncgear.drawings.charts.chart import EMPTY, Across, Chart, Line, Role, joints_up_to
from ncgear.kinematics.motion import SliderMotion
from ncgear.numerics.arrays import Array
from ncgear.project.drive import Drive


@dataclass(frozen=True)
class Quantity:
    """A column of the motion table, with the name and the unit that it has in a chart."""

    column: str
    name: str
    unit: str
    names_extreme: bool = True

    def values(self, motion: SliderMotion) -> Array:
        """The values in ``unit``, shape (n,)."""
        values: Array = getattr(motion, self.column)
        return values


DISPLACEMENT = Quantity("displacement_mm", "displacement", "mm", names_extreme=False)
VELOCITY = Quantity("velocity_mm_s", "velocity", "mm/s")
ACCELERATION = Quantity("acceleration_mm_s2", "acceleration", "mm/s\u00b2")
FORCE = Quantity("force_n", "force", "N")
POWER = Quantity("power_w", "driving power", "W")
RATIO = Quantity("ratio", "ratio i\u2081\u2082", "")

MOTION = (DISPLACEMENT, VELOCITY, ACCELERATION)
LOAD = (FORCE, POWER)


def slider_chart(drive: Drive, quantity: Quantity) -> Chart:
    """A quantity of a drive's motion table, beside the uniform crank's, with the joints of the law."""
    joints = np.degrees(joints_up_to(drive.transmission, float(drive.motion.phi1_rad[-1])))
    return motion_chart(quantity, drive.motion, drive.uniform_motion, joints)


def motion_chart(
    quantity: Quantity, own: SliderMotion, uniform: SliderMotion | None = None, joints_deg: Array = EMPTY
) -> Chart:
    """A quantity of a motion over the driving angle, beside the uniform crank unless that is None.

    ``joints_deg`` (shape (k,)) are the joints of the law, which are marked.
    """
    lines = [Line(Role.OWN, "this design", np.degrees(own.phi1_rad), quantity.values(own))]
    if uniform is not None:
        angle, values = np.degrees(uniform.phi1_rad), quantity.values(uniform)
        lines.append(Line(Role.UNIFORM, "uniform crank, same speed", angle, values))
    return Chart(
        quantity.name,
        quantity.unit,
        tuple(lines),
        degrees(own.phi1_rad[-1]),
        joints_deg=joints_deg,
        names_extreme=quantity.names_extreme,
    )


def over_displacement(chart: Chart, motions: Sequence[SliderMotion]) -> Chart:
    """A chart of motions over their displacement instead of the driving angle, with no marks.

    ``motions`` are those of the chart's lines, in their order.
    """
    places = [motion.displacement_mm for motion in motions]
    lines = tuple(replace(line, x=x) for line, x in zip(chart.lines, places, strict=True))
    end = max(float(x.max()) for x in places)
    return replace(chart, lines=lines, end=end, joints_deg=EMPTY, names_extreme=False, across=Across.DISPLACEMENT)
