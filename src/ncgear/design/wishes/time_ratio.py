"""The keys of a quick return."""

from __future__ import annotations

from math import degrees
from typing import TYPE_CHECKING, Any

from ncgear.design.keys.base import required
from ncgear.design.wishes.base import On, Wished, WishKeys
from ncgear.design.wishes.working_stroke import WorkingStroke
from ncgear.errors import WrongInput
from ncgear.numerics.bounds import shown_below

if TYPE_CHECKING:
    from ncgear.wishes.wish import Wish


class TimeRatio(WishKeys):
    """A quick return: the time of the working stroke over the time of the return."""

    KIND = "time_ratio"
    MEANING = "time of the working stroke over the time of the return; left out: free"
    SEVERAL = False

    at_least: float = required("least ratio of the working stroke's time to the return's time", ge=0.01, le=100.0)

    @classmethod
    def refuse_together(cls, wishes: Wished, on: On) -> None:
        """Refuse a time ratio for which the wished working stroke is too short."""
        from ncgear.wishes.wish import NEGLIGIBLE

        cycle = on.cycle_rad
        for ratio in wishes.of(cls):
            for stroke in wishes.of(WorkingStroke):
                longest = stroke.driving_rad + stroke.within_rad
                needed = cycle * ratio.at_least * (1.0 - NEGLIGIBLE)
                if ratio.hard and stroke.hard and longest * (1.0 + ratio.at_least) < needed:
                    raise WrongInput(
                        f"{ratio.at_least:g} given, but a working stroke of {degrees(longest):g} deg takes "
                        f"{shown_below(longest / (cycle - longest))} times the time of the return; at most that is "
                        "right, or another wishes.working_stroke",
                        key="wishes.time_ratio.at_least",
                    )

    def value(self, on: On, **common: Any) -> Wish:
        """The least ratio."""
        from ncgear.wishes.time_ratio import TimeRatio as Value

        return Value(at_least=self.at_least, **common)
