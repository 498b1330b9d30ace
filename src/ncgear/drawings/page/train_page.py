"""The report of a train of gears as running: the page of a machine, with the parts that a train has."""

from __future__ import annotations

from collections.abc import Mapping
from math import degrees
from typing import Any

from markupsafe import Markup

from ncgear import __version__
from ncgear.drawings.page.data import paces
from ncgear.drawings.page.page import rendered
from ncgear.drawings.page.tables import ToothLinks, typeset, versions
from ncgear.drawings.page.train_scene import train_scene
from ncgear.figures.answers.answer import Answer
from ncgear.figures.numbers import shown
from ncgear.figures.tables import Table, columns_of
from ncgear.trains.train import Train

MICROMETRES = 1e3
"""1 mm in micrometres."""


def train_facts(answer: Answer) -> list[tuple[str, str]]:
    """Name and text of each figure of a train's answer, for pages."""
    return typeset([("train", answer.head.partition(": ")[2]), *((row.name, row.texts[0]) for row in answer.rows)])


def train_advices(answer: Answer) -> list[dict[str, Any]]:
    """The faults of a train's answer as pages show pieces of advice."""
    return [
        {
            "stage": "",
            "what": fault.what,
            "meaning": "",
            "matters": True,
            "remedies": [{"text": cure, "changes": {}, "words": [], "command": ""} for cure in fault.cures],
        }
        for fault in answer.faults
    ]


def train_page(train: Train, answer: Answer, figures: Mapping[str, Any], text: str, file_name: str) -> bytes:
    """The page of a train, its contact by outlines as written; ``figures`` are those of its summary."""
    scene, advices = train_scene(train), train_advices(answer)
    verdict = {"warnings": advices, "good": answer.good, "not_judged": answer.not_judged, "table": figures["verdict"]}
    data = {"cycle_deg": degrees(train.cycle_rad), "swings": False, "scene": scene["data"], "charts": [], "grids": []}
    return rendered(
        {
            "design": figures["design"],
            "facts": train_facts(answer),
            "pairs": [],
            "verdict": verdict,
            "advices": [("", ToothLinks(), advices)],
            "has_gears": False,
            "comparison": [_parts(figures["parts"]), _meshes(figures["meshes"]), _room(figures["room"])],
            "compared": "Parts and contact",
            "speed": shown(abs(train.speed_rpm)),
            "text": text,
            "file_name": file_name,
            "versions": versions(),
            "plain": ToothLinks(),
            "ncgear_version": __version__,
            "figures": [],
            "achieved": [],
            "data": data,
            "cycle_deg": data["cycle_deg"],
            "scene": Markup(scene["svg"]),
            "views": list(scene["data"]["views"]),
            "solids": [],
            "gears": [],
            "paces": paces(abs(train.speed_rpm)),
        }
    )


def _parts(parts: list[dict[str, Any]]) -> Table:
    heads = columns_of("part", "teeth", "face width, mm", "from, mm", "bore, mm", "fixed to")
    keys = "name", "teeth", "face_width_mm", "low_mm", "bore_mm", "fixed_to"
    rows = [[one[key] for key in keys] for one in parts]
    return Table("Parts", heads, tuple((name, teeth or None, *rest) for name, teeth, *rest in rows))


def _meshes(meshes: list[dict[str, Any]]) -> Table:
    heads = columns_of("gear", "mate", "overlap at most, µm", "at, deg", "gap at most, µm", "at, deg")
    rows = [
        (
            one["first"],
            one["second"],
            round(MICROMETRES * one["penetration_max_mm"], 2),
            _at(one["penetration_max_at_rad"]),
            round(MICROMETRES * one["gap_max_mm"], 2),
            _at(one["gap_max_at_rad"]),
        )
        for one in meshes
    ]
    return Table("Meshes, by the outlines as written", heads, tuple(rows))


def _room(distances: list[dict[str, Any]]) -> Table:
    heads = columns_of("part", "other part", "least distance, mm", "at, deg")
    rows = [(one["first"], one["second"], one["least_distance_mm"], _at(one["at_rad"])) for one in distances]
    return Table("Room between parts that do not mesh", heads, tuple(rows))


def _at(angle_rad: float) -> float:
    """A driving angle in degrees as people read it."""
    return round(degrees(angle_rad), 1)
