"""Contact of the teeth over a whole cycle: transmission error, backlash, contacts, pressure angle, sliding."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from typing import Any

import numpy as np
from matplotlib.axes import Axes

from ncgear.contact.designed.as_designed import AsDesigned
from ncgear.contact.pair import PairContact
from ncgear.drawings.plots.canvas import (
    DRIVEN,
    DRIVING,
    REFERENCE,
    Margins,
    align,
    angle_scale,
    dress,
    figure,
    mark_joints,
    png,
)
from ncgear.numerics.arrays import Array

ROW_IN = 1.5
"""Height of a row of axes in inches."""

PUSHING: dict[str, Any] = {"color": DRIVING, "linewidth": 1.6, "label": "pushing flanks as designed"}
BACK: dict[str, Any] = {"color": REFERENCE, "linewidth": 1.1, "label": "backs as designed"}
WRITTEN: dict[str, Any] = {"color": DRIVEN, "linewidth": 0.8, "label": "pushing flanks as written", "zorder": 1.9}

MILLI_FROM_RAD = 5e-3
"""Angle from which a scale is in mrad instead of millionths of a radian."""

Drawing = Callable[[Axes, AsDesigned], None]
"""Draws a row over phi1."""

NO_BACKLASH_RAD = 1e-9
"""Play below which none is drawn: some nanometres at the flanks."""


def contact(result: PairContact, title: str, joints_rad: Array) -> bytes:
    """Rows over phi1; ``joints_rad`` (shape (n,)) are marked by thin lines."""
    designed = result.as_designed
    rows: list[Drawing] = [flanks_in_contact, pressure_angles, sliding]
    if np.max(np.abs(designed.backlash_rad)) >= NO_BACKLASH_RAD:
        rows.insert(0, backlash)
    size = 8.2, ROW_IN * (len(rows) + 1) + 1.3
    made = figure(*size, title)
    spaces = {**Margins(left=1.0).shares(*size), "hspace": 0.16}
    column = made.subplots(len(rows) + 1, 1, sharex=True, gridspec_kw=spaces)
    _errors(column[0], result)
    for axes, draw in zip(column[1:], rows, strict=True):
        draw(axes, designed)
    for axes in column:
        mark_joints(axes, np.degrees(joints_rad))
    angle_scale(column, float(np.degrees(designed.placement.cycle_rad)))
    align(column, size[0])
    return png(made)


def _errors(axes: Axes, result: PairContact) -> None:
    """Driven angle beyond the law's, of the worst outlines and as designed."""
    written = max(result.as_written, key=lambda outlines: outlines.transmission_error_rad)
    angle, (factor, unit) = _angle(result.as_designed), scaled(written.pushing_rad)
    axes.plot(angle, factor * result.as_designed.pushing.error_rad, **PUSHING)
    axes.plot([], [], **BACK)
    axes.plot(angle, factor * written.pushing_rad, **WRITTEN)
    dress(axes, "", f"error of driven\nangle in {unit}")


def backlash(axes: Axes, designed: AsDesigned) -> None:
    """Play of the driven gear over phi1."""
    factor, unit = scaled(designed.backlash_rad)
    axes.plot(_angle(designed), factor * designed.backlash_rad, color=DRIVING, linewidth=1.6, label="as designed")
    dress(axes, "", f"backlash\nin {unit}")


def flanks_in_contact(axes: Axes, designed: AsDesigned) -> None:
    """How many pairs of flanks touch over phi1, on either side of the teeth."""
    for side, style in _sides(designed):
        axes.plot(_angle(designed), side.simultaneous, drawstyle="steps-mid", **style)
    most = int(max(designed.pushing.simultaneous.max(), designed.back.simultaneous.max()))
    axes.set_yticks(range(most + 1))
    axes.set_ylim(-0.2, most + 0.2)
    dress(axes, "", "flanks\nin contact")


def pressure_angles(axes: Axes, designed: AsDesigned) -> None:
    """Pressure angle of the foremost contact over phi1, on either side of the teeth."""
    for side, style in _sides(designed):
        axes.plot(_angle(designed), np.degrees(side.first.pressure_angle_rad), **style)
    dress(axes, "", "pressure angle\nin deg")


def sliding(axes: Axes, designed: AsDesigned) -> None:
    """Speed of sliding at the foremost contact per speed of the driving gear over phi1."""
    for side, style in _sides(designed):
        axes.plot(_angle(designed), side.first.sliding_mm(designed.placement), **style)
    dress(axes, "", "sliding\nin mm per rad")


def _angle(designed: AsDesigned) -> Array:
    return np.degrees(designed.placement.phi1_rad)


def _sides(designed: AsDesigned) -> Sequence[tuple[Any, dict[str, Any]]]:
    """Both sides with their styles, the pushing one last, on top."""
    return (designed.back, BACK), (designed.pushing, PUSHING)


def scaled(angles_rad: Array) -> tuple[float, str]:
    """Factor from rad to the unit in which angles (shape (n,)) are drawn, and its name."""
    small = float(np.max(np.abs(angles_rad))) < MILLI_FROM_RAD
    return (1e6, "\u00b5rad") if small else (1e3, "mrad")
