"""Measured gears as files: figures, a table with a row per flank, all points with their deviations, pictures."""

from __future__ import annotations

from ncgear.drawings.compared_pictures import compared_pictures
from ncgear.figures.compared import compared_csv, compared_figures, points_csv
from ncgear.figures.csv_text import outline_csv
from ncgear.figures.numbers import json_text
from ncgear.project.compared import ComparedPair


def compared_files(pair: ComparedPair, name: str) -> dict[str, bytes]:
    """The files by their names; outlines as measured have the form of those of a build."""
    files = {
        "measured.json": json_text(compared_figures(pair, name)).encode(),
        "measured.csv": compared_csv(pair).encode(),
        **compared_pictures(pair, name),
    }
    for one in pair.gears:
        files[f"measured-{one.gear.value}-points.csv"] = points_csv(one).encode()
        files[f"measured-{one.gear.value}-outline.csv"] = outline_csv(one.outline_mm).encode()
    return files
