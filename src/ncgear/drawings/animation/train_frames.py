"""Frames of a train of gears that moves: all parts in the ground's frame, the paths of followed points behind them."""

from __future__ import annotations

from collections.abc import Iterator
from typing import Any

import numpy as np
from matplotlib.colors import to_rgba
from matplotlib.patches import Polygon
from matplotlib.transforms import Affine2D

from ncgear.drawings.animation.moving_picture import Frame, opaque
from ncgear.drawings.animation.packing import Frames
from ncgear.drawings.plots import canvas
from ncgear.drawings.plots.train_picture import PATH_POINTS, color_of
from ncgear.trains.train import Train

MARGIN = 0.04
"""Margin of the picture, as a share of its larger side."""

WIDTH_IN = 7.0
"""Width in inches for which lines and letters are sized."""

HEADING_IN = 0.4


def train_frames(train: Train, title: str, width_px: int) -> Frames:
    """What draws so many frames over a cycle of the train, at a width in pixels."""
    low, high = _room(train)
    size = high - low
    height_in = WIDTH_IN * size[1] / size[0] + HEADING_IN
    made = canvas.figure(WIDTH_IN, height_in, title)
    # Videos need even numbers of pixels.
    made.set_dpi(2 * round(width_px / 2) / WIDTH_IN)
    made.set_figheight(2 * round(height_in * made.dpi / 2) / made.dpi)
    axes = made.add_axes((0.0, 0.0, 1.0, 1.0 - HEADING_IN / height_in))
    axes.set_xlim(low[0], high[0])
    axes.set_ylim(low[1], high[1])
    axes.set_aspect("equal")
    axes.set_axis_off()
    angles = np.linspace(0.0, train.cycle_rad, PATH_POINTS)
    for trace in train.traces:
        axes.plot(*train.trace_mm(trace, angles).T, color=canvas.HIGHLIGHT, linewidth=1.4)
        axes.plot(*trace.wished_mm.T, "o", color=canvas.INK, markersize=3.0)
    patches = []
    for number, part in sorted(enumerate(train.parts), key=lambda one: one[1].low_mm):
        color = color_of(train, part)
        face = to_rgba(color, 0.35 if part.teeth else 0.15)
        patch = Polygon(part.outline_mm, closed=True, facecolor=face, edgecolor=color, linewidth=0.8)
        axes.add_patch(patch)
        patches.append((number, patch))
    tips = axes.plot([], [], "o", color=canvas.HIGHLIGHT, markersize=5.0)[0]

    def frames(count: int) -> Iterator[Frame]:
        # Matplotlib has no types for the canvas of Agg and its buffers.
        drawn: Any = made.canvas
        driving = np.linspace(0.0, train.cycle_rad, count, endpoint=False)
        poses = train.poses_at(driving)
        traced = [train.trace_mm(trace, driving) for trace in train.traces]
        for row in range(count):
            for number, patch in patches:
                turn = Affine2D().rotate(float(poses.angle_rad[number, row]))
                place = turn.translate(float(poses.x_mm[number, row]), float(poses.y_mm[number, row]))
                patch.set_transform(place + axes.transData)
            tips.set_data([path[row, 0] for path in traced], [path[row, 1] for path in traced])
            drawn.draw()
            yield opaque(np.asarray(drawn.buffer_rgba()))

    return frames


def _room(train: Train) -> tuple[Any, Any]:
    """The corners of the smallest upright rectangle, with a margin, in which all parts stay over a cycle."""
    poses = train.poses_at(np.linspace(0.0, train.cycle_rad, 61))
    corners = []
    for number, part in enumerate(train.parts):
        axis, turn = poses.places(number)
        placed = axis[:, None] + turn[:, None] * (part.outline_mm @ np.array([1.0, 1.0j]))
        corners.append([placed.real.min(), placed.imag.min(), placed.real.max(), placed.imag.max()])
    low, high = np.min(corners, axis=0)[:2], np.max(corners, axis=0)[2:]
    margin = MARGIN * float((high - low).max())
    return low - margin, high + margin
