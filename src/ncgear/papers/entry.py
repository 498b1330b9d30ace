"""One line of the reproduction ledger: the printed figure, the figure that ncgear computes, and the verdict claimed.

A computed number agrees with a printed number if it is within the rounding of the printed digits.  An equation agrees
if both its sides agree to rounding errors.  A claim that numbers are smaller than others agrees if every pair agrees.
``papers.judgement`` checks the verdicts against the numbers.
"""

from __future__ import annotations

from collections.abc import Callable
from decimal import Decimal
from enum import StrEnum

from ncgear.frozen import dataclass

HOLDS = 1e-9
"""Largest residual of an equation that counts as true, relative to its largest term.  Rounding errors of a solved law
are three orders smaller; a missing term or a wrong sign makes residuals six orders larger (tests/test_ledger.py)."""

BINARY = 1e-9
"""Share by which half a step is widened, because a decimal half has no exact binary form."""


@dataclass(frozen=True)
class Computed:
    """Numbers computed for a printed figure, and how far each may be off because of rounded inputs.

    ``input_rounding`` is empty where the inputs are given dimensions, which count as exact.  It has one number per
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
    """Numbers computed from printed readings, and how far the rounding of the readings moves each, to first order."""
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

    Zeros at the end of a whole number do not count as digits, since they may only fill places: 6300 has two digits, 182
    has three.
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
        """The computed numbers with two decimals more than the printed numbers."""
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
    """An equation that holds or does not; its computed value is the largest relative residual."""

    text: str = "equation"

    def agrees(self, computed: Computed) -> bool:
        """Whether all residuals are rounding errors."""
        return all(abs(residual) <= HOLDS for residual in computed.values)

    def computed_text(self, computed: Computed) -> str:
        """Whether the equation holds; a residual only if it fails, since rounding errors differ between machines."""
        if self.agrees(computed):
            return "holds"
        return f"off by {max(map(abs, computed.values)):.2g} of the largest"

    def difference_text(self, computed: Computed) -> str:
        """The residual, 0 for an equation that holds."""
        return "0" if self.agrees(computed) else f"{max(map(abs, computed.values)):.2g}"


@dataclass(frozen=True)
class Below:
    """A claim that numbers are smaller than others; the computed values are pairs, the smaller value first."""

    text: str

    def agrees(self, computed: Computed) -> bool:
        """Whether the first value is smaller in every pair."""
        return all(small < large for small, large in _pairs(computed))

    def computed_text(self, computed: Computed) -> str:
        """The pair that supports the claim least or contradicts it most, and how many pairs support it."""
        pairs = _pairs(computed)
        small, large = max(pairs, key=lambda pair: pair[0] / pair[1])
        sign = "<" if small < large else "=" if small == large else ">"
        worst = f"{small:.4g} {sign} {large:.4g}"
        held = sum(one < other for one, other in pairs)
        return worst if len(pairs) == 1 else f"{worst}; holds for {held} of {len(pairs)}"

    def difference_text(self, computed: Computed) -> str:
        """A claim of more or less has no difference."""
        return "0" if self.agrees(computed) else "-"


def _pairs(computed: Computed) -> list[tuple[float, float]]:
    return list(zip(computed.values[::2], computed.values[1::2], strict=True))


def texts(line: str) -> tuple[str, ...]:
    """The numbers of a line of a table, as printed."""
    return tuple(line.split())


def printed(line: str) -> Printed:
    """Printed numbers from a text in which their unit follows them: ``1600 1100 mm/s``."""
    words = line.split()
    count = sum(word[-1].isdigit() and word[0] in "-.0123456789" for word in words)
    return Printed(tuple(words[:count]), " ".join(words[count:]))


def half_step(text: str) -> float:
    """Half a unit of the last digit that counts; raises ValueError unless the text is a finite number."""
    number = Decimal(text)
    exponent = (number if "." in text or not number else number.normalize()).as_tuple().exponent
    if not isinstance(exponent, int):
        raise ValueError(f"{text!r} is no number")
    return 0.5 * 10.0**exponent


def _fixed(value: float, text: str, sign: str) -> str:
    """The value with two decimals more than the printed text; zero without a sign."""
    decimals = 2 + len(text.partition(".")[2])
    shown = f"{value:{sign}.{decimals}f}"
    return shown.lstrip("+-") if float(shown) == 0.0 else shown


class Finding(StrEnum):
    """The verdict on a printed figure."""

    REPRODUCED = "reproduced"
    UNDER_READING = "reproduced under a stated reading"
    FITTED = "reproduced under a reading chosen because it fits"
    GIVEN_BACK = "an input given back"
    NOT_REPRODUCIBLE = "not reproducible"
    NEEDS_DATA = "needs data the paper does not give"


AGREEING = (Finding.REPRODUCED, Finding.UNDER_READING, Finding.FITTED, Finding.GIVEN_BACK)
"""Verdicts on figures that ncgear confirms."""

OF_PRINTED = (Finding.REPRODUCED, Finding.FITTED, Finding.NOT_REPRODUCIBLE)
"""Verdicts on figures that a paper computes from numbers that it prints: right, wrong, or from other numbers."""


@dataclass(frozen=True)
class _Placed:
    where: str

    @property
    def places(self) -> tuple[str, ...]:
        """The places in the paper, separated by commas in ``where``."""
        return tuple(self.where.split(", "))


@dataclass(frozen=True)
class Entry(_Placed):
    """A printed figure with its places in the paper, its computation, and the verdict claimed for it.

    The numbers that ``compute`` gives count as exact.  ``words`` state the reading, the reason, or the missing data;
    only a figure that is simply reproduced needs no words.  ``of_printed`` is true where the computation only adds,
    divides or compares numbers that the paper prints.  Raises ValueError where words are missing, where a verdict other
    than ``NEEDS_DATA`` has no computation, or where a figure made of printed numbers has a verdict that is not in
    ``OF_PRINTED``.
    """

    what: str
    published: Printed | Relation | Below
    verdict: Finding
    compute: Callable[[], Computed | float | tuple[float, ...]] | None = None
    words: str = ""
    of_printed: bool = False

    def __post_init__(self) -> None:
        if self.verdict is not Finding.REPRODUCED and not self.words:
            raise ValueError(f"{self.what}: {self.verdict} without a word why")
        if self.verdict is not Finding.NEEDS_DATA and self.compute is None:
            raise ValueError(f"{self.what}: {self.verdict}, but nothing is computed")
        if self.of_printed and self.verdict not in OF_PRINTED:
            raise ValueError(
                f"{self.what}: of printed numbers, so neither {self.verdict} nor anything but right or wrong"
            )

    def computed(self) -> Computed | None:
        """The numbers computed for the figure; None without a computation."""
        found = self.compute and self.compute()
        if found is None or isinstance(found, Computed):
            return found
        return computed(*(found if isinstance(found, tuple) else (found,)))


class Reason(StrEnum):
    """The reason why a printed figure is not computed."""

    GIVEN = "dimensions, settings and choices, from which the figures above are computed if they depend on them"
    MEASURED = "readings, which nothing in the paper makes"
    DRAWN = "pictures and curves without a number"
    DEFINED = "definitions, with no figure to them"
    ELSEWHERE = "figures taken from other publications"
    VAGUE = "claims without a number to hold them to"


@dataclass(frozen=True)
class LeftOut(_Placed):
    """A printed place that the ledger does not compute, with the reason; ``figures`` are its numbers."""

    content: str
    reason: Reason
    figures: tuple[str, ...] = ()


@dataclass(frozen=True)
class Paper:
    """A paper, its entries, and the parts left out; one of these must name each of the ``promised`` places."""

    title: str
    reference: str
    promised: tuple[str, ...]
    entries: tuple[Entry, ...]
    left_out: tuple[LeftOut, ...]


def equations(*numbers: str | int) -> tuple[str, ...]:
    """Names of single equations."""
    return tuple(f"eq. {number}" for number in numbers)


def counted(kind: str, last: int) -> tuple[str, ...]:
    """``Table 1`` to ``Table n``, or another kind of place."""
    return tuple(f"{kind} {number}" for number in range(1, last + 1))
