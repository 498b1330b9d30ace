"""Motion and power over the driving angle and over the displacement, beside the uniform crank at the same speed."""

from __future__ import annotations

from dataclasses import dataclass, replace
from typing import Any

import numpy as np
from matplotlib.axes import Axes

from ncgear.kinematics.slider import SliderMotion
from ncgear.numerics.arrays import Array
from ncgear.output.plots.angle_axis import align, angle_scale, mark_joints
from ncgear.output.plots.canvas import DRIVING, INK, NORMAL, REFERENCE, SMALL, Margins, dress, figure, png
from ncgear.output.units import THOUSANDS, readable

NO_JOINTS = np.empty(0)

OWN: dict[str, Any] = {"color": DRIVING, "linewidth": 2.0, "label": "this design"}
UNIFORM: dict[str, Any] = {
    "color": REFERENCE,
    "linewidth": 1.2,
    "linestyle": (0, (5, 2.5)),
    "label": "uniform crank, same speed",
}
"""The uniform crank lies above: where the two agree, both show."""

EDGE = 0.15
"""Share of the scale at either end in which a note stands beside its point, not above or below the middle of it."""


@dataclass(frozen=True)
class Quantity:
    """A column of the motion table as it is drawn: ``factor`` times the column's values, in ``unit``.

    ``extreme`` names the largest value in the picture.
    """

    column: str
    name: str
    unit: str
    extreme: bool
    factor: float = 1.0

    @property
    def label(self) -> str:
        """Name and unit, as they stand at an axis."""
        return f"{self.name} in {self.unit}"

    @property
    def in_thousands(self) -> Quantity:
        """In a thousand times the unit; as it is where that has no name."""
        if self.unit not in THOUSANDS:
            return self
        return replace(self, unit=THOUSANDS[self.unit], factor=1e-3 * self.factor)

    def of(self, table: SliderMotion) -> Array:
        """The values in the drawn unit."""
        values: Array = getattr(table, self.column)
        return self.factor * values

    def readable(self, *tables: SliderMotion) -> Quantity:
        """In the one unit in which the tables' largest value is read."""
        factor, _ = readable(self.unit, *(self.of(table) for table in tables))
        return self if factor == 1.0 else self.in_thousands

    def on(self, axes: Axes, *tables: SliderMotion) -> Quantity:
        """In the unit that the axes have, so that several machines can be drawn onto them; else as it is readable."""
        of_axes = (drawn for drawn in (self, self.in_thousands) if drawn.label == axes.get_ylabel())
        return next(of_axes, self.readable(*tables))


DISPLACEMENT = Quantity("displacement_mm", "displacement", "mm", extreme=False)
VELOCITY = Quantity("velocity_mm_s", "velocity", "mm/s", extreme=True)
ACCELERATION = Quantity("acceleration_mm_s2", "acceleration", "mm/s\u00b2", extreme=True)
FORCE = Quantity("force_n", "force", "N", extreme=True)
POWER = Quantity("power_w", "driving power", "W", extreme=True)


def motion(table: SliderMotion, uniform: SliderMotion, title: str, joints_rad: Array = NO_JOINTS) -> bytes:
    """Displacement, velocity and acceleration over phi1; ``joints_rad`` (shape (n,)) are marked by thin lines."""
    size = 8.2, 7.2
    made = figure(*size, title)
    column = made.subplots(3, 1, sharex=True, gridspec_kw={**Margins().shares(*size), "hspace": 0.12})
    for axes, quantity in zip(column, (DISPLACEMENT, VELOCITY, ACCELERATION), strict=True):
        over_angle(axes, table, uniform, quantity, joints_rad)
    angle_scale(column, float(np.degrees(table.phi1_rad[-1])))
    align(column, size[0])
    return png(made)


def power(table: SliderMotion, uniform: SliderMotion, title: str, joints_rad: Array = NO_JOINTS) -> bytes:
    """Resisting force and driving power, over phi1 on the left and over the displacement on the right."""
    size = 10.2, 5.6
    made = figure(*size, title)
    spaces = {"hspace": 0.12, "wspace": 0.06}
    grid = made.subplots(2, 2, sharex="col", sharey="row", gridspec_kw={**Margins().shares(*size), **spaces})
    for (left, right), quantity in zip(grid, (FORCE, POWER), strict=True):
        over_angle(left, table, uniform, quantity, joints_rad)
        over_displacement(right, table, uniform, quantity)
    angle_scale(grid[:, 0], float(np.degrees(table.phi1_rad[-1])))
    align(grid[:, 0], size[0])
    grid[1, 1].set_xlabel("displacement in mm", size=NORMAL, color=INK)
    return png(made)


def over_angle(axes: Axes, table: SliderMotion, uniform: SliderMotion, quantity: Quantity, joints_rad: Array) -> None:
    """A quantity of both mechanisms over phi1, with its largest value and the joints of the law (shape (n,))."""
    drawn = quantity.on(axes, table, uniform)
    angle, values = np.degrees(table.phi1_rad), drawn.of(table)
    axes.plot(angle, values, **OWN)
    axes.plot(np.degrees(uniform.phi1_rad), drawn.of(uniform), **UNIFORM)
    mark_joints(axes, np.degrees(joints_rad))
    dress(axes, "", drawn.label)
    if drawn.extreme:
        mark_extreme(axes, angle, values, drawn.unit)


def over_displacement(axes: Axes, table: SliderMotion, uniform: SliderMotion, quantity: Quantity) -> None:
    """A quantity of both mechanisms over the slider's displacement."""
    drawn = quantity.readable(table, uniform)
    for source, style in ((table, OWN), (uniform, UNIFORM)):
        axes.plot(source.displacement_mm, drawn.of(source), **style)
    dress(axes, "", "")


def mark_extreme(axes: Axes, angle: Array, values: Array, unit: str) -> None:
    """Mark and name the value that is largest in size, above a maximum, below a minimum; or say that all are zero."""
    place = int(np.argmax(np.abs(values)))
    x, y = float(angle[place]), float(values[place])
    if y == 0.0:
        axes.set_ylim(0.0, 1.0)
        axes.text(0.5, 0.5, "zero throughout", transform=axes.transAxes, size=NORMAL, color=INK, ha="center")
        return
    axes.plot(x, y, "o", color=DRIVING, markersize=4.5)
    text = f"{y:.4g} {unit} at {x:.0f}\u00b0".replace("-", "\u2212")
    side: dict[str, Any] = {"ha": _alignment(x / float(angle[-1])), "va": "bottom" if y > 0.0 else "top"}
    offset = (0.0, 5.0 if y > 0.0 else -5.0)
    axes.annotate(text, (x, y), xytext=offset, textcoords="offset points", size=SMALL, color=INK, **side)
    axes.margins(y=0.16)


def _alignment(share: float) -> str:
    if share < EDGE:
        return "left"
    return "right" if share > 1.0 - EDGE else "center"
