"""The answer of a command as a value, and its text of one screen.

What a person wants to know, in this order: what it is, what it achieves, what is wrong and what would help, where the
files are, what to do next.  Every figure beyond that is printed with ``--verbose``.
"""

from __future__ import annotations

import os
from collections.abc import Sequence
from dataclasses import replace
from pathlib import Path
from textwrap import shorten, wrap
from typing import TYPE_CHECKING

from ncgear.figures.numbers import fixed, to_digits
from ncgear.figures.quantities import figure, name_of
from ncgear.frozen import dataclass

if TYPE_CHECKING:
    from ncgear.figures.advice.verdict import Verdict

LINES, COLUMNS = 24, 100
"""One screen: a terminal opens with 24 lines, and a hundred characters are what a line can have and still be read at a
glance."""

FAULTS = 6
"""Lines about what is wrong that have room before the last figures have."""

INDENT, GAP = "  ", "  "
CUT = " ..."

VERBOSE = "--verbose"
MORE = "--verbose prints every figure"


@dataclass(frozen=True)
class Row:
    """A figure: its name and a text for each column of the answer and, after them, perhaps more; or one text.

    A text without a name begins where names do.
    """

    name: str
    texts: tuple[str, ...]


@dataclass(frozen=True)
class Fault:
    """What is wrong, in a part of a line, and what would help, the least costly first."""

    what: str
    cures: tuple[str, ...] = ()


@dataclass(frozen=True)
class Answer:
    """What a command has found.

    ``head`` says what it is, ``about`` more of it, ``notes`` what has to be known before all that.  ``rows`` are the
    figures, the most telling first, those under ``heads`` before those with one text.  ``faults`` are what is wrong,
    the most serious first, below ``wrong`` or their number; where nothing is, ``good`` says so.  ``not_judged`` names
    what nothing is known of.  ``then`` is what to do next.
    """

    head: str
    rows: tuple[Row, ...]
    faults: tuple[Fault, ...] = ()
    about: str = ""
    notes: tuple[str, ...] = ()
    heads: tuple[str, ...] = ()
    good: str = ""
    wrong: str = ""
    not_judged: str = ""
    then: str = ""


def row(key: str, *values: object) -> Row:
    """The row of a figure, with a value for each column."""
    return Row(name_of(key), tuple(figure(key, value) for value in values))


def difference(own: float, other: float) -> str:
    """Words for how a figure differs from that of another machine; empty where that has none."""
    if not other:
        return ""
    share = own / other
    if share > 2.0:
        return f"{to_digits(share, 3)} times"
    percent = fixed(100.0 * abs(share - 1.0), 1)
    return "the same" if percent == "0.0" else f"{percent} % {'lower' if share < 1.0 else 'higher'}"


def faults_of(verdict: Verdict) -> tuple[Fault, ...]:
    """What breaks conditions, the most serious first, each behind the name of its stage."""
    return tuple(
        Fault(f"{row.of}{advice.brief}", tuple(remedy.brief for remedy in advice.remedies))
        for row in verdict.rows
        for advice in row.advices
        if advice.matters
    )


def answer_text(answer: Answer, paths: Sequence[Path] = (), kept: Sequence[Path] = ()) -> str:
    """The answer on one screen, with the files written and those of others that were kept."""
    top = [line for note in answer.notes for line in _in_two_lines(note)]
    top += [*([""] if top else []), answer.head, *([answer.about] if answer.about else [])]
    last = [*_written(paths), *_kept(kept), _next(answer.then)]
    rows, faults = answer.rows, answer.faults
    unknown = _in_two_lines(answer.not_judged)
    left = LINES - len(top) - bool(answer.heads) - len(unknown) - len(last) - 3
    wrong = min(len(faults), FAULTS) + 1
    rows = rows[: left - wrong]
    blocks = [
        top,
        _aligned(replace(answer, rows=rows)),
        [*_wrong(answer, left - len(rows) - 1), *unknown],
        last,
    ]
    return "\n\n".join("\n".join(map(_cut, block)) for block in blocks if block)


def _next(then: str) -> str:
    """What to do next and, where there is room, how to see more."""
    line = f"Next: {then}; {MORE}" if then else f"More: {MORE}"
    return line if len(line) <= COLUMNS else f"Next: {then}"


