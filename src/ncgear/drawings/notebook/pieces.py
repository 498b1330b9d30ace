"""The pieces of a notebook's view: a frame with its style, figures, tables, charts, outlines, the running machine.

Each output stands by itself and loads nothing.  The page around an output has a mark where it is dark; the style looks
for the marks of JupyterLab, VS Code, Colab, marimo and pages of documentation, and is light without a mark.  All text
from outside this package is escaped: pieces are macros of ``pieces.html.j2``.

The machine is the report's scene, moved by CSS alone, since notebooks run the scripts of few outputs only; a check box
starts and stops it.  Places between two frames lie on the straight line between them: at ``FRAMES`` to a turn the gears
of the designs are astray by less than 0.002 rad (tests/test_notebook_in_browser.py).
"""

from __future__ import annotations

from collections.abc import Callable, Iterable, Iterator, Mapping, Sequence
from functools import cache
from hashlib import sha256
from importlib.resources import files
from math import ceil, pi
from typing import Any, NamedTuple

import numpy as np
from jinja2 import Environment, PackageLoader
from markupsafe import Markup
from shapely import Polygon

from ncgear.drawings.page.assets import scene_style
from ncgear.drawings.page.chart_figure import PageChart
from ncgear.drawings.page.chart_svg import drawn
from ncgear.drawings.page.scene_svg import closed_path, grid_mm, scene_svg
from ncgear.drawings.palette import DARK, LIGHT
from ncgear.drawings.scene.scene import Scene
from ncgear.errors import DesignError, fault_words
from ncgear.figures.numbers import labelled
from ncgear.figures.tables import Table
from ncgear.numerics.arrays import Array
from ncgear.pitch.curve import ClosedPitchCurve, PitchCurve
from ncgear.pitch.pair import PitchPair
from ncgear.pitch.shape import Gear
from ncgear.teeth.gear import ToothedGear, ToothedPair

NOTHING = Markup("")

DARK_PAGES = (
    'body[data-jp-theme-light="false"]',
    "body.vscode-dark",
    "body.vscode-high-contrast:not(.vscode-high-contrast-light)",
    'html[theme="dark"]',
    'html[data-theme="dark"]',
    'body[data-theme="dark"]',
    ".dark",
    ".dark-theme",
    '[data-md-color-scheme="slate"]',
)
"""Marks of a dark page around an output: JupyterLab, VS Code, Colab, Sphinx themes, marimo, MkDocs."""


def _colors(colors: Mapping[str, str]) -> str:
    return "".join(f"--{name}:{color};" for name, color in colors.items())


def style() -> str:
    """The style sheet of every output, without the style of the scene."""
    dark = ", ".join(f"{page} .ncgear" for page in DARK_PAGES)
    css = (files("ncgear.drawings.notebook") / "notebook.css").read_text(encoding="utf-8")
    return f".ncgear {{ {_colors(LIGHT)} }}\n{dark} {{ {_colors(DARK)} }}\n{css}"


@cache
def _macros() -> Any:
    environment = Environment(loader=PackageLoader("ncgear.drawings.notebook", ""), autoescape=True)
    return environment.get_template("pieces.html.j2").module


def framed(title: str, *pieces: Markup, description: str = "") -> str:
    """A whole output: its style, a title, a description in muted words, and the pieces below them."""
    return str(_macros().framed(style(), title, description, pieces))


def made(piece: Callable[[], Markup]) -> Markup:
    """A piece, or the words of its refusal; a fault of ncgear is shown as a fault, and stops nothing."""
    try:
        return piece()
    except Exception as error:
        return not_made(error)


def not_made(error: Exception) -> Markup:
    """The words of a refusal, or of any other error as a fault."""
    if isinstance(error, DesignError):
        return refusal(str(error))
    return refusal(fault_words(error))


def refusal(words: str) -> Markup:
    """The words of a refusal, as a piece."""
    return Markup(_macros().refusal(words))


def facts(pairs: Iterable[tuple[str, str]]) -> Markup:
    """Names and values in a line that wraps."""
    return Markup(_macros().facts(list(pairs)))


def figures(section: Mapping[str, object]) -> Markup:
    """A section of a summary as ``facts``, in the words that the terminal has for its keys."""
    return facts(labelled(section))


def table(content: Table) -> Markup:
    """A table with its notes."""
    return Markup(_macros().table(content))


def charts(shown: Iterable[PageChart]) -> Markup:
    """Charts beside each other, as the report draws them, each with its extremes and the key of its lines."""
    named = []
    for chart in map(drawn, shown):
        # Names in an SVG count for the whole page: they follow from its content
        old, new = chart.page_chart.key, f"ncgear-{digest(chart.drawing)}"
        named.append((chart, chart.drawing.replace(f'"{old}-', f'"{new}-').replace(f"#{old}-", f"#{new}-")))
    return Markup(_macros().charts(named))


