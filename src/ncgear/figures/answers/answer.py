"""The answer of a command as a value, and its text of one screen.

What a person wants to know, in this order: what it is, what it achieves, what is wrong and what would help, where the
files are, what to do next.  Every figure beyond that is printed with ``--verbose``.
"""

from __future__ import annotations

import os
from collections.abc import Iterable, Sequence
from dataclasses import replace
from itertools import accumulate, chain
from pathlib import Path
from textwrap import shorten, wrap
from typing import TYPE_CHECKING

from ncgear.figures.numbers import figure, fixed, name_of, to_digits
from ncgear.figures.tables import GAP, aligned
from ncgear.frozen import dataclass

if TYPE_CHECKING:
    from ncgear.figures.advice.verdict import Verdict

LINES, COLUMNS = 24, 100
"""One screen: a terminal opens with 24 lines, and a hundred characters are what a line can have and still be read at a
glance."""

MANY = 10_000
"""More lines than any answer has."""

FAULTS = 6
"""Lines about what is wrong, and what would help, that have room before the last figures have."""

INDENT = "  "
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


ROUNDING = 1e-9
"""Share of a figure: where another machine has less than this share, it has rounding errors and no more."""


def difference(own: float, other: float) -> str:
    """How a figure differs from the same figure of another machine, in words; empty where the other has none."""
    if abs(other) <= ROUNDING * abs(own):
        return ""
    share = own / other
    if share > 2.0:
        return f"{to_digits(share, 3)} times"
    percent = fixed(100.0 * abs(share - 1.0), 1)
    return "the same" if percent == "0.0" else f"{percent} % {'lower' if share < 1.0 else 'higher'}"


def faults_of(verdict: Verdict) -> tuple[Fault, ...]:
    """What breaks conditions, the most serious first, each behind the name of its stage."""
    return told_once(
        Fault(f"{row.of}{advice.what}", tuple(remedy.brief for remedy in advice.remedies))
        for row in verdict.rows
        for advice in row.advices
        if advice.matters
    )


def told_once(faults: Iterable[Fault]) -> tuple[Fault, ...]:
    """The faults, each remedy with the first that it helps."""
    told, found = set[str](), list[Fault]()
    for fault in faults:
        found.append(replace(fault, cures=tuple(cure for cure in fault.cures if cure not in told)))
        told |= set(fault.cures)
    return tuple(found)


def answer_text(answer: Answer, paths: Sequence[Path] = (), kept: Sequence[Path] = ()) -> str:
    """The answer on one screen, with the files written and the kept files of others."""
    then = f"Next: {answer.then}" if answer.then else "More: "
    told = f"{then}; {MORE}" if answer.then else f"{then}{MORE}"
    start = "Kept under a new name, since ncgear had not written them so: "
    of_others = [_listed(start, [path.name for path in kept])] if kept else []
    ends = *_written(paths), *of_others, told if len(told) <= COLUMNS else then
    last = [line for end in ends for line in _wrapped(end)]
    return "\n\n".join(
        "\n".join(block)
        for block in [*_blocks(answer, LINES - len(last), list(map(_fault, answer.faults))), last]
        if block
    )


def whole_answer(answer: Answer) -> list[list[str]]:
    """Blocks of lines of the answer with all that would help: nothing is left out, however many lines that takes."""
    told = [
        (_wrapped(fault.what, INDENT), [line for cure in fault.cures for line in _wrapped(f"-> {cure}", 2 * INDENT)])
        for fault in answer.faults
    ]
    return _blocks(answer, MANY, told)


