"""One line of the reproduction ledger: what a paper prints, what ncgear computes for it, and the verdict claimed.

A computed number agrees with a printed one if it is within the rounding of the digits that are printed; an equation
agrees if both of its sides do, to rounding errors.  ``papers.judgement`` holds the verdicts against the numbers.
"""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass
from decimal import Decimal
from enum import StrEnum

HOLDS = 1e-9
"""Largest residual of an equation that counts as true, relative to its largest term.  Rounding errors of a solved law
are three orders smaller; a term left out or a wrong sign makes six orders more (tests/test_ledger.py)."""

BINARY = 1e-9
"""What half a step is widened by, as a share of it, because a decimal half has no exact binary form."""


@dataclass(frozen=True)
class Computed:
    """Numbers computed for what is printed, and how far each may be off because of rounded inputs.

    ``input_rounding`` is empty where the inputs are given dimensions, which count as exact; it holds one number per
    value where the inputs are readings that the paper prints rounded.
    """

    values: tuple[float, ...]
    input_rounding: tuple[float, ...] = ()

    @property
    def leeway(self) -> tuple[float, ...]:
        """The rounding of the inputs, zeros where there is none."""
        return self.input_rounding or (0.0,) * len(self.values)


def computed(*values: float) -> Computed:
    """Numbers computed from given dimensions."""
    return Computed(tuple(map(float, values)))


def from_readings(function: Callable[..., tuple[float, ...]], *texts: str) -> Computed:
    """Numbers computed from printed readings, with how far the rounding of the readings moves each, to first order."""
    readings = [float(text) for text in texts]
    values = function(*readings)
    leeway = [0.0] * len(values)
    for place, text in enumerate(texts):
        moved = function(*readings[:place], readings[place] + half_step(text), *readings[place + 1 :])
        leeway = [sum_ + abs(new - value) for sum_, new, value in zip(leeway, moved, values, strict=True)]
    return Computed(tuple(values), tuple(leeway))


@dataclass(frozen=True)
class Printed:
    """One printed number or several, as texts, with their unit.

    Zeros at the end of a whole number do not count as digits, since they may only fill the place: 6300 has two digits,
    182 has three.
    """

    texts: tuple[str, ...]
    unit: str = ""

    @property
    def values(self) -> tuple[float, ...]:
        """The numbers."""
        return tuple(map(float, self.texts))

    @property
    def text(self) -> str:
        """All numbers with their unit."""
        return " ".join(filter(None, (", ".join(self.texts), self.unit)))

    def agrees(self, computed: Computed) -> bool:
        """Whether every number is within half a step of the last printed digit plus the rounding of the inputs."""
        return all(
            abs(value - printed) <= half_step(text) * (1.0 + BINARY) + leeway
            for text, printed, value, leeway in zip(
                self.texts, self.values, computed.values, computed.leeway, strict=True
            )
        )

    def computed_text(self, computed: Computed) -> str:
        """The computed numbers with two decimals more than are printed."""
        return ", ".join(_fixed(value, text, "") for value, text in zip(computed.values, self.texts, strict=True))

    def difference_text(self, computed: Computed) -> str:
        """Computed minus printed, for the number that is off by the most steps of its last digit."""
        off = [
            (abs(value - printed) / half_step(text), value - printed, text)
            for value, printed, text in zip(computed.values, self.values, self.texts, strict=True)
        ]
        # Compared to six digits, so that rounding errors do not decide
        _, difference, text = max(off, key=lambda steps: round(steps[0], 6))
        return _fixed(difference, text, "+")


@dataclass(frozen=True)
class Relation:
    """An equation or a claim that holds or does not; its computed value is the largest relative residual."""

    text: str = "equation"

    def agrees(self, computed: Computed) -> bool:
        """Whether all residuals are rounding errors."""
        return all(abs(residual) <= HOLDS for residual in computed.values)

    def computed_text(self, computed: Computed) -> str:
        """Whether it holds; the residual only if it does not, since rounding errors differ between machines."""
        if self.agrees(computed):
            return "holds"
        return f"off by {max(map(abs, computed.values)):.2g} of the largest"

    def difference_text(self, computed: Computed) -> str:
        """The residual, 0 for an equation that holds."""
        return "0" if self.agrees(computed) else f"{max(map(abs, computed.values)):.2g}"


def texts(line: str) -> tuple[str, ...]:
    """The numbers of a line of a table, as printed."""
    return tuple(line.split())


def half_step(text: str) -> float:
    """Half a unit of the last digit that counts; raises ValueError for a text that is no finite number."""
    number = Decimal(text)
    exponent = (number if "." in text or not number else number.normalize()).as_tuple().exponent
    if not isinstance(exponent, int):
        raise ValueError(f"{text!r} is no number")
    return 0.5 * 10.0**exponent


def _fixed(value: float, text: str, sign: str) -> str:
    """With two decimals more than the printed text has; zero without a sign."""
    decimals = 2 + len(text.partition(".")[2])
    shown = f"{value:{sign}.{decimals}f}"
    return shown.lstrip("+-") if float(shown) == 0.0 else shown


class Verdict(StrEnum):
    """How a printed figure fares."""

    REPRODUCED = "reproduced"
    UNDER_READING = "reproduced under a stated reading"
    NOT_REPRODUCIBLE = "not reproducible"
    NEEDS_DATA = "needs data the paper does not give"


@dataclass(frozen=True)
class Entry:
    """A printed figure with its places in the paper, how it is computed, and the verdict claimed for it.

    ``words`` state the reading, the reason, or the missing data; only a figure that is simply reproduced needs none.
    Raises ValueError where the words are missing, or where a verdict other than ``NEEDS_DATA`` has no computation.
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
    """What a place of a paper gives without computing it: dimensions, settings, definitions."""

    places: tuple[str, ...]
    content: str


@dataclass(frozen=True)
class Paper:
    """A paper, its entries, and what it gives; each of the ``promised`` places must be named by one or the other."""

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
