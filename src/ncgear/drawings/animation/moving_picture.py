"""The moving picture of a machine: the machine beside its gears, and two charts below; frames as arrays of pixels.

Parts that stand still are drawn once, as a background.  For each frame the moving parts are drawn over it, from the
back to the front; this takes a tenth of the time of a new figure.  The charts show displacement and velocity over the
driving angle; in each a dot follows the motion, and a number gives the present value.  The words beside numbers are
part of the background: letters would take most of the time of a frame.
"""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from math import degrees
from typing import Any

import numpy as np
from matplotlib.axes import Axes
from matplotlib.collections import LineCollection
from matplotlib.figure import Figure, SubFigure
from matplotlib.lines import Line2D
from matplotlib.patches import Circle
from matplotlib.text import Text
from matplotlib.transforms import Affine2D, ScaledTranslation, Transform
from numpy.typing import NDArray

from ncgear.drawings.animation import artists as looks
from ncgear.drawings.animation.artists import MovingArtists, standing_artist
from ncgear.drawings.charts.chart import Chart, Quantity, Role, decimals_of, motion_chart
from ncgear.drawings.charts.drawer import Look, draw
from ncgear.drawings.plots.canvas import DRIVEN, DRIVING, EDGE_IN, INK, NORMAL, SMALL, Style, dress, figure, look_at
from ncgear.drawings.scene.scene import Scene, ScenePoses
from ncgear.drawings.scene.standing import Box, hatches_mm, support_hatches_mm, supports_mm, views, walls_mm
from ncgear.figures.numbers import fixed, rounded
from ncgear.frozen import dataclass
from ncgear.kinematics.motion import OutputMotion
from ncgear.mechanisms.mechanism import Mechanism


def draw_standing(axes: Axes, scene: Scene) -> None:
    """Draw walls, supports, the mark of the ground, and the circle of the crank pin."""
    linkage = scene.machine.linkage
    if not scene.links:
        return
    lines = [*supports_mm(linkage), *walls_mm(scene)]
    hatches = [*support_hatches_mm(linkage), *hatches_mm(scene)]
    axes.add_collection(LineCollection(hatches, **looks.HATCHING), autolim=False)
    axes.add_collection(LineCollection(lines, **looks.WALL), autolim=False)
    axes.add_artist(Circle((0.0, 0.0), scene.machine.linkage.crank_mm, fill=False, **looks.ORBIT))


def machine(axes: Axes, scene: Scene, pixel_mm: float) -> Iterator[MovingArtists]:
    """All moving parts of the whole machine, from the back to the front."""
    bodies = [looks.body_artist(axes, body, pixel_mm, axes.transData) for body in scene.links]
    output, links = bodies[:1], bodies[1:]
    yield from looks.material_artists(axes, scene)
    yield from output
    others = tuple(_gears(axes, scene, pixel_mm, axes.transData))
    yield from (*links, *others) if scene.crank_is_behind else (*others, *links)
    yield looks.pin_artists(axes, scene)
    pivots = np.array([*scene.machine.linkage.pivots_mm.values()]).reshape(-1, 2)
    yield standing_artist(axes, pivots, looks.SHAFT, axes.transData)
    yield standing_artist(axes, np.array(scene.axes_mm), looks.SHAFT, axes.transData)


def gears(axes: Axes, scene: Scene, pixel_mm: float) -> Iterator[MovingArtists]:
    """The gears with their pitch curves, line of centres, pitch points and shafts."""
    yield from _gears(axes, scene, pixel_mm, axes.transData)
    yield standing_artist(axes, np.array(scene.axes_mm), looks.SHAFT, axes.transData)


def mesh(axes: Axes, scene: Scene, pixel_mm: float) -> Iterator[MovingArtists]:
    """The gears around the pitch point of the last pair, which stays at the origin of the axes."""
    camera = Affine2D()

    def pose(poses: ScenePoses, row: int) -> None:
        x, y = poses.pitch_points_mm[-1][row]
        camera.clear().translate(-float(x), -float(y))

    yield MovingArtists((), pose)
    yield from _gears(axes, scene, pixel_mm, camera + axes.transData)


def _gears(axes: Axes, scene: Scene, pixel_mm: float, to_screen: Transform) -> Iterator[MovingArtists]:
    for pair in scene.pairs:
        yield looks.gear_artists(axes, pair.driving, pixel_mm, to_screen)
        yield looks.gear_artists(axes, pair.driven, pixel_mm, to_screen)
    yield standing_artist(axes, np.array(scene.axes_mm), looks.CENTRES, to_screen)
    if scene.pairs:
        yield looks.pitch_point_artist(axes, to_screen)


CURVE_POINTS = 721
"""Points of a chart's line: one every half degree of a turn."""

DIGITS = 3
"""Significant digits of the largest value of a chart; the eye does not follow more."""

