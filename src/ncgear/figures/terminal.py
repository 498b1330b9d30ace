"""Text for the terminal: a summary in aligned lines, comparisons, warnings, timings, the files written."""

from __future__ import annotations

from collections.abc import Iterator, Mapping, Sequence
from itertools import groupby
from math import degrees
from pathlib import Path
from textwrap import wrap
from typing import Any

from ncgear.figures.answers.answer import Answer, whole_answer
from ncgear.figures.numbers import fixed, placed, shown
from ncgear.figures.quantities import STATISTICS, figure, name_of, told
from ncgear.figures.summary.check_summary import check_summary
from ncgear.figures.tables import WIDTH, Column, aligned
from ncgear.figures.wished import wish_line
from ncgear.numerics.units import label_and_unit
from ncgear.project.drive import Drive

INDENT = "  "

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
    "strength": "Strength of the teeth",
    "displacement": "Displacement as a flow meter or pump",
}
"""Headings of sections; the heading of any other section is its key."""

JUDGED = ("warnings", "remarks", "verdict")
"""Keys of what is judged."""

ELSEWHERE = ("motion", "wishes", "comparison", *JUDGED, "timing_s")
"""Keys of a summary that are not written as sections."""

COMPARED = (
    "speed_rpm",
    "peak_power_w",
    "peak_power_resistance_w",
    "mean_power_w",
    "peak_acceleration_cycle_mm_s2",
    "peak_speed_mm_s",
    "peak_acceleration_cycle_rad_s2",
    "peak_speed_rad_s",
)
"""The figures of a comparison of mechanisms, by their keys."""


def compared_columns(rows: Sequence[Mapping[str, Any]]) -> dict[str, Column]:
    """The columns of a comparison of mechanisms by key of its rows, in the units of what they move."""
    keys = [key for key in COMPARED if any(key in row for row in rows)]
    return {key: Column(name_of(key), label_and_unit(key)[1]) for key in keys}


SAME_SPEED = "Comparison at equal driving speed"
MIXED_SPEEDS = "At other driving speeds: mixes speeds, so this proves nothing about equal productivity"

NAME_WIDTH = 36
LEAST_WIDTH = 8
"""A comparison's first column is at most NAME_WIDTH wide, and each other one at least LEAST_WIDTH."""


def check_text(drive: Drive) -> str:
    """The results of a check: sections, comparison, warnings."""
    return summary_text(check_summary(drive))


def build_text(summaries: Sequence[Mapping[str, Any]], paths: Sequence[Path], kept: Sequence[Path] = ()) -> str:
    """The results of a build: the summary of every pair, the files written, and the kept files of others."""
    return "\n\n".join([*map(summary_text, summaries), "\n".join(written_lines(paths, kept))])


def summary_text(summary: Mapping[str, Any]) -> str:
    """A summary for reading: its sections, the comparison, the warnings, the remarks."""
    blocks = [
        *_sections(summary),
        motion_lines(summary),
        *comparison_lines(summary.get("comparison") or []),
        *judged_blocks(summary),
    ]
    return "\n\n".join("\n".join(block) for block in blocks if block)


def judged_blocks(figures: Mapping[str, Any]) -> list[list[str]]:
    """The warnings, the remarks and the verdict that figures hold; empty blocks where there are none."""
    return [
        _marked("warning: ", figures.get("warnings") or []),
        _marked("remark: ", figures.get("remarks") or []),
        verdict_lines(figures.get("verdict") or []),
    ]


def verdict_lines(rows: Sequence[Mapping[str, Any]]) -> list[str]:
    """Every condition of a verdict, and what was found of it."""
    if not rows:
        return []
    lines = []
    for row in rows:
        of = "" if row["stage"] is None else f"stage {row['stage']}: "
        because = f": {row['because']}" if row["because"] else ""
        remark = f"; remark: {row['remark']}" if row["remark"] else ""
        lines.append(f"  {row['verdict']:10}  {of}{row['says']}{because}{remark}")
    return ["Verdict", *lines]


def _sections(summary: Mapping[str, Any]) -> list[list[str]]:
    """One block of lines per section, with the values of all sections in one column."""
    sections = {key: value for key, value in summary.items() if key not in ELSEWHERE}
    rows = {
        TITLES.get(key, label_and_unit(key)[0].capitalize()): (
            labelled(value) if isinstance(value, Mapping) else [_labelled_value(key, value)]
        )
        for key, value in sections.items()
    }
    width = max((len(label) for section in rows.values() for label, _ in section), default=0)
    return [
        [title, *(line for label, value in section for line in value_lines(label, value, width))]
        for title, section in rows.items()
        if section
    ]


def labelled(section: Mapping[str, Any]) -> list[tuple[str, str]]:
    """Label and text of each entry of a section; the text has the value, its unit and its place."""
    return list(_flattened(section, ""))


