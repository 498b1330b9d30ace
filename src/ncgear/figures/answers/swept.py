"""The answer of a sweep: the best designs by each figure, and why others cannot be made."""

from __future__ import annotations

from collections.abc import Sequence

from ncgear.design.varied import Varied
from ncgear.figures.answers.answer import Answer, Fault, Row
from ncgear.figures.quantities import name_of
from ncgear.figures.sweep import best_cells, ranked, refusals
from ncgear.numerics.units import label_and_unit
from ncgear.screening.block import Block

BEST = 3
"""Designs that are told for each figure."""


def swept_answer(varied: Sequence[Varied], found: Block) -> Answer:
    """How many can be made, the best of them, and why the others cannot."""
    made, figures = int(found.made.sum()), ranked(found) if found.made.any() else {}
    keys = [name.rpartition(".")[2] for name in figures.values()]
    heads = [one.key.rpartition(".")[2] for one in varied] + [
        f"{name_of(key)}, {label_and_unit(key)[1]}" for key in keys
    ]
    rows = [
        Row(title if place == 0 else "", tuple(cells))
        for title, figure in figures.items()
        for place, cells in enumerate(best_cells(figure, varied, found)[:BEST])
    ]
    refused = [
        Fault(f"{count} {'design' if count == 1 else 'designs'}: {said}") for count, _, said in refusals(varied, found)
    ]
    return Answer(
        f"{len(found.made)} designs, of which {made} can be made",
        tuple(rows),
        tuple(refused),
        heads=tuple(heads),
        good="",
        wrong=f"{len(found.made) - made} are refused",
        then="sweep.csv has every design",
    )
