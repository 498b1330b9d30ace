"""The page on speed against error, and the pictures that it shows."""

from __future__ import annotations

import os
import platform
from collections.abc import Sequence
from importlib.metadata import version

from ncgear.precision.study import Measured, Method, Point, Study
from ncgear.precision.told.plot import speed_against_error
from ncgear.precision.told.words import choice_text, error_text, level_text, named, rates_text, time_text, verdict_text

PAGE = "speed-against-error.md"
PICTURES = "speed-against-error"
"""Folder beside the page."""


def pictures(found: Sequence[Measured]) -> dict[str, bytes]:
    """One PNG for each study."""
    return {f"{one.study.key}.png": speed_against_error(one) for one in found}


def page(found: Sequence[Measured]) -> str:
    """The whole page in Markdown."""
    parts = [_head(), _overview(found), *(_section(one) for one in found)]
    return "\n\n".join(parts) + "\n"


def _head() -> str:
    return (
        "# Speed against error\n\n"
        "What each number costs by the methods it could be computed with, written by `ncgear bench` on "
        f"{machine()}. Times are the least of repeated runs in one process; errors are against references that none "
        "of the methods made. The point that ncgear works at is **bold** in the tables and has a ring in the pictures. "
        "The knee is the quickest point whose error is enough: one below which nobody gains, or ten times the least "
        "error of all where no method gets so far; adaptive methods find by themselves how fine they must be."
    )


def machine() -> str:
    """Cores, system and versions, as far as they tell of times."""
    versions = f"Python {platform.python_version()}, numpy {version('numpy')}, scipy {version('scipy')}"
    return f"{os.cpu_count()} cores, {platform.system()} {platform.machine()}, {versions}"


def _overview(found: Sequence[Measured]) -> str:
    rows = []
    for one in found:
        point = one.chosen[1]
        link = f"[{one.study.title}](#{anchor(one.study.title)})"
        rows.append((link, named(one.chosen), time_text(point), error_text(point), verdict_text(one)))
    return _table(("number", "ncgear's method", "time", "error", "knee"), rows)


def _section(found: Measured) -> str:
    study = found.study
    return "\n\n".join(
        part
        for part in (
            f"## {study.title}",
            f"Reference: {study.reference}. Errors in {study.unit}; nobody gains below {study.enough:g}.",
            f"![{study.title}: time against error]({PICTURES}/{study.key}.png)",
            _table(_heads(study), [_row(found, *one) for one in found.of_all]),
            rates_text(found),
            choice_text(found),
        )
        if part
    )


def _heads(study: Study) -> tuple[str, ...]:
    size = (study.size.name,) if study.size else ()
    return ("method", "level", *size, "time", "error")


def _row(found: Measured, method: Method, point: Point) -> tuple[str, ...]:
    size = () if point.size is None else (f"{point.size:.0f}",)
    cells = method.name, level_text(method, point), *size, time_text(point), error_text(point)
    return tuple(f"**{cell}**" for cell in cells) if (method, point) == found.chosen else cells


def anchor(title: str) -> str:
    """The fragment by which a heading is linked to."""
    return "".join(mark for mark in title.lower().replace(" ", "-") if mark.isalnum() or mark in "-_")


def _table(heads: Sequence[str], rows: Sequence[Sequence[str]]) -> str:
    lines = [heads, ["---"] * len(heads), *rows]
    return "\n".join(f"| {' | '.join(line)} |" for line in lines)
