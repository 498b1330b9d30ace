"""Teeth that the page's words name, as links that show them in the scene.

Words name teeth as the advices do: ``tooth 28 of the driving gear``, ``teeth 1-3, 7``, ``(tooth 3)`` after the name of
a gear.  Of a run such as 1-3 both ends are links.  A link has the gear's name in the scene in ``data-gear`` and the
number in ``data-tooth``; script/find.js acts on it.
"""

from __future__ import annotations

import re
from collections.abc import Iterator

from markupsafe import Markup, escape

from ncgear.figures.tables import HtmlRow, Table
from ncgear.frozen import dataclass

NUMBERS = r"\d+(?:-\d+)?(?:, \d+(?:-\d+)?)*"
NAMED = re.compile(rf"\b(driving|driven) gear\b|\b(?:tooth|teeth) ({NUMBERS})(?: of the (driving|driven) gear\b)?")
"""A gear's name, or numbers of teeth and the gear whose teeth they are."""

TEETH_FIRST = re.compile(rf"({NUMBERS})(?=$|, by up to )")
"""What a cell of teeth begins with, in a row whose name begins so."""

TEETH_ROW = "teeth "

TOOTH_COLUMNS = ("tooth", "space after tooth")
"""Heads of columns that hold a tooth's number, of a gear that the row's first cell or the table's title names."""


@dataclass(frozen=True)
class ToothLinks:
    """Makes links of one pair's teeth; ``stage`` is that of two pairs in series, None of a single one."""

    stage: int | None = None

    def text(self, words: str, gear: str = "") -> Markup:
        """Words as HTML, their teeth as links; ``gear`` is the one that is meant where none is named before."""
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
    """The gear that the title of a table names; empty where it names none."""
    found = re.search(r"\b(driving|driven)\b", table.title)
    return found[1] if found else ""
