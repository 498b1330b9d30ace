"""The strength of a pair of gears as files: figures, a table with a row per tooth, pictures."""

from __future__ import annotations

from collections.abc import Mapping
from typing import Any

from ncgear.drawings.strength_pictures import strength_pictures
from ncgear.figures.numbers import json_text
from ncgear.figures.strong import strength_csv
from ncgear.files.build import folder_of
from ncgear.project.drive import Drive
from ncgear.project.strengthening import Rating


def strength_files(drive: Drive, rating: Rating, figures: Mapping[str, Any]) -> dict[str, bytes]:
    """Pictures and table of a rating, and its figures, as files by name; of a stage, in a folder of its own."""
    files = {
        **strength_pictures(drive, rating),
        "strength.csv": strength_csv(rating.strength).encode(),
        "strength.json": json_text(figures).encode(),
    }
    return {folder_of(drive.stage) + name: content for name, content in files.items()}
