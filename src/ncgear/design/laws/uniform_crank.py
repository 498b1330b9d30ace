"""The law ``uniform_crank``: circular gears, for comparison."""

from __future__ import annotations

from typing import TYPE_CHECKING

from ncgear.design.laws.base import Begins, LawKeys

if TYPE_CHECKING:
    from ncgear.mechanisms.mechanism import Mechanism
    from ncgear.ratio.transmission import Lobes, Transmission


class UniformCrank(LawKeys):
    """Circular gears: the crank turns uniformly."""

    CHOICE = "circular gears"
    BEGINS = Begins.MACHINE

    def transmission(self, linkage: Mechanism, lobes: Lobes) -> Transmission:
        """A constant ratio."""
        from ncgear.ratio.laws.uniform import uniform_law

        return uniform_law(lobes)
