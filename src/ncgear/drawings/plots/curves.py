"""Motion and power over the driving angle and over the displacement, beside the uniform crank at the same speed.

Torques and forces over the driving angle, beside the uniform crank with the same masses at the same speed.

What the simulated teeth do over the driving angle, beside what they would do if nothing gave way.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, replace
from typing import Any

import numpy as np
from matplotlib.axes import Axes

from ncgear.drawings.plots.canvas import (
    DRIVING,
    HIGHLIGHT,
    INK,
    NORMAL,
    REFERENCE,
    SMALL,
    Margins,
    align,
    angle_scale,
    dress,
    figure,
    mark_joints,
    png,
)
from ncgear.figures.numbers import THOUSANDS, readable
from ncgear.kinematics.motion import SliderMotion
from ncgear.numerics.arrays import Array

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


LOAD_ROW_IN = 1.9
"""Height of a row of axes in inches."""

LEVEL: dict[str, Any] = {"color": INK, "linewidth": 0.9, "linestyle": (0, (1.5, 1.5))}


@dataclass(frozen=True, eq=False)
class LoadRow:
    """A quantity at n driving angles, of the design and of the uniform crank, shape (n,) each.

    It is given in ``unit`` and drawn in the one in which it is read; ``mean`` is drawn as a level line, ``extreme``
    names the largest value in the picture.
    """

    name: str
    unit: str
    own: Array
    uniform: Array
    mean: float | None = None
    extreme: bool = True


def load_curves(phi1_rad: Array, rows: Sequence[LoadRow], title: str, joints_rad: Array) -> bytes:
    """One row of axes for each quantity; ``joints_rad`` (shape (n,)) are marked by thin lines."""
    size = 8.2, LOAD_ROW_IN * len(rows) + 1.4
    made = figure(*size, title)
    spaces = {**Margins(left=1.0).shares(*size), "hspace": 0.14}
    grid = made.subplots(len(rows), 1, sharex=True, squeeze=False, gridspec_kw=spaces)
    column = list(grid[:, 0])
    for axes, row in zip(column, rows, strict=True):
        _draw(axes, np.degrees(phi1_rad), row)
        mark_joints(axes, np.degrees(joints_rad))
    angle_scale(column, float(np.degrees(phi1_rad[-1])))
    align(column, size[0])
    return png(made)


def _draw(axes: Axes, angle: Array, row: LoadRow) -> None:
    factor, unit = readable(row.unit, row.own, row.uniform)
    axes.plot(angle, factor * row.own, **OWN)
    axes.plot(angle, factor * row.uniform, **UNIFORM)
    if row.mean is not None:
        axes.axhline(factor * row.mean, label="mean", **LEVEL)
    dress(axes, "", f"{row.name}\nin {unit}")
    if row.extreme:
        mark_extreme(axes, angle, factor * row.own, unit)


TIME_ROW_IN = 1.9
"""Height of a row of axes in inches."""

SIMULATED: dict[str, Any] = {"color": DRIVING, "linewidth": 1.6}
IDEAL: dict[str, Any] = {"color": REFERENCE, "linewidth": 1.1, "linestyle": (0, (5, 2.5))}
APART: dict[str, Any] = {"color": HIGHLIGHT, "alpha": 0.25, "linewidth": 0.0}


@dataclass(frozen=True, eq=False)
class TimeRow:
    """A quantity at n driving angles, simulated and as it is compared, shape (n,); None for no other.

    It is given in ``unit`` and drawn in the one in which it is read.
    """

    name: str
    unit: str
    simulated: Array
    compared: Array | None = None


def time_rows(
    phi1_rad: Array,
    rows: Sequence[TimeRow],
    title: str,
    apart_rad: Array,
    labels: tuple[str, str] = ("simulated", "law"),
) -> bytes:
    """One row of axes for each quantity; stretches ``apart_rad`` (shape (k, 2)), without pushing flanks, are shaded."""
    size = 8.2, TIME_ROW_IN * len(rows) + 1.4
    made = figure(*size, title)
    spaces = {**Margins(left=1.0).shares(*size), "hspace": 0.14}
    column = list(made.subplots(len(rows), 1, sharex=True, squeeze=False, gridspec_kw=spaces)[:, 0])
    for axes, row in zip(column, rows, strict=True):
        _draw_of_time_rows(axes, np.degrees(phi1_rad), row, labels)
        _shade(axes, np.degrees(apart_rad))
    angle_scale(column, float(np.degrees(phi1_rad[-1])))
    align(column, size[0])
    return png(made)


def _draw_of_time_rows(axes: Axes, angle: Array, row: TimeRow, labels: tuple[str, str]) -> None:
    factor, unit = readable(row.unit, row.simulated, *(() if row.compared is None else (row.compared,)))
    simulated = factor * row.simulated
    axes.plot(angle, simulated, label=labels[0], **SIMULATED)
    if row.compared is not None:
        axes.plot(angle, factor * row.compared, label=labels[1], **IDEAL)
    dress(axes, "", f"{row.name}\nin {unit}")
    mark_extreme(axes, angle, simulated, unit)


def _shade(axes: Axes, apart_deg: Array) -> None:
    for number, (start, end) in enumerate(apart_deg):
        axes.axvspan(start, end, label="" if number else "pushing flanks apart", **APART)