TICKS = 4
"""Number of steps of a chart's scale of angles over the loop."""


def charts(both: Sequence[Axes], scene: Scene) -> list[MovingArtists]:
    """Displacement and velocity over the loop on two axes, with the present value in words."""
    phi1 = np.linspace(0.0, scene.loop_rad, CURVE_POINTS)
    motion = scene.machine.motion(phi1)
    shown = Quantity.DISPLACEMENT, Quantity.VELOCITY
    linkage = scene.machine.linkage
    return [_chart(axes, linkage, motion, quantity) for axes, quantity in zip(both, shown, strict=True)]


def _chart(axes: Axes, linkage: Mechanism, motion: OutputMotion, quantity: Quantity) -> MovingArtists:
    chart = motion_chart(quantity, linkage, motion)
    draw(axes, chart, CHART_LOOK)
    decimals = decimals_of(float(np.abs(chart.own.values).max()), DIGITS)
    dot = Line2D([], [], zorder=4, **looks.PITCH_POINT)
    axes.add_artist(dot)
    widest = max((fixed(value, decimals) for value in chart.own.values), key=len)
    number = _number_in_words(axes, f"{chart.name} ", widest, f" {chart.unit}")

    def pose(poses: ScenePoses, row: int) -> None:
        value = rounded(quantity.values(poses.motion, linkage.OUTPUT)[row], decimals)
        dot.set_data([degrees(poses.motion.phi1_rad[row])], [value])
        number.set_text(fixed(value, decimals))

    return MovingArtists((dot, number), pose)


ABOVE = 1.06
"""Height at which words stand above axes, as a share of the axes' height."""


def _number_in_words(axes: Axes, before: str, widest: str, after: str) -> Text:
    """A number above the left end of axes; fixed words stand before it, and after the room for the widest number."""
    made = axes.figure
    style: Style = {"size": SMALL, "color": INK, "va": "bottom"}
    begins_in = _width_in(made, before, style)
    ends_in = begins_in + _width_in(made, widest, style)
    start, end = (axes.transAxes + ScaledTranslation(x, 0.0, made.dpi_scale_trans) for x in (begins_in, ends_in))
    axes.text(0.0, ABOVE, before, transform=start, ha="right", **style)
    axes.text(0.0, ABOVE, after, transform=end, **style)
    return axes.text(0.0, ABOVE, "", transform=end, ha="right", **style)


def _width_in(made: Figure | SubFigure, words: str, style: Style) -> float:
    probe = made.text(0.0, 0.0, words, **style)
    width = float(probe.get_window_extent().width) / made.dpi
    probe.remove()
    return width


def _dress_chart(axes: Axes, chart: Chart, _: str) -> None:
    axes.axhline(0.0, color=INK, linewidth=0.5)
    dress(axes, "", "")
    axes.set_xlim(0.0, chart.end)
    axes.set_xticks(np.linspace(0.0, chart.end, TICKS + 1))
    axes.locator_params(axis="y", nbins=4)
    axes.xaxis.set_major_formatter("{x:.0f}\u00b0")


CHART_LOOK = Look({Role.OWN: {"color": DRIVING, "linewidth": 1.2}}, marks_extremes=False, finish=_dress_chart)


def angles(figure: Figure, x: float, y: float) -> MovingArtists:
    """Both angles in words that end at a point given in shares of the figure; only their numbers move."""
    style: Style = {"size": NORMAL, "color": INK, "ha": "right", "va": "top", "family": "DejaVu Sans Mono"}
    figure.text(x, y, ANGLES, **style)
    letter = _width_in(figure, ANGLES, style) / len(ANGLES) / figure.get_figwidth()
    after = [len(ANGLES) - place for place, sign in enumerate(ANGLES) if sign == DEGREE]
    numbers = tuple(figure.text(x - count * letter, y, "", **style) for count in after)

    def pose(poses: ScenePoses, row: int) -> None:
        for number, angle in zip(numbers, (poses.motion.phi1_rad[row], poses.motion.phi2_rad[row]), strict=True):
            number.set_text(fixed(degrees(angle), 1))

    return MovingArtists(numbers, pose)


DEGREE = "\u00b0"
ANGLES = f"phi1 {DEGREE:>6}  phi2 {DEGREE:>6}"
"""Words about both angles, with room for five letters of each."""


Frame = NDArray[np.uint8]
"""Pixels, shape (height, width, 3)."""

WIDTH_IN = 9.6
"""Width in inches for which lines and letters are sized; the resolution follows from the width in pixels."""

HEADING_IN = 0.52
BELOW_IN = 0.42
CHART_IN = 0.72
FOOT_IN = 0.34
"""Heights in inches from top to bottom, without the views: heading, words of the charts, charts, their scale."""

GAP_IN = 0.12
"""Space between views in inches."""

NAME_PT = 42.0
"""Width of a gear's name in points, with the space before it."""

