"""The law ``spiral``: gears that turn less than once, on logarithmic spirals."""

from __future__ import annotations

from math import radians
from typing import TYPE_CHECKING, Any

from ncgear.design.keys.base import required
from ncgear.design.laws.base import Begins, LawKeys, RangeDeg

if TYPE_CHECKING:
    from ncgear.mechanisms.mechanism import Mechanism
    from ncgear.ratio.transmission import Lobes, Transmission


class Spiral(LawKeys):
    """Logarithmic spirals over a range of the driving angle; the pressure angle is the same everywhere."""

    CHOICE = "logarithmic spirals that turn less than once"
    BEGINS = Begins.SHAPE
    NARROWER_RATIO = "bring motion.ratio_start and motion.ratio_end nearer to each other"
    range_deg: RangeDeg = required(
        "turn of the driving gear from end to end, in degrees; the driven gear's angle follows"
    )
    ratio_start: float = required("transmission ratio i12 = dphi1/dphi2 at phi1 = 0", gt=0.0)
    ratio_end: float = required(
        "transmission ratio at the other end; between them the pitch radii are logarithmic spirals", gt=0.0
    )

    @property
    def is_open(self) -> bool:
        """Spirals do not close."""
        return True

    def transmission(self, linkage: Mechanism, lobes: Lobes) -> Transmission:
        """The law in closed form."""
        from ncgear.ratio.laws.spiral import logarithmic_spirals

        return logarithmic_spirals(self.ratio_start, self.ratio_end, radians(self.range_deg))

    def gentler(self, share: float, even_turn: str) -> dict[str, Any]:
        """Both ratios moved towards their geometric mean."""
        mean = (self.ratio_start * self.ratio_end) ** 0.5
        start, end = (mean * (ratio / mean) ** share for ratio in (self.ratio_start, self.ratio_end))
        return {"ratio_start": start, "ratio_end": end}