def _in_two_lines(note: str) -> list[str]:
    return wrap(note, COLUMNS, subsequent_indent=INDENT, max_lines=2, placeholder=CUT)


def _cut(line: str) -> str:
    """A line that is not too long; its end is left out, from a space on."""
    if len(line) <= COLUMNS:
        return line
    indent = line[: len(line) - len(line.lstrip())]
    end = line.rfind(" ", len(indent), COLUMNS - len(CUT) + 1)
    return (line[:end] if end > 0 else line[: COLUMNS - len(CUT)]).rstrip(" ,;:") + CUT


def _aligned(answer: Answer) -> list[str]:
    """The rows with columns below their heads, what comes after the columns to the left; then those with one text."""
    count = len(answer.heads)
    columns = [one for one in answer.rows if len(one.texts) > 1]
    alone = [one for one in answer.rows if len(one.texts) == 1]
    start = max((len(one.name) for one in columns), default=0)
    widths = [max(map(len, texts)) for texts in zip(answer.heads, *(one.texts[:count] for one in columns), strict=True)]
    lines = [f"{'':{start}}{_columns(answer.heads, widths)}"] if columns else []
    for one in columns:
        after = "".join(f"{GAP}{text}" for text in one.texts[count:])
        lines.append(f"{one.name:{start}}{_columns(one.texts[:count], widths)}{after}")
    start = max((len(one.name) for one in alone), default=0)
    lines += [f"{one.name:{start}}{GAP}{one.texts[0]}" if one.name else one.texts[0] for one in alone]
    return [f"{INDENT}{line}".rstrip() for line in lines]


def _columns(texts: Sequence[str], widths: Sequence[int]) -> str:
    return "".join(f"{GAP}{text:>{width}}" for text, width in zip(texts, widths, strict=True))


def _wrong(answer: Answer, room: int) -> list[str]:
    """What is wrong, in at most ``room`` lines below a heading, or that nothing is."""
    faults = answer.faults
    if not faults:
        return [answer.good] if answer.good else []
    count = "1 warning" if len(faults) == 1 else f"{len(faults)} warnings, the most serious first"
    count = answer.wrong or count
    helped = " (-> what would help)" if any(fault.cures for fault in faults) else ""
    told = faults if len(faults) <= room else faults[: room - 1]
    left = [f"{INDENT}and {len(faults) - len(told)} more: {VERBOSE}"] if len(told) < len(faults) else []
    return [f"{count}{helped}", *map(_fault, told), *left]


def _fault(fault: Fault) -> str:
    """What is wrong and the first that would help and has room behind it."""
    what = f"{INDENT}{fault.what}"
    lines = (f"{what} -> {cure}" for cure in fault.cures)
    return next((line for line in lines if len(line) <= COLUMNS), what)


OPENED = (
    "report.html",
    "tooth_pair.png",
    "data_sheet.md",
    "pair.step",
    "gears.3mf",
    "pair.dxf",
    "summary.json",
    "sweep.parquet",
)
"""The files that people look for first, after a design file."""


def _written(paths: Sequence[Path]) -> list[str]:
    """Where the files are, and the names of the first."""
    if not paths:
        return []
    if len(paths) == 1:
        return [f"Written: {paths[0]}"]
    folder = Path(os.path.commonpath([path.parent for path in paths]))
    names = [path.relative_to(folder).as_posix() for path in paths]
    plain = [name for name in names if name.endswith(".yaml") and "/" not in name]
    first = [*plain, *(name for name in OPENED if name in names)]
    where = "Written: " if folder == Path() else f"Written to {folder}: "
    return [_listed(where, [*first, *(name for name in names if name not in first)])]


def _kept(kept: Sequence[Path]) -> list[str]:
    if not kept:
        return []
    return [_listed("Kept under a new name, since ncgear had not written them so: ", [path.name for path in kept])]


def _listed(start: str, names: Sequence[str]) -> str:
    """As many names as a line has room for, and the number of the others."""
    for count in range(len(names), 0, -1):
        left = f" and {len(names) - count} more" if count < len(names) else ""
        line = f"{start}{', '.join(names[:count])}{left}"
        if len(line) <= COLUMNS:
            return line
    return f"{start}{len(names)} files"


def in_one_line(text: str, width: int = COLUMNS) -> str:
    """The beginning of a text, without line breaks."""
    return shorten(text, width, placeholder=CUT) if text else ""
