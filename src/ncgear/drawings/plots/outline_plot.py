"""A picture of an outline with the pitch curve that follows it, and of the mate beside it."""

from __future__ import annotations

import numpy as np

from ncgear.drawings.plots import canvas
from ncgear.numerics.arrays import Array

WIDTH_IN, HEIGHT_IN = 8.2, 5.0


def outline_and_curve(
    outlines: list[Array], curve: Array, mate: Array, axes_mm: tuple[Array, Array], greatest: list[Array], title: str
) -> bytes:
    """PNG of the outlines of one gear or both, the curve and its mate, points of shape (n, 2) each in the drawing.

    ``axes_mm`` are those of both gears, ``greatest`` the ends of the greatest deviation from each outline.
    """
    made = canvas.figure(WIDTH_IN, HEIGHT_IN, title, canvas.Margins(left=0.6, right=0.2, top=0.75))
    axes = made.add_subplot()
    for place, outline in enumerate(outlines):
        label = "_" if place else "outline"
        axes.fill(*outline.T, color=canvas.REFERENCE, alpha=0.25, linewidth=0.0, label=label)
    for points, color, label in ((curve, canvas.DRIVING, "pitch curve"), (mate, canvas.DRIVEN, "its mate")):
        axes.plot(*np.concatenate([points, points[:1]]).T, color=color, linewidth=1.6, label=label)
    for place, ends in enumerate(greatest):
        label = "_" if place else "greatest deviation"
        axes.plot(*ends.T, color=canvas.HIGHLIGHT, linewidth=2.2, label=label)
    axes.plot(*np.array(axes_mm).T, "+", color=canvas.INK, markersize=10)
    axes.set_aspect("equal")
    canvas.dress(axes, "x in mm", "y in mm")
    canvas.legend_above(axes)
    return canvas.png(made)
