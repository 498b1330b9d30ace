"""Machines and gears in a notebook: the report's scene, run by CSS alone, and closed outlines at phi1 = 0.

Notebooks run scripts of few outputs only; a check box runs and stops the scene.  Places between two frames lie on the
straight line between them: at ``FRAMES`` to a turn the gears of the designs are astray by less than 0.002 rad
(tests/test_notebook_in_browser.py).
"""

from __future__ import annotations

from collections.abc import Iterable, Iterator, Sequence
from math import ceil, pi
from typing import NamedTuple

import numpy as np
from markupsafe import Markup
from shapely import Polygon

from ncgear.drawings.notebook.frame import NOTHING, digest
from ncgear.drawings.page.assets import scene_style
from ncgear.drawings.page.scene_svg import closed_path, grid_mm, scene_svg
from ncgear.drawings.scene.scene import Scene
from ncgear.numerics.arrays import Array
from ncgear.pitch.curve import PitchCurve
from ncgear.pitch.pair import PitchPair
from ncgear.pitch.shape import Gear
from ncgear.teeth.gear import ToothedGear, ToothedPair

FRAMES = 96
MOST_FRAMES = 480
"""Frames for a turn of the driving gear, and most frames of a loop of several turns."""

TURN_S = 5.0
"""Seconds for a turn of the driving gear: so fast that the eye can follow."""

RUNS = """\
.ncgear .machine {{ height: 20rem; }}
.ncgear .machine svg {{ background: none; }}
.ncgear .run {{ display: inline-flex; gap: 0.4rem; align-items: center; }}
.ncgear .run input {{ accent-color: var(--driving); margin: 0; }}
#{name} g[id] {{ animation: {duration:.4g}s linear infinite paused; }}
.run:has(:checked) + .machine #{name} g[id] {{ animation-play-state: running; }}
"""


def running(scene: Scene) -> Markup:
    """The scene of a machine with its check box."""
    still = scene_svg(scene)
    name = f"ncgear-{digest(still)}"
    turns = scene.loop_rad / (2.0 * pi) * (2.0 if scene.swings else 1.0)
    # An even number: gears that swing turn back on a frame.
    frames = min(MOST_FRAMES, 2 * ceil(FRAMES * turns / 2.0))
    phi1 = np.append(scene.evenly_in_time(frames), 0.0 if scene.swings else scene.loop_rad)
    ways = dict(_ways(scene, phi1))
    rules = [scene_style(), RUNS.format(name=name, duration=TURN_S * turns)]
    for body, transforms in ways.items():
        rules += [
            _keyframes(f"{name}-{body}", transforms),
            f"#{name} #{name}-{body} {{ animation-name: {name}-{body}; }}",
        ]
    svg = still.replace("<svg ", f'<svg id="{name}" ', 1).replace(' tabindex="0"', "")
    return Markup(
        '<style>{}</style><label class="run"><input type="checkbox"> run the machine</label>'
        '<div class="machine">{}</div>'
    ).format(Markup("\n".join(rules)), Markup(svg.replace('id="scene-', f'id="{name}-')))


def _keyframes(name: str, transforms: Iterable[str]) -> str:
    texts = list(transforms)
    if len(set(texts)) == 1:
        texts = texts[:1] * 2
    steps = (f"{100.0 * number / (len(texts) - 1):.5g}%{{transform:{text}}}" for number, text in enumerate(texts))
    return f"@keyframes {name}{{{''.join(steps)}}}"


def _ways(scene: Scene, phi1: Array) -> Iterator[tuple[str, list[str]]]:
    """The transforms of each group of the SVG by its name, at driving angles in rad, shape (n,)."""
    poses, linkage = scene.poses(phi1), scene.machine.linkage
    for name, places in poses.places.items():
        yield name, [_moved(x, y, angle) for (x, y), angle in zip(places.origin_mm, places.angle_rad, strict=True)]
    for pin, link in linkage.PINS.items():
        yield pin, [_moved(x, y) for x, y in poses.places[link].origin_mm]
    for number, points in enumerate(poses.pitch_points_mm, start=1):
        yield f"pitch-point-{number}", [_moved(x, y) for x, y in points]
    for name, (left, length) in scene.strips_mm(poses).items():
        assert scene.chamber is not None
        yield name, _stretched(left, scene.chamber.level_mm, length)


def _stretched(x_mm: Array, y_mm: float, depth_mm: Array) -> list[str]:
    return [f"{_moved(x, y_mm)}scale({depth:.5g},1)" for x, depth in zip(x_mm, depth_mm, strict=True)]


