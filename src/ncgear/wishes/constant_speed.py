"""Even speed from one place to another."""

from __future__ import annotations

from dataclasses import replace
from math import exp, tanh

from ncgear.frozen import dataclass
from ncgear.kinematics.crank_stretches import CrankStretch, Stroke, crank_angle_rad, speeds_mm_s, spread
from ncgear.kinematics.motion import Machine
from ncgear.mechanisms.mechanism import Mechanism, Unit
from ncgear.numerics.bounds import shown_above
from ncgear.wishes.requirements import EvenSpeed, Requirement, SpeedWithin
from ncgear.wishes.wish import Offer, Outcome, Wish, Written, of_stroke

PERCENT = Unit("percent", "%", 100.0)


@dataclass(frozen=True, kw_only=True)
class ConstantSpeed(Wish):
    """The speed stays within the share ``tolerance`` of one value between two places; None: of any value."""

    from_mm: float
    to_mm: float
    tolerance: float
    stroke: Stroke = Stroke.WORKING
    speed_mm_s: float | None = None

    def stretch(self, linkage: Mechanism) -> CrankStretch:
        """The crank angles between both places."""
        ends = sorted(crank_angle_rad(linkage, place, self.stroke) for place in (self.from_mm, self.to_mm))
        return CrankStretch(*ends)

    def requirements(self, linkage: Mechanism, cycle_rad: float) -> tuple[Requirement, ...]:
        """The band of the wished speed, or the spread of any speed."""
        stretch = self.stretch(linkage)
        if self.speed_mm_s is None:
            return (EvenSpeed(stretch, spread(self.tolerance)),)
        least, most = ((1.0 + share) * self.speed_mm_s for share in (-self.tolerance, self.tolerance))
        return (SpeedWithin(stretch, least, most),)

    def outcome(self, machine: Machine) -> Outcome:
        """The share by which the speed leaves the wished speed or, if none is wished, the best suited speed."""
        (least, most), speed = speeds_mm_s(machine, self.stretch(machine.linkage)), self.speed_mm_s
        if speed is None:
            share, speed = (most - least) / (most + least), (most + least) / 2.0
        else:
            share = max(most / speed - 1.0, 1.0 - least / speed)
        return replace(self.judged(PERCENT, share, most=self.tolerance), speed_mm_s=speed)

    def words(self, place: Written, angle: Written) -> str:
        """Both places and the stroke."""
        between = f"from {place(self.from_mm)} to {place(self.to_mm)} {self.output.place.text}"
        return f"constant speed {between}{of_stroke(self.stroke)}"

    def offer(self, asked: Requirement, missed: float, cycle_rad: float) -> Offer:
        """A wider tolerance."""
        even = self.speed_mm_s is None
        tolerance = shown_above(tanh(missed / 2.0) if even else (1.0 + self.tolerance) * exp(missed) - 1.0)
        return self.eased(f"a tolerance of {tolerance} of the speed", tolerance=tolerance)
