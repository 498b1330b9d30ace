"""Pictures of a train of gears: all parts with the paths of followed points, every mesh, and moving frames."""

from __future__ import annotations

from collections.abc import Iterator, Mapping
from typing import Any

import numpy as np
from matplotlib.axes import Axes
from matplotlib.colors import to_rgba
from matplotlib.patches import Polygon
from matplotlib.transforms import Affine2D

from ncgear.drawings.animation.moving_picture import Frame, opaque
from ncgear.drawings.animation.packing import Frames
from ncgear.drawings.plots import canvas
from ncgear.numerics.arrays import Array
from ncgear.numerics.plane import as_points
from ncgear.trains.train import GROUND, GearMesh, Part, Poses, Train

WIDTH_IN, HEIGHT_IN = 8.2, 7.0

PATH_POINTS = 720

COLORS = (canvas.DRIVING, canvas.DRIVEN, canvas.HIGHLIGHT)


def train_picture(train: Train, outlines_mm: Mapping[str, Array], driving_rad: float, title: str) -> bytes:
    """PNG of the whole train at a driving angle, with the paths of all traces and the points to be followed."""
    made = canvas.figure(WIDTH_IN, HEIGHT_IN, title, canvas.Margins(left=0.7, right=0.2, top=0.5))
    axes = made.add_subplot()
    poses = train.poses_at(np.array([driving_rad]))
    for number, part in sorted(enumerate(train.parts), key=lambda numbered: numbered[1].low_mm):
        _draw(axes, part, outlines_mm[part.name], poses, number, color_of(train, part))
    _draw_traces(axes, train, 3.5)
    axes.set_aspect("equal", adjustable="datalim")
    canvas.dress(axes, "x in mm", "y in mm")
    return canvas.png(made)


def _draw_traces(axes: Axes, train: Train, point: float) -> None:
    """The paths of followed points over a cycle, and the points that are wished."""
    angles = np.linspace(0.0, train.cycle_rad, PATH_POINTS * train.turns + 1)
    for trace in train.traces:
        axes.plot(*train.trace_mm(trace, angles).T, color=canvas.HIGHLIGHT, linewidth=1.4)
        axes.plot(*trace.wished_mm.T, "o", color=canvas.INK, markersize=point)


def color_of(train: Train, part: Part) -> str:
    """The colour of a part: gears that mesh have different colours, bars and fixed parts are grey."""
    return COLORS[train.tints[part.name] % len(COLORS)] if part.teeth else canvas.REFERENCE


def _draw(axes: Axes, part: Part, outline_mm: Array, poses: Poses, number: int, color: str) -> None:
    (axis,), (turn,) = poses.places(number)
    placed = axis + (outline_mm @ np.array([1.0, 1.0j])) * turn
    if part.rim_mm is None:
        face = to_rgba(color, 0.35 if part.teeth else 0.15)
        # The line below has the same extent, which the axes need not find in every chord of the area
        axes.add_artist(Polygon(as_points(placed), closed=True, facecolor=face, linewidth=0.0))
    axes.plot(*_closed(placed), color=color, linewidth=0.8)
    if part.rim_mm is not None:
        circle = axis + part.reach_mm * np.exp(1j * np.linspace(0.0, 2.0 * np.pi, 181))
        axes.plot(circle.real, circle.imag, color=color, linewidth=0.8)
    marker = "x" if part.fixed_to == GROUND else "+"
    axes.plot(axis.real, axis.imag, marker, color=canvas.INK, markersize=5)


def _closed(points: Array) -> tuple[Array, Array]:
    closed = np.append(points, points[:1])
    return closed.real, closed.imag


MOST_MESHES = 9
"""Most meshes that are all drawn; of more, which repeat at other phases, only the first of each two outlines."""


def _drawn_meshes(train: Train) -> list[GearMesh]:
    if len(train.meshes) <= MOST_MESHES:
        return list(train.meshes)
    first: dict[tuple[int, int], GearMesh] = {}
    for mesh in train.meshes:
        first.setdefault((id(train.part(mesh.first).outline_mm), id(train.part(mesh.second).outline_mm)), mesh)
    return list(first.values())


def meshes_picture(train: Train, outlines_mm: Mapping[str, Array], title: str) -> bytes:
    """PNG of the meshes at driving angle 0: each gear with its partner, in the pose in which they are assembled."""
    meshes = _drawn_meshes(train)
    columns = min(len(meshes), 3)
    rows = -(-len(meshes) // columns)
    made = canvas.figure(
        3.6 * columns + 0.3,
        3.6 * rows + 0.6,
        title,
        canvas.Margins(left=0.5, right=0.1, bottom=0.5, top=0.8),
        hspace=0.35,
    )
    poses = train.assembled
    for place, mesh in enumerate(meshes, start=1):
        axes = made.add_subplot(rows, columns, place)
        said = []
        for name in (mesh.first, mesh.second):
            number = train.number(name)
            _draw(axes, train.parts[number], outlines_mm[name], poses, number, color_of(train, train.parts[number]))
            turned = round(float(np.degrees(poses.angle_rad[number, 0])), 3) % 360.0
            said.append(f"{name}, {train.parts[number].teeth} teeth, at {turned:.3f} deg")
        axes.set_title("\n".join(said), size=canvas.SMALL, color=canvas.INK)
        axes.set_aspect("equal", adjustable="datalim")
        canvas.dress(axes, "", "")
    return canvas.png(made)


FRAME_WIDTH_IN = 7.0
"""Width in inches for which lines and letters are sized."""

HEADING_IN = 0.4


def train_frames(train: Train, title: str, width_px: int) -> Frames:
    """A function that draws frames over a cycle of the train, at a width in pixels."""
    low, high = train.room_mm()
    size = high - low
    height_in = FRAME_WIDTH_IN * size[1] / size[0] + HEADING_IN
    made = canvas.figure(FRAME_WIDTH_IN, height_in, title)
    # Videos need even numbers of pixels.
    made.set_dpi(2 * round(width_px / 2) / FRAME_WIDTH_IN)
    made.set_figheight(2 * round(height_in * made.dpi / 2) / made.dpi)
    axes = made.add_axes((0.0, 0.0, 1.0, 1.0 - HEADING_IN / height_in))
    canvas.look_at(axes, (*low, *size))
    _draw_traces(axes, train, 3.0)
    patches = []
    for number, part in sorted(enumerate(train.parts), key=lambda numbered: numbered[1].low_mm):
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
