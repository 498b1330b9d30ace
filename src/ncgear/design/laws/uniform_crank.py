"""The law ``uniform_crank``: circular gears, for comparison."""

from __future__ import annotations

from typing import TYPE_CHECKING, Literal

from ncgear.design.keys.base import required
from ncgear.design.laws.base import Begins, DesignLaw, LawKeys

if TYPE_CHECKING:
    from ncgear.mechanisms.mechanism import Mechanism
    from ncgear.ratio.transmission import Lobes, Transmission


class UniformCrank(LawKeys):
    """Circular gears: the crank turns uniformly."""

    law: Literal["uniform_crank"] = required("the name of this law: uniform_crank")

    def transmission(self, linkage: Mechanism, lobes: Lobes) -> Transmission:
        """A constant ratio."""
        from ncgear.ratio.laws.uniform import uniform_law

        return uniform_law(lobes)


LAW = DesignLaw(
    keys=UniformCrank,
    choice="circular gears",
    begins=Begins.MACHINE,
)
