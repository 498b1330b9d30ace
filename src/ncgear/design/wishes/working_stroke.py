"""The keys of the driving angle of the working stroke."""

from __future__ import annotations

from typing import TYPE_CHECKING, Annotated, Any

from pydantic import Field

from ncgear.design.keys.base import Positive, angle
from ncgear.design.wishes.base import On, WishKeys

if TYPE_CHECKING:
    from ncgear.wishes.wish import Wish


class WorkingStroke(WishKeys):
    """The driving angle of the working stroke."""

    KIND = "working_stroke"
    MEANING = "driving angle that the working stroke takes; left out: free"
    SEVERAL = False
    ANGLES = (("angle", "driving_rad"),)

    driving_rad: float = angle("driving angle {unit}", "angle", needed=True, of=Positive)
    within_rad: float = angle("how far {unit} it may be from that", "tolerance", of=Annotated[float, Field(ge=0.0)])

    def value(self, on: On, **common: Any) -> Wish:
        """The driving angle with its tolerance."""
        from ncgear.wishes.working_stroke import WorkingStroke as Value

        return Value(angle_rad=self.driving_rad, tolerance_rad=self.within_rad, **common)
