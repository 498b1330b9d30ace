"""A near-dwell: the output stays close to an end for a driving angle."""

from __future__ import annotations

from math import degrees

from ncgear.frozen import dataclass
from ncgear.kinematics.crank_stretches import CrankStretch, End, about_end, nearest_dwell_mm, taken_rad
from ncgear.kinematics.motion import Machine
from ncgear.mechanisms.mechanism import Mechanism
from ncgear.numerics.bounds import shown_above, shown_below
from ncgear.wishes.requirements import Requirement, TimeWithin
from ncgear.wishes.wish import DEGREES, Offer, Outcome, Wish, Written


@dataclass(frozen=True, kw_only=True)
class Dwell(Wish):
    """The displacement stays within ``within_mm`` of an end for a driving angle: a near-dwell."""

    end: End
    within_mm: float
    for_rad: float

    def stretch(self, linkage: Mechanism) -> CrankStretch:
        """The crank angles about the dead centre."""
        return about_end(linkage, self.end, self.within_mm)

    def requirements(self, linkage: Mechanism, cycle_rad: float) -> tuple[Requirement, ...]:
        """The time of the stretch about the dead centre."""
        return (TimeWithin(self.stretch(linkage), least_rad=self.for_rad),)

    def outcome(self, machine: Machine) -> Outcome:
        """The driving angle that the stretch takes."""
        return self.judged(DEGREES, taken_rad(machine, self.stretch(machine.linkage)), self.for_rad)

    def words(self, place: Written, angle: Written) -> str:
        """The distance and the end."""
        return f"dwell within {place(self.within_mm)} {self.output.place.text} of the {self.end.value} end"

    def offer(self, asked: Requirement, missed: float, cycle_rad: float) -> Offer:
        """A shorter dwell."""
        number = shown_below(degrees(self.for_rad - missed))
        return self.eased(f"a dwell of {number} deg", for_deg=number)

    def instead(self, linkage: Mechanism, ratio_max: float) -> tuple[Offer, ...]:
        """The least distance from the end that a dwell of this length can keep."""
        place = linkage.OUTPUT.place
        within = shown_above(place.factor * nearest_dwell_mm(linkage, self.end, self.for_rad, ratio_max))
        return (self.eased(f"one within {within} {place.text}", **{f"within_{place.ending}": within}),)
