"""The law ``ellipse``: elliptical gears."""

from __future__ import annotations

from typing import TYPE_CHECKING, Any

from ncgear.design.keys.base import angle, required
from ncgear.design.laws.base import Begins, LawKeys, LawNumber

if TYPE_CHECKING:
    from ncgear.mechanisms.mechanism import Mechanism
    from ncgear.ratio.transmission import Lobes, Transmission


class Ellipse(LawKeys):
    """Elliptical gears; with lobes 1:1 two equal ellipses that turn about a focus each."""

    CHOICE = "elliptical gears"
    BEGINS = Begins.SHAPE
    eccentricity: float = required("eccentricity of the ellipse, 0 (a circle) to under 1", ge=0.0, lt=1.0)
    phase: float = angle("driving angle {unit} at which the driving radius is smallest")

    @property
    def law_numbers(self) -> tuple[LawNumber, ...]:
        """The eccentricity."""
        return (LawNumber("eccentricity", "eccentricity", self.eccentricity),)

    def transmission(self, linkage: Mechanism, lobes: Lobes) -> Transmission:
        """Elliptical gears, or similar gears with several lobes."""
        from ncgear.ratio.laws.ellipse import elliptical_law

        return elliptical_law(self.eccentricity, self.phase, lobes)

    def gentler(self, share: float, even_turn: str) -> dict[str, Any]:
        """A smaller eccentricity."""
        return {"eccentricity": share * self.eccentricity}
