"""The papers of the ledger, and the check of their verdicts against the computed numbers."""

from __future__ import annotations

from ncgear.frozen import dataclass
from ncgear.papers import gear_baler, pitch_lines, shaped_gears, sieve_and_pan, threshing_drum, track_chassis
from ncgear.papers.entry import AGREEING, Computed, Entry, Finding, Paper

PAPERS: tuple[Paper, ...] = (
    gear_baler.PAPER,
    track_chassis.PAPER,
    threshing_drum.PAPER,
    sieve_and_pan.PAPER,
    pitch_lines.PAPER,
    shaped_gears.PAPER,
)


class Contradicted(ArithmeticError):
    """The computation contradicts a verdict that was claimed."""


@dataclass(frozen=True)
class JudgedEntry:
    """An entry whose verdict stands, with its computed numbers."""

    entry: Entry
    computed: Computed | None


@dataclass(frozen=True)
class Judgement:
    """A paper with all its entries judged, in its order."""

    paper: Paper
    entries: tuple[JudgedEntry, ...]

    def count(self, verdict: Finding) -> int:
        """Number of entries with a verdict."""
        return sum(entry.entry.verdict is verdict for entry in self.entries)


def judgement(paper: Paper) -> Judgement:
    """All entries of a paper; raises Contradicted as ``judged`` does."""
    return Judgement(paper, tuple(map(judged, paper.entries)))


def judged(entry: Entry) -> JudgedEntry:
    """The entry with its numbers; raises Contradicted where the numbers do not support its verdict.

    A figure claimed to be reproduced must agree.  Any other figure must not agree: otherwise it is reproduced after
    all.
    """
    computed = entry.computed()
    agrees = computed is not None and entry.published.agrees(computed)
    if agrees != (entry.verdict in AGREEING):
        found = entry.published.computed_text(computed) if computed else "nothing computed"
        raise Contradicted(
            f"{entry.places[0]}, {entry.what}: printed {entry.published.text}, {found}; claimed {entry.verdict}"
        )
    return JudgedEntry(entry, computed)
