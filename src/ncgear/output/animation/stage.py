"""A view of the scene on axes: what stands is drawn once, what moves is told its pose frame by frame.

Every body is a path in its own frame under a transform of its own; a new pose changes six numbers of it.
"""

from __future__ import annotations

from collections.abc import Callable, Iterator, Sequence
from dataclasses import dataclass

import numpy as np
from matplotlib.artist import Artist
from matplotlib.axes import Axes
from matplotlib.collections import LineCollection
from matplotlib.lines import Line2D
from matplotlib.patches import Circle, PathPatch, Rectangle
from matplotlib.path import Path
from matplotlib.transforms import Affine2D, Transform

from ncgear.numerics.arrays import Array
from ncgear.output.animation import looks
from ncgear.scene.bodies import Body, Places
from ncgear.scene.gears import SceneGear
from ncgear.scene.links import pin_radius_mm
from ncgear.scene.scene import Poses, Scene
from ncgear.scene.simplified import simplified
from ncgear.scene.standing import hatches_mm, straws, wall_mm
from ncgear.scene.views import Box

PIXEL_SHARE = 0.1
"""How far a drawn outline may stray from the written one, in pixels: less than Agg's sixteenth levels of grey show."""

Moved = Callable[[Poses, int], None]


@dataclass(frozen=True)
class Moving:
    """Artists in the order in which they are drawn, and what puts them into one of the poses."""

    artists: tuple[Artist, ...]
    pose: Moved


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
    slider, crank, rod = (_body(axes, body, pixel_mm, axes.transData) for body in scene.links)
    if scene.chamber.begins_mm is not None:
        yield _material(axes, scene)
    yield slider
    others = tuple(gears(axes, scene, pixel_mm))
    yield from (crank, rod, *others) if scene.crank_is_behind else (*others, crank, rod)
    yield _pins(axes, scene)


def gears(axes: Axes, scene: Scene, pixel_mm: float) -> Iterator[Moving]:
    """The gears with their pitch curves, lines of centres, shafts and pitch points."""
    yield from _gears(axes, scene, pixel_mm, axes.transData)


def mesh(axes: Axes, scene: Scene, pixel_mm: float) -> Iterator[Moving]:
    """The gears about the pitch point of the last pair, which stays where the axes have their origin."""
    camera = Affine2D()

    def pose(poses: Poses, row: int) -> None:
        x, y = poses.pitch_points_mm[-1][row]
        camera.clear().translate(-float(x), -float(y))

    yield Moving((), pose)
    yield from _gears(axes, scene, pixel_mm, camera + axes.transData)


def _gears(axes: Axes, scene: Scene, pixel_mm: float, to_screen: Transform) -> Iterator[Moving]:
    for pair in scene.pairs:
        yield _gear(axes, pair.driving, pixel_mm, to_screen)
        yield _gear(axes, pair.driven, pixel_mm, to_screen)
    yield _axes_of_rotation(axes, scene, to_screen)
    if scene.pairs:
        yield _pitch_points(axes, scene, to_screen)


def _body(axes: Axes, body: Body, pixel_mm: float, to_screen: Transform) -> Moving:
    contours = simplified(body.contours_mm, PIXEL_SHARE * pixel_mm)
    transform = Affine2D()
    # Not snapped to whole pixels, or what moves slowly would jump from one to the next.
    patch = PathPatch(_path(contours), transform=transform + to_screen, snap=False, **looks.BODIES[body.kind])
    axes.add_artist(patch)
    return Moving((patch,), lambda poses, row: _place(transform, poses.places[body.name], row))


def _gear(axes: Axes, gear: SceneGear, pixel_mm: float, to_screen: Transform) -> Moving:
    filled = _body(axes, gear.body, pixel_mm, to_screen)
    (patch,) = filled.artists
    curve = Line2D(*gear.pitch_curve_mm.T, transform=patch.get_transform(), **looks.PITCH_CURVES[gear.body.kind])
    axes.add_artist(curve)
    return Moving((patch, curve), filled.pose)


def _place(transform: Affine2D, places: Places, row: int) -> None:
    x, y = places.origin_mm[row]
    transform.clear().rotate(float(places.angle_rad[row])).translate(float(x), float(y))


def _path(contours: Sequence[Array]) -> Path:
    """A compound path; holes run the other way round, which is how Agg knows them."""
    closed = [Path(np.vstack([contour, contour[:1]]), closed=True) for contour in contours]
    return Path.make_compound_path(*closed)


def _material(axes: Axes, scene: Scene) -> Moving:
    """A strip of unit depth that ends at the chamber's wall, squeezed to what is left of it."""
    chamber, squeezed = scene.chamber, Affine2D()
    transform = squeezed + axes.transData
    charge = Rectangle((-1.0, -0.5), 1.0, 1.0, transform=transform, **looks.CHARGE)
    grain = LineCollection(list(straws() - [1.0, 0.0]), transform=transform, **looks.STRAW)
    axes.add_artist(charge)
    axes.add_collection(grain, autolim=False)

    def pose(poses: Poses, row: int) -> None:
        squeezed.clear().scale(float(poses.material_mm[row]), chamber.height_mm)
        squeezed.translate(chamber.end_mm, chamber.linkage.offset_mm)

    return Moving((charge, grain), pose)


def _pins(axes: Axes, scene: Scene) -> Moving:
    pins = [Circle((0.0, 0.0), pin_radius_mm(scene.machine.linkage), **looks.PIN) for _ in range(2)]
    for pin in pins:
        axes.add_artist(pin)

    def pose(poses: Poses, row: int) -> None:
        for pin, name in zip(pins, ("rod", "slider"), strict=True):
            pin.set_center(tuple(poses.places[name].origin_mm[row]))

    return Moving(tuple(pins), pose)


def _axes_of_rotation(axes: Axes, scene: Scene, to_screen: Transform) -> Moving:
    """They stand, but over what moves."""
    places = np.array(scene.axes_mm).T
    drawn = Line2D(*places, transform=to_screen, **looks.CENTRES), Line2D(*places, transform=to_screen, **looks.SHAFT)
    for line in drawn:
        axes.add_artist(line)
    return Moving(drawn, lambda poses, row: None)


def _pitch_points(axes: Axes, scene: Scene, to_screen: Transform) -> Moving:
    points = Line2D([], [], transform=to_screen, **looks.PITCH_POINT)
    axes.add_artist(points)

    def pose(poses: Poses, row: int) -> None:
        points.set_data(*np.array([point[row] for point in poses.pitch_points_mm]).T)

    return Moving((points,), pose)