def _moved(x_mm: float, y_mm: float, angle_rad: float | None = None) -> str:
    turned = "" if angle_rad is None else f"rotate({angle_rad:.5f}rad)"
    return f"translate({x_mm:.6g}px,{y_mm:.6g}px){turned}"


CURVE_POINTS = 721
"""Points of a pitch curve: one every half degree."""

FINENESS = 2e-4
"""Tolerance of a drawn outline as a share of the picture's size: a tenth of a pixel."""

ROOM = 1.04
"""Size of the picture divided by that of what is on it."""


RING = 1.1
"""Outer radius of a ring, divided by the largest radius of its curve or teeth: these alone know of no body."""

ROUND = 2.0 * np.pi * np.linspace(0.0, 1.0, 181)[:-1]


class Outline(NamedTuple):
    """Closed contours in mm, shape (n, 2) each, in the frame of a gear, the outer one first; the place of its axis."""

    gear: Gear
    contours_mm: tuple[Array, ...]
    axis_mm: float


def _outline(curve: PitchCurve, points_mm: Array, axis_mm: float) -> Outline:
    """The outline of a gear by its pitch curve or teeth: that of a ring is around them."""
    if not curve.is_ring:
        return Outline(curve.gear, (points_mm,), axis_mm)
    radius = RING * float(np.hypot(*points_mm.T).max())
    circle = radius * np.column_stack([np.cos(ROUND), np.sin(ROUND)])
    return Outline(curve.gear, (circle, points_mm), axis_mm)


def pitch_outlines(pitch: PitchPair) -> list[Outline]:
    """Both pitch curves; those of gears that turn less than once are closed by straight sides to the axis."""
    outlines = []
    for curve, axis in ((pitch.driving, 0.0), (pitch.driven, pitch.center_distance_mm)):
        points = curve.drawn(CURVE_POINTS).position
        closed = points if pitch.toothed is None else np.vstack([points, np.zeros((1, 2))])
        outlines.append(_outline(curve, closed, axis))
    return outlines


def tooth_outlines(teeth: ToothedPair) -> list[Outline]:
    """Both tooth outlines in mesh."""
    distance = teeth.driving.flanks.curve.center_distance_mm
    return [tooth_outline(teeth.of(gear), axis) for gear, axis in zip(Gear, (0.0, distance), strict=True)]


def tooth_outline(gear: ToothedGear, axis_mm: float = 0.0) -> Outline:
    """The teeth of one gear."""
    return _outline(gear.flanks.curve, gear.outline_mm, axis_mm)


def section_outline(gear: Gear, section: Polygon) -> Outline:
    """The section of a solid, with its holes."""
    rings = (np.asarray(ring.coords)[:-1] for ring in (section.exterior, *section.interiors))
    return Outline(gear, tuple(rings), 0.0)


def picture(outlines: Sequence[Outline], name: str) -> Markup:
    """The outlines to one scale, with their axes; the name is what a screen reader says."""
    corners = np.vstack([outline.contours_mm[0] + np.array([outline.axis_mm, 0.0]) for outline in outlines])
    low, high = corners.min(axis=0), corners.max(axis=0)
    size, middle = ROOM * (high - low), (low + high) / 2.0
    box = f"{middle[0] - size[0] / 2.0:.6g} {-middle[1] - size[1] / 2.0:.6g} {size[0]:.6g} {size[1]:.6g}"
    grid = grid_mm(FINENESS * float(size.max()))
    # A ring goes behind the gear within it.
    drawn = sorted(outlines, key=lambda outline: -float(np.ptp(outline.contours_mm[0][:, 0])))
    shapes = NOTHING.join(_shape(outline, grid) for outline in drawn)
    return Markup(
        '<figure class="shape"><svg viewBox="{}" role="img" aria-label="{}"><g transform="scale(1 -1)">{}</g></svg>'
        "</figure>"
    ).format(box, name, shapes)


def _shape(outline: Outline, grid: float) -> Markup:
    color = outline.gear.value
    return Markup(
        '<g transform="translate({0:.6g} 0)"><path transform="scale({1:.6g})" d="{2}" fill="var(--{3})" '
        'fill-opacity="0.22" fill-rule="evenodd" stroke="var(--{3})" stroke-width="1.4"/>'
        '<path d="M0 0h0" stroke="var(--ink)" stroke-width="7" stroke-linecap="round"/></g>'
    ).format(outline.axis_mm, grid, closed_path(outline.contours_mm, grid), color)
