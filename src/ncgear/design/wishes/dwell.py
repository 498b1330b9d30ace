"""The keys of a near-dwell."""

from __future__ import annotations

from math import degrees
from typing import TYPE_CHECKING, Any, Literal

from ncgear.design.keys.base import Positive, angle, required
from ncgear.design.wishes.base import On, Way, Wished, WishKeys
from ncgear.errors import NoSuchMechanism, WrongInput
from ncgear.numerics.bounds import shown_above

if TYPE_CHECKING:
    from ncgear.wishes.wish import Wish

DIGITS = 3
"""Significant digits of the nearest possible dwell; it is rounded up, so that gears can make it."""


class Dwell(WishKeys):
    """A near-dwell: the slider stays close to an end for a driving angle."""

    KIND = "dwell"
    MEANING = "near-dwells at the ends of the stroke, a list"
    INSIDE = ("within",)
    ANGLES = (("for", "for_angle_rad"),)

    at: Literal["retracted", "extended"] = required("the end that it stays close to")
    within_mm: Way = required("how far in mm from the end it may be; 0 would be an exact dwell")
    for_angle_rad: float = angle("driving angle {unit} of the dwell", "for", needed=True, of=Positive)

    @classmethod
    def refuse_together(cls, wishes: Wished, on: On) -> None:
        """Refuse an exact dwell, and dwells at both ends that leave no driving angle for the ways between them."""
        own = wishes.of(cls)
        ends = ("retracted", "extended")
        longest = [
            max((dwell.for_angle_rad for dwell in own if dwell.hard and dwell.at == end), default=0.0) for end in ends
        ]
        together = sum(longest)
        if not together < on.cycle_rad:
            raise WrongInput(
                f"dwells at both ends for {degrees(together):g} deg together, but a cycle takes "
                f"{degrees(on.cycle_rad):g} deg of the driving angle; less is right",
                key="wishes.dwell",
            )
        for number, dwell in enumerate(own):
            if dwell.place("within") == 0.0:
                raise dwell._exact(f"wishes.dwell.{number}.within_{dwell.PLACE}", on)

    def _exact(self, key: str, on: On) -> NoSuchMechanism:
        """The refusal of an exact dwell, with the nearest dwell that can be made."""
        from ncgear.kinematics.crank_stretches import End, nearest_dwell_mm

        output = on.linkage.OUTPUT
        nearest_mm = nearest_dwell_mm(on.linkage, End(self.at), self.for_angle_rad, on.ratio_max)
        nearest = output.place.factor * nearest_mm
        return NoSuchMechanism(
            "0 given, an exact dwell, but gears of a finite ratio never let the crank stand still, and the "
            f"{output.name} stands still at its {self.at} end for an instant only; with ratios up to "
            f"{on.ratio_max:g} (optimize.limits.ratio_max) it can stay within {shown_above(nearest, DIGITS)} "
            f"{output.place.text} for {degrees(self.for_angle_rad):g} deg: that or more is right",
            key=key,
        )

    def value(self, on: On, **common: Any) -> Wish:
        """A near-dwell at the end."""
        from ncgear.kinematics.crank_stretches import End
        from ncgear.wishes.dwell import Dwell as Value

        within = on.mm(self.place("within"))
        return Value(end=End(self.at), within_mm=within, for_rad=self.for_angle_rad, **common)
