"""Pictures of power against acceleration, and against a flywheel: the limit of all laws, and the laws found."""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np
from matplotlib.axes import Axes

from ncgear.drawings.plots import canvas
from ncgear.drawings.plots.canvas import Style
from ncgear.numerics.arrays import Array

WIDTH_IN, HEIGHT_IN = 8.2, 5.8
ROOM = 1.6
"""Room above the highest mechanism, as a factor; the steep end of the family may be outside the picture."""

WEAKEST = 1e-9
"""A power beyond the left edge of every picture, in its unit."""

Named = tuple[str, float, float]
"""The name of a mechanism, its power in W and its acceleration in mm/s2."""


def frontier(
    limit: Array, laws: Array, family: Array, mechanisms: Sequence[Named], title: str, unit: str = "mm/s2"
) -> bytes:
    """PNG of the frontier; ``limit``, ``laws`` and ``family`` have rows of power in W and acceleration in ``unit``.

    A part of the family may be outside the picture.
    """
    standing = rows([mechanism[1:] for mechanism in mechanisms])
    shown = np.vstack([limit, laws, standing])
    made = canvas.figure(WIDTH_IN, HEIGHT_IN, title, canvas.Margins(left=0.8, right=0.25, top=0.8))
    axes = made.add_subplot()
    _draw_curves(axes, limit, laws, family)
    _set_scales(axes, shown)
    curves = list(axes.lines)
    for (name, *_), (power, acceleration) in zip(mechanisms, standing, strict=True):
        axes.plot([power], [acceleration], color=canvas.HIGHLIGHT, marker="D", markersize=6.0, linestyle="none")
        # Names may contain dollar signs, which are not formulas.
        note: Style = {"size": canvas.SMALL, "color": canvas.INK, "parse_math": False}
        words = axes.annotate(name, (power, acceleration), xytext=(6.0, 5.0), textcoords="offset points", **note)
        canvas.place_note(axes, words, NOTE_PLACES, curves)
    canvas.dress(axes, "peak power in W", f"peak acceleration in {unit[:-1]}\u00b2")
    canvas.legend_above(axes)
    return canvas.png(made)


def flywheels(limit: Array, laws: Array, title: str) -> bytes:
    """PNG of least power against the flywheel; rows of moment of inertia in kg m2 and power in W."""
    made = canvas.figure(WIDTH_IN, HEIGHT_IN, title, canvas.Margins(left=0.8, right=0.25, top=0.8))
    axes = made.add_subplot()
    # A limit is certain for its own flywheel only, not between two
    axes.plot(*limit.T, color=canvas.INK, linestyle="none", marker="_", markersize=14.0, label="certified limit")
    axes.plot(*laws.T, color=canvas.DRIVING, linewidth=1.8, marker="o", markersize=3.5, label="laws that can be made")
    axes.set_ylim(bottom=0.0)
    canvas.dress(axes, "flywheel on the driven shaft in kg m\u00b2", "peak power in W")
    canvas.legend_above(axes)
    return canvas.png(made)


def rows(points: Sequence[tuple[float, float]]) -> Array:
    """Points as rows, shape (n, 2)."""
    return np.array(points, dtype=float).reshape(-1, 2)


def _draw_curves(axes: Axes, limit: Array, laws: Array, family: Array) -> None:
    # More power never needs more acceleration: so each point of the limit holds for all smaller powers, down to the
    # point before it.  Straight lines between points would lie above a hollow curve.
    powers, heights = np.append(WEAKEST, limit[:, 0]), np.append(limit[:1, 1], limit[:, 1])
    axes.fill_between(powers, heights, 1e-3, step="pre", color=canvas.REFERENCE, alpha=0.14, linewidth=0.0)
    note: Style = {"transform": axes.transAxes, "size": canvas.SMALL, "color": canvas.REFERENCE, "style": "italic"}
    axes.text(0.03, 0.05, "impossible for any law", **note)
    axes.plot(*limit.T, color=canvas.INK, linewidth=1.6, label="certified limit")
    # A single law may coincide with a mechanism and must still show on top of it.
    size = 3.5 if len(laws) > 1 else 8.0
    style: Style = {"color": canvas.DRIVING, "linewidth": 1.8, "marker": "o", "markersize": size, "zorder": 4}
    axes.plot(*laws.T, label="laws that can be made" if len(laws) > 1 else "this law", **style)
    if family.size:
        axes.plot(*family.T, color=canvas.DRIVEN, linewidth=1.4, marker="s", markersize=3.0, label="published family")


NOTE_PLACES = (
    *((side, sign * 6.0, up) for up in (5.0, -5.0) for side, sign in (("left", 1.0), ("right", -1.0))),
    ("center", 0.0, 9.0),
    ("center", 0.0, -9.0),
)
"""Places of a mechanism's name about its point, the best first."""


def _set_scales(axes: Axes, shown: Array) -> None:
    """Logarithmic scales that hold all points (shape (n, 2)), with plain numbers."""
    (least_power, least), (most_power, most) = shown.min(axis=0), shown.max(axis=0)
    axes.set_xscale("log")
    axes.set_yscale("log")
    axes.set_xlim(least_power / 1.05, most_power * 1.35)
    axes.set_ylim(least / 1.25, most * ROOM)
    for axis in (axes.xaxis, axes.yaxis):
        canvas.plain_log(axis, (1.0, 2.0, 3.0, 5.0, 7.0))
