"""The pieces of what a notebook shows: a frame with its style, figures, tables, charts, outlines, the machine running.

Each output stands by itself and loads nothing.  Notebooks tell on the page around an output whether they are dark; the
style looks for the marks of JupyterLab, VS Code, Colab, marimo and pages of documentation, and is light without one.
All text that is not of this package is escaped: pieces are put together by ``Markup.format``.

The machine is the report's scene, run by CSS alone, as notebooks run scripts of few outputs only; a check box runs and
stops it.  Places between two frames lie on the straight line between them: at ``FRAMES`` to a turn the gears of the
designs are astray by less than 0.002 rad (tests/test_notebook_in_browser.py).
"""

from __future__ import annotations

from collections.abc import Callable, Iterable, Iterator, Mapping, Sequence
from hashlib import sha256
from math import ceil, pi
from typing import NamedTuple

import numpy as np
from markupsafe import Markup
from shapely import Polygon

from ncgear.drawings.charts.chart import Line
from ncgear.drawings.page.assets import scene_style
from ncgear.drawings.page.chart_figure import PageChart
from ncgear.drawings.page.chart_svg import drawn
from ncgear.drawings.page.scene_svg import closed_path, grid_mm, scene_svg
from ncgear.drawings.palette import DARK, LIGHT
from ncgear.drawings.scene.scene import Scene
from ncgear.errors import DesignError, fault_words
from ncgear.figures.tables import Table
from ncgear.figures.terminal import labelled
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
"""What the page around an output has where it is dark: JupyterLab, VS Code, Colab, Sphinx themes, marimo, MkDocs."""

STYLE = """\
.ncgear { font: 14px/1.4 system-ui, "Segoe UI", Arial, sans-serif; font-variant-numeric: tabular-nums;
  color: var(--ink); background: var(--panel); border: 1px solid var(--rule); border-radius: 8px;
  padding: 0.7rem 0.9rem; max-width: 64rem; }
.ncgear :is(h3, p, dl, dd, figure, ul) { margin: 0; padding: 0; }
.ncgear h3 { font-size: 1.1rem; overflow-wrap: anywhere; color: inherit; }
.ncgear :is(.description, .extremes, dt, .unit, .note, caption) { color: var(--muted); font-weight: 400; }
.ncgear .description { overflow-wrap: anywhere; white-space: pre-line; }
.ncgear dl { display: flex; flex-wrap: wrap; gap: 0.3rem 1.5rem; margin: 0.5rem 0; }
.ncgear dt { font-size: 0.8rem; }
.ncgear dd { font-weight: 600; }
.ncgear .refused { border-left: 4px solid var(--warning); background: var(--warning-ground); color: var(--warning);
  padding: 0.35rem 0.7rem; margin: 0.4rem 0; overflow-wrap: anywhere; }
.ncgear .row { display: flex; flex-wrap: wrap; gap: 0.6rem 1rem; }
.ncgear .row > figure { flex: 1 1 19rem; min-width: 0; max-width: 30rem; }
.ncgear figcaption { font-size: 0.85rem; display: flex; flex-wrap: wrap; gap: 0 0.8rem; color: inherit; }
.ncgear figcaption b { font-weight: 600; }
.ncgear .key i { display: inline-block; width: 1.2rem; margin-right: 0.3rem; vertical-align: 0.25em;
  border-top: 2.5px solid var(--driving); }
.ncgear .key :is(.other, .uniform) i { border-top-color: var(--uniform); border-top-width: 2px; }
.ncgear .key .uniform i { border-top-style: dashed; }
.ncgear .key .limit i { border-top: 2px dotted var(--ink); }
.ncgear .plot svg { display: block; width: 100%; height: auto; stroke-linejoin: round; overflow: visible; }
.ncgear .shape svg { display: block; width: 100%; height: 20rem; }
.ncgear .shape :is(path, circle) { vector-effect: non-scaling-stroke; }
.ncgear .tables { overflow-x: auto; }
.ncgear table { border-collapse: collapse; margin: 0.5rem 0; color: inherit; background: none; font-size: 0.92em; }
.ncgear caption { text-align: left; caption-side: top; padding: 0.2rem 0; }
.ncgear :is(tr, tr:nth-child(odd), tr:hover) { background: none; }
.ncgear :is(th, td) { padding: 0.15rem 0.6rem; border: 0; border-top: 1px solid var(--grid); text-align: right;
  vertical-align: top; font-weight: 400; color: inherit; max-width: none; white-space: normal; }
.ncgear :is(th:first-child, .words) { text-align: left; }
.ncgear tr.note td { border-top: 0; text-align: left; padding-top: 0; }
.ncgear thead .unit { display: block; }
"""


