"""A gentle stop: the greatest deceleration, or speed, over a stretch of the stroke or of the whole cycle."""

from __future__ import annotations

from abc import ABC, abstractmethod
from math import degrees, exp, inf, pi
from typing import ClassVar

from ncgear.frozen import dataclass
from ncgear.kinematics.crank_stretches import (
    CrankStretch,
    Stroke,
    crank_angle_rad,
    crank_rad,
    deceleration_mm_s2,
    speeds_mm_s,
)
from ncgear.kinematics.motion import Machine
from ncgear.mechanisms.mechanism import Mechanism, Unit
from ncgear.numerics.bounds import shown_above, shown_below
from ncgear.wishes.requirements import DecelerationWithin, Requirement, SpeedWithin, TimeWithin
from ncgear.wishes.wish import DrivingWish, Offer, Outcome, Written, of_stroke


@dataclass(frozen=True, kw_only=True)
class GentleStretch(DrivingWish, ABC):
    """A motion that is gentle between two places of one stroke, or of both strokes (None), joined at an end."""

    BOUNDED: ClassVar[str]
    """Name of the bounded quantity."""

    from_mm: float = 0.0
    to_mm: float = inf
    stroke: Stroke | None = Stroke.WORKING

    def stretch(self, linkage: Mechanism) -> CrankStretch:
        """The crank angles between both places; a whole turn for both ends and both strokes."""
        if self.driving is not None:
            return self.driving.crank
        far, turn = linkage.working_angle_rad, 2.0 * pi
        whole, outer = self.from_mm <= 0.0, self.to_mm >= linkage.stroke_mm
        out = 0.0 if whole else crank_angle_rad(linkage, self.from_mm, Stroke.WORKING)
        home = turn if whole else crank_angle_rad(linkage, self.from_mm, Stroke.RETURN)
        before = far if outer else crank_angle_rad(linkage, self.to_mm, Stroke.WORKING)
        behind = far if outer else crank_angle_rad(linkage, self.to_mm, Stroke.RETURN)
        if self.stroke is None:
            return CrankStretch(out, home) if outer else CrankStretch(behind - turn, before)
        return CrankStretch(out, before) if self.stroke is Stroke.WORKING else CrankStretch(behind, home)

    def passed(self, machine: Machine) -> CrankStretch:
        """The crank angles of the stretch; for a driving range, the crank angles that the motion passes in it."""
        if self.driving is None:
            return self.stretch(machine.linkage)
        return CrankStretch(crank_rad(machine, self.driving.start_rad), crank_rad(machine, self.driving.end_rad))

    def words(self, place: Written, angle: Written) -> str:
        """The bounded quantity and its stretch."""
        what, unit = f"greatest {self.BOUNDED}", self.output.place
        if self.driving is not None:
            return f"{what} from driving angle {angle(self.driving.start_rad)} to {angle(self.driving.end_rad)} deg"
        return f"{what} from {place(self.from_mm)} to {place(self.to_mm)} {unit.text}{of_stroke(self.stroke)}"

    def offer(self, asked: Requirement, missed: float, cycle_rad: float) -> Offer:
        """A greater bound; or driving angles that begin later, or end earlier, by ``missed``."""
        if self.driving is not None and isinstance(asked, TimeWithin):
            start, end = self.driving.start_rad + missed, self.driving.end_rad - missed
            first, last = shown_above(degrees(start)), shown_below(degrees(end))
            return self.eased(f"a stretch from {first} to {last} deg", from_phi1_deg=first, to_phi1_deg=last)
        unit, kept = self.greater(missed)
        most, key = shown_above(kept), f"{self.BOUNDED}_at_most_{unit.ending}"
        return self.eased(f"a {self.BOUNDED} of at most {most} {unit.text}", **{key: most})

    @abstractmethod
    def greater(self, missed: float) -> tuple[Unit, float]:
        """The unit of the bound, and the bound that would be kept."""


@dataclass(frozen=True, kw_only=True)
class GentleSpeed(GentleStretch):
    """The speed is at most ``most_mm_s`` on the stretch."""

    BOUNDED = "speed"

    most_mm_s: float

    def bound(self, stretch: CrankStretch) -> Requirement:
        """The upper bound of the speed."""
        return SpeedWithin(stretch, most_mm_s=self.most_mm_s)

    def outcome(self, machine: Machine) -> Outcome:
        """The greatest speed."""
        return self.judged(self.output.speed, speeds_mm_s(machine, self.passed(machine))[1], most=self.most_mm_s)

    def greater(self, missed: float) -> tuple[Unit, float]:
        """The bound times the factor whose logarithm is ``missed``."""
        return self.output.speed, self.most_mm_s * exp(missed)


@dataclass(frozen=True, kw_only=True)
class GentleStop(GentleStretch):
    """The speed falls by at most ``most_mm_s2`` in a second on the stretch."""

    BOUNDED = "deceleration"

    most_mm_s2: float

    def bound(self, stretch: CrankStretch) -> Requirement:
        """The bound of the deceleration."""
        return DecelerationWithin(stretch, self.most_mm_s2)

    def outcome(self, machine: Machine) -> Outcome:
        """The greatest deceleration."""
        return self.judged(
            self.output.acceleration, deceleration_mm_s2(machine, self.passed(machine)), most=self.most_mm_s2
        )

    def greater(self, missed: float) -> tuple[Unit, float]:
        """The bound, greater by the share ``missed``."""
        return self.output.acceleration, (1.0 + missed) * self.most_mm_s2
