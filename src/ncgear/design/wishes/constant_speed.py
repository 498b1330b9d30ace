"""The keys of even speed from one place to another."""

from __future__ import annotations

from collections.abc import Sequence
from itertools import pairwise
from typing import TYPE_CHECKING, Annotated, Any, Self

from pydantic import Field

from ncgear.design.keys.base import Faults, Length, Positive, fault, optional, required, unkept
from ncgear.design.wishes.base import On, StrokeName, WishKeys

if TYPE_CHECKING:
    from ncgear.wishes.wish import Wish

LEAST_TOLERANCE = 1e-4
"""A hundredth of a percent of the speed: a hundredth of the usual tolerance, and more accurate than teeth."""


class ConstantSpeed(WishKeys):
    """Even speed from one place to another."""

    KIND = "constant_speed"
    MEANING = "stretches of even speed, a list"
    INSIDE = ("to",)

    from_mm: Length = required("displacement in mm where the even speed begins, the smaller of both")
    to_mm: Length = required("displacement in mm where the even speed ends, the larger of both")
    tolerance: Annotated[float, Field(ge=LEAST_TOLERANCE, le=0.5)] = optional(
        "how far the speed may be from one value, as a share of it: 0.005 is half a percent", 0.005
    )
    stroke: StrokeName = optional("on the way out (working) or on the way back (return)", "working")
    speed_mm_s: Positive | None = optional("that one value in mm/s; left out: the law decides")

    def _faults(self) -> Faults:
        yield from unkept(self, f"to_{self.PLACE} > from_{self.PLACE}")

    def agrees(self, next_one: ConstantSpeed) -> bool:
        """Whether both speeds are possible at the place where this stretch ends and the next begins."""
        own, other = self.speed("speed"), next_one.speed("speed")
        if own is None or other is None:
            return True
        (slower, loose), (faster, tight) = sorted(((own, self.tolerance), (other, next_one.tolerance)))
        return slower * (1.0 + loose) >= faster * (1.0 - tight)

    @classmethod
    def disagreements(cls, own: Sequence[Self]) -> Faults:
        """Faults of stretches of one stroke that overlap, or that do not agree where they meet."""
        for stroke in ("working", "return"):
            strokes = [(number, wish) for number, wish in enumerate(own) if wish.stroke == stroke]
            strokes.sort(key=lambda wish: wish[1].place("from"))
            for (_, low), (number, high) in pairwise(strokes):
                (start, end), begins = (low.place("from"), low.place("to")), high.place("from")
                if begins < end or (begins == end and not low.agrees(high)):
                    yield fault(
                        f"{cls.KIND}.{number}.from_{high.PLACE}",
                        f"{begins:g} given, but even speed is wished from {start:g} to {end:g} {high.PLACE} of "
                        f"the same stroke too; over {end:g} is right",
                    )

    def value(self, on: On, **common: Any) -> Wish:
        """Even speed over the stretch."""
        from ncgear.kinematics.crank_stretches import Stroke
        from ncgear.wishes.constant_speed import ConstantSpeed as Value

        return Value(
            from_mm=on.mm(self.place("from")),
            to_mm=on.mm(self.place("to")),
            tolerance=self.tolerance,
            stroke=Stroke(self.stroke),
            speed_mm_s=self.speed("speed"),
            **common,
        )
