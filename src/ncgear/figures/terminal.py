"""The same figures of several mechanisms as text, side by side.

The comparison of mechanisms as aligned text, with rows at other speeds set apart.

What a run says in the terminal: the summary as aligned text, the comparison, the warnings, the files written.
"""

from __future__ import annotations

from collections.abc import Iterator, Mapping, Sequence
from math import degrees
from pathlib import Path
from textwrap import wrap
from typing import Any

from ncgear.figures.numbers import shown
from ncgear.figures.summary.check import check_summary
from ncgear.numerics.units import label_and_unit
from ncgear.project.drive import Drive

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


WIDTH = 110
INDENT = "  "

LABELS = {
    "peak acceleration working": "peak acceleration, working stroke",
    "peak acceleration cycle": "peak acceleration, whole cycle",
}
"""Labels where the key's own words would read badly."""

PLACE = "_at_rad"
"""End of a key that holds the driving angle at which another key has its extreme value."""

TITLES = {
    "design": "Design",
    "drive": "Drive",
    "stage": "Stage",
    "stages": "Stages in series",
    "closure": "Closure of the cycle",
    "ratio": "Transmission ratio i12 = dphi1/dphi2",
    "pitch": "Pitch curves",
    "teeth": "Teeth",
    "contact": "Contact",
    "check": "Motion and power at the operating speed",
    "masses": "Moving masses",
}
"""Headings of sections; others are headed by their key."""

ELSEWHERE = ("comparison", "warnings", "timing_s")
"""Keys of a summary that have a form of their own."""


def check_text(drive: Drive) -> str:
    """The results of a check: sections, comparison, warnings."""
    return summary_text(check_summary(drive))


def build_text(summaries: Sequence[Mapping[str, Any]], paths: Sequence[Path]) -> str:
    """The results of a build, of every pair as ``check_text`` has those of a check, and the files it has written."""
    written = "\n".join(["Written", *(f"{INDENT}{path}" for path in paths)])
    return "\n\n".join([*map(summary_text, summaries), written])


def timing_text(drive: Drive) -> str:
    """How long each stage took, in seconds, and their sum."""
    taken = {_of_pair(pair, stage): seconds for pair in _timed(drive) for stage, seconds in pair.timing_s.items()}
    rows = {**taken, "sum": sum(taken.values())}
    width = max(map(len, rows))
    return "\n".join(["Time in s", *(f"{INDENT}{stage:<{width}}  {seconds:8.3f}" for stage, seconds in rows.items())])


def _timed(drive: Drive) -> list[Drive]:
    return [drive, *(pair for pair in drive.by_stage if pair is not drive)]


def _of_pair(pair: Drive, stage: str) -> str:
    return stage if pair.stage is None else f"stage {pair.stage}: {stage}"


def summary_text(summary: Mapping[str, Any]) -> str:
    """A summary for reading: its sections, the comparison, the warnings."""
    blocks = [
        *_sections(summary),
        *comparison_lines(summary.get("comparison") or [], WIDTH),
        _warnings(summary.get("warnings") or []),
    ]
    return "\n\n".join("\n".join(block) for block in blocks if block)


def _sections(summary: Mapping[str, Any]) -> list[list[str]]:
    """One block of lines per section, with the values of all sections in one column."""
    sections = {key: value for key, value in summary.items() if key not in ELSEWHERE}
    rows = {TITLES.get(key, label_and_unit(key)[0].capitalize()): _rows(key, value) for key, value in sections.items()}
    width = max((len(label) for section in rows.values() for label, _ in section), default=0)
    return [
        [title, *(line for label, value in section for line in _line_of_report(label, value, width))]
        for title, section in rows.items()
        if section
    ]


def _rows(key: str, value: Any) -> list[tuple[str, str]]:
    if isinstance(value, Mapping):
        return labelled(value)
    return [_row_of_report(key, value)]


def labelled(section: Mapping[str, Any]) -> list[tuple[str, str]]:
    """Label and text of each entry of a section, values with their units and places."""
    return list(_flattened(section, ""))


def _flattened(section: Mapping[str, Any], prefix: str) -> Iterator[tuple[str, str]]:
    """Label and value of each entry; nested entries carry the names of what they are in.

    ``min_at_rad`` is not an entry of its own: it follows the value of ``min``.
    """
    places = _places(section)
    for key, value in section.items():
        label = label_and_unit(key)[0]
        if isinstance(value, Mapping):
            yield from _flattened(value, f"{prefix}{label}, ")
        elif _owner(key) not in places:
            yield _row_of_report(key, value, prefix, places.get(label))


def _places(section: Mapping[str, Any]) -> dict[str, float]:
    """Driving angles of extreme values, by the label of the value."""
    labels = {label_and_unit(key)[0] for key in section}
    return {_owner(key): angle for key, angle in section.items() if _owner(key) in labels}


def _owner(key: str) -> str:
    """Label of the value whose place this key holds; empty for any other key."""
    return key.removesuffix(PLACE).replace("_", " ") if key.endswith(PLACE) else ""


def _row_of_report(key: str, value: Any, prefix: str = "", place_rad: float | None = None) -> tuple[str, str]:
    label, unit = label_and_unit(key)
    nothing = value is None or (isinstance(value, list) and not value)
    text = shown(value) if nothing or not unit else f"{shown(value)} {unit}"
    return prefix + LABELS.get(
        label, label
    ), text if place_rad is None else f"{text} at phi1 = {degrees(place_rad):.4g} deg"


def _line_of_report(label: str, value: str, width: int) -> list[str]:
    """``label  value``, the value wrapped under itself."""
    start = f"{INDENT}{label:<{width}}  "
    lines = wrap(value, max(WIDTH - len(start), 20)) or [""]
    return [start + lines[0], *(" " * len(start) + line for line in lines[1:])]


def _warnings(warnings: Sequence[str]) -> list[str]:
    start = "warning: "
    return [
        line
        for warning in warnings
        for line in wrap(warning, WIDTH, initial_indent=start, subsequent_indent=" " * len(start))
    ]
