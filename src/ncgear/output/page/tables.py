"""The page's tables as rows of text: comparison, contact, versions."""

from __future__ import annotations

import platform
from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from importlib.metadata import version
from typing import Any

from ncgear import __version__
from ncgear.contact.pair_contact import PairContact
from ncgear.drive import Drive
from ncgear.output.comparison import COLUMNS, MIXED_SPEEDS, SAME_SPEED
from ncgear.output.comparison_rows import comparison_rows
from ncgear.output.contact_summary import contact_summary
from ncgear.output.numbers import shown
from ncgear.output.report import labelled

LIBRARIES = ("numpy", "scipy", "sympy", "shapely", "trimesh", "mapbox-earcut", "matplotlib", "pydantic", "ruamel.yaml")
"""What the figures of the page come from, beside ncgear and Python."""


@dataclass(frozen=True)
class Row:
    """Cells of text, the first of which names the row, and what is to be said about it."""

    cells: tuple[str, ...]
    note: str = ""


@dataclass(frozen=True)
class Table:
    """Rows under a title; ``head`` has one pair of a name and a unit for each cell, or nothing."""

    title: str
    head: tuple[tuple[str, str], ...]
    rows: tuple[Row, ...]


def comparison_tables(drive: Drive) -> list[Table]:
    """The mechanisms at equal speed; those that were published at others, and headed as such."""
    rows = comparison_rows(drive)
    same, mixed = ([row for row in rows if row["same_speed"] is wanted] for wanted in (True, False))
    return [_comparison(title, chosen) for title, chosen in ((SAME_SPEED, same), (MIXED_SPEEDS, mixed)) if chosen]


def _comparison(title: str, rows: Sequence[Mapping[str, Any]]) -> Table:
    head = (("mechanism", ""), *COLUMNS.values())
    cells = [(str(row["name"]), *(shown(row[key]) for key in COLUMNS)) for row in rows]
    return Table(title, head, tuple(Row(c, row["note"]) for c, row in zip(cells, rows, strict=True)))


def contact_tables(drive: Drive, contact: PairContact) -> list[Table]:
    """The figures of the contact: in short, as designed, and as each form in which the outlines were written."""
    found = contact_summary(contact, drive.pair_speed_rad_s)
    designed, written = found.pop("as_designed"), found.pop("as_written")
    rest = {f"as written to {source.upper()}": figures for source, figures in written.items()}
    sections = {"contact": found, "as designed": designed, **rest}
    return [Table(title, (), tuple(map(Row, labelled(section)))) for title, section in sections.items()]


def versions() -> Table:
    """What the page was made with."""
    made = (("ncgear", __version__), ("python", platform.python_version()), *((n, version(n)) for n in LIBRARIES))
    return Table("Made with", (), tuple(map(Row, made)))