def _blocks(answer: Answer, lines: int, told: Sequence[Told]) -> list[list[str]]:
    """Three blocks in so many lines: what it is, what it achieves, and what is wrong, which is ``told``."""
    top = [line for note in answer.notes for line in _wrapped(note)]
    top += [*([""] if top else []), *_wrapped(answer.head), *_wrapped(answer.about)]
    unknown = _wrapped(answer.not_judged)
    # What helps against the most serious is told before the last figures, against others as far as FAULTS goes
    faults, helps = (sum(map(len, lines)) for lines in zip(*told, strict=True)) if told else (0, 0)
    needed = max(min(faults, FAULTS) + sum(len(below) for _, below in told[:1]), min(faults + helps, FAULTS))
    left = lines - len(top) - bool(answer.heads) - len(unknown) - 3
    # The first rows are the most telling
    tried = (_aligned(replace(answer, rows=answer.rows[:count])) for count in range(len(answer.rows), 0, -1))
    room = left - needed - 1 + bool(answer.heads)
    figures = next((lines for lines in tried if len(lines) <= room), [])
    wrong = _wrong(answer, told, left - max(len(figures) - bool(answer.heads), 0) - 1)
    return [top, figures, [*wrong, *unknown]]


def _wrapped(text: str, indent: str = "") -> list[str]:
    """A text in lines that are not too long, however many it takes: what is told is told to its end."""
    return wrap(text, COLUMNS, initial_indent=indent, subsequent_indent=indent + INDENT, break_on_hyphens=False)


def _aligned(answer: Answer) -> list[str]:
    """The rows with columns below their heads, what comes after the columns to the left; then those with one text."""
    count = len(answer.heads)
    columns = [row for row in answer.rows if len(row.texts) > 1]
    alone = [row for row in answer.rows if len(row.texts) == 1]
    cells = [("", *answer.heads), *((row.name, *row.texts[:count]) for row in columns)] if columns else []
    after = ["", *("".join(f"{GAP}{text}" for text in row.texts[count:]) for row in columns)]
    lines = [f"{line}{more}".rstrip() for line, more in zip(aligned(cells, left=1), after, strict=False)]
    start = max((len(row.name) for row in alone), default=0)
    for row in alone:
        name = f"{INDENT}{row.name:{start}}{GAP}" if row.name else INDENT
        lines += wrap(
            row.texts[0], COLUMNS, initial_indent=name, subsequent_indent=" " * max(len(name), 2 * len(INDENT))
        )
    return lines


Told = tuple[list[str], list[str]]
"""Lines of what is wrong, with what would help where a line has room for both; and the lines below them."""


def _wrong(answer: Answer, told: Sequence[Told], room: int) -> list[str]:
    """What is wrong, in ``room`` lines below a heading as far as that goes, or that nothing is.

    Where there is no room for all, what would help is left out of the least serious, and then these.
    """
    faults = answer.faults
    if not faults:
        return [answer.good] if answer.good else []
    count = "1 warning" if len(faults) == 1 else f"{len(faults)} warnings, the most serious first"
    count = answer.wrong or count
    helped = " (-> what would help)" if any(fault.cures for fault in faults) else ""
    # The most serious is told in full, whatever room it takes
    spare = max(room - sum(len(what) for what, _ in told), len(told[0][1]))
    cures = list(accumulate(len(below) for _, below in told))
    lines = [[*what, *(below if end <= spare else [])] for (what, below), end in zip(told, cures, strict=True)]
    ends = list(accumulate(map(len, lines)))
    shown = len(told) if ends[-1] <= room else max(1, sum(end < room for end in ends))
    left = [f"{INDENT}and {len(faults) - shown} more: {VERBOSE}"] if shown < len(faults) else []
    return [f"{count}{helped}", *chain.from_iterable(lines[:shown]), *left]


def _fault(fault: Fault) -> Told:
    """What is wrong, and the first that would help in one line with it, else the first, below it."""
    lines = (f"{INDENT}{fault.what} -> {cure}" for cure in fault.cures)
    below = [line for cure in fault.cures[:1] for line in _wrapped(f"-> {cure}", 2 * INDENT)]
    return next((([line], []) for line in lines if len(line) <= COLUMNS), (_wrapped(fault.what, INDENT), below))


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
    if len(paths) < 2:
        return [f"Written: {path}" for path in paths]
    folder = Path(os.path.commonpath([path.parent for path in paths]))
    names = [path.relative_to(folder).as_posix() for path in paths]
    plain = [name for name in names if name.endswith(".yaml") and "/" not in name]
    first = [*plain, *(name for name in OPENED if name in names)]
    where = "Written: " if folder == Path() else f"Written to {folder}: "
    return [_listed(where, [*first, *(name for name in names if name not in first)])]


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
