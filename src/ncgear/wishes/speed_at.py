"""The speed at one place: bounds, or as low or as high as possible."""

from __future__ import annotations

from dataclasses import field
from math import exp, inf

from ncgear.frozen import dataclass
from ncgear.kinematics.crank_stretches import CrankStretch, Stroke, place_of, speeds_mm_s
from ncgear.kinematics.motion import Machine
from ncgear.mechanisms.mechanism import Mechanism
from ncgear.numerics.bounds import shown_above, shown_below
from ncgear.wishes.requirements import PushedSpeed, Requirement, SpeedWithin
from ncgear.wishes.wish import Offer, Outcome, Wish, Written, of_stroke


@dataclass(frozen=True, kw_only=True)
class SpeedAt(Wish):
    """Bounds of the speed at one place."""

    at_mm: float
    stroke: Stroke = Stroke.WORKING
    least_mm_s: float = 0.0
    most_mm_s: float = inf

    def stretch(self, linkage: Mechanism) -> CrankStretch:
        """The crank angle of the place, as a stretch without length."""
        return place_of(linkage, self.at_mm, self.stroke)

    def requirements(self, linkage: Mechanism, cycle_rad: float) -> tuple[Requirement, ...]:
        """Both bounds of the speed at the place."""
        return (SpeedWithin(self.stretch(linkage), self.least_mm_s, self.most_mm_s),)

    def outcome(self, machine: Machine) -> Outcome:
        """The speed there."""
        speed, _ = speeds_mm_s(machine, self.stretch(machine.linkage))
        return self.judged(self.output.speed, speed, self.least_mm_s, self.most_mm_s)

    def words(self, place: Written, angle: Written) -> str:
        """The place and the stroke."""
        return f"speed at {place(self.at_mm)} {self.output.place.text}{of_stroke(self.stroke)}"

    def offer(self, asked: Requirement, missed: float, cycle_rad: float) -> Offer:
        """Bounds farther apart by the factor whose logarithm is ``missed``."""
        place, unit = self.output.place, self.output.speed
        bounds = {"at least": shown_below(self.least_mm_s * exp(-missed))} if self.least_mm_s > 0.0 else {}
        bounds |= {"at most": shown_above(self.most_mm_s * exp(missed))} if self.most_mm_s < inf else {}
        said = " and ".join(f"{bound} {speed} {unit.text}" for bound, speed in bounds.items())
        keys = {f"{bound.replace(' ', '_')}_{unit.ending}": speed for bound, speed in bounds.items()}
        return self.eased(f"{said} at {place.factor * self.at_mm:g} {place.text}", **keys)


@dataclass(frozen=True, kw_only=True)
class ExtremeSpeed(SpeedAt):
    """The speed at one place as low, or as high, as the goal's other parts allow: always soft.

    It sets no bound. p percent of speed to the wrong side count like a soft wish that is missed by p percent.
    """

    fastest: bool = False
    weight: float | None = field(default=1.0)

    @property
    def aim(self) -> str:
        """As fast, or as slow, as possible."""
        return "as fast as may be" if self.fastest else "as slow as may be"

    def requirements(self, linkage: Mechanism, cycle_rad: float) -> tuple[Requirement, ...]:
        """No requirement."""
        return ()

    def pushed(self, linkage: Mechanism) -> tuple[PushedSpeed, ...]:
        """The speed at the place."""
        return (PushedSpeed(self.stretch(linkage), self.fastest),)

    def offer(self, asked: Requirement, missed: float, cycle_rad: float) -> Offer:
        """No offer, since nothing can be missed; raises TypeError."""
        raise TypeError("it asks for nothing that could be missed")
