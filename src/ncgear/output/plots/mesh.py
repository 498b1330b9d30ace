"""Contact of the teeth over a whole cycle: transmission error, backlash, contacts, pressure angle, sliding."""

from __future__ import annotations

from collections.abc import Sequence
from typing import Any

import numpy as np
from matplotlib.axes import Axes

from ncgear.contact.as_designed import AsDesigned
from ncgear.contact.pair_contact import PairContact
from ncgear.numerics.arrays import Array
from ncgear.output.plots.angle_axis import align, angle_scale, mark_joints
from ncgear.output.plots.canvas import DRIVEN, DRIVING, REFERENCE, Margins, dress, figure, png

ROW_IN = 1.5
"""Height of a row of axes in inches."""

PUSHING: dict[str, Any] = {"color": DRIVING, "linewidth": 1.6, "label": "pushing flanks as designed"}
BACK: dict[str, Any] = {"color": REFERENCE, "linewidth": 1.1, "label": "backs as designed"}
WRITTEN: dict[str, Any] = {"color": DRIVEN, "linewidth": 0.8, "label": "pushing flanks as written", "zorder": 1.9}

MILLI_FROM_RAD = 5e-3
"""Angle from which a scale is in mrad instead of millionths of a radian."""

NO_BACKLASH_RAD = 1e-9
"""Play below which none is drawn: some nanometres at the flanks."""


def contact(result: PairContact, title: str, joints_rad: Array) -> bytes:
    """Rows over phi1; ``joints_rad`` (shape (n,)) are marked by thin lines."""
    designed = result.as_designed
    rows = [_errors, _backlash, _contacts, _pressure_angles, _sliding]
    if np.max(np.abs(designed.backlash_rad)) < NO_BACKLASH_RAD:
        rows.remove(_backlash)
    size = 8.2, ROW_IN * len(rows) + 1.3
    made = figure(*size, title)
    column = made.subplots(len(rows), 1, sharex=True, gridspec_kw={**Margins(left=1.0).shares(*size), "hspace": 0.16})
    for axes, draw in zip(column, rows, strict=True):
        draw(axes, result, np.degrees(designed.placement.phi1_rad))
        mark_joints(axes, np.degrees(joints_rad))
    angle_scale(column, float(np.degrees(designed.placement.cycle_rad)))
    align(column, size[0])
    return png(made)


def _errors(axes: Axes, result: PairContact, angle: Array) -> None:
    """Driven angle beyond the law's, of the worst outlines and as designed."""
    written = max(result.as_written, key=lambda outlines: outlines.transmission_error_rad)
    factor, unit = scaled(written.pushing_rad)
    axes.plot(angle, factor * result.as_designed.pushing.error_rad, **PUSHING)
    axes.plot([], [], **BACK)
    axes.plot(angle, factor * written.pushing_rad, **WRITTEN)
    dress(axes, "", f"error of driven\nangle in {unit}")


def _backlash(axes: Axes, result: PairContact, angle: Array) -> None:
    factor, unit = scaled(result.as_designed.backlash_rad)
    axes.plot(angle, factor * result.as_designed.backlash_rad, color=DRIVING, linewidth=1.6)
    dress(axes, "", f"backlash\nin {unit}")


def _contacts(axes: Axes, result: PairContact, angle: Array) -> None:
    for side, style in _sides(result.as_designed):
        axes.plot(angle, side.simultaneous, drawstyle="steps-mid", **style)
    most = int(max(result.as_designed.pushing.simultaneous.max(), result.as_designed.back.simultaneous.max()))
    axes.set_yticks(range(most + 1))
    axes.set_ylim(-0.2, most + 0.2)
    dress(axes, "", "flanks\nin contact")


def _pressure_angles(axes: Axes, result: PairContact, angle: Array) -> None:
    for side, style in _sides(result.as_designed):
        axes.plot(angle, np.degrees(side.first.pressure_angle_rad), **style)
    dress(axes, "", "pressure angle\nin deg")


def _sliding(axes: Axes, result: PairContact, angle: Array) -> None:
    for side, style in _sides(result.as_designed):
        axes.plot(angle, side.first.sliding_mm(result.as_designed.placement), **style)
    dress(axes, "", "sliding\nin mm per rad")


def _sides(designed: AsDesigned) -> Sequence[tuple[Any, dict[str, Any]]]:
    """Both sides with their styles, the pushing one last, on top."""
    return (designed.back, BACK), (designed.pushing, PUSHING)


def scaled(angles_rad: Array) -> tuple[float, str]:
    """Factor from rad to the unit in which angles (shape (n,)) are drawn, and its name."""
    small = float(np.max(np.abs(angles_rad))) < MILLI_FROM_RAD
    return (1e6, "\u00b5rad") if small else (1e3, "mrad")