LOWEST_IN, HIGHEST_IN = 2.2, 4.6
"""Bounds of the height of the views in inches."""

LARGE_GEARS = 0.4
"""Gears wider than this share of the machine are large enough in the view of the machine."""


@dataclass(frozen=True, eq=False)
class Picture:
    """A figure whose moving artists are drawn frame by frame."""

    figure: Figure
    moving: tuple[MovingArtists, ...]

    def frames(self, poses: ScenePoses) -> Iterator[Frame]:
        """A frame for each pose."""
        # Matplotlib has no types for the canvas of Agg and its buffers.
        canvas: Any = self.figure.canvas
        canvas.draw()
        background = canvas.copy_from_bbox(self.figure.bbox)
        for row in range(poses.motion.phi1_rad.size):
            canvas.restore_region(background)
            for moving in self.moving:
                moving.pose(poses, row)
                for artist in moving.artists:
                    artist.draw(canvas.get_renderer())
            yield opaque(np.asarray(canvas.buffer_rgba()))


def opaque(pixels: NDArray[np.uint8]) -> Frame:
    """Red, green and blue of pixels (height, width, 4); copying one colour at a time is fastest."""
    frame = np.empty((*pixels.shape[:2], 3), np.uint8)
    for color in range(3):
        frame[..., color] = pixels[..., color]
    return frame


def picture(scene: Scene, width_px: int) -> Picture:
    """The picture of a scene at a width in pixels; both sides become even numbers, because videos need them."""
    boxes = _shown(scene)
    shapes = [width / height for _, _, width, height in boxes.values()]
    views_in = float(np.clip((WIDTH_IN - (len(boxes) + 1) * GAP_IN) / sum(shapes), LOWEST_IN, HIGHEST_IN))
    made = _figure(views_in, width_px, scene.name)
    panels = dict(zip(boxes, _panels(made, shapes, views_in), strict=True))
    pixel_mm = {name: look_at(axes, boxes[name]) for name, axes in panels.items()}
    draw_standing(panels["machine"], scene)
    moving = [*machine(panels["machine"], scene, pixel_mm["machine"])]
    for name, view in (("gears", gears), ("mesh", mesh)):
        if name in panels:
            moving += view(panels[name], scene, pixel_mm[name])
            _name_gears(panels[name])
    moving += charts(_chart_axes(made), scene)
    moving.append(angles(made, 1.0 - EDGE_IN / WIDTH_IN, 1.0 - EDGE_IN / made.get_figheight()))
    for part in moving:
        for artist in part.artists:
            # Matplotlib leaves animated artists out of the background.
            artist.set_animated(True)
    return Picture(made, tuple(moving))


def _shown(scene: Scene) -> dict[str, Box]:
    """The boxes of the machine and of the view beside it: the gears, or their mesh if the gears are large."""
    found = views(scene)
    if not scene.pairs:
        return found
    large = found["gears"][2] > LARGE_GEARS * found["machine"][2]
    beside = "mesh" if large else "gears"
    return {name: found[name] for name in ("machine", beside)}


def _figure(views_in: float, width_px: int, title: str) -> Figure:
    height_in = HEADING_IN + views_in + BELOW_IN + CHART_IN + FOOT_IN
    dpi = even(width_px) / WIDTH_IN
    made = figure(WIDTH_IN, even(height_in * dpi) / dpi, title)
    made.set_dpi(dpi)
    return made


def even(pixels: float) -> int:
    """The nearest even number."""
    return 2 * round(pixels / 2.0)


def _panels(made: Figure, shapes: list[float], views_in: float) -> list[Axes]:
    """Axes side by side; their widths have the ratio of the given shapes (width by height)."""
    height = made.get_figheight()
    bottom, room = (height - HEADING_IN - views_in) / height, WIDTH_IN - (len(shapes) + 1) * GAP_IN
    widths = [room * shape / sum(shapes) for shape in shapes]
    starts = np.cumsum([GAP_IN, *(width + GAP_IN for width in widths[:-1])])
    places = zip(starts, widths, strict=True)
    return [made.add_axes((start / WIDTH_IN, bottom, width / WIDTH_IN, views_in / height)) for start, width in places]


def _chart_axes(made: Figure) -> tuple[Axes, Axes]:
    height, left, middle = made.get_figheight(), 0.06, 0.555
    bottom, share, width = FOOT_IN / height, CHART_IN / height, 0.425
    return made.add_axes((left, bottom, width, share)), made.add_axes((middle, bottom, width, share))


def _name_gears(axes: Axes) -> None:
    for name, color, left_pt in (("driven", DRIVEN, 0.0), ("driving", DRIVING, NAME_PT)):
        words = axes.annotate(name, (1.0, 1.0), (-left_pt, 2.0), xycoords="axes fraction", textcoords="offset points")
        words.set(color=color, size=SMALL, weight="bold", ha="right", va="bottom")
