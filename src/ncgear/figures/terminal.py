"""Text for the terminal: every figure in aligned lines, comparisons, warnings, timings, the files written."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from itertools import groupby
from pathlib import Path
from textwrap import wrap
from typing import Any

from ncgear.figures.answers.answer import Answer, in_one_line, whole_answer
from ncgear.figures.numbers import STATISTICS, figure, fixed, labelled, name_of, told
from ncgear.figures.summary.check_summary import comparison_tables
from ncgear.figures.tables import WIDTH, aligned
from ncgear.project.drive import Drive

INDENT = "  "

NAME_WIDTH = 36
"""Characters of a name in a comparison; a longer name is told in full below the table."""

TITLES = {
    "stages": "Stages in series",
    "closure": "Closure of the cycle",
    "ratio": "Transmission ratio i12 = dphi1/dphi2",
    "pitch": "Pitch curves",
    "check": "Motion and power at the operating speed",
    "motion": "What the motion achieves",
    "masses": "Moving masses",
    "strength": "Strength of the teeth",
    "displacement": "Displacement as a flow meter or pump",
}
"""Headings of sections; the heading of any other section is its name."""

JUDGED = ("warnings", "remarks", "verdict")
"""Keys of what is judged."""

ELSEWHERE = ("comparison", *JUDGED, "timing_s")
"""Keys of figures that are not written as sections."""


def verdict_lines(rows: Sequence[Mapping[str, Any]]) -> list[str]:
    """Every condition of a verdict, and what was found of it."""
    lines = ["Verdict"] if rows else []
    for row in rows:
        of = "" if row["stage"] is None else f"stage {row['stage']}: "
        because = f": {row['because']}" if row["because"] else ""
        remark = f"; remark: {row['remark']}" if row["remark"] else ""
        lines.append(f"  {row['verdict']:10}  {of}{row['says']}{because}{remark}")
    return lines


def value_lines(label: str, value: str, width: int) -> list[str]:
    """The line ``label  value``; further lines of a long value begin below the value."""
    start = f"{INDENT}{label:<{width}}  "
    lines = wrap(value, max(WIDTH - len(start), 20)) or [""]
    return [start + lines[0], *(" " * len(start) + line for line in lines[1:])]


def _marked(start: str, sentences: Sequence[str]) -> list[str]:
    return [
        line
        for sentence in sentences
        for line in wrap(sentence, WIDTH, initial_indent=start, subsequent_indent=" " * len(start))
    ]


def comparison_lines(rows: Sequence[Mapping[str, Any]]) -> list[list[str]]:
    """One block of lines for the mechanisms at equal speed, and one for mechanisms at other speeds."""
    blocks = []
    for table in comparison_tables(rows):
        rows_in_short = ((in_one_line(name, NAME_WIDTH), *others) for name, *others in map(table.texts, table.rows))
        lines = aligned([*zip(*table.columns, strict=True), *rows_in_short], left=1)
        told = [(str(name), note) for (name, *_), note in zip(table.rows, table.row_notes, strict=True)]
        said = [": ".join(filter(None, told_row)) for told_row in told if told_row[1] or len(told_row[0]) > NAME_WIDTH]
        blocks.append([table.title, *lines, *_marked(INDENT, said)])
    return blocks


def timing_text(drive: Drive) -> str:
    """The seconds that each step took, and their sum."""
    taken = {}
    for pair in (drive, *(pair for pair in drive.by_stage if pair is not drive)):
        taken.update({f"{pair.of}{step}": seconds for step, seconds in pair.timing_s.items()})
    rows = [(step, fixed(seconds, 3)) for step, seconds in {**taken, "sum": sum(taken.values())}.items()]
    return "\n".join(["Time in s", *aligned(rows, left=1, least=[0, 8])])


def written_lines(paths: Sequence[Path], kept: Sequence[Path] = ()) -> list[str]:
    """The files that a command has written, and those in their places that it has kept."""
    return ["Written", *(f"{INDENT}{path}" for path in paths), *kept_lines(kept)]


def kept_lines(kept: Sequence[Path]) -> list[str]:
    """The new names of files that were not as ncgear had written them."""
    head = ["Kept under a new name, because they were not as ncgear had written them"] if kept else []
    return [*head, *(f"{INDENT}{path}" for path in kept)]


Figures = Mapping[str, Any]

ROOM = 140
"""Characters of a line of a table."""


def full_text(answer: Answer, figures: Sequence[Figures], paths: Sequence[Path], kept: Sequence[Path] = ()) -> str:
    """The whole answer, then every figure, once for each pair of gears that is told by itself, then the files."""
    written = _text([written_lines(paths, kept) if paths else []])
    return "\n\n".join(filter(None, [_text(whole_answer(answer)), *map(figures_text, figures), written]))


def figures_text(figures: Figures) -> str:
    """The plain figures, a block for each group or for groups that stand side by side, the comparison, the verdict."""
    found = {key: value for key, value in figures.items() if key not in ELSEWHERE and value != []}
    groups = [[f"{head[:1].upper()}{head[1:]}", *lines] for head, *lines in _groups(found)]
    compared = comparison_lines(figures.get("comparison") or [])
    warnings, remarks, verdict = (figures.get(key) or [] for key in JUDGED)
    judged = _marked("warning: ", warnings), _marked("remark: ", remarks), verdict_lines(verdict)
    return _text([_plain_lines("", found), *groups, *compared, *judged])


def _text(blocks: Sequence[Sequence[str]]) -> str:
    return "\n\n".join("\n".join(block) for block in blocks if block)


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
        found += [table] if table else [[TITLES.get(key, name_of(key)), *_content(key, value)] for key, value in some]
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
    return any(isinstance(value, list) or _holds_table(value) for value in group.values() if _is_group(value))


def _with_room(cells: Sequence[Sequence[str]], left: int = 0) -> list[str]:
    """The lines of a table, with its columns as rows where only that has room; none where that has no room either."""
    tables = aligned(cells, left), aligned(_turned(cells), 1)
    return next((lines for lines in tables if max(map(len, lines)) <= ROOM), [])


def _turned(cells: Sequence[Sequence[str]]) -> list[list[str]]:
    return [list(row) for row in zip(*cells, strict=True)]
