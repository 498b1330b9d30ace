"""The report of a train of gears as running: the page of a machine, with the parts that a train has."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from math import degrees
from pathlib import Path
from typing import Any

from markupsafe import Markup

from ncgear.drawings.page.data import paces
from ncgear.drawings.page.page import rendered
from ncgear.drawings.page.tables import ToothLinks, typeset
from ncgear.drawings.page.train_scene import train_scene
from ncgear.figures.answers.answer import Answer
from ncgear.figures.numbers import shown
from ncgear.figures.tables import Column, Table, columns_of
from ncgear.trains.train import Train


def train_facts(answer: Answer) -> list[tuple[str, str]]:
    """Name and text of each figure of a train's answer, for pages."""
    return typeset([("train", answer.head.partition(": ")[2]), *((row.name, row.texts[0]) for row in answer.rows)])


def train_advices(answer: Answer) -> list[dict[str, Any]]:
    """The faults of a train's answer as pages show pieces of advice."""
    words_only = {"changes": {}, "words": [], "command": ""}
    cures = [[{"text": cure, **words_only} for cure in one.cures] for one in answer.faults]
    said = {"stage": "", "meaning": "", "matters": True}
    return [{**said, "what": one.what, "remedies": of} for one, of in zip(answer.faults, cures, strict=True)]


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
            "comparison": [_table(*one, figures) for one in TABLES if figures[one[1]]],
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

    return Table(title, heads, tuple(tuple(cell(key, one[key]) for key in keys) for one in figures[of]))
