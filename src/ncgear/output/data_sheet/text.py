"""The data sheet as text (Markdown), and the table of its pitch curves as numbers."""

from __future__ import annotations

import re

import numpy as np

from ncgear.drive import Drive
from ncgear.output.data_sheet.pitch_table import pitch_columns
from ncgear.output.data_sheet.values import Column, DataSheet, Group, Row, Table, Value, cell_text
from ncgear.output.tables import csv_text

PITCH_STEPS = 720
"""Of half a degree each over a turn of the driving gear."""

PITCH_COLUMNS = ("phi1_deg", "phi2_deg", "ratio", "radius_driving_mm", "radius_driven_mm")

MEANT = re.compile(r"[\\|<&`*_\[\]]")
"""Characters that mean more than themselves in Markdown; a backslash before them takes that away."""


def pitch_csv(drive: Drive) -> str:
    """Angles, ratio and pitch radii over one turn of the driving gear, every half degree."""
    degrees = np.linspace(0.0, 360.0, PITCH_STEPS + 1)
    _, driven, *others = pitch_columns(drive.pitch, np.radians(degrees))
    return csv_text(PITCH_COLUMNS, [degrees, np.degrees(driven), *others])


def sheet_text(sheet: DataSheet) -> str:
    """The sheet as Markdown."""
    blocks = [f"# Gear data: {sheet.name}", *map(_group, sheet.groups), *map(_table, sheet.tables)]
    return "\n\n".join(blocks) + "\n"


def _group(group: Group) -> str:
    rows = [_cells(row) for row in group.rows]
    return _headed(group.title, ("", "driving, or both", "driven", "unit"), rows)


def _cells(row: Row) -> tuple[Value, ...]:
    return row.label, row.pair if row.of_pair else row.driving, row.driven, row.unit


def _table(table: Table) -> str:
    notes = "".join(f"\n\n{note[0].upper()}{note[1:]}." for note in table.notes)
    return _headed(table.title, tuple(map(_heading, table.columns)), list(table.rows)) + notes


def _heading(column: Column) -> str:
    return f"{column.label} in {column.unit}" if column.unit else column.label


def _headed(title: str, heads: tuple[str, ...], rows: list[tuple[Value, ...]]) -> str:
    lines = [_line(heads), _line(("---",) * len(heads)), *map(_line, rows)]
    return "\n".join([f"## {title}", "", *lines])


def _line(cells: tuple[Value, ...]) -> str:
    return f"| {' | '.join(map(_cell, cells))} |"


def _cell(value: Value) -> str:
    """A cell on one line, in which what the design file says is text: no cell ends in it, no HTML begins."""
    return MEANT.sub(r"\\\g<0>", " ".join(cell_text(value).split())) if isinstance(value, str) else cell_text(value)
