"""The figures at the top of what a design achieves: the peaks beside those of the crank, and the safeties."""

from __future__ import annotations

from collections.abc import Iterable

from ncgear.drawings.page.tables import typeset
from ncgear.figures.answers.machine import compared_rows, machine_facts, safeties
from ncgear.project.drive import Drive


def facts(drive: Drive) -> list[list[str]]:
    """Name and text of each figure, the peaks before all else with those of the crank and how much they differ."""
    compared = {row.name: row.texts for row in compared_rows(drive)}
    rows = {name: (text,) for name, text in machine_facts(drive)} | compared
    ordered = dict.fromkeys([*compared, *rows])
    return [[name, *(text for _, text in typeset((name, one) for one in rows[name]))] for name in ordered]


def safety_facts(pairs: Iterable[Drive]) -> list[tuple[str, str]]:
    """Name and text of the least safety against each kind of damage, for each pair; none where no load is known."""
    return [
        fact
        for pair in pairs
        for damage, safety, wanted in safeties(pair) or ()
        for fact in typeset([(f"safety against {damage}, {wanted} wanted", safety)], pair.stage)
    ]