def digest(text: str) -> str:
    """A short name that follows from a text."""
    return sha256(text.encode()).hexdigest()[:12]


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
    return Markup(_macros().running("\n".join(rules), svg.replace('id="scene-', f'id="{name}-')))


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
        y_mm, strips = scene.chamber.level_mm, zip(left, length, strict=True)
        yield name, [f"{_moved(x_mm, y_mm)}scale({depth_mm:.5g},1)" for x_mm, depth_mm in strips]


def _moved(x_mm: float, y_mm: float, angle_rad: float | None = None) -> str:
    turned = "" if angle_rad is None else f"rotate({angle_rad:.5f}rad)"
    return f"translate({x_mm:.6g}px,{y_mm:.6g}px){turned}"


CURVE_POINTS = 721
"""Points of a pitch curve: one every half degree."""

FINENESS = 2e-4
"""Tolerance of a drawn outline as a share of the picture's size: a tenth of a pixel."""

ROOM = 1.04
"""Size of the picture divided by the size of the outlines on it."""

RING = 1.1
"""Outer radius of a ring, divided by the largest radius of its curve or teeth: these alone know of no body."""

ROUND = 2.0 * np.pi * np.linspace(0.0, 1.0, 181)[:-1]


class DrawnOutline(NamedTuple):
    """Closed contours in mm, shape (n, 2) each, in the frame of a gear, the outer one first; the place of its axis."""

    gear: Gear
    contours_mm: tuple[Array, ...]
    axis_mm: float


def _outline(curve: ClosedPitchCurve, points_mm: Array, axis_mm: float) -> DrawnOutline:
    """The outline of a gear by its pitch curve or teeth; the outline of a ring is around them."""
    if not curve.is_ring:
        return DrawnOutline(curve.gear, (points_mm,), axis_mm)
    radius = RING * float(np.hypot(*points_mm.T).max())
    circle = radius * np.column_stack([np.cos(ROUND), np.sin(ROUND)])
    return DrawnOutline(curve.gear, (circle, points_mm), axis_mm)


def pitch_outlines(pitch: PitchPair) -> list[DrawnOutline]:
    """Both pitch curves; curves of gears that turn less than once are closed by straight sides to the axis."""
    outlines = []
    for curve, axis in ((pitch.driving, 0.0), (pitch.driven, pitch.center_distance_mm)):
        points = curve.drawn(CURVE_POINTS).position
        closed = points if pitch.toothed is None else np.vstack([points, np.zeros((1, 2))])
        outlines.append(_outline(curve, closed, axis))
    return outlines


def tooth_outlines(teeth: ToothedPair) -> list[DrawnOutline]:
    """Both tooth outlines in mesh."""
    curve = teeth.driving.flanks.curve
    assert isinstance(curve, PitchCurve)
    axes_mm = 0.0, curve.center_distance_mm
    return [tooth_outline(teeth.of(gear), axis) for gear, axis in zip(Gear, axes_mm, strict=True)]


def tooth_outline(gear: ToothedGear, axis_mm: float = 0.0) -> DrawnOutline:
    """The teeth of one gear."""
    return _outline(gear.flanks.curve, gear.outline_mm, axis_mm)


def section_outline(gear: Gear, section: Polygon) -> DrawnOutline:
    """The section of a solid, with its holes."""
    rings = (np.asarray(ring.coords)[:-1] for ring in (section.exterior, *section.interiors))
    return DrawnOutline(gear, tuple(rings), 0.0)


def picture(outlines: Sequence[DrawnOutline], name: str) -> Markup:
    """The outlines to one scale, with their axes; the name is what a screen reader says."""
    corners = np.vstack([outline.contours_mm[0] + np.array([outline.axis_mm, 0.0]) for outline in outlines])
    low, high = corners.min(axis=0), corners.max(axis=0)
    size, middle = ROOM * (high - low), (low + high) / 2.0
    box = f"{middle[0] - size[0] / 2.0:.6g} {-middle[1] - size[1] / 2.0:.6g} {size[0]:.6g} {size[1]:.6g}"
    grid = grid_mm(FINENESS * float(size.max()))
    # A ring goes behind the gear within it.
    drawn = sorted(outlines, key=lambda outline: -float(np.ptp(outline.contours_mm[0][:, 0])))
    shapes = [
        (gear.gear.value, f"{gear.axis_mm:.6g}", f"{grid:.6g}", closed_path(gear.contours_mm, grid)) for gear in drawn
    ]
    return Markup(_macros().picture(name, box, shapes))
