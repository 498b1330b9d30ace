"""A place that the output passes at a driving angle."""

from __future__ import annotations

from math import degrees, inf

import numpy as np

from ncgear.frozen import dataclass
from ncgear.kinematics.crank_stretches import CrankStretch, Stroke, crank_at_way_rad
from ncgear.kinematics.motion import Machine
from ncgear.mechanisms.mechanism import Mechanism
from ncgear.numerics.bounds import shown_above, shown_below
from ncgear.wishes.requirements import Requirement, TimeWithin
from ncgear.wishes.wish import Offer, Outcome, Wish, Written, of_stroke


@dataclass(frozen=True, kw_only=True)
class Position(Wish):
    """The output passes a place at a driving angle, give or take a tolerance of the place."""

    at_mm: float
    phi1_rad: float
    tolerance_mm: float
    stroke: Stroke = Stroke.WORKING

    def way_mm(self, linkage: Mechanism) -> float:
        """The way from the retracted end to the place; on the return it includes the working stroke."""
        return self.at_mm if self.stroke is Stroke.WORKING else 2.0 * linkage.stroke_mm - self.at_mm

    def requirements(self, linkage: Mechanism, cycle_rad: float) -> tuple[Requirement, ...]:
        """At the driving angle the way is under the place's far bound and over its near bound."""
        way, most = self.way_mm(linkage), 2.0 * linkage.stroke_mm
        before, after = (way + side * self.tolerance_mm for side in (-1.0, 1.0))
        asked: list[Requirement] = []
        if before > 0.0:
            asked.append(TimeWithin(CrankStretch(0.0, crank_at_way_rad(linkage, before)), most_rad=self.phi1_rad))
        if after < most:
            asked.append(TimeWithin(CrankStretch(0.0, crank_at_way_rad(linkage, after)), least_rad=self.phi1_rad))
        return tuple(asked)

    def outcome(self, machine: Machine) -> Outcome:
        """The place at the driving angle, judged by the way from the retracted end, which grows in the return too."""
        stroke_mm = float(machine.linkage.stroke_mm)
        place = float(machine.displacement(np.array([self.phi1_rad]), 0).value[0])
        working = self.phi1_rad <= machine.extended_rad
        gone = place if working else 2.0 * stroke_mm - place
        missed = float(max(abs(gone - self.way_mm(machine.linkage)) - self.tolerance_mm, 0.0))
        least, most = self.at_mm - self.tolerance_mm, self.at_mm + self.tolerance_mm
        other = working is not (self.stroke is Stroke.WORKING)
        return Outcome(self, self.output.place, place, least, most, missed, other_stroke=other)

    def words(self, place: Written, angle: Written) -> str:
        """The driving angle and the stroke."""
        return f"place at {angle(self.phi1_rad)} deg{of_stroke(self.stroke)}"

    def offer(self, asked: Requirement, missed: float, cycle_rad: float) -> Offer:
        """A later angle if the near bound is passed too late, an earlier one if the far bound is passed too early."""
        late = isinstance(asked, TimeWithin) and asked.most_rad < inf
        unit = self.output.place
        angle = self.phi1_rad + missed if late else self.phi1_rad - missed
        number = (shown_above if late else shown_below)(degrees(angle))
        return self.eased(f"{unit.factor * self.at_mm:g} {unit.text} passed at {number} deg", phi1_deg=number)
