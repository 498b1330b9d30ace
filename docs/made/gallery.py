"""The gallery: every design of designs/ with its picture, its own description, what it is, and its file."""

from __future__ import annotations

from collections.abc import Iterator
from html import escape
from io import BytesIO

import numpy as np
from PIL import Image

from made.drawings import DESIGNS
from ncgear.design.keys.design import Design
from ncgear.design.mechanisms import MECHANISMS, NO_LINKAGE, entry_of
from ncgear.design.reading.balance_file import load_balance
from ncgear.design.reading.design_file import load, load_train
from ncgear.design.reading.text import has_train
from ncgear.drawings.animation.moving_picture import draw_standing, gears, machine
from ncgear.drawings.plots.canvas import figure, look_at, png
from ncgear.drawings.scene.scene import Scene, scene_of
from ncgear.drawings.scene.standing import views
from ncgear.errors import DesignError
from ncgear.project.drive import Drive

NAME = "gallery.md"

PREFIX = "gallery-"
"""How the names of the gallery's pictures in docs/images begin."""

PATHS, TRAINS = (
    {
        path.stem: path
        for path in sorted(DESIGNS.glob("*.yaml"))
        if has_train(path.read_text(encoding="utf-8")) is of_train
    }
    for of_train in (False, True)
)
"""All designs of machines, and all of trains of gears, by the names of their files."""

INTRODUCTION = """\
# Gallery

<!-- Made by `make docs` from the files of designs/. -->

Every design of [`designs/`](../designs), drawn by ncgear at one sixth of its cycle: the machine, and beside it the
gears where they are small. `ncgear report designs/NAME.yaml` makes the page on which it runs. A copy of the file that
is nearest to your machine is a good beginning; [words that people search for](words.md) may say which that is.
"""

KINDS = {
    "crank_slider": "Crank-sliders",
    "scotch_yoke": "Scotch yokes",
    "crank_rocker": "Crank-rockers",
    "slotted_lever": "Slotted levers",
    "rack_pinion": "Racks",
    NO_LINKAGE: "Gears by themselves",
}
"""The headings, by mechanism; every mechanism has one."""


def gallery_page() -> str:
    """The page, from the files alone."""
    lines = [INTRODUCTION]
    designs = {name: load(path).design for name, path in PATHS.items()}
    for mechanism, heading in KINDS.items():
        chosen = {name: one for name, one in designs.items() if entry_of(one.linkage) is MECHANISMS[mechanism]}
        lines += [f"## {heading}", "", "| | |", "|---|---|", *(_row(name, one) for name, one in chosen.items()), ""]
    return "\n".join([*lines, *_trains(), *_balance()])


def _row(name: str, design: Design) -> str:
    said = escape(" ".join((design.description or "").split()), quote=False).replace("|", "&#124;")
    file = f"../designs/{name}.yaml"
    picture = f"[![{name}](images/{PREFIX}{name}.png)]({file})"
    return f"| {picture} | **[{name}]({file})**<br>{said}<br>{', '.join(_what(design))} |"


def _what(design: Design) -> Iterator[str]:
    """The law, how many gears of which kind, and what else the file has."""
    yield f"law `{design.motion.law}`"
    gears = design.gears
    if gears is None:
        yield "no gears yet"
    else:
        yield "two pairs of gears" if design.stages > 1 else "a ring gear" if gears.mesh == "internal" else "one pair"
        if gears.helix is not None:
            yield f"{gears.helix.kind} teeth"
    for section in ("resistance", "wishes", "masses", "drivetrain", "optimize"):
        if section in design.model_fields_set:
            yield f"`{section}`"


def _trains() -> Iterator[str]:
    yield from ("## Trains of gears", "", "What `ncgear check` and `ncgear build` make of [trains](trains.md):", "")
    for name, path in TRAINS.items():
        yield f"- [{name}](../designs/{path.name}): {load_train(path).file.description}"
    yield ""


def _balance() -> Iterator[str]:
    yield from ("## Balance files", "", "What [`ncgear balance`](commands/balance.md) reads:", "")
    for path in sorted((DESIGNS / "balance").glob("*.yaml")):
        comment = [line.lstrip("# ") for line in path.read_text(encoding="utf-8").splitlines() if line.startswith("#")]
        yield f"- [{load_balance(path).balance.name}](../designs/balance/{path.name}): {' '.join(comment)}"
    yield ""


WIDTH_IN, HEIGHT_IN = 5.0, 2.2
LARGE_GEARS = 0.4
"""Gears wider than this share of the machine are large enough in the picture of the machine."""

SHARE = 1.0 / 6.0
"""Where in the cycle the machine is drawn."""

COLOURS = 48


def thumbnail(name: str) -> bytes:
    """A small picture of a design's machine as PNG; without its gears where they are refused."""
    scene = _scene(Drive(load(PATHS[name]).design))
    boxes = views(scene)
    beside = bool(scene.pairs) and bool(scene.links) and boxes["gears"][2] < LARGE_GEARS * boxes["machine"][2]
    made = figure(WIDTH_IN, HEIGHT_IN, "")
    panels = made.subplots(1, 2 if beside else 1, squeeze=False, width_ratios=[1.7, 1.0] if beside else [1.0])[0]
    made.subplots_adjust(left=0.01, right=0.99, bottom=0.02, top=0.98, wspace=0.04)
    poses = scene.poses(np.array([SHARE * scene.loop_rad if scene.swings else SHARE * 2.0 * np.pi]))
    for axes, view, parts in zip(panels, ("machine", "gears"), (machine, gears), strict=False):
        pixel_mm = look_at(axes, boxes[view])
        if view == "machine":
            draw_standing(axes, scene)
        for moving in parts(axes, scene, pixel_mm):
            moving.pose(poses, 0)
    return _fewer_colours(png(made))


def _scene(drive: Drive) -> Scene:
    try:
        return scene_of(drive)
    except DesignError:
        return scene_of(Drive(drive.design.model_copy(update={"gears": None})))


def _fewer_colours(picture: bytes) -> bytes:
    written = BytesIO()
    image = Image.open(BytesIO(picture)).convert("RGB").quantize(COLOURS, dither=Image.Dither.NONE)
    image.save(written, "PNG", optimize=True)
    return written.getvalue()
