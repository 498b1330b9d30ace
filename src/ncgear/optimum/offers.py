"""What could be asked for in place of wishes and limits that no law keeps, and the refusals that offer it."""

from __future__ import annotations

from collections.abc import Callable, Sequence

from ncgear.errors import NoSuchMechanism
from ncgear.frozen import dataclass

Value = float | bool

Told = Callable[[str, Sequence["Offer"]], str]
"""From what is said of a refusal, and the offers, to one text."""


@dataclass(frozen=True)
class Offer:
    """What could be asked for instead, in words, and the dotted keys of a design file with the values that ask for it.

    ``key`` is that of the wish or limit that is eased, where messages name it.
    """

    said: str
    values: tuple[tuple[str, Value], ...] = ()
    key: str = ""

    def __str__(self) -> str:
        return f"{self.said} ({self.key})" if self.key else self.said


class Refused(NoSuchMechanism):
    """The refusal of wishes and limits that no law keeps together, with offers.

    ``told`` makes one sentence of what is ``said`` and of the offers.  With ``each``, every offer alone is enough;
    without, all are together.  ``found`` is true where laws were found with the offers.
    """

    def __init__(self, said: str, offers: Sequence[Offer], key: str, told: Told, *, each: bool, found: bool) -> None:
        super().__init__(told(said, offers), key=key)
        self.said, self.offers, self.told, self.each, self.found = said, tuple(offers), told, each, found

    def among(self, allowed: Callable[[Sequence[Offer]], bool]) -> Refused:
        """The same refusal with the offers that are allowed; with none where all are needed and not allowed."""
        alone = [one for one in self.offers if allowed([one])] if self.each else self.offers
        offers = alone if self.each or allowed(self.offers) else ()
        return Refused(self.said, offers, self.key, self.told, each=self.each, found=self.found)
