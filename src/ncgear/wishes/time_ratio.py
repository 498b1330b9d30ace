"""A quick return: the time of the working stroke over the time of the return."""

from __future__ import annotations

from ncgear.frozen import dataclass
from ncgear.kinematics.crank_stretches import CrankStretch, time_ratio
from ncgear.kinematics.motion import Machine
from ncgear.mechanisms.mechanism import Mechanism, Unit
from ncgear.numerics.bounds import shown_below
from ncgear.wishes.requirements import Requirement, TimeWithin
from ncgear.wishes.wish import Offer, Outcome, Wish, Written


@dataclass(frozen=True, kw_only=True)
class TimeRatio(Wish):
    """The working stroke takes at least ``at_least`` times the time of the return."""

    at_least: float

    def requirements(self, linkage: Mechanism, cycle_rad: float) -> tuple[Requirement, ...]:
        """The driving angle of the working stroke, since the cycle's is given."""
        working = CrankStretch(0.0, linkage.working_angle_rad)
        return (TimeWithin(working, least_rad=self._working_rad(cycle_rad)),)

    def _working_rad(self, cycle_rad: float) -> float:
        return cycle_rad * self.at_least / (1.0 + self.at_least)

    def outcome(self, machine: Machine) -> Outcome:
        """The ratio of both times."""
        return self.judged(Unit("", ""), time_ratio(machine), self.at_least)

    def words(self, place: Written, angle: Written) -> str:
        """The name of the ratio."""
        return "time ratio of working stroke and return"

    def offer(self, asked: Requirement, missed: float, cycle_rad: float) -> Offer:
        """A shorter working stroke."""
        working = self._working_rad(cycle_rad) - missed
        number = shown_below(working / (cycle_rad - working))
        return self.eased(f"at least {number} times the time of the return", at_least=number)
