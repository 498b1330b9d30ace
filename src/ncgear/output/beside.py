"""The same figures of several mechanisms as text, side by side."""

from __future__ import annotations

from collections.abc import Mapping
from typing import Any

from ncgear.output.report import INDENT, labelled

MECHANISMS = {"this_design": "this design", "uniform_crank": "uniform crank"}
"""Keys of sections that are set side by side, and their heads."""


def beside_lines(title: str, sections: Mapping[str, Mapping[str, Any]]) -> list[str]:
    """A head and one line for each figure that any of the sections, by key of MECHANISMS, has."""
    columns = [dict(labelled(section)) for section in sections.values()]
    labels = list(dict.fromkeys(label for column in columns for label in column))
    rows = [[label, *(column.get(label, "-") for column in columns)] for label in labels]
    table = [[title, *(MECHANISMS[key] for key in sections)], *([INDENT + first, *rest] for first, *rest in rows)]
    widths = [max(map(len, column)) for column in zip(*table, strict=True)]
    return ["  ".join(f"{cell:<{width}}" for cell, width in zip(row, widths, strict=True)).rstrip() for row in table]
