"""The moving parts as artists of matplotlib, in the colours and lines of the moving picture.

Each path is in the frame of its body and has its own transform: a new pose changes six numbers, and no path.
"""

from __future__ import annotations

from collections.abc import Callable, Iterator, Sequence

import numpy as np
from matplotlib.artist import Artist
from matplotlib.axes import Axes
from matplotlib.collections import LineCollection
from matplotlib.colors import to_rgb
from matplotlib.lines import Line2D
from matplotlib.patches import Circle, PathPatch, Rectangle
from matplotlib.path import Path
from matplotlib.transforms import Affine2D, Transform

from ncgear.drawings.palette import LIGHT
from ncgear.drawings.plots.canvas import DRIVEN, DRIVING, HIGHLIGHT, INK, MATERIAL, PAPER, Style
from ncgear.drawings.scene.bodies import Body, BodyKind, BodyPlaces, Chamber, pin_radius_mm
from ncgear.drawings.scene.geared_pairs import SceneGear
from ncgear.drawings.scene.scene import Scene, ScenePoses
from ncgear.drawings.scene.standing import simplified, straws
from ncgear.frozen import dataclass
from ncgear.numerics.arrays import Array

PURE = (INK, DRIVING, DRIVEN, HIGHLIGHT, MATERIAL)
"""Colours of lines and dots; a palette made only from the colours of areas would lack them."""

TINT, LINK_SHARE = 0.24, 0.85
"""Shares of the colour in the filling of a gear, and of crank and rod; the rest is white."""


def tinted(color: str, share: float = TINT) -> tuple[float, float, float]:
    """A colour thinned with white."""
    red, green, blue = 1.0 - share * (1.0 - np.array(to_rgb(color)))
    return float(red), float(green), float(blue)


BODIES: dict[BodyKind, Style] = {
    BodyKind.DRIVING: {"facecolor": (*tinted(DRIVING), 0.88), "edgecolor": DRIVING, "linewidth": 0.7},
    BodyKind.DRIVEN: {"facecolor": (*tinted(DRIVEN), 0.88), "edgecolor": DRIVEN, "linewidth": 0.7},
    BodyKind.CRANK: {"facecolor": tinted(LIGHT["link"], LINK_SHARE), "edgecolor": INK, "linewidth": 0.8},
    BodyKind.ROD: {"facecolor": tinted(LIGHT["link"], LINK_SHARE), "edgecolor": INK, "linewidth": 0.8},
    BodyKind.SLIDER: {"facecolor": LIGHT["slider"], "edgecolor": INK, "linewidth": 0.8},
}

PITCH_CURVES: dict[BodyKind, Style] = {
    kind: {"color": color, "linewidth": 0.6, "linestyle": (0, (7, 3, 1.5, 3))}
    for kind, color in ((BodyKind.DRIVING, DRIVING), (BodyKind.DRIVEN, DRIVEN))
}

EDGES: dict[BodyKind, Style] = {
    kind: {"color": color, "linewidth": 0.5, "alpha": 0.7}
    for kind, color in ((BodyKind.DRIVING, DRIVING), (BodyKind.DRIVEN, DRIVEN))
}

CHARGE: Style = {"facecolor": tinted(MATERIAL, 0.3), "edgecolor": "none"}
BLOCK: Style = {"facecolor": tinted(LIGHT["load"], 0.45), "edgecolor": LIGHT["load"], "linewidth": 0.8}
STRAW: Style = {"color": MATERIAL, "linewidth": 0.7}
WALL: Style = {"color": INK, "linewidth": 1.3}
HATCHING: Style = {"color": INK, "linewidth": 0.45, "alpha": 0.6}
ORBIT: Style = {"color": INK, "linewidth": 0.5, "linestyle": (0, (1.5, 4)), "alpha": 0.6}
CENTRES: Style = {"color": INK, "linewidth": 0.6, "linestyle": (0, (8, 2, 1, 2)), "alpha": 0.7}
SHAFT: Style = {"color": INK, "marker": "o", "markersize": 3.6, "linestyle": "none"}
PIN: Style = {"facecolor": PAPER, "edgecolor": INK, "linewidth": 0.9}
PITCH_POINT: Style = {"color": HIGHLIGHT, "marker": "o", "markersize": 4.2, "linestyle": "none"}


PIXEL_SHARE = 0.1
"""Largest distance of a drawn outline from the written outline, in pixels: too small for Agg's shades of grey."""


@dataclass(frozen=True)
class MovingArtists:
    """Artists in the order in which they are drawn; ``pose`` puts them into the pose of a given number."""

    artists: tuple[Artist, ...]
    pose: Callable[[ScenePoses, int], None]


