"""One entry of the ledger: what a paper prints, how it is computed here, and the verdict claimed for it."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass
from enum import StrEnum

from ncgear.ledger.printed import Computed, Printed, Relation


class Verdict(StrEnum):
    """How a printed figure fares."""

    REPRODUCED = "reproduced"
    UNDER_READING = "reproduced under a stated reading"
    NOT_REPRODUCIBLE = "not reproducible"
    NEEDS_DATA = "needs data the paper does not give"


@dataclass(frozen=True)
class Entry:
    """``verdict`` is a claim, which ``judged`` holds against what ``compute`` gives.

    ``words`` say the reading, the reason, or the data that are missing; only a figure that is reproduced goes without.
    """

    places: tuple[str, ...]
    what: str
    published: Printed | Relation
    verdict: Verdict
    compute: Callable[[], Computed] | None = None
    words: str = ""

    def __post_init__(self) -> None:
        if self.verdict is not Verdict.REPRODUCED and not self.words:
            raise ValueError(f"{self.what}: {self.verdict} without a word why")
        if self.verdict is not Verdict.NEEDS_DATA and self.compute is None:
            raise ValueError(f"{self.what}: {self.verdict}, but nothing is computed")


@dataclass(frozen=True)
class Given:
    """What a place of a paper holds that is not computed: dimensions, settings, definitions."""

    places: tuple[str, ...]
    content: str


@dataclass(frozen=True)
class Paper:
    """A paper, its entries and what it gives; ``promised`` are the places that one or the other must name."""

    title: str
    reference: str
    promised: tuple[str, ...]
    entries: tuple[Entry, ...]
    given: tuple[Given, ...]


def equations(*numbers: str | int) -> tuple[str, ...]:
    """Names of single equations."""
    return tuple(f"eq. {number}" for number in numbers)


def counted(kind: str, last: int) -> tuple[str, ...]:
    """``Table 1`` to ``Table n``, or another kind of place."""
    return tuple(f"{kind} {number}" for number in range(1, last + 1))
