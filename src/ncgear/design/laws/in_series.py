"""The law ``in_series``: pairs of gears in series, each with a law of its own."""

from __future__ import annotations

from typing import TYPE_CHECKING, Annotated, Union

from pydantic import Field

from ncgear.design.keys.base import Faults, Several, fault, required
from ncgear.design.keys.gears import MOST_PAIRS
from ncgear.design.laws.base import Begins, LawKeys
from ncgear.design.laws.registry import LawName, law_keys
from ncgear.errors import renamed

if TYPE_CHECKING:
    from ncgear.mechanisms.mechanism import Mechanism
    from ncgear.ratio.transmission import Law, Lobes, Transmission

    PairLaw = LawKeys
else:
    # This union is made at run time, so that only the registry lists the laws; type checkers cannot follow it.
    PairLaw = Annotated[
        Union[tuple(law_keys(name) for name in LawName if name != "in_series")],  # noqa: UP007
        Field(discriminator="law"),
    ]


class InSeries(LawKeys):
    """Pairs in series, one lobe of each gear; the driven gear of each pair turns the driving gear of the next."""

    CHOICE = "pairs in series, each with a law of its own"
    BEGINS = Begins.FORMULA
    pairs: Annotated[Several[PairLaw], Field(min_length=2, max_length=MOST_PAIRS)] = required(
        "the laws of the pairs, from the driving shaft on, each with the keys of `motion`; the angles of a pair are "
        "those of its own gears"
    )

    def _each_turns_on_by_itself(self) -> Faults:
        for number, law in enumerate(self.pairs):
            reasons = {
                f"{law.law} given, but it tells how a slider moves, which the last pair alone cannot do; a law of the "
                "ratio is right": law.gives_slider,
                f"{law.law} over a range given, but pairs in series turn on and on; leave the range out": law.is_open,
                "two pairs given in place of one; give each as an item of pairs": law.pairs_in_series > 1,
                f"{law.law} given with a distance of its axes, but gears gives the size; solve_for: scale is right, "
                "without center_distance_mm": law.gives_center_distance,
            }
            for said in (words for words, holds in reasons.items() if holds):
                yield fault(f"pairs.{number}.law", said)

    @property
    def pairs_in_series(self) -> int:
        """The number of laws."""
        return len(self.pairs)

    @property
    def pairs_key(self) -> str:
        """The list of laws."""
        return "pairs"

    def law_on(self, linkage: Mechanism, lobes: Lobes, *, ring: bool = False) -> Law:
        """The laws one after the other on the mechanism."""
        from ncgear.ratio.laws.row import laws_in_series
        from ncgear.ratio.transmission import Law

        return Law(linkage, laws_in_series([self._pair(number) for number in range(len(self.pairs))]))

    def _pair(self, number: int) -> Transmission:
        from ncgear.mechanisms.driven_shaft import DrivenShaft
        from ncgear.ratio.transmission import Lobes

        with renamed("motion", f"motion.pairs.{number}"):
            return self.pairs[number].law_on(DrivenShaft(), Lobes()).transmission