def body_artist(axes: Axes, body: Body, pixel_mm: float, to_screen: Transform) -> MovingArtists:
    """A body's section; ``to_screen`` turns places in the machine's frame into pixels of ``pixel_mm``."""
    contours = simplified(body.contours_mm, PIXEL_SHARE * pixel_mm)
    transform = Affine2D()
    # Snapped to whole pixels, a slow body would jump from one pixel to the next.
    patch = PathPatch(_path(contours), transform=transform + to_screen, snap=False, **BODIES[body.kind])
    axes.add_artist(patch)
    return MovingArtists((patch,), lambda poses, row: _place(transform, poses.places[body.name], row))


def gear_artists(axes: Axes, gear: SceneGear, pixel_mm: float, to_screen: Transform) -> MovingArtists:
    """A gear with the edges on its face and its pitch curve."""
    filled = body_artist(axes, gear.body, pixel_mm, to_screen)
    (patch,) = filled.artists
    curve = Line2D(*gear.pitch_curve_mm.T, transform=patch.get_transform(), **PITCH_CURVES[gear.body.kind])
    loops = [np.vstack([edge, edge[:1]]) for edge in gear.body.edges_mm]
    style = EDGES[gear.body.kind]
    edges = [Line2D(*loop.T, transform=patch.get_transform(), **style) for loop in loops]
    for line in (*edges, curve):
        axes.add_artist(line)
    return MovingArtists((patch, *edges, curve), filled.pose)


def _place(transform: Affine2D, places: BodyPlaces, row: int) -> None:
    x, y = places.origin_mm[row]
    transform.clear().rotate(float(places.angle_rad[row])).translate(float(x), float(y))


def _path(contours: Sequence[Array]) -> Path:
    """A compound path; Agg knows holes by their opposite sense."""
    closed = [Path(np.vstack([contour, contour[:1]]), closed=True) for contour in contours]
    return Path.make_compound_path(*closed)


def material_artists(axes: Axes, scene: Scene) -> Iterator[MovingArtists]:
    """The material in front of the slider, up to the chamber's wall, and the material behind it, if there is any."""
    chamber = scene.chamber
    if chamber is not None:
        shown = (("material", chamber.begins_mm), ("material-behind", chamber.behind_mm))
        yield from (_strip(axes, scene, chamber, name) for name, met_mm in shown if met_mm is not None)


def _strip(axes: Axes, scene: Scene, chamber: Chamber, name: str) -> MovingArtists:
    """A strip of unit length, which is squeezed to the length of the material and moved to its left end."""
    squeezed = Affine2D()
    transform = squeezed + axes.transData
    parts: list[Artist] = [
        Rectangle((0.0, -0.5), 1.0, 1.0, transform=transform, **(CHARGE if chamber.straw else BLOCK))
    ]
    axes.add_artist(parts[0])
    if chamber.straw:
        grain = LineCollection(list(straws()), transform=transform, **STRAW)
        axes.add_collection(grain, autolim=False)
        parts.append(grain)

    def pose(poses: ScenePoses, row: int) -> None:
        left_mm, depth_mm = (float(values[row]) for values in scene.strips_mm(poses)[name])
        squeezed.clear().scale(depth_mm, chamber.material_height_mm).translate(left_mm, chamber.level_mm)
        for artist in parts:
            artist.set_visible(depth_mm != 0.0)

    return MovingArtists(tuple(parts), pose)


def pin_artists(axes: Axes, scene: Scene) -> MovingArtists:
    """The pins of the mechanism."""
    linkage = scene.machine.linkage
    pins = [Circle((0.0, 0.0), pin_radius_mm(linkage), **PIN) for _ in linkage.PINS]
    for pin in pins:
        axes.add_artist(pin)

    def pose(poses: ScenePoses, row: int) -> None:
        for pin, name in zip(pins, linkage.PINS.values(), strict=True):
            pin.set_center(tuple(poses.places[name].origin_mm[row]))

    return MovingArtists(tuple(pins), pose)


def standing_artist(axes: Axes, points_mm: Array, style: Style, to_screen: Transform) -> MovingArtists:
    """A line or marks at fixed points of shape (n, 2) that are drawn over the moving bodies."""
    line = Line2D(*points_mm.T, transform=to_screen, **style)
    axes.add_artist(line)
    return MovingArtists((line,), lambda poses, row: None)


def pitch_point_artist(axes: Axes, to_screen: Transform) -> MovingArtists:
    """The pitch points of all pairs."""
    points = Line2D([], [], transform=to_screen, **PITCH_POINT)
    axes.add_artist(points)

    def pose(poses: ScenePoses, row: int) -> None:
        points.set_data(*np.array([point[row] for point in poses.pitch_points_mm]).T)

    return MovingArtists((points,), pose)
