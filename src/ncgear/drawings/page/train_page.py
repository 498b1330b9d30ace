"""The report of a train of gears as running: the page of a machine, with the parts that a train has.

The train is an SVG element, and ``scene.js`` moves its parts as links by tables.
"""

from __future__ import annotations

from collections.abc import Iterator, Mapping, Sequence
from math import degrees, pi
from pathlib import Path
from typing import Any

import numpy as np
from markupsafe import Markup

from ncgear.drawings.page.data import link_table, paces
from ncgear.drawings.page.page import rendered
from ncgear.drawings.page.scene_svg import body_svg, closed_path, grid_mm
from ncgear.drawings.page.tables import ToothLinks, typeset
from ncgear.drawings.scene.bodies import Body, BodyKind
from ncgear.figures.answers.answer import Answer
from ncgear.figures.numbers import shown
from ncgear.figures.tables import Column, Table, columns_of
from ncgear.numerics.arrays import Array
from ncgear.numerics.plane import as_points
from ncgear.trains.train import Part, Train

STEPS = 240
"""Steps of the tables over a cycle: a waving angle is within 1e-5 rad."""

TOLERANCE = 3e-4
"""Tolerance of outlines as a share of the picture's size: a third of a pixel."""

CIRCLE = np.exp(1j * np.linspace(0.0, 2.0 * pi, 90, endpoint=False))

KINDS = (BodyKind.DRIVING, BodyKind.DRIVEN, BodyKind.SLIDER)
"""The looks of gears that mesh with each other, by the tint of each; bars look like cranks."""


def train_scene(train: Train) -> dict[str, Any]:
    """``svg``, the element with no part turned, and ``data`` that move it; angles in rad, lengths in mm."""
    driving, (low, high) = np.linspace(0.0, train.cycle_rad, STEPS + 1), train.room_mm()
    (left, bottom), (width, height) = low.tolist(), (high - low).tolist()
    poses, size_mm = train.poses_at(driving), max(width, height)
    shown = sorted(enumerate(train.parts), key=lambda numbered: numbered[1].low_mm)
    parts = "".join(body_svg(_body(train, part, number), TOLERANCE * size_mm) for number, part in shown)
    links = {
        f"part-{number}": {
            key: link_table(
                np.stack([driving, values[number], np.gradient(values[number], driving, edge_order=2)]), 1.0
            )
            for key, values in (("x", poses.x_mm), ("y", poses.y_mm), ("angle", poses.angle_rad))
        }
        for number, _ in shown
    }
    data = {
        "loop": train.cycle_rad,
        "shafts": [link_table(np.stack([driving, driving, np.ones_like(driving)])[:, [0, -1]], 1.0)],
        "gears": [],
        "pairs": [],
        "linkage": {"links": links, "pins": {}},
        "chamber": None,
        "views": {"machine": [left, bottom, width, height]},
    }
    svg = (
        f'<svg class="scene" viewBox="{left:.6g} {-bottom - height:.6g} {width:.6g} {height:.6g}" tabindex="0" '
        f'role="img" aria-label="the train"><g class="world" transform="scale(1 -1)">{parts}'
        f"{''.join(_traces(train, driving, size_mm))}</g></svg>"
    )
    return {"svg": svg, "data": data, "gears": False}


def _body(train: Train, part: Part, number: int) -> Body:
    """A part in its own frame; the outline of a ring is its hole."""
    circles = [(0j, part.reach_mm)] if part.rim_mm is not None else []
    circles += [(0j, part.bore_mm / 2.0)] if part.bore_mm is not None else []
    circles += [(complex(hole.x_mm, hole.y_mm), hole.diameter_mm / 2.0) for hole in part.holes]
    kind = KINDS[train.tints[part.name] % len(KINDS)] if part.teeth else BodyKind.CRANK
    return Body(f"part-{number}", kind, (part.outline_mm, *(as_points(at + radius * CIRCLE) for at, radius in circles)))


