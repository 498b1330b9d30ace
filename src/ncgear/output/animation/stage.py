"""A view of the scene on axes: what stands, and what moves from the back to the front."""

from __future__ import annotations

from collections.abc import Iterator

from matplotlib.axes import Axes
from matplotlib.collections import LineCollection
from matplotlib.patches import Circle
from matplotlib.transforms import Affine2D, Transform

from ncgear.output.animation import looks
from ncgear.output.animation.artists import (
    Moving,
    axis_artist,
    body_artist,
    gear_artists,
    material_artists,
    pin_artists,
    pitch_point_artist,
)
from ncgear.scene.scene import Poses, Scene
from ncgear.scene.standing import hatches_mm, wall_mm
from ncgear.scene.views import Box


def look_at(axes: Axes, box: Box) -> float:
    """Set the limits to a box, at equal scales; returns the size of a pixel in mm."""
    left, bottom, width, height = box
    axes.set_xlim(left, left + width)
    axes.set_ylim(bottom, bottom + height)
    axes.set_aspect("equal")
    axes.set_axis_off()
    axes.apply_aspect()
    return width / axes.bbox.width


def draw_standing(axes: Axes, scene: Scene) -> None:
    """Walls, the mark of the ground, and the circle of the crank pin."""
    wall = wall_mm(scene.chamber)
    sides = [wall] if scene.chamber.begins_mm is not None else [wall[:2], wall[2:]]
    axes.add_collection(LineCollection(list(hatches_mm(scene.chamber)), **looks.HATCHING), autolim=False)
    axes.add_collection(LineCollection(sides, **looks.WALL), autolim=False)
    axes.add_artist(Circle((0.0, 0.0), scene.machine.linkage.crank_mm, fill=False, **looks.ORBIT))


def machine(axes: Axes, scene: Scene, pixel_mm: float) -> Iterator[Moving]:
    """All that moves in the whole machine, from the back to the front."""
    slider, crank, rod = (body_artist(axes, body, pixel_mm, axes.transData) for body in scene.links)
    if scene.chamber.begins_mm is not None:
        yield material_artists(axes, scene)
    yield slider
    others = tuple(_gears(axes, scene, pixel_mm, axes.transData))
    yield from (crank, rod, *others) if scene.crank_is_behind else (*others, crank, rod)
    yield pin_artists(axes, scene)
    yield axis_artist(axes, scene, looks.SHAFT, axes.transData)


def gears(axes: Axes, scene: Scene, pixel_mm: float) -> Iterator[Moving]:
    """The gears with their pitch curves, line of centres, pitch points and shafts."""
    yield from _gears(axes, scene, pixel_mm, axes.transData)
    yield axis_artist(axes, scene, looks.SHAFT, axes.transData)


def mesh(axes: Axes, scene: Scene, pixel_mm: float) -> Iterator[Moving]:
    """The gears about the pitch point of the last pair, which stays at the origin of the axes."""
    camera = Affine2D()

    def pose(poses: Poses, row: int) -> None:
        x, y = poses.pitch_points_mm[-1][row]
        camera.clear().translate(-float(x), -float(y))

    yield Moving((), pose)
    yield from _gears(axes, scene, pixel_mm, camera + axes.transData)


def _gears(axes: Axes, scene: Scene, pixel_mm: float, to_screen: Transform) -> Iterator[Moving]:
    for pair in scene.pairs:
        yield gear_artists(axes, pair.driving, pixel_mm, to_screen)
        yield gear_artists(axes, pair.driven, pixel_mm, to_screen)
    yield axis_artist(axes, scene, looks.CENTRES, to_screen)
    if scene.pairs:
        yield pitch_point_artist(axes, scene, to_screen)
