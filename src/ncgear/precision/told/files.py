"""The files of a run that measures speed against error, and what it says in the terminal."""

from __future__ import annotations

from collections.abc import Sequence
from pathlib import Path

from ncgear.files.publish import publish
from ncgear.precision.study import Measured
from ncgear.precision.told.page import PAGE, PICTURES, page, pictures
from ncgear.precision.told.words import error_text, named, time_text, verdict_text


def write(folder: Path, found: Sequence[Measured]) -> list[Path]:
    """Write the page, and the pictures into a folder beside it; returns all paths."""
    written = publish(folder / PICTURES, pictures(found))
    return [*publish(folder, {PAGE: page(found).encode()}), *written]


def bench_text(found: Sequence[Measured], paths: Sequence[Path]) -> str:
    """The chosen points, and the files written."""
    width = max(len(one.study.key) for one in found)
    lines = [
        f"{one.study.key:<{width}}  {time_text(one.chosen[1]):>8}  {error_text(one.chosen[1]):>8}  "
        f"{named(one.chosen)}; knee: {verdict_text(one)}"
        for one in found
    ]
    return "\n".join([*lines, "", "Written", *(f"  {path}" for path in paths)])
