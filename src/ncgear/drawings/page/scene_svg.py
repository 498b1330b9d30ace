"""The scene as an SVG element of the page; ``scene.js`` moves it, ``scene.css`` colours it.

The unit is mm, the frame is that of the scene, and y points up within the group of class ``world``.  Each moving body
is a group with the id ``scene-NAME``, where NAME is the name of the body.  Its paths are in whole steps of a grid,
which takes few characters, and an inner group scales them.  Outlines differ from the written ones by at most
``tolerance_mm`` and half a step of the grid.
"""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from math import floor, log10

import numpy as np

from ncgear.drawings.scene import standing
from ncgear.drawings.scene.bodies import Body, Chamber, pin_radius_mm
from ncgear.drawings.scene.geared_pairs import SceneGear, ScenePair
from ncgear.drawings.scene.scene import Scene
from ncgear.numerics.arrays import Array

PLACES_PER_TOLERANCE = 5.0
"""Least tolerance in steps of the grid: rounding moves a point by at most a seventh of the tolerance."""


def grid_mm(tolerance_mm: float) -> float:
    """The step of the grid in mm, a power of ten."""
    return float(10.0 ** floor(log10(tolerance_mm / PLACES_PER_TOLERANCE)))


def closed_path(contours: Sequence[Array], grid: float) -> str:
    """Path data of closed contours in whole steps of the grid.

    Each point is given relative to the one before it, in whole numbers, which the single precision of browsers keeps
    exact.
    """
    return "".join(_contour(np.rint(contour / grid).astype(int)) + "z" for contour in contours)


def strokes_path(strokes: Array, grid: float) -> str:
    """Path data of separate strokes, shape (n, 2, 2)."""
    return "".join(_contour(stroke) for stroke in np.rint(strokes / grid).astype(int))


def _contour(points: np.ndarray) -> str:
    steps = np.diff(points, axis=0)
    moved = steps[np.any(steps != 0, axis=1)]
    text = " ".join(map(str, moved.ravel().tolist()))
    return f"M{points[0, 0]} {points[0, 1]}l{text}".replace(" -", "-")


GEAR_TOLERANCE = 0.0025
"""Tolerance of a gear's outline in modules: a third of a pixel in a view of 9 modules with 1200 pixels."""

LINK_TOLERANCE = 2e-4
"""Tolerance of slider, crank and the other links, as a share of the crank's length."""


def gear_tolerance_mm(pair: ScenePair) -> float:
    """Largest distance in mm of a drawn gear's outline from the written one."""
    return GEAR_TOLERANCE * pair.module_mm


def scene_svg(scene: Scene) -> str:
    """The SVG element with no body turned; ``show`` of scene.js gives it the first pose."""
    left, bottom, width, height = standing.views(scene)["machine"]
    box = f"{left:.6g} {-bottom - height:.6g} {width:.6g} {height:.6g}"
    parts = (*_standing(scene), *_bodies(scene), *_marks(scene))
    return (
        f'<svg class="scene" viewBox="{box}" tabindex="0" role="img" aria-label="the mechanism">'
        f'<g class="world" transform="scale(1 -1)">{"".join(parts)}</g></svg>'
    )


def _standing(scene: Scene) -> Iterator[str]:
    chamber, linkage = scene.chamber, scene.machine.linkage
    if not scene.links:
        return
    grid = grid_mm(_link_tolerance_mm(scene))
    lines, hatches = standing.supports_mm(linkage), standing.support_hatches_mm(linkage)
    if chamber is not None:
        for name, met_mm in (("material", chamber.begins_mm), ("material-behind", chamber.behind_mm)):
            yield _group("", name, _material(chamber)) if met_mm is not None else ""
    lines, hatches = [*lines, *standing.walls_mm(scene)], np.concatenate([hatches, standing.hatches_mm(scene)])
    yield _scaled(grid, f'<path class="hatching" d="{strokes_path(hatches, grid)}"/>')
    yield f'<circle class="orbit" r="{linkage.crank_mm:.6g}"/>'
    yield _scaled(grid, f'<path class="wall" d="{"".join(strokes_path(line[None], grid) for line in lines)}"/>')


def _material(chamber: Chamber) -> str:
    """A strip of unit depth; scene.js stretches it to the depth of the material."""
    height = chamber.material_height_mm
    kind = "charge" if chamber.straw else "load"
    strip = f'<rect class="{kind}" x="0" y="{-height / 2.0:.6g}" width="1" height="{height:.6g}"/>'
    if not chamber.straw:
        return strip
    strokes = standing.straws() * [1.0, height]
    grain = "".join(f"M{a:.4f} {b:.3f}L{c:.4f} {d:.3f}" for (a, b), (c, d) in strokes.tolist())
    return f'{strip}<path class="straw" d="{grain}"/>'


def _bodies(scene: Scene) -> Iterator[str]:
    tolerance = _link_tolerance_mm(scene)
    output, links = ([body_svg(link, tolerance) for link in some] for some in (scene.links[:1], scene.links[1:]))
    gears = [_gear(pair, gear) for pair in scene.pairs for gear in (pair.driving, pair.driven)]
    yield from output
    yield from (*links, *gears) if scene.crank_is_behind else (*gears, *links)


def _gear(pair: ScenePair, gear: SceneGear) -> str:
    tolerance = gear_tolerance_mm(pair)
    grid = grid_mm(tolerance)
    curve = standing.simplified([gear.pitch_curve_mm], tolerance)
    extra = f'<path class="pitch-curve" d="{closed_path(curve, grid)}"/>'
    return body_svg(gear.body, tolerance, extra)


def body_svg(body: Body, tolerance_mm: float, extra: str = "") -> str:
    """The group of a body, its outline with a tolerance; ``extra`` are further paths in steps of the grid."""
    grid = grid_mm(tolerance_mm)
    outline = closed_path(standing.simplified(body.contours_mm, tolerance_mm), grid)
    if body.edges_mm:
        extra = f'<path class="edge" d="{closed_path(body.edges_mm, grid)}"/>{extra}'
    return _group(f"body {body.kind.value}", body.name, _scaled(grid, f'<path class="outline" d="{outline}"/>{extra}'))


def _marks(scene: Scene) -> Iterator[str]:
    for pair in scene.pairs:
        start, end = pair.mounting.driving_axis_mm, pair.mounting.driven_axis_mm
        yield f'<path class="centres" d="M{start[0]:.6g} {start[1]:.6g}L{end[0]:.6g} {end[1]:.6g}"/>'
    for x, y in (*scene.axes_mm, *scene.machine.linkage.pivots_mm.values()):
        yield f'<path class="shaft" d="M{x:.6g} {y:.6g}h0"/>'
    for name in scene.machine.linkage.PINS:
        yield _group("", name, f'<circle class="pin" r="{pin_radius_mm(scene.machine.linkage):.6g}"/>')
    for number, _ in enumerate(scene.pairs, start=1):
        yield _group("", f"pitch-point-{number}", '<path class="pitch-point" d="M0 0h0"/>')


def _group(kinds: str, name: str, content: str) -> str:
    return f'<g id="scene-{name}" class="{kinds or name}">{content}</g>'


def _scaled(grid: float, content: str) -> str:
    return f'<g transform="scale({grid:.6g})">{content}</g>'


def _link_tolerance_mm(scene: Scene) -> float:
    return LINK_TOLERANCE * scene.machine.linkage.crank_mm