def _colors(colors: Mapping[str, str]) -> str:
    return "".join(f"--{name}:{color};" for name, color in colors.items())


def style() -> str:
    """The style sheet of every output, without that of the scene."""
    dark = ", ".join(f"{page} .ncgear" for page in DARK_PAGES)
    return f".ncgear {{ {_colors(LIGHT)} }}\n{dark} {{ {_colors(DARK)} }}\n{STYLE}"


def framed(title: str, *pieces: Markup, description: str = "") -> str:
    """A whole output: its style, a title, a description in muted words, and the pieces below them."""
    told = Markup('<p class="description">{}</p>').format(description) if description else NOTHING
    head = Markup("<h3>{}</h3>{}").format(title, told)
    output = Markup('<style>{}</style><div class="ncgear">{}</div>')
    return output.format(Markup(style()), NOTHING.join([head, *pieces]))


def made(piece: Callable[[], Markup]) -> Markup:
    """A piece, or the words with which it is refused; a fault of ncgear's own is told as one, and ends nothing."""
    try:
        return piece()
    except Exception as error:
        return not_made(error)


def not_made(error: Exception) -> Markup:
    """What an error tells: a refusal by its words, anything else as a fault."""
    if isinstance(error, DesignError):
        return refusal(str(error))
    return refusal(fault_words(error))


def refusal(words: str) -> Markup:
    """Words of what cannot be made."""
    return Markup('<p class="refused">{}</p>').format(words)


def facts(pairs: Iterable[tuple[str, str]]) -> Markup:
    """Names and values in a line that wraps."""
    entries = (Markup("<div><dt>{}</dt><dd>{}</dd></div>").format(name, value) for name, value in pairs)
    return Markup("<dl>{}</dl>").format(NOTHING.join(entries))


def figures(section: Mapping[str, object]) -> Markup:
    """A section of a summary as ``facts``, in the words that the terminal has for its keys."""
    return facts(labelled(section))


def table(content: Table) -> Markup:
    """A table with its notes."""
    heads = NOTHING.join(
        Markup('<th>{}<span class="unit">{}</span></th>').format(column.label, column.unit)
        for column in content.columns
    )
    top = Markup("<thead><tr>{}</tr></thead>").format(heads) if heads else NOTHING
    rows = [
        Markup("<tr><th>{}</th>{}</tr>").format(row.cells[0], _cells(row.cells[1:], row.span)) + _note(row.note)
        for row in content.html_rows
    ]
    below = NOTHING.join(Markup('<p class="note">{}</p>').format(note) for note in content.notes)
    return Markup('<div class="tables"><table><caption>{}</caption>{}<tbody>{}</tbody></table>{}</div>').format(
        content.title, top, NOTHING.join(rows), below
    )


def _cells(texts: Sequence[str], span: int) -> Markup:
    first = Markup(' colspan="{}"').format(span) if span > 1 else NOTHING
    return NOTHING.join(
        Markup("<td{}>{}</td>").format(first if number == 0 else NOTHING, text) for number, text in enumerate(texts)
    )


def _note(note: str) -> Markup:
    return Markup('<tr class="note"><td colspan="99">{}</td></tr>').format(note) if note else NOTHING


def charts(shown: Iterable[PageChart]) -> Markup:
    """Charts beside each other, as the report draws them, each with its extremes and the key of its lines."""
    return Markup('<div class="row">{}</div>').format(NOTHING.join(map(_chart, shown)))


def _chart(shown: PageChart) -> Markup:
    # Names within an SVG are those of the whole page: they follow from what is drawn, so equal names are equal things.
    plain = drawn(shown)
    key = f"ncgear-{digest(plain.drawing)}"
    drawing = plain.drawing.replace(f'"{shown.key}-', f'"{key}-').replace(f"#{shown.key}-", f"#{key}-")
    lines = shown.chart.lines
    keys = NOTHING.join(map(_key, lines)) if len(lines) > 1 else NOTHING
    return Markup(
        '<figure class="plot" role="img" aria-label="{0}: {1}"><figcaption><b>{0}</b>'
        '<span class="extremes">{1}</span><span class="key">{2}</span></figcaption>{3}</figure>'
    ).format(plain.heading, plain.extremes, keys, Markup(drawing))


def _key(line: Line) -> Markup:
    return Markup('<span class="{}"><i></i>{} </span>').format(line.role.value, line.label)


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


def _outline(curve: ClosedPitchCurve, points_mm: Array, axis_mm: float) -> Outline:
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
    curve = teeth.driving.flanks.curve
    assert isinstance(curve, PitchCurve)
    axes_mm = 0.0, curve.center_distance_mm
    return [tooth_outline(teeth.of(gear), axis) for gear, axis in zip(Gear, axes_mm, strict=True)]


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
