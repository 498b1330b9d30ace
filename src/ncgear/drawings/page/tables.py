"""The tables of the page (comparison, contact, data sheet, versions), and the main figures that stand at its top."""

from __future__ import annotations

import platform
from collections.abc import Iterable, Mapping, Sequence
from importlib.metadata import version
from typing import Any

from ncgear import __version__
from ncgear.contact.pair import PairContact
from ncgear.figures.data_sheet.sheet import DataSheet, Group
from ncgear.figures.numbers import shown
from ncgear.figures.strong import weakest_table
from ncgear.figures.summary.build_summary import contact_summary
from ncgear.figures.summary.check_summary import comparison_rows
from ncgear.figures.tables import Column, Table
from ncgear.figures.terminal import MIXED_SPEEDS, SAME_SPEED, compared_columns, labelled
from ncgear.project.drive import Drive
from ncgear.project.strengthening import Rating, known_rating

LIBRARIES = ("numpy", "scipy", "shapely", "trimesh", "mapbox-earcut", "matplotlib", "pydantic", "ruamel.yaml")
"""The libraries that compute the figures of the page, beside ncgear and Python."""


def comparison_tables(drive: Drive) -> list[Table]:
    """A table of the mechanisms at equal speed, and one of the figures that were published at other speeds."""
    rows = comparison_rows(drive)
    same, mixed = ([row for row in rows if row["same_speed"] is wanted] for wanted in (True, False))
    return [_comparison(title, chosen) for title, chosen in ((SAME_SPEED, same), (MIXED_SPEEDS, mixed)) if chosen]


def _comparison(title: str, rows: Sequence[Mapping[str, Any]]) -> Table:
    compared = compared_columns(rows)
    cells = [(str(row["name"]), *(shown(row[key]) for key in compared)) for row in rows]
    columns = (Column("mechanism"), *compared.values())
    return Table(title, columns, tuple(cells), row_notes=tuple(row["note"] for row in rows))


def contact_tables(drive: Drive, contact: PairContact) -> list[Table]:
    """The worst figures of the contact, and all figures as designed beside those of each form of written outlines."""
    found = contact_summary(contact, drive.contact_extremes)
    designed, written = found.pop("as_designed"), found.pop("as_written")
    forms = {f"as written to {source.upper()}": figures for source, figures in written.items()}
    return [
        Table("The worst of all", (), tuple(labelled(found))),
        _beside("In detail", {"as designed": designed, **forms}),
    ]


def strength_tables(drive: Drive) -> list[Table]:
    """The weakest teeth of both gears; empty where no strength is known."""
    rating = known_rating(drive)
    return [weakest_table(drive, rating)] if isinstance(rating, Rating) else []


def _beside(title: str, sections: Mapping[str, Mapping[str, Any]]) -> Table:
    """The same figures of several sections side by side, without lists of teeth, which summary.json has."""
    plain = [{key: value for key, value in one.items() if not isinstance(value, list)} for one in sections.values()]
    columns = [dict(labelled(section)) for section in plain]
    labels = dict.fromkeys(label for column in columns for label in column)
    heads = (Column(""), *map(Column, sections))
    return Table(title, heads, tuple((label, *(column.get(label, "") for column in columns)) for label in labels))


def sheet_tables(sheet: DataSheet) -> list[Table]:
    """The groups of a data sheet as tables, and its tables."""
    return [*map(_group, sheet.groups), *sheet.tables]


def _group(group: Group) -> Table:
    """A group as a table; a value of the pair fills two columns, and a cell without a value is empty."""
    heads = Column(""), Column("driving"), Column("driven"), Column("")
    rows = [(one.label, *one.texts, one.unit) for one in group.entries]
    return Table(group.title, heads, tuple(rows))


def versions() -> Table:
    """The versions of ncgear, Python and the libraries that made the page."""
    made = (("ncgear", __version__), ("python", platform.python_version()), *((n, version(n)) for n in LIBRARIES))
    return Table("Made with", (), made)


TYPESET = (("mm/s2", "mm/s\u00b2"), ("rad/s2", "rad/s\u00b2"), (" cm3", " cm\u00b3"), (" deg", "\u00b0"))
"""Units as they are typed on a terminal, and as they are set on a page."""


def typeset(facts: Iterable[tuple[str, str]], stage: int | None = None) -> list[tuple[str, str]]:
    """Names and texts of facts for the page; the names begin with the stage where there are two."""
    of = f"stage {stage}: " if stage else ""
    found = []
    for name, text in facts:
        for typed, set_ in TYPESET:
            text = text.replace(typed, set_)
        found.append((of + name, text))
    return found
