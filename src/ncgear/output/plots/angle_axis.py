"""Rows of axes over the driving angle: their scale, the joints of the law, and labels in one line."""

from __future__ import annotations

from collections.abc import Sequence
from typing import Any

import numpy as np
from matplotlib.axes import Axes

from ncgear.numerics.arrays import Array
from ncgear.output.plots.canvas import INK, NORMAL, key_above

ANGLE = "driving angle phi1 in deg"

JOINT: dict[str, Any] = {"color": "#8A8A8A", "linewidth": 0.8, "linestyle": (0, (1.5, 2.5)), "zorder": 0.8}

MOST_JOINTS = 12
"""More joints than these, as of a table, are not marked: they would say no more than a grid."""


def mark_joints(axes: Axes, joints_deg: Array) -> None:
    """Thin lines at the joints of the law, shape (n,)."""
    if joints_deg.size > MOST_JOINTS:
        return
    for number, joint in enumerate(joints_deg):
        axes.axvline(joint, label=None if number else "joints of the law", **JOINT)


def angle_scale(column: Sequence[Axes], end_deg: float) -> None:
    """Scale in degrees below the lowest axes, key above the highest."""
    # A cycle that takes several turns of the driving gear is marked as much more widely.
    step = 45 * max(round(end_deg / 360.0), 1)
    column[-1].set_xlim(0.0, end_deg)
    column[-1].set_xticks(np.arange(0.0, end_deg + 1.0, step))
    column[-1].set_xlabel(ANGLE, size=NORMAL, color=INK)
    key_above(column[0])


def align(column: Sequence[Axes], width_in: float) -> None:
    """Labels of the vertical scales, of one line or two, end at the same place in all rows."""
    for axes in column:
        axes.yaxis.set_label_coords(-0.55 / (width_in * axes.get_position().width), 0.5)
