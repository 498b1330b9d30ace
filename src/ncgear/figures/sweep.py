"""A sweep as CSV, and the best of it as text."""

from __future__ import annotations

import re
from collections import Counter
from collections.abc import Sequence
from itertools import product
from pathlib import Path
from textwrap import fill

import numpy as np

from ncgear.design.varied import Varied
from ncgear.figures.csv_text import rows_text
from ncgear.figures.numbers import shown
from ncgear.figures.tables import aligned
from ncgear.figures.terminal import written_lines
from ncgear.numerics.arrays import IndexArray
from ncgear.screening.block import MADE, Block

BEST = 5
"""Number of designs that the text lists for each figure."""

RANKED = {
    "least acceleration": "check.peak_acceleration_cycle_",
    "least power": "check.peak_power_",
}
"""How the names begin of the figures that the best designs have least of; they end in the unit."""

WIDTH, COUNT_WIDTH = 110, 7


def sweep_csv(varied: Sequence[Varied], found: Block) -> str:
    """One row for each design: its values, its figures where it can be made, and the verdict."""
    names = [*(one.key for one in varied), *found.figures, "verdict"]
    columns = [
        [value if made else "" for value, made in zip(values.tolist(), found.made, strict=True)]
        for values in found.figures.values()
    ]
    rows = zip(_values(varied), *columns, found.verdicts, strict=True)
    return rows_text(names, [[*values, *rest] for values, *rest in rows])


def sweep_text(varied: Sequence[Varied], found: Block, paths: Sequence[Path], kept: Sequence[Path] = ()) -> str:
    """How many can be made, the best of them, why the others cannot, the files written, and those kept."""
    made = int(found.made.sum())
    blocks = [f"{len(found.made)} designs, of which {made} can be made"]
    if made:
        blocks += [_best(title, figure, varied, found) for title, figure in ranked(found).items()]
    if made < len(found.made):
        blocks.append("\n".join(["Refused", *_refused(varied, found)]))
    return "\n\n".join([*blocks, "\n".join(written_lines(paths, kept))])


def ranked(found: Block) -> dict[str, str]:
    """The figures that the best designs have least of, in the units of what moves."""
    return {title: name for title, start in RANKED.items() for name in found.figures if name.startswith(start)}


def _values(varied: Sequence[Varied]) -> list[tuple[float, ...]]:
    return list(product(*(one.values for one in varied)))


def _order(figure: str, found: Block) -> IndexArray:
    """The best rows by a figure.

    Rows whose figure shows the same digits, such as laws with one working stroke, are ordered by the other figures.
    """
    made = found.made.nonzero()[0]
    others = [found.figures[name][made] for name in ranked(found).values() if name != figure]
    read = np.array([float(shown(float(value))) for value in found.figures[figure][made]])
    return made[np.lexsort((*others, read))[:BEST]]


def _best(title: str, figure: str, varied: Sequence[Varied], found: Block) -> str:
    """A table of the designs with the least of a figure."""
    heads = [*(one.key for one in varied), *ranked(found).values()]
    return "\n".join([f"Best by {title}", *aligned([heads, *best_cells(figure, varied, found)])])


def best_cells(figure: str, varied: Sequence[Varied], found: Block) -> list[list[str]]:
    """The designs with the least of a figure: the texts of what is varied, and of the figures."""
    values = _values(varied)
    return [
        [
            *map(shown, values[number]),
            *(shown(float(found.figures[name][number])) for name in ranked(found).values()),
        ]
        for number in _order(figure, found).tolist()
    ]


def _refused(varied: Sequence[Varied], found: Block) -> list[str]:
    """The most frequent problems, each with the first design that has it and all that is said of that one."""
    lines = []
    for count, where, verdict in refusals(varied, found):
        said = f"{'first ' if count > 1 else ''}at {where}: {verdict}"
        space = " " * (COUNT_WIDTH + 2)
        text = fill(said, WIDTH, initial_indent=space, subsequent_indent=space, break_on_hyphens=False)
        lines.append(f"{count:>{COUNT_WIDTH}}{text[COUNT_WIDTH:]}")
    return lines


def refusals(varied: Sequence[Varied], found: Block) -> list[tuple[int, str, str]]:
    """How many designs have a problem, where the first of them is, and all that is said of that one."""
    values = _values(varied)
    refused = [number for number, verdict in enumerate(found.verdicts) if verdict != MADE]
    counts = Counter(_problem(found.verdicts[number]) for number in refused)
    first = {_problem(found.verdicts[number]): number for number in reversed(refused)}
    told = []
    for problem, count in counts.most_common(BEST):
        number = first[problem]
        where = ", ".join(f"{one.key} = {shown(value)}" for one, value in zip(varied, values[number], strict=True))
        told.append((count, where, found.verdicts[number]))
    return told


def _problem(verdict: str) -> str:
    """A verdict up to its first number, which many designs share."""
    return re.split(r"-?\d", verdict, maxsplit=1)[0]
