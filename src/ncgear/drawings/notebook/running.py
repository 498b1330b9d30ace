"""The machine in a notebook: the report's scene, run by CSS alone, as notebooks run scripts of few outputs only.

A check box runs and stops it.  Places between two frames lie on the straight line between them: at ``FRAMES`` to a turn
the gears of the designs are astray by less than 0.002 rad (tests/test_notebook_in_browser.py).
"""

from __future__ import annotations

from collections.abc import Iterable, Iterator
from math import ceil, pi

import numpy as np
from markupsafe import Markup

from ncgear.drawings.notebook.frame import digest
from ncgear.drawings.page.assets import scene_style
from ncgear.drawings.page.scene_svg import scene_svg
from ncgear.drawings.scene.scene import Scene
from ncgear.numerics.arrays import Array

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
