"""The moving picture: the machine beside its gears, two charts below; frames as arrays of pixels.

What stands is drawn once.  A frame is that background with what moves drawn over it: a tenth of the time of a figure
drawn anew.
"""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import dataclass
from typing import Any

import numpy as np
from matplotlib.axes import Axes
from matplotlib.figure import Figure
from numpy.typing import NDArray

from ncgear.output.animation.artists import Moving
from ncgear.output.animation.readout import angles, charts
from ncgear.output.animation.stage import draw_standing, gears, look_at, machine, mesh
from ncgear.output.plots.canvas import DRIVEN, DRIVING, EDGE_IN, SMALL, figure
from ncgear.scene.scene import Poses, Scene
from ncgear.scene.views import Box, views

Frame = NDArray[np.uint8]
"""Pixels, shape (height, width, 3)."""

WIDTH_IN = 9.6
"""Width in inches for which lines and letters are sized; pixels are what the resolution makes of it."""

HEADING_IN = 0.52
CHART_IN = 0.72
FOOT_IN = 0.34
GAP_IN = 0.12
"""Heights of the heading and of the charts, room below the charts, space between views."""

NAME_PT = 42.0
"""Width of the name of a gear in points, with the space before it."""

LOWEST_IN, HIGHEST_IN = 2.2, 4.6
"""Bounds of the height of the views."""

LARGE = 0.4
"""Share of the machine's width from which on gears are large in its view."""

BELOW_IN = 0.42
"""Between views and charts, where the charts' words are."""


@dataclass(frozen=True, eq=False)
class Picture:
    """A figure whose moving artists are drawn frame by frame."""

    figure: Figure
    machine: Axes
    moving: tuple[Moving, ...]

    def frames(self, poses: Poses) -> Iterator[Frame]:
        """A frame for each pose."""
        # Of what it draws on, matplotlib tells no types.
        canvas: Any = self.figure.canvas
        canvas.draw()
        background = canvas.copy_from_bbox(self.figure.bbox)
        for row in range(poses.motion.phi1_rad.size):
            canvas.restore_region(background)
            for moving in self.moving:
                moving.pose(poses, row)
                for artist in moving.artists:
                    artist.draw(canvas.get_renderer())
            yield np.asarray(canvas.buffer_rgba())[..., :3].copy()


def picture(scene: Scene, width_px: int) -> Picture:
    """The picture of a scene, so many pixels wide; both its sides are even numbers of pixels, as videos want them."""
    boxes = _shown(scene)
    shapes = [width / height for _, _, width, height in boxes.values()]
    views_in = float(np.clip((WIDTH_IN - (len(boxes) + 1) * GAP_IN) / sum(shapes), LOWEST_IN, HIGHEST_IN))
    made = _figure(views_in, width_px, scene.name)
    panels = dict(zip(boxes, _panels(made, shapes, views_in), strict=True))
    pixel_mm = {name: look_at(axes, boxes[name]) for name, axes in panels.items()}
    draw_standing(panels["machine"], scene)
    moving = [*machine(panels["machine"], scene, pixel_mm["machine"])]
    for name, draw in (("gears", gears), ("mesh", mesh)):
        if name in panels:
            moving += draw(panels[name], scene, pixel_mm[name])
            _names(panels[name])
    moving += charts(_charts(made), scene)
    moving.append(angles(made, 1.0 - EDGE_IN / WIDTH_IN, 1.0 - EDGE_IN / made.get_figheight()))
    return Picture(made, panels["machine"], tuple(_animated(moving)))


def _shown(scene: Scene) -> dict[str, Box]:
    """The machine, and beside it the gears or, where these are large in it already, their mesh."""
    found = views(scene)
    if not scene.pairs:
        return found
    large = found["gears"][2] > LARGE * found["machine"][2]
    beside = "mesh" if large else "gears"
    return {name: found[name] for name in ("machine", beside)}


def _animated(moving: list[Moving]) -> Iterator[Moving]:
    """The same, left out of the background."""
    for one in moving:
        for artist in one.artists:
            artist.set_animated(True)
        yield one


def _figure(views_in: float, width_px: int, title: str) -> Figure:
    height_in = HEADING_IN + views_in + BELOW_IN + CHART_IN + FOOT_IN
    dpi = even(width_px) / WIDTH_IN
    made = figure(WIDTH_IN, even(height_in * dpi) / dpi, title)
    made.set_dpi(dpi)
    return made


def even(pixels: float) -> int:
    """The even number next to it."""
    return 2 * round(pixels / 2.0)


def _panels(made: Figure, shapes: list[float], views_in: float) -> list[Axes]:
    """Axes side by side, as wide as what they show is for its height."""
    height = made.get_figheight()
    bottom, room = (height - HEADING_IN - views_in) / height, WIDTH_IN - (len(shapes) + 1) * GAP_IN
    widths = [room * shape / sum(shapes) for shape in shapes]
    starts = np.cumsum([GAP_IN, *(width + GAP_IN for width in widths[:-1])])
    places = zip(starts, widths, strict=True)
    return [made.add_axes((start / WIDTH_IN, bottom, width / WIDTH_IN, views_in / height)) for start, width in places]


def _charts(made: Figure) -> tuple[Axes, Axes]:
    height, left, middle = made.get_figheight(), 0.06, 0.555
    bottom, share, width = FOOT_IN / height, CHART_IN / height, 0.425
    return made.add_axes((left, bottom, width, share)), made.add_axes((middle, bottom, width, share))


def _names(axes: Axes) -> None:
    """Which colour is which gear, above the view's right end."""
    for name, color, left_pt in (("driven", DRIVEN, 0.0), ("driving", DRIVING, NAME_PT)):
        words = axes.annotate(name, (1.0, 1.0), (-left_pt, 2.0), xycoords="axes fraction", textcoords="offset points")
        words.set(color=color, size=SMALL, weight="bold", ha="right", va="bottom")
