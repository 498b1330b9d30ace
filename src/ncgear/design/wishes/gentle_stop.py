"""The keys of a gentle stop."""

from __future__ import annotations

from math import degrees, pi
from typing import TYPE_CHECKING, Any, Literal

from ncgear.design.keys.base import Faults, Length, Positive, angle, fault, given, key_of, optional, unkept
from ncgear.design.wishes.base import On, Way, WishKeys
from ncgear.design.words import listed, spellings
from ncgear.errors import WrongInput

if TYPE_CHECKING:
    from ncgear.wishes.wish import Wish


class GentleStop(WishKeys):
    """A gentle stop: the greatest deceleration, or speed, over a stretch of the stroke or of the whole cycle."""

    KIND = "gentle_stop"
    MEANING = (
        "greatest decelerations, or speeds, over stretches of the stroke or of the whole cycle, a list; over the whole "
        "cycle optimize.limits.peak_acceleration_mm_s2 and peak_jerk_mm_s3 hold too, and dwell keeps close to an end"
    )
    INSIDE = ("from",)
    REACHING = ("to",)

    from_mm: Way | None = optional(
        "displacement in mm where the stretch begins, the smaller; left out: the retracted end"
    )
    to_mm: Length | None = optional("displacement in mm where the stretch ends, the larger; left out: the extended end")
    deceleration_at_most_mm_s2: Positive | None = optional(
        "greatest deceleration over the stretch in mm/s^2: by how much the speed falls"
    )
    speed_at_most_mm_s: Positive | None = optional("in place of it: greatest speed over the stretch in mm/s")
    stroke: Literal["working", "return", "both"] = optional(
        "on the way out (working), on the way back (return), or on both ways, about one end or all round", "working"
    )
    from_rad: float = angle(
        "in place of places: driving angle {unit} where the stretch begins, the smaller; negative before the retracted "
        "end, where phi1 is 0",
        "from_phi1",
    )
    to_rad: float = angle("driving angle {unit} where the stretch ends, the larger", "to_phi1")

    @property
    def driving_rad(self) -> tuple[float, float] | None:
        """Both driving angles in rad; None if the stretch has places."""
        return (self.from_rad, self.to_rad) if key_of(self, "from_phi1") else None

    @property
    def bound(self) -> tuple[str, float]:
        """The bounded quantity, ``speed`` or ``deceleration``, and its greatest value in the unit of the file."""
        speed = getattr(self, self.bound_key("speed"))
        return ("deceleration", getattr(self, self.bound_key("deceleration"))) if speed is None else ("speed", speed)

    def bound_key(self, quantity: str) -> str:
        """The key of a bound of ``speed`` or ``deceleration``."""
        return f"{quantity}_at_most_{self.SPEED}{'2' if quantity == 'deceleration' else ''}"

    def ends(self, stroke: float) -> tuple[float, float]:
        """Both places in the unit of the file, for a stroke in that unit."""
        end = self.place("to")
        return self.place("from") or 0.0, stroke if end is None else end

    def _one_bound_and_a_length(self) -> Faults:
        yield from unkept(self, f"one of {self.bound_key('deceleration')} {self.bound_key('speed')}")
        yield from unkept(self, f"to_{self.PLACE} > from_{self.PLACE}")
        start, end = self.place("from"), self.place("to")
        if self.stroke == "both" and start and end is not None:
            yield fault(
                "stroke",
                f"both given from {start:g} to {end:g} {self.PLACE}; a wish for each stroke is right, or leave out "
                f"from_{self.PLACE} or to_{self.PLACE}, so that both ways meet at an end",
            )

    def _places_or_driving_angles(self) -> Faults:
        ends, places = [spellings(f"{end}_phi1") for end in ("from", "to")], (f"from_{self.PLACE}", f"to_{self.PLACE}")
        angles = given(self, (*ends[0], *ends[1]))
        if not angles:
            return
        if beside := given(self, places):
            yield fault(
                beside[0],
                f"{listed((*beside, *angles), 'and')} are given: places and driving angles are mixed; "
                f"{' and '.join(places)}, or from_phi1_deg and to_phi1_deg, are right",
            )
        for names in ends:
            yield from unkept(self, f"one of {' '.join(names)}")
        if "stroke" in self.model_fields_set:
            yield fault("stroke", "given with driving angles, which tell the stroke themselves; leave it out")
        if not self.from_rad < self.to_rad:
            start, end = (key_of(self, f"{end}_phi1") for end in ("from", "to"))
            yield fault(end, f"{getattr(self, end):g} given, which is not over {start}; a larger angle is right")

    def refuse(self, key: str, on: On) -> None:
        """Refuse driving angles more than a cycle away on either side, and a stretch of a whole cycle or more."""
        if (ends := self.driving_rad) is None:
            return
        (start, end), cycle = ends, on.cycle_rad
        for name, beyond in (("from", start <= -cycle), ("to", end > cycle), ("to", end - start >= cycle)):
            if beyond:
                raise WrongInput(
                    f"from {degrees(start):g} to {degrees(end):g} deg given, but a cycle takes {degrees(cycle):g} deg "
                    "of the driving angle from the retracted end on, and as many before it; a part of a cycle within "
                    "them is right, or stroke: both without places for all of it",
                    key=f"{key}.{key_of(self, f'{name}_phi1')}",
                )

    def value(self, on: On, **common: Any) -> Wish:
        """A bound over the stretch; until a law is known, an even crank's angles stand for a driving range."""
        from ncgear.kinematics.crank_stretches import CrankStretch, Stroke
        from ncgear.wishes.gentle_stop import GentleSpeed
        from ncgear.wishes.gentle_stop import GentleStop as Value
        from ncgear.wishes.requirements import DrivingRange

        start, end = map(on.mm, self.ends(on.stroke))
        (bounded, most), even, driving = self.bound, 2.0 * pi / on.cycle_rad, None
        if (ends := self.driving_rad) is not None:
            driving = DrivingRange(*ends, CrankStretch(even * ends[0], even * ends[1]))
        stroke = None if self.stroke == "both" else Stroke(self.stroke)
        common |= {"from_mm": start, "to_mm": end, "stroke": stroke, "driving": driving}
        return GentleSpeed(most_mm_s=most, **common) if bounded == "speed" else Value(most_mm_s2=most, **common)
