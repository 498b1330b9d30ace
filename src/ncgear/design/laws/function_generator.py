"""The law ``function_generator``: gears that compute y = f(x) by the angles of their shafts."""

from __future__ import annotations

from math import radians
from typing import TYPE_CHECKING

from ncgear.design.keys.base import FORMULA, Expression, required
from ncgear.design.laws.base import Begins, LawKeys, RangeDeg

if TYPE_CHECKING:
    from ncgear.mechanisms.mechanism import Mechanism
    from ncgear.ratio.transmission import Lobes, Transmission


class FunctionGenerator(LawKeys):
    """Both angles are linear scales: the driving one of x, the driven one of y."""

    CHOICE = "a function y = f(x) that the gears compute, over a range of both angles"
    BEGINS = Begins.FORMULA
    NARROWER_RATIO = "take a smaller range of x (motion.x_from, motion.x_to) or a function that is more even"
    RULES = ("x_to > x_from",)

    function: Expression = required(
        f'y as a formula of x: "log(x)", {FORMULA}; it must rise, or fall, throughout, and be smooth'
    )
    x_from: float = required("x at phi1 = 0")
    x_to: float = required("x at the other end of the range, greater than x_from")
    driving_range_deg: RangeDeg = required("turn of the driving gear in degrees while x goes from x_from to x_to")
    driven_range_deg: RangeDeg = required(
        "turn of the driven gear in degrees meanwhile; if y falls, its scale runs backwards"
    )

    @property
    def is_open(self) -> bool:
        """A range of x has two ends."""
        return True

    def transmission(self, linkage: Mechanism, lobes: Lobes) -> Transmission:
        """The law of both scales."""
        from ncgear.ratio.laws.function_generator import generated_function

        ranges = radians(self.driving_range_deg), radians(self.driven_range_deg)
        return generated_function(self.function, (self.x_from, self.x_to), *ranges)
