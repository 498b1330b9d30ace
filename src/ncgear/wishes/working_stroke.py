"""The driving angle that the working stroke takes."""

from __future__ import annotations

from math import degrees

from ncgear.frozen import dataclass
from ncgear.kinematics.crank_stretches import CrankStretch
from ncgear.kinematics.motion import Machine
from ncgear.mechanisms.mechanism import Mechanism
from ncgear.numerics.bounds import shown_above
from ncgear.wishes.requirements import Requirement, TimeWithin
from ncgear.wishes.wish import DEGREES, Offer, Outcome, Wish, Written


@dataclass(frozen=True, kw_only=True)
class WorkingStroke(Wish):
    """The working stroke takes a driving angle, give or take a tolerance."""

    angle_rad: float
    tolerance_rad: float = 0.0

    @property
    def bounds_rad(self) -> tuple[float, float]:
        """The least and the greatest driving angle."""
        return self.angle_rad - self.tolerance_rad, self.angle_rad + self.tolerance_rad

    def requirements(self, linkage: Mechanism, cycle_rad: float) -> tuple[Requirement, ...]:
        """The driving angle of the working stroke."""
        return (TimeWithin(CrankStretch(0.0, linkage.working_angle_rad), *self.bounds_rad),)

    def outcome(self, machine: Machine) -> Outcome:
        """The driving angle of the extended end."""
        return self.judged(DEGREES, machine.extended_rad, *self.bounds_rad)

    def words(self, place: Written, angle: Written) -> str:
        """The name of the angle."""
        return "driving angle of the working stroke"

    def offer(self, asked: Requirement, missed: float, cycle_rad: float) -> Offer:
        """A wider tolerance."""
        number = shown_above(degrees(self.tolerance_rad + missed))
        return self.eased(f"a tolerance of {number} deg", tolerance_deg=number)
