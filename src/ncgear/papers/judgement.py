"""Verdicts held against the numbers: what is claimed must be borne out by what is computed."""

from __future__ import annotations

from dataclasses import dataclass

from ncgear.papers.entry import Computed, Entry, Paper, Verdict


class Contradicted(ArithmeticError):
    """A verdict was claimed that the computation contradicts."""


@dataclass(frozen=True)
class Judged:
    """An entry whose verdict stands, with what was computed for it."""

    entry: Entry
    computed: Computed | None


def judged(entry: Entry) -> Judged:
    """The entry with its numbers; raises Contradicted where they do not bear its verdict out.

    A figure said to be reproduced must agree, and any other must not: what agrees is not beyond reproduction.
    """
    computed = entry.compute() if entry.compute else None
    agrees = computed is not None and entry.published.agrees(computed)
    if agrees != (entry.verdict in (Verdict.REPRODUCED, Verdict.UNDER_READING)):
        found = entry.published.computed_text(computed) if computed else "nothing computed"
        raise Contradicted(
            f"{entry.places[0]}, {entry.what}: printed {entry.published.text}, {found}; claimed {entry.verdict}"
        )
    return Judged(entry, computed)


@dataclass(frozen=True)
class Judgement:
    """A paper with all its entries judged, in its order."""

    paper: Paper
    entries: tuple[Judged, ...]

    def count(self, verdict: Verdict) -> int:
        """Entries with a verdict."""
        return sum(one.entry.verdict is verdict for one in self.entries)


def judgement(paper: Paper) -> Judgement:
    """All entries of a paper; raises Contradicted as ``judged`` does."""
    return Judgement(paper, tuple(map(judged, paper.entries)))
