"""A table as a value, and the ways in which it is written: aligned text, Markdown, and the cells of HTML."""

from __future__ import annotations

import re
from collections.abc import Iterable, Sequence
from itertools import zip_longest
from typing import NamedTuple

from ncgear.figures.numbers import drawn
from ncgear.frozen import dataclass

Value = float | int | str | bool | tuple[float, float] | None
"""The content of a cell: a value, or the least and the greatest one; None leaves it empty."""

Cells = tuple[Value, ...]

WIDTH = 110
"""Columns of a line of text."""

GAP = "  "
"""Between the columns of aligned text."""

MEANT = re.compile(r"[\\|<&`*_\[\]]")
"""Characters with a meaning in Markdown; a backslash before them takes the meaning away."""


class Column(NamedTuple):
    """Heading of a column; ``unit`` may be empty."""

    label: str
    unit: str = ""

    @property
    def heading(self) -> str:
        """``span in mm``."""
        return f"{self.label} in {self.unit}" if self.unit else self.label


def columns_of(*headings: str) -> tuple[Column, ...]:
    """Columns by their headings, each a label or, as in ``stress, MPa``, a label and a unit."""
    return tuple(Column(*heading.rsplit(", ", 1)) for heading in headings)


class HtmlRow(NamedTuple):
    """Cells of text; the first one names the row, and the second one is ``span`` columns wide."""

    cells: tuple[str, ...]
    span: int
    note: str


@dataclass(frozen=True)
class Table:
    """Rows of cells under a title; a row has as many cells as there are ``columns``, or fewer.

    In a shorter row the second cell also fills the missing columns.  A table without columns has no heads.  ``notes``
    are sentences about the whole table; ``row_notes`` has one note, perhaps empty, for each row.  A ``long`` table may
    be broken between rows in print.
    """

    title: str
    columns: tuple[Column, ...]
    rows: tuple[Cells, ...]
    notes: tuple[str, ...] = ()
    row_notes: tuple[str, ...] = ()
    long: bool = False

    def texts(self, cells: Cells) -> list[str]:
        """The texts of a row, each to the decimals of its column's unit."""
        units = [column.unit for column in self.columns]
        return [cell_text(value, unit) for value, unit in zip_longest(cells, units[: len(cells)], fillvalue="")]

    @property
    def html_rows(self) -> list[HtmlRow]:
        """The rows for HTML, in text that is not escaped yet."""
        notes = self.row_notes or ("",) * len(self.rows)
        return [
            HtmlRow(tuple(self.texts(cells)), max(1 + len(self.columns) - len(cells), 1), note)
            for cells, note in zip(self.rows, notes, strict=True)
        ]


def cell_text(value: Value, unit: str = "") -> str:
    """A cell for reading: numbers as on a drawing (``numbers.drawn``), a range as ``10 to 12``, nothing for None."""
    if value is None:
        return ""
    if isinstance(value, tuple):
        return " to ".join(dict.fromkeys(drawn(end, unit) for end in value))
    return drawn(value, unit) if isinstance(value, float) else str(value)


def aligned(
    rows: Sequence[Sequence[str]], left: int = 0, least: Sequence[int] | int = 0, indent: str = GAP
) -> list[str]:
    """One line for each row of texts, all of one length, in columns as wide as their widest text.

    The first ``left`` columns are aligned to the left, the others to the right.  ``least`` is the least width of the
    columns, one for each or one for all.
    """
    count = len(rows[0]) if rows else 0
    narrowest = [least] * count if isinstance(least, int) else least
    widths = [max(low, *map(len, texts)) for low, texts in zip(narrowest, zip(*rows, strict=True), strict=True)]
    aligns = "<" * left + ">" * (count - left)
    lines = (
        GAP.join(f"{text:{align}{width}}" for text, align, width in zip(row, aligns, widths, strict=False))
        for row in rows
    )
    return [f"{indent}{line}".rstrip() for line in lines]


def markdown(heads: Sequence[str], rows: Iterable[Sequence[str]], rule: str = "---") -> list[str]:
    """The lines of a table in Markdown, the texts unchanged; ``rule`` is drawn below each head."""
    first, *others = (f"| {' | '.join(texts)} |" for texts in (heads, *rows))
    return [first, f"|{'|'.join([rule] * len(heads))}|", *others]


def markdown_text(value: Value, unit: str = "") -> str:
    """A cell on one line of Markdown; no character of it ends the cell, begins HTML or has another meaning."""
    text = cell_text(value, unit)
    return MEANT.sub(r"\\\g<0>", " ".join(text.split())) if isinstance(value, str) else text
