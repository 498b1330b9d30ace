"""The comparison of mechanisms as aligned text, with rows at other speeds set apart."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from textwrap import wrap
from typing import Any

from ncgear.output.numbers import shown

COLUMNS = {
    "speed_rpm": ("speed", "r/min"),
    "peak_power_w": ("peak power", "W"),
    "mean_power_w": ("mean power", "W"),
    "peak_acceleration_cycle_mm_s2": ("peak accel., cycle", "mm/s2"),
    "peak_speed_mm_s": ("peak speed", "mm/s"),
}
"""Column heads and units by key of a row."""

SAME_SPEED = "Comparison at equal driving speed"
MIXED_SPEEDS = "At other driving speeds: mixes speeds, so this proves nothing about equal productivity"

NAME_WIDTH = 36

Row = Mapping[str, Any]


def comparison_lines(rows: Sequence[Row], width: int) -> list[list[str]]:
    """One block of lines for the mechanisms at equal speed, and one, headed as such, for those at other speeds.

    Each row has ``name``, the keys of COLUMNS (None where unknown), ``same_speed`` and ``note``; a note is wrapped to
    ``width`` characters below its row.
    """
    same = [row for row in rows if row["same_speed"]]
    mixed = [row for row in rows if not row["same_speed"]]
    name_width = max((len(line) for row in rows for line in _name(row)), default=0)
    return [
        [title, *_head(name_width), *(line for row in chosen for line in _row(row, name_width, width))]
        for title, chosen in ((SAME_SPEED, same), (MIXED_SPEEDS, mixed))
        if chosen
    ]


def _head(name_width: int) -> list[str]:
    return [
        _line("", [head for head, _ in COLUMNS.values()], name_width),
        _line("", [unit for _, unit in COLUMNS.values()], name_width),
    ]


def _row(row: Row, name_width: int, width: int) -> list[str]:
    values = [shown(row.get(key)) for key in COLUMNS]
    first, *more = _name(row)
    indent = " " * 6
    note = wrap(row.get("note") or "", width, initial_indent=indent, subsequent_indent=indent)
    return [_line(first, values, name_width), *(f"  {line}" for line in more), *note]


def _line(name: str, values: Sequence[str], name_width: int) -> str:
    cells = (f"{value:>{max(len(head), 8)}}" for value, (head, _) in zip(values, COLUMNS.values(), strict=True))
    return "  ".join([f"  {name:<{name_width}}", *cells])


def _name(row: Row) -> list[str]:
    return wrap(str(row["name"]), NAME_WIDTH) or [""]
