"""Thousands of designs: those alike computed together, the others, and all that are doubtful, one by one.

A law is refused only by the way of a single design: what a batch is not sure of goes that way and gets its verdict.
"""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np

from ncgear.design.schema import Design
from ncgear.errors import DesignError
from ncgear.screening.batches import Kind, kind_of
from ncgear.screening.rows import Row, rows_of
from ncgear.screening.single import single_figures
from ncgear.screening.table import MADE, Screened

COUNTS = (65, 129)
"""Points of a piece, and those tried where the first do not resolve a law."""

TOGETHER = 128
"""Designs computed at once, whose arrays a core's cache holds (benchmarks/screening.md)."""


def screened(designs: Sequence[Design], counts: Sequence[int] = COUNTS) -> Screened:
    """Figures and verdicts of n designs, which must all have gears, or none.

    ``counts`` are the points of a piece that are tried one after the other.
    """
    rows: dict[int, Row] = {}
    for kind, numbers in _groups(designs).items():
        for first in range(0, len(numbers), TOGETHER):
            rows.update(_together(kind, designs, numbers[first : first + TOGETHER], counts))
    alone = [number for number in range(len(designs)) if number not in rows]
    rows.update({number: _alone(designs[number]) for number in alone})
    return _table([rows[number] for number in range(len(designs))], alone)


def _groups(designs: Sequence[Design]) -> dict[Kind, list[int]]:
    """Numbers of the designs that can be computed together."""
    groups: dict[Kind, list[int]] = {}
    for number, design in enumerate(designs):
        kind = kind_of(design)
        if kind is not None:
            groups.setdefault(kind, []).append(number)
    return groups


def _together(kind: Kind, designs: Sequence[Design], numbers: list[int], counts: Sequence[int]) -> dict[int, Row]:
    """What the first count of points is sure of, and of the rest what the next ones are."""
    if not numbers or not counts:
        return {}
    found = rows_of(kind, [designs[number] for number in numbers], counts[0])
    rows = {number: row for number, row in zip(numbers, found, strict=True) if row is not None}
    left = [number for number in numbers if number not in rows]
    return {**rows, **_together(kind, designs, left, counts[1:])}


def _alone(design: Design) -> Row:
    try:
        return single_figures(design)
    except DesignError as error:
        return error


def _table(rows: list[Row], alone: list[int]) -> Screened:
    figures = [row for row in rows if isinstance(row, dict)]
    names = figures[0] if figures else {}
    return Screened(
        figures={name: np.array([row[name] for row in figures]) for name in names},
        made=np.array([isinstance(row, dict) for row in rows], dtype=bool),
        verdicts=tuple(MADE if isinstance(row, dict) else str(row) for row in rows),
        one_by_one=np.isin(np.arange(len(rows)), alone),
    )
