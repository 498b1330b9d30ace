"""The answer of a sweep: the best designs by each objective, and why others cannot be made."""

from __future__ import annotations

from ncgear.figures.answers.answer import Answer, Fault, Row
from ncgear.figures.sweep import REFUSALS, cells_of, counts_of, head_of, title_of
from ncgear.screening.overview import Overview
from ncgear.screening.rows import WITH_MASSES

BEST = 3
"""Designs that are told for each objective."""


def swept_answer(screened: Overview, deeper: Overview | None, stage: str, then: str) -> Answer:
    """How many can be made, the best of them, and why the others cannot."""
    last = deeper or screened
    head, *more = counts_of(screened, deeper, stage)
    heads = [key.rpartition(".")[2] for key in last.space.keys] + [head_of(one.name) for one in last.wanted.objectives]
    rows = [
        Row(title_of(objective) if place == 0 else "", tuple(cells))
        for objective, best in zip(last.wanted.objectives, last.best, strict=False)
        for place, cells in enumerate(cells_of(best, last.wanted)[:BEST])
    ]
    if without_masses(last):
        rows.append(Row("masses", ("not counted in power: give them as masses",)))
    refused = [
        Fault(f"{one.count} {'design' if one.count == 1 else 'designs'}: {one.verdict}")
        for one in last.frequent_refusals[:REFUSALS]
    ]
    return Answer(
        head,
        tuple(rows),
        tuple(refused),
        about="; ".join(more),
        heads=tuple(heads),
        good="",
        wrong=f"{last.count - last.made} are refused",
        then=then,
    )


def without_masses(overview: Overview) -> bool:
    """Whether designs are ranked by a power that counts no masses."""
    by_power = any(one.name.endswith("power_w") for one in overview.wanted.objectives)
    return by_power and all(set(WITH_MASSES).isdisjoint(one.figures) for one in overview.best)