def _flattened(section: Mapping[str, Any], prefix: str) -> Iterator[tuple[str, str]]:
    """Label and text of each entry; the label of a nested entry begins with the names of the groups around it.

    ``min_at_rad`` is not an entry of its own: it follows the value of ``min``.
    """
    # Driving angles of extreme values, by the label of the value.
    labels = {label_and_unit(key)[0] for key in section}
    places = {_owner(key): angle for key, angle in section.items() if _owner(key) in labels}
    for key, value in section.items():
        label = label_and_unit(key)[0]
        if isinstance(value, Mapping):
            yield from _flattened(value, f"{prefix}{label}, ")
        elif _owner(key) not in places:
            yield _labelled_value(key, value, prefix, places.get(label))


def _owner(key: str) -> str:
    """Label of the value whose place this key holds; empty for any other key."""
    return key.removesuffix(PLACE).replace("_", " ") if key.endswith(PLACE) else ""


def _labelled_value(key: str, value: Any, prefix: str = "", place_rad: float | None = None) -> tuple[str, str]:
    label, text, unit = told(key, value)
    place = "" if place_rad is None else f" at phi1 = {placed(degrees(place_rad))} deg"
    return prefix + label, f"{text} {unit}".rstrip() + place


def value_lines(label: str, value: str, width: int) -> list[str]:
    """The line ``label  value``; further lines of a long value begin below the value."""
    start = f"{INDENT}{label:<{width}}  "
    lines = wrap(value, max(WIDTH - len(start), 20)) or [""]
    return [start + lines[0], *(" " * len(start) + line for line in lines[1:])]


def _marked(start: str, sentences: Sequence[str]) -> list[str]:
    """Lines of sentences that begin with what they are."""
    return [
        line
        for sentence in sentences
        for line in wrap(sentence, WIDTH, initial_indent=start, subsequent_indent=" " * len(start))
    ]


def motion_lines(summary: Mapping[str, Any]) -> list[str]:
    """What the motion achieves, and then every wish; empty for a summary that says nothing of it."""
    if "motion" not in summary:
        return []
    lines = [summary["motion"]["in_words"], *map(wish_line, summary["wishes"])]
    return ["What the motion achieves", *(part for line in lines for part in _indented(line))]


def _indented(line: str) -> list[str]:
    return wrap(line, WIDTH, initial_indent=INDENT, subsequent_indent=2 * INDENT)


def comparison_lines(rows: Sequence[Mapping[str, Any]]) -> list[list[str]]:
    """One block of lines for the mechanisms at equal speed, and one for mechanisms at other speeds.

    Each row has ``name``, keys of COMPARED (None where unknown), ``same_speed`` and ``note``.
    """
    name_width = max((len(line) for row in rows for line in _name_lines(row)), default=0)
    blocks = []
    for title, same in ((SAME_SPEED, True), (MIXED_SPEEDS, False)):
        chosen = [row for row in rows if row["same_speed"] is same]
        if chosen:
            blocks.append([title, *_compared(chosen, name_width)])
    return blocks


def _compared(rows: Sequence[Mapping[str, Any]], name_width: int) -> list[str]:
    """The lines of a comparison; long names continue below themselves, and notes are below their rows."""
    columns = compared_columns(rows)
    cells = [
        ["", *(column.label for column in columns.values())],
        ["", *(column.unit for column in columns.values())],
        *([_name_lines(row)[0], *(shown(row.get(key)) for key in columns)] for row in rows),
    ]
    table = aligned(cells, left=1, least=[name_width, *[LEAST_WIDTH] * len(columns)])
    lines, indent = table[:2], " " * 6
    for row, line in zip(rows, table[2:], strict=True):
        note = wrap(row.get("note") or "", WIDTH, initial_indent=indent, subsequent_indent=indent)
        lines += [line, *(f"{INDENT}{more}" for more in _name_lines(row)[1:]), *note]
    return lines


def _name_lines(row: Mapping[str, Any]) -> list[str]:
    return wrap(str(row["name"]), NAME_WIDTH) or [""]


def timing_text(drive: Drive) -> str:
    """The seconds that each step took, and their sum."""
    taken = {}
    for pair in (drive, *(pair for pair in drive.by_stage if pair is not drive)):
        of = "" if pair.stage is None else f"stage {pair.stage}: "
        taken.update({f"{of}{step}": seconds for step, seconds in pair.timing_s.items()})
    rows = [(step, fixed(seconds, 3)) for step, seconds in {**taken, "sum": sum(taken.values())}.items()]
    return "\n".join(["Time in s", *aligned(rows, left=1, least=[0, LEAST_WIDTH])])


def written_lines(paths: Sequence[Path], kept: Sequence[Path] = ()) -> list[str]:
    """The files that a command has written, and those in their places that it has kept."""
    return ["Written", *(f"{INDENT}{path}" for path in paths), *kept_lines(kept)]


