"""What the moving picture tells in figures: displacement and velocity over the angle, each with a dot that follows."""

from __future__ import annotations

from collections.abc import Sequence
from math import degrees, floor, log10

import numpy as np
from matplotlib.axes import Axes
from matplotlib.figure import Figure
from matplotlib.lines import Line2D
from matplotlib.text import Text

from ncgear.numerics.arrays import Array
from ncgear.output.animation import looks
from ncgear.output.animation.artists import Moving
from ncgear.output.plots.canvas import DRIVING, INK, NORMAL, SMALL, dress
from ncgear.output.plots.curves import DISPLACEMENT, VELOCITY, Quantity
from ncgear.scene.scene import Poses, Scene

CURVE_POINTS = 721
"""One every half degree of a turn."""

TICKS = 4
"""Steps of the scale of angles over the loop."""


def charts(both: Sequence[Axes], scene: Scene) -> list[Moving]:
    """Displacement and velocity over the loop on two axes, with the present value in words."""
    phi1 = np.linspace(0.0, scene.loop_rad, CURVE_POINTS)
    motion = scene.machine.motion(phi1)
    kinds = DISPLACEMENT, VELOCITY.readable(motion)
    return [_chart(axes, phi1, kind.of(motion), kind) for axes, kind in zip(both, kinds, strict=True)]


def _chart(axes: Axes, phi1: Array, values: Array, quantity: Quantity) -> Moving:
    axes.plot(np.degrees(phi1), values, color=DRIVING, linewidth=1.2)
    axes.axhline(0.0, color=INK, linewidth=0.5)
    dress(axes, "", "")
    axes.set_xlim(0.0, degrees(phi1[-1]))
    axes.set_xticks(np.linspace(0.0, degrees(phi1[-1]), TICKS + 1))
    axes.locator_params(axis="y", nbins=4)
    axes.xaxis.set_major_formatter("{x:.0f}\u00b0")
    digits = _digits(values)
    dot = Line2D([], [], zorder=4, **looks.PITCH_POINT)
    words = axes.text(0.0, 1.06, "", transform=axes.transAxes, size=SMALL, color=INK, va="bottom")
    axes.add_artist(dot)

    def pose(poses: Poses, row: int) -> None:
        # Adding zero turns a rounded -0 into 0.
        value = round(float(quantity.of(poses.motion)[row]), digits) + 0.0
        dot.set_data([degrees(poses.motion.phi1_rad[row])], [value])
        words.set_text(f"{quantity.name} {value:.{digits}f} {quantity.unit}")

    return Moving((dot, words), pose)


def angles(figure: Figure, x: float, y: float) -> Moving:
    """Both angles in words, right-aligned to a point given in shares of the figure."""
    words: Text = figure.text(x, y, "", size=NORMAL, color=INK, ha="right", va="top", family="DejaVu Sans Mono")

    def pose(poses: Poses, row: int) -> None:
        turned = poses.motion.phi1_rad[row], poses.motion.phi2_rad[row]
        phi1, phi2 = (round(degrees(angle), 1) + 0.0 for angle in turned)
        words.set_text(f"phi1 {phi1:5.1f}\u00b0  phi2 {phi2:5.1f}\u00b0")

    return Moving((words,), pose)


def _digits(values: Array) -> int:
    """Decimals that tell the greatest of the values to three digits, which is as much as the eye follows."""
    largest = float(np.abs(values).max())
    return max(0, 2 - floor(log10(largest))) if largest > 0.0 else 0
