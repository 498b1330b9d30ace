"""The tables of the page, the main figures at its top, and links to the scene for the teeth that texts name.

Texts name teeth like the advice: ``tooth 28 of the driving gear``, ``teeth 1-3, 7``, ``(tooth 3)`` after the name of a
gear.  In a run such as 1-3 both ends are links.  A link has the gear's name in the scene in ``data-gear`` and the
number in ``data-tooth``; script/find.js acts on it.
"""

from __future__ import annotations

import platform
import re
from collections.abc import Iterable, Iterator, Mapping
from importlib.metadata import version
from typing import Any

from markupsafe import Markup, escape

from ncgear import __version__
from ncgear.contact.pair import PairContact
from ncgear.figures.data_sheet.sheet import DataSheet, Group
from ncgear.figures.numbers import labelled
from ncgear.figures.strong import weakest_table
from ncgear.figures.summary.build_summary import contact_summary
from ncgear.figures.tables import Column, HtmlRow, Table
from ncgear.frozen import dataclass
from ncgear.project.drive import Drive
from ncgear.project.strengthening import Rating, known_rating

LIBRARIES = ("numpy", "scipy", "shapely", "trimesh", "mapbox-earcut", "matplotlib", "pydantic", "ruamel.yaml")
"""The libraries that compute the figures of the page, beside ncgear and Python."""


def contact_tables(drive: Drive, contact: PairContact) -> list[Table]:
    """The worst figures of the contact, and all designed figures beside the figures of all written outlines."""
    found = contact_summary(contact, drive.contact_extremes)
    designed, written = found.pop("as_designed"), found.pop("as_written")
    forms = {f"as written to {source.upper()}": figures for source, figures in written.items()}
    return [
        Table("The worst of all", (), tuple(labelled(found))),
        beside("In detail", {"as designed": designed, **forms}),
    ]


def strength_tables(drive: Drive) -> list[Table]:
    """The weakest teeth of both gears; empty where no strength is known."""
    rating = known_rating(drive)
    return [weakest_table(drive, rating)] if isinstance(rating, Rating) else []


def beside(title: str, sections: Mapping[str, Mapping[str, Any]]) -> Table:
    """The same figures of several sections side by side, without lists of teeth, which summary.json has."""
    plain = [
        {key: value for key, value in section.items() if not isinstance(value, list)} for section in sections.values()
    ]
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
    rows = [(entry.label, *entry.texts, entry.unit) for entry in group.entries]
    return Table(group.title, heads, tuple(rows))


def versions() -> Table:
    """The versions of ncgear, Python and the libraries that made the page."""
    made = (("ncgear", __version__), ("python", platform.python_version()), *((n, version(n)) for n in LIBRARIES))
    return Table("Made with", (), made)


TYPESET = (("mm/s2", "mm/s\u00b2"), ("rad/s2", "rad/s\u00b2"), (" cm3", " cm\u00b3"), (" deg", "\u00b0"))
"""Units as they are typed on a terminal, and as they are set on a page."""


def typeset(facts: Iterable[tuple[str, str]], of: str = "") -> list[tuple[str, str]]:
    """Names and texts of facts for the page; the names begin with ``of``, such as ``stage 1: ``."""
    found = []
    for name, text in facts:
        for typed, set_ in TYPESET:
            text = text.replace(typed, set_)
        found.append((of + name, text))
    return found


NUMBERS = r"\d+(?:-\d+)?(?:, \d+(?:-\d+)?)*"
NAMED = re.compile(rf"\b(driving|driven) gear\b|\b(?:tooth|teeth) ({NUMBERS})(?: of the (driving|driven) gear\b)?")
"""A gear's name, or numbers of teeth and the name of their gear."""

TEETH_FIRST = re.compile(rf"({NUMBERS})(?=$|, by up to )")
"""The beginning of a cell of teeth."""

TEETH_ROW = "teeth "

TOOTH_COLUMNS = ("tooth", "space after tooth")
"""Heads of columns that hold a tooth's number, of a gear that the row's first cell or the table's title names."""


@dataclass(frozen=True)
class ToothLinks:
    """Makes links of one pair's teeth; ``stage`` is the number of the pair, None where there is a single pair."""

    stage: int | None = None

    def text(self, words: str, gear: str = "") -> Markup:
        """Words as HTML, their teeth as links; ``gear`` is the gear of teeth that stand before any name of a gear."""
        made, end = Markup(), 0
        for found in NAMED.finditer(words):
            named, numbers, of = found.groups()
            gear = named or of or gear
            if numbers is not None and gear:
                start, stop = found.span(2)
                made += escape(words[end:start]) + self._links(numbers, gear)
                end = stop
        return made + escape(words[end:])

    def rows(self, table: Table) -> Iterator[HtmlRow]:
        """The rows of a table with their cells and notes as HTML.

        Long tables get no links: whoever goes through the page by keyboard would stop at each.
        """
        titled = _titled(table)
        for row in table.html_rows:
            first, *others = row.cells
            if table.long:
                yield row
                continue
            of_row = first if first in ("driving", "driven") else titled
            cells = [self.text(first)]
            for place, cell in enumerate(others, start=1):
                label = table.columns[place].label if place < len(table.columns) and row.span == 1 else ""
                gear = label if label in ("driving", "driven") else of_row
                cells.append(self._cell(cell, gear, label in TOOTH_COLUMNS or first.startswith(TEETH_ROW)))
            yield HtmlRow(tuple(cells), row.span, self.text(row.note, titled))

    def notes(self, table: Table) -> list[Markup]:
        """The notes of a table as HTML."""
        return [self.text(note, _titled(table)) for note in table.notes]

    def _cell(self, cell: str, gear: str, begins_with_teeth: bool) -> Markup:
        found = TEETH_FIRST.match(cell) if begins_with_teeth and gear else None
        if found is None:
            return self.text(cell, gear)
        return self._links(found[1], gear) + self.text(cell[found.end() :], gear)

    def _links(self, numbers: str, gear: str) -> Markup:
        """Numbers and runs of numbers with the signs between them, each number a link."""
        name = gear if self.stage is None else f"{gear}-{self.stage}"
        of_stage = "" if self.stage is None else f", stage {self.stage}"

        def link(found: re.Match[str]) -> str:
            said = f"show tooth {found[0]} of the {gear} gear{of_stage}"
            return (
                f'<a href="#machine" class="tooth" data-gear="{name}" data-tooth="{found[0]}" title="{said}" '
                f'aria-label="{said}">{found[0]}</a>'
            )

        return Markup(re.sub(r"\d+", link, numbers))


def _titled(table: Table) -> str:
    found = re.search(r"\b(driving|driven)\b", table.title)
    return found[1] if found else ""
