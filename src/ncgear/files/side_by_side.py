"""Designs side by side as files: their figures, a table of them, and their motions in charts."""

from __future__ import annotations

from ncgear.drawings.side_by_side import side_by_side_png
from ncgear.figures.csv_text import rows_text
from ncgear.figures.numbers import json_text
from ncgear.figures.side_by_side import SideBySide, side_by_side_columns, side_by_side_figures


def side_by_side_files(found: SideBySide) -> dict[str, bytes]:
    """The files by their names."""
    return {
        "compare.json": json_text(side_by_side_figures(found)).encode(),
        "compare.csv": rows_text(*side_by_side_columns(found)).encode(),
        "compare.png": side_by_side_png(found),
    }
