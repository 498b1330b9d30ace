"""The data sheet of a pair of gears as plain values: groups of rows and tables, for whoever renders them."""

from __future__ import annotations

from dataclasses import dataclass

Value = float | int | str | bool | None
"""What stands in a cell; None where there is nothing to say."""

DIGITS = 7
"""Of numbers in text: a tenth of a micrometre on a gear of 100 mm."""


def cell_text(value: Value) -> str:
    """A cell for reading: numbers to ``DIGITS`` digits, nothing for None."""
    if value is None:
        return ""
    return f"{value:.{DIGITS}g}" if isinstance(value, float) else str(value)


@dataclass(frozen=True)
class Row:
    """One line of the sheet: values of the ``pair``, or of the ``driving`` and the ``driven`` gear; ``unit`` may be
    empty."""

    label: str
    unit: str = ""
    pair: Value = None
    driving: Value = None
    driven: Value = None

    @property
    def of_pair(self) -> bool:
        """Whether the value is the pair's, for which renderers need one cell."""
        return self.pair is not None


@dataclass(frozen=True)
class Group:
    """Rows under a heading."""

    title: str
    rows: tuple[Row, ...]


@dataclass(frozen=True)
class Column:
    """Heading of a table's column; ``unit`` may be empty."""

    label: str
    unit: str = ""


@dataclass(frozen=True)
class Table:
    """Numbers by row, each as long as ``columns``; ``notes`` are sentences that belong to it."""

    title: str
    columns: tuple[Column, ...]
    rows: tuple[tuple[Value, ...], ...]
    notes: tuple[str, ...] = ()


@dataclass(frozen=True)
class DataSheet:
    """What a drawing of the pair needs."""

    name: str
    groups: tuple[Group, ...]
    tables: tuple[Table, ...]
