"""What a screening gives: figures of the designs that can be made, and of the others which condition they fail.

Thousands of designs: those alike computed together, the others, and all that are doubtful, one by one.

A law is refused only by the way of a single design: what a batch is not sure of goes that way and gets its verdict.
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

CHECK_FIGURES = (
    "drive.law_speed_rpm",
    "closure.residual_rad",
    "closure.stroke_residual_mm",
    "ratio.min",
    "ratio.max",
    "check.peak_power_w",
    "check.mean_power_w",
    "check.peak_speed_mm_s",
    "check.peak_acceleration_working_mm_s2",
    "check.peak_acceleration_cycle_mm_s2",
)
"""Keys of ``summary.json`` that every design has."""

PITCH_FIGURES = (
    "pitch.center_distance_mm",
    "pitch.length_driving_mm",
    "pitch.length_driven_mm",
    "pitch.driving_convex",
    "pitch.driven_convex",
    "pitch.min_radius_driving_mm",
    "pitch.min_radius_driven_mm",
    "pitch.max_tangent_angle_deg",
    "pitch.max_pressure_angle_deg",
)
"""Those of designs that say how their gears are; convex is 1 or 0."""

MADE = "made"


@dataclass(frozen=True, eq=False)
class Screened:
    """Of n designs, the m that can be made.

    ``figures`` has an array of shape (m,) for each key, in the order of the designs; ``verdicts`` a word for each of
    the n: ``made``, or the key at fault and what is wrong.  ``one_by_one`` (shape (n,)) marks those that were computed
    by themselves, because the batch could not be sure of them or has no form for their law.
    """

    figures: dict[str, Array]
    made: Mask
    verdicts: tuple[str, ...]
    one_by_one: Mask

    @property
    def rows(self) -> IndexArray:
        """Numbers of the designs that the figures belong to, shape (m,)."""
        numbers: IndexArray = self.made.nonzero()[0]
        return numbers


COUNTS = (65, 129, 257)
"""Points of a piece, and those tried where the first do not resolve a law."""

TOGETHER = 256
"""Designs computed at once, whose arrays a core's cache holds (benchmarks/screening.md)."""


def screened(
    designs: Sequence[Design | DesignError],
    counts: Sequence[int] = COUNTS,
    on_done: Callable[[int, int], None] = lambda done, total: None,
) -> Screened:
    """Figures and verdicts of n designs, which must all have gears, or none; errors stand for designs refused before.

    ``counts`` are the points of a piece that are tried one after the other; ``on_done`` hears how many of how many
    designs are done.
    """
    numbered = dict(enumerate(designs))
    rows: dict[int, Row] = {number: design for number, design in numbered.items() if isinstance(design, DesignError)}
    wanted = {number: design for number, design in numbered.items() if isinstance(design, Design)}
    for kind, group in _groups(wanted).items():
        for first in range(0, len(group), TOGETHER):
            rows.update(_together(kind, dict(group[first : first + TOGETHER]), counts))
            on_done(len(rows), len(numbered))
    alone = [number for number in wanted if number not in rows]
    for number in alone:
        rows[number] = _alone(wanted[number])
        on_done(len(rows), len(numbered))
    return _table([rows[number] for number in numbered], alone)


def _groups(designs: dict[int, Design]) -> dict[Kind, list[tuple[int, Design]]]:
    """The designs that can be computed together, with their numbers."""
    groups: dict[Kind, list[tuple[int, Design]]] = {}
    for number, design in designs.items():
        kind = kind_of(design)
        if kind is not None:
            groups.setdefault(kind, []).append((number, design))
    return groups


def _together(kind: Kind, designs: dict[int, Design], counts: Sequence[int]) -> dict[int, Row]:
    """What the first count of points is sure of, and of the rest what the next ones are, by the designs' numbers."""
    if not designs or not counts:
        return {}
    try:
        found = rows_of(kind, list(designs.values()), counts[0])
    except DesignError:
        # A resistance that is no smooth function: each design is refused by itself.
        return {}
    rows = {number: row for number, row in zip(designs, found, strict=True) if row is not None}
    left = {number: design for number, design in designs.items() if number not in rows}
    return {**rows, **_together(kind, left, counts[1:])}


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
