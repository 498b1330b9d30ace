"""The keys of the speed at one place."""

from __future__ import annotations

from math import inf
from typing import TYPE_CHECKING, Any, Literal

from ncgear.design.keys.base import Faults, Length, Positive, fault, given, optional, required, unkept
from ncgear.design.wishes.base import On, StrokeName, WishKeys

if TYPE_CHECKING:
    from ncgear.wishes.wish import Wish


class SpeedAt(WishKeys):
    """The speed at one place: bounds, or as low or as high as possible."""

    KIND = "speed_at"
    MEANING = "slow or fast at places, a list"
    INSIDE = ("at",)

    at_mm: Length = required("displacement in mm at which the speed counts")
    at_least_mm_s: Positive | None = optional("least speed there in mm/s")
    at_most_mm_s: Positive | None = optional("greatest speed there in mm/s")
    stroke: StrokeName = optional("on the way out (working) or on the way back (return)", "working")
    make: Literal["slowest", "fastest"] | None = optional(
        "in place of bounds: as slow or as fast there as the goal allows, which needs hard: false"
    )

    def _faults(self) -> Faults:
        low, high = (f"{bound}_{self.SPEED}" for bound in ("at_least", "at_most"))
        bounds = given(self, (low, high))
        if self.make is None and not bounds:
            yield fault("", f"says nothing of the speed; give {low}, {high} or make")
        if self.make is not None and bounds:
            yield fault(bounds[0], f"given, and make: {self.make} too, but only one of them can count; keep one")
        if self.make is not None and self.hard:
            yield fault("make", f"{self.make} has no bound that could be kept; hard: false is right with it")
        yield from unkept(self, f"{high} >= {low}")

    def value(self, on: On, **common: Any) -> Wish:
        """Bounds of the speed, or a speed to be made as low or as high as possible."""
        from ncgear.kinematics.crank_stretches import Stroke
        from ncgear.wishes.speed_at import ExtremeSpeed
        from ncgear.wishes.speed_at import SpeedAt as Value

        at, stroke = on.mm(self.place("at")), Stroke(self.stroke)
        if self.make is not None:
            return ExtremeSpeed(at_mm=at, stroke=stroke, fastest=self.make == "fastest", **common)
        least, most = self.speed("at_least") or 0.0, self.speed("at_most") or inf
        return Value(at_mm=at, stroke=stroke, least_mm_s=least, most_mm_s=most, **common)
