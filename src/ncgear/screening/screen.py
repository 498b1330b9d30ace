"""Thousands of designs screened: figures of those that can be made, and of the others which condition they fail.

Designs of one kind are computed together.  The others, and all that a batch is not sure of, are computed one by one.
A law is refused, and its verdict given, only where its design is computed by itself.
"""

from __future__ import annotations

from collections.abc import Callable, Sequence
from dataclasses import dataclass

import numpy as np

from ncgear.design.keys.design import Design
from ncgear.errors import DesignError
from ncgear.numerics.arrays import Array, IndexArray, Mask
from ncgear.screening.rows import Row, rows_of, single_figures
from ncgear.screening.samples import Kind, kind_of

MADE = "made"


@dataclass(frozen=True, eq=False)
class Screened:
    """What was found about n designs, of which m can be made.

    ``figures`` has an array of shape (m,) for each key, in the order of the designs; ``verdicts`` a word for each of
    the n: ``made``, or the key at fault and what is wrong.
    """

    figures: dict[str, Array]
    made: Mask
    verdicts: tuple[str, ...]

    @property
    def numbers(self) -> IndexArray:
        """Numbers of the designs that the figures belong to, shape (m,)."""
        numbers: IndexArray = self.made.nonzero()[0]
        return numbers


COUNTS = (65, 129, 257)
"""Numbers of points of a piece; the next one is tried where the one before does not resolve a law."""

TOGETHER = 256
"""Designs computed at once, whose arrays a core's cache holds (benchmarks/screening.md)."""


def screened(
    designs: Sequence[Design | DesignError],
    counts: Sequence[int] = COUNTS,
    on_done: Callable[[int, int], None] = lambda done, total: None,
    as_written: Callable[[str], str] = str,
) -> Screened:
    """Figures and verdicts of n designs, which must all have gears, or none; errors stand for designs refused before.

    ``counts`` are the points of a piece that are tried one after the other; ``on_done`` hears how many of how many
    designs are done, and ``as_written`` spells the key of an error as the design file does.
    """
    found: dict[int, Row] = {n: design for n, design in enumerate(designs) if isinstance(design, DesignError)}

    def add(more: dict[int, Row]) -> None:
        found.update(more)
        on_done(len(found), len(designs))

    computed_together(designs, counts, add)
    for number, design in enumerate(designs):
        if number not in found and isinstance(design, Design):
            try:
                add({number: single_figures(design)})
            except DesignError as error:
                add({number: error})
    return _table([found[number] for number in range(len(designs))], as_written)


def computed_together(
    designs: Sequence[Design | DesignError], counts: Sequence[int], add: Callable[[dict[int, Row]], None]
) -> None:
    """Hand rows of designs, by number, to ``add``, batch by batch; designs that no batch is sure of are left out."""
    groups: dict[Kind, list[tuple[int, Design]]] = {}
    for number, design in enumerate(designs):
        if isinstance(design, Design) and (kind := kind_of(design)) is not None:
            groups.setdefault(kind, []).append((number, design))
    for kind, group in groups.items():
        for first in range(0, len(group), TOGETHER):
            add(_batch(kind, dict(group[first : first + TOGETHER]), counts))


def _batch(kind: Kind, designs: dict[int, Design], counts: Sequence[int]) -> dict[int, Row]:
    """Rows by the designs' numbers: those that the first count of points is sure of, the rest by the next counts."""
    if not designs or not counts:
        return {}
    try:
        found = rows_of(kind, list(designs.values()), counts[0])
    except DesignError:
        # A resistance that is no smooth function: each design is refused by itself.
        return {}
    rows = {number: row for number, row in zip(designs, found, strict=True) if row is not None}
    left = {number: design for number, design in designs.items() if number not in rows}
    return {**rows, **_batch(kind, left, counts[1:])}


def _table(rows: list[Row], as_written: Callable[[str], str]) -> Screened:
    for row in rows:
        if isinstance(row, DesignError):
            row.key = as_written(row.key)
    figures = [row for row in rows if isinstance(row, dict)]
    names = figures[0] if figures else {}
    return Screened(
        figures={name: np.array([row[name] for row in figures]) for name in names},
        made=np.array([isinstance(row, dict) for row in rows], dtype=bool),
        verdicts=tuple(MADE if isinstance(row, dict) else str(row) for row in rows),
    )