def kept_lines(kept: Sequence[Path]) -> list[str]:
    """The new names of files that were not as ncgear had written them."""
    if not kept:
        return []
    return ["Kept under a new name, because they were not as ncgear had written them", *(f"{INDENT}{p}" for p in kept)]


Figures = Mapping[str, Any]

ROOM = 140
"""Characters of a line of a table."""


def full_text(answer: Answer, figures: Sequence[Figures], paths: Sequence[Path], kept: Sequence[Path] = ()) -> str:
    """The whole answer, then every figure, once for each pair of gears that is told by itself, then the files."""
    told_by_pair = [block for one in figures for block in (*_blocks(one), *judged_blocks(one))]
    blocks = [*whole_answer(answer), *told_by_pair, written_lines(paths, kept) if paths else []]
    return "\n\n".join("\n".join(block) for block in blocks if block)


def _blocks(figures: Figures) -> list[list[str]]:
    """The plain figures, and a block for each group or for groups that stand side by side."""
    found = {key: value for key, value in figures.items() if key not in JUDGED}
    return [_plain_lines("", found), *_groups(found)]


def _plain_lines(name: str, figures: Figures) -> list[str]:
    """One line for each figure of a group that is no group itself."""
    rows = _texts(name, {key: value for key, value in figures.items() if not _is_group(value)})
    width = max((len(label) for label, _ in rows), default=0)
    return [line for label, text in rows for line in value_lines(label, text, width)]


def _texts(name: str, group: Figures) -> list[tuple[str, str]]:
    """Names and texts of a group of figures; statistics are in the unit that the name of the group ends in."""
    if STATISTICS.keys() >= group.keys():
        return [(STATISTICS[key], figure(name, value)) for key, value in group.items()]
    return labelled(group)


def _groups(figures: Figures) -> list[list[str]]:
    """The name and the lines of each group; groups that follow one another and hold the same figures are one table."""
    groups = [(key, value) for key, value in figures.items() if _is_group(value) and value]
    found = []
    for keys, alike in groupby(groups, lambda group: _keys(group[1])):
        some = list(alike)
        table = _side_by_side(some) if keys and len(some) > 1 else []
        found += [table] if table else [[name_of(key), *_content(key, value)] for key, value in some]
    return found


def _is_group(value: Any) -> bool:
    return isinstance(value, Mapping) or (isinstance(value, list) and bool(value) and isinstance(value[0], Mapping))


def _keys(group: Any) -> frozenset[str]:
    """The keys of a group that holds nothing but plain figures; empty of any other."""
    plain = isinstance(group, Mapping) and not any(map(_is_group, group.values()))
    return frozenset(group) if plain else frozenset()


def _side_by_side(groups: Sequence[tuple[str, Figures]]) -> list[str]:
    """Groups of the same figures as a table; no lines where it has no room."""
    rows = [(name_of(key), dict(_texts(key, group))) for key, group in groups]
    heads = list(rows[0][1])
    cells = [["", *heads], *([name, *(own[head] for head in heads)] for name, own in rows)]
    return _with_room(cells if len(rows) >= len(heads) else _turned(cells), 1)


def _content(name: str, value: Any) -> list[str]:
    """The lines of a group; a list of groups is a table, or has one below the other where that has no room."""
    if isinstance(value, list):
        return _table(value) or [line for row in value for line in [*_content(name, row), ""]][:-1]
    return [*_plain_lines(name, value), *(INDENT + line for block in _groups(value) for line in block)]


def _table(rows: Sequence[Figures]) -> list[str]:
    """The lines of a table, without the columns that have no value in any row; none where it has no room."""
    if len(rows) == 1 or any(map(_holds_table, rows)):
        return []
    if any(row.keys() != rows[0].keys() or any(map(_is_group, row.values())) for row in rows):
        flat = [dict(labelled(row)) for row in rows]
        heads = list(dict.fromkeys(head for row in flat for head in row))
        return _with_room([heads, *([row.get(head, "-") for head in heads] for row in flat)])
    keys = [key for key in rows[0] if any(row[key] is not None for row in rows)]
    columns = [[told(key, row[key]) for row in rows] for key in keys]
    heads = [", ".join(filter(None, (column[0][0], max(unit for *_, unit in column)))) for column in columns]
    return _with_room([heads, *_turned([[text for _, text, _ in column] for column in columns])])


def _holds_table(group: Figures) -> bool:
    """Whether a list of groups is anywhere in a group."""
    return any(isinstance(one, list) or _holds_table(one) for one in group.values() if _is_group(one))


def _with_room(cells: Sequence[Sequence[str]], left: int = 0) -> list[str]:
    """The lines of a table, with its columns as rows where only that has room; none where that has no room either."""
    tables = aligned(cells, left), aligned(_turned(cells), 1)
    return next((lines for lines in tables if max(map(len, lines)) <= ROOM), [])


def _turned(cells: Sequence[Sequence[str]]) -> list[list[str]]:
    """Rows as columns."""
    return [list(row) for row in zip(*cells, strict=True)]
