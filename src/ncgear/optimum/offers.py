"""Refusals of wishes and limits that no law keeps together, with possible values instead."""

from __future__ import annotations

from collections.abc import Callable, Sequence

from ncgear.errors import NoSuchMechanism
from ncgear.wishes.wish import Offer

Told = Callable[[str, Sequence[Offer]], str]
"""A function from the words of a refusal and the offers to one text."""


class Refused(NoSuchMechanism):
    """The refusal of wishes and limits that no law keeps together, with offers.

    ``told`` makes a sentence from ``said`` and the offers.  With ``each``, every offer alone is enough; without it, all
    offers are needed together.  ``found`` is true where laws were found with the offers.
    """

    def __init__(self, said: str, offers: Sequence[Offer], key: str, told: Told, *, each: bool, found: bool) -> None:
        super().__init__(told(said, offers), key=key)
        self.said, self.offers, self.told, self.each, self.found = said, tuple(offers), told, each, found

    def among(self, allowed: Callable[[Sequence[Offer]], bool]) -> Refused:
        """The same refusal with the allowed offers; without offers where all are needed but not all are allowed."""
        alone = [offer for offer in self.offers if allowed([offer])] if self.each else self.offers
        offers = alone if self.each or allowed(self.offers) else ()
        return Refused(self.said, offers, self.key, self.told, each=self.each, found=self.found)
