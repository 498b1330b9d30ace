"""What the simulated teeth do over the driving angle, beside what they would do if nothing gave way."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from typing import Any

import numpy as np
from matplotlib.axes import Axes

from ncgear.numerics.arrays import Array
from ncgear.output.plots.angle_axis import align, angle_scale
from ncgear.output.plots.canvas import DRIVING, HIGHLIGHT, REFERENCE, Margins, dress, figure, png
from ncgear.output.plots.curves import mark_extreme
from ncgear.output.units import readable

ROW_IN = 1.9
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
    phi1_rad: Array, rows: Sequence[TimeRow], title: str, apart_rad: Array, labels: tuple[str, str] = ("simulated", "law")
) -> bytes:
    """One row of axes for each quantity; stretches ``apart_rad`` (shape (k, 2)), without pushing flanks, are shaded."""
    size = 8.2, ROW_IN * len(rows) + 1.4
    made = figure(*size, title)
    spaces = {**Margins(left=1.0).shares(*size), "hspace": 0.14}
    column = list(made.subplots(len(rows), 1, sharex=True, squeeze=False, gridspec_kw=spaces)[:, 0])
    for axes, row in zip(column, rows, strict=True):
        _draw(axes, np.degrees(phi1_rad), row, labels)
        _shade(axes, np.degrees(apart_rad))
    angle_scale(column, float(np.degrees(phi1_rad[-1])))
    align(column, size[0])
    return png(made)


def _draw(axes: Axes, angle: Array, row: TimeRow, labels: tuple[str, str]) -> None:
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
