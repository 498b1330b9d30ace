"""A picture of an outline with the pitch curve that follows it, and of the mate beside it."""

from __future__ import annotations

import numpy as np

from ncgear.drawings.plots import canvas
from ncgear.numerics.arrays import Array

WIDTH_IN, HEIGHT_IN = 8.2, 5.0


def outline_and_curve(
    outline: Array, curve: Array, mate: Array, axes_mm: tuple[Array, Array], greatest: tuple[Array, Array], title: str
) -> bytes:
    """PNG of an outline, the curve and its mate, points of shape (n, 2) each in the drawing.

    ``axes_mm`` are those of both gears, ``greatest`` the ends of the greatest deviation.
    """
    made = canvas.figure(WIDTH_IN, HEIGHT_IN, title, canvas.Margins(left=0.6, right=0.2, top=0.75))
    axes = made.add_subplot()
    axes.fill(*outline.T, color=canvas.REFERENCE, alpha=0.25, linewidth=0.0, label="outline")
    for points, color, label in ((curve, canvas.DRIVING, "pitch curve"), (mate, canvas.DRIVEN, "its mate")):
        axes.plot(*np.concatenate([points, points[:1]]).T, color=color, linewidth=1.6, label=label)
    axes.plot(*np.array(greatest).T, color=canvas.HIGHLIGHT, linewidth=2.2, label="greatest deviation")
    axes.plot(*np.array(axes_mm).T, "+", color=canvas.INK, markersize=10)
    axes.set_aspect("equal")
    canvas.dress(axes, "x in mm", "y in mm")
    canvas.legend_above(axes)
    return canvas.png(made)
