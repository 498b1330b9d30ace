"""Torques and forces over the driving angle, beside the uniform crank with the same masses at the same speed."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from typing import Any

import numpy as np
from matplotlib.axes import Axes

from ncgear.numerics.arrays import Array
from ncgear.output.plots.angle_axis import align, angle_scale, mark_joints
from ncgear.output.plots.canvas import INK, Margins, dress, figure, png
from ncgear.output.plots.curves import OWN, UNIFORM, mark_extreme
from ncgear.output.units import readable

ROW_IN = 1.9
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
    size = 8.2, ROW_IN * len(rows) + 1.4
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
