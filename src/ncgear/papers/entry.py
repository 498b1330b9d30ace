"""What a paper prints, and when a computed number agrees with it: within the rounding of the digits printed.

One entry of the ledger: what a paper prints, how it is computed here, and the verdict claimed for it.
"""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass
from decimal import Decimal
from enum import StrEnum

HOLDS = 1e-9
"""Largest residual, relative to the equation's largest term, of an equation that counts as true: rounding errors of a
solved law stay three orders below it, and a term left out or a sign turned is six orders above (tests/test_ledger.py).
"""

BINARY = 1e-9
"""Share of a half step added to it, so that a decimal half is not lost to its binary form."""


@dataclass(frozen=True)
class Computed:
    """Numbers computed for what is printed, and by how much each may be off because readings it is made from are
    printed rounded (none where it is made from given dimensions, which are taken as exact)."""

    values: tuple[float, ...]
    input_rounding: tuple[float, ...] = ()

    @property
    def leeway(self) -> tuple[float, ...]:
        """The input's rounding, zero where there is none."""
        return self.input_rounding or (0.0,) * len(self.values)


@dataclass(frozen=True)
class Printed:
    """One number or several, as texts, with their unit.

    Zeros at the end of a whole number do not count as digits, since nothing tells whether they are: 6300 is printed to
    two digits, 182 to three.
    """

    texts: tuple[str, ...]
    unit: str = ""

    @property
    def values(self) -> tuple[float, ...]:
        """The numbers."""
        return tuple(map(float, self.texts))

    @property
    def text(self) -> str:
        """All with their unit."""
        return " ".join(filter(None, (", ".join(self.texts), self.unit)))

    def agrees(self, computed: Computed) -> bool:
        """Whether every number is within half a step of the last digit printed, and the input's rounding."""
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
        """Computed less printed, of the number that is farthest off by the steps of its last digit."""
        off = [
            (abs(value - printed) / half_step(text), value - printed, text)
            for value, printed, text in zip(computed.values, self.values, self.texts, strict=True)
        ]
        # To six digits, so that rounding errors of the computer do not choose
        _, difference, text = max(off, key=lambda steps: round(steps[0], 6))
        return _fixed(difference, text, "+")


@dataclass(frozen=True)
class Relation:
    """An equation or a claim, which holds or does not; what is computed for it is its largest relative residual."""

    text: str = "equation"

    def agrees(self, computed: Computed) -> bool:
        """Whether all residuals are rounding errors."""
        return all(abs(residual) <= HOLDS for residual in computed.values)

    def computed_text(self, computed: Computed) -> str:
        """Rounding errors differ from machine to machine, so they are not told."""
        if self.agrees(computed):
            return "holds"
        return f"off by {max(map(abs, computed.values)):.2g} of the largest"

    def difference_text(self, computed: Computed) -> str:
        """An equation that holds differs by nothing."""
        return "0" if self.agrees(computed) else f"{max(map(abs, computed.values)):.2g}"


def of(*values: float) -> Computed:
    """Numbers from given dimensions."""
    return Computed(tuple(map(float, values)))


def from_readings(function: Callable[..., tuple[float, ...]], *texts: str) -> Computed:
    """Numbers made of readings as printed, with what the readings' rounding can do to each, to first order."""
    readings = [float(text) for text in texts]
    values = function(*readings)
    leeway = [0.0] * len(values)
    for place, text in enumerate(texts):
        moved = function(*readings[:place], readings[place] + half_step(text), *readings[place + 1 :])
        leeway = [sum_ + abs(new - value) for sum_, new, value in zip(leeway, moved, values, strict=True)]
    return Computed(tuple(values), tuple(leeway))


def texts(line: str) -> tuple[str, ...]:
    """The numbers of a line of a table, as printed."""
    return tuple(line.split())


def half_step(text: str) -> float:
    """Half a unit of the last digit that counts."""
    return 0.5 * 10.0 ** _exponent(text)


def _exponent(text: str) -> int:
    number = Decimal(text)
    exponent = (number if "." in text or not number else number.normalize()).as_tuple().exponent
    if not isinstance(exponent, int):
        raise ValueError(f"{text!r} is no number")
    return exponent


def _fixed(value: float, text: str, sign: str) -> str:
    """With two decimals more than are printed; zero without a sign."""
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