def _traces(train: Train, driving_rad: Array, size_mm: float) -> Iterator[str]:
    """The paths of followed points, and the points wished for them."""
    grid = grid_mm(TOLERANCE * size_mm)
    for trace in train.traces:
        path = closed_path([train.trace_mm(trace, driving_rad)[:-1]], grid)
        yield f'<g transform="scale({grid:g})"><path class="trace" d="{path}"/></g>'
        for x, y in trace.wished_mm.tolist():
            yield f'<circle class="pin" cx="{x:.6g}" cy="{y:.6g}" r="{10.0 * TOLERANCE * size_mm:.4g}"/>'


def train_facts(answer: Answer) -> list[tuple[str, str]]:
    """Name and text of each figure of a train's answer, for pages."""
    return typeset([("train", answer.head.partition(": ")[2]), *((row.name, row.texts[0]) for row in answer.rows)])


def train_advices(answer: Answer) -> list[dict[str, Any]]:
    """The faults of a train's answer as pages show pieces of advice."""
    words_only = {"changes": {}, "words": [], "command": ""}
    cures = [[{"text": cure, **words_only} for cure in fault.cures] for fault in answer.faults]
    said = {"stage": "", "meaning": "", "matters": True}
    return [{**said, "what": fault.what, "remedies": of} for fault, of in zip(answer.faults, cures, strict=True)]


def train_page(train: Train, answer: Answer, figures: Mapping[str, Any], design_file: Path) -> bytes:
    """The page of a train, its contact by outlines as written; ``figures`` are those of its summary."""
    scene, advices, cycle_deg = train_scene(train), train_advices(answer), degrees(train.cycle_rad)
    verdict = {"warnings": advices, "good": answer.good, "not_judged": answer.not_judged, "table": figures["verdict"]}
    return rendered(
        {
            **dict.fromkeys(("pairs", "figures", "achieved", "solids", "gears"), ()),
            "design": figures["design"],
            "facts": train_facts(answer),
            "verdict": verdict,
            "advices": [("", ToothLinks(), advices)],
            "has_gears": False,
            "comparison": [_table(*columns, figures) for columns in TABLES if figures[columns[1]]],
            "compared": "Contact",
            "speed": shown(abs(train.speed_rpm)),
            "text": design_file.read_text(encoding="utf-8"),
            "file_name": design_file.name,
            "data": {"cycle_deg": cycle_deg, "swings": False, "scene": scene["data"], "charts": [], "grids": []},
            "cycle_deg": cycle_deg,
            "scene": Markup(scene["svg"]),
            "views": list(scene["data"]["views"]),
            "paces": paces(abs(train.speed_rpm)),
        }
    )


TABLES: tuple[tuple[str, str, tuple[str, ...], tuple[Column, ...]], ...] = (
    (
        "Meshes, by the outlines as written",
        "meshes",
        ("first", "second", "penetration_max_mm", "penetration_max_at_rad", "gap_max_mm", "gap_max_at_rad"),
        columns_of("gear", "mate", "overlap at most, µm", "at, deg", "gap at most, µm", "at, deg"),
    ),
    (
        "Room between parts that do not mesh",
        "room",
        ("first", "second", "least_distance_mm", "at_rad"),
        columns_of("part", "other part", "least distance, mm", "at, deg"),
    ),
)
"""Title, key of the figures, and keys and headings of the columns of each table."""


def _table(title: str, of: str, keys: Sequence[str], heads: tuple[Column, ...], figures: Mapping[str, Any]) -> Table:
    def cell(key: str, value: Any) -> Any:
        if key.endswith("_max_mm"):
            return round(1e3 * value, 2)
        return round(degrees(value), 1) if key.endswith("_rad") else value

    return Table(title, heads, tuple(tuple(cell(key, row[key]) for key in keys) for row in figures[of]))
