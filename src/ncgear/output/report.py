"""What a run says in the terminal: the summary as aligned text, the comparison, the warnings, the files written."""

from __future__ import annotations

from collections.abc import Iterator, Mapping, Sequence
from math import degrees
from pathlib import Path
from textwrap import wrap
from typing import Any

from ncgear.drive import Drive
from ncgear.output.comparison import comparison_lines
from ncgear.output.numbers import label_and_unit, shown
from ncgear.output.summary.check import check_summary

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
        [title, *(line for label, value in section for line in _line(label, value, width))]
        for title, section in rows.items()
        if section
    ]


def _rows(key: str, value: Any) -> list[tuple[str, str]]:
    if isinstance(value, Mapping):
        return labelled(value)
    return [_row(key, value)]


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
            yield _row(key, value, prefix, places.get(label))


def _places(section: Mapping[str, Any]) -> dict[str, float]:
    """Driving angles of extreme values, by the label of the value."""
    labels = {label_and_unit(key)[0] for key in section}
    return {_owner(key): angle for key, angle in section.items() if _owner(key) in labels}


def _owner(key: str) -> str:
    """Label of the value whose place this key holds; empty for any other key."""
    return key.removesuffix(PLACE).replace("_", " ") if key.endswith(PLACE) else ""


def _row(key: str, value: Any, prefix: str = "", place_rad: float | None = None) -> tuple[str, str]:
    label, unit = label_and_unit(key)
    nothing = value is None or (isinstance(value, list) and not value)
    text = shown(value) if nothing or not unit else f"{shown(value)} {unit}"
    return prefix + LABELS.get(
        label, label
    ), text if place_rad is None else f"{text} at phi1 = {degrees(place_rad):.4g} deg"


def _line(label: str, value: str, width: int) -> list[str]:
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
