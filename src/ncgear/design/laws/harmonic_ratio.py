"""The law ``harmonic_ratio``: ln i12 as a series of harmonics of the driven angle, for one pair of gears or two."""

from __future__ import annotations

from math import cos, pi, sin
from typing import TYPE_CHECKING, Annotated, Any

from pydantic import Field

from ncgear.design.keys.base import Model, Several, optional
from ncgear.design.laws.base import Begins, DraggedPoint, LawKeys

if TYPE_CHECKING:
    from ncgear.mechanisms.mechanism import Mechanism
    from ncgear.ratio.laws.over_driven_angle import StagedLaw
    from ncgear.ratio.transmission import Lobes, Transmission

MOST_HARMONICS = 200

LARGEST_COEFFICIENT = 10.0
"""Largest coefficient of ln i12: a single harmonic of 7 has a range of 1:1e6, and the driven gear stands still."""

MOST_POINTS = 31
"""Most points that bend the curve of a series: the number of points for 15 harmonics."""

Coefficient = Annotated[float, Field(ge=-LARGEST_COEFFICIENT, le=LARGEST_COEFFICIENT)]
Coefficients = Annotated[Several[Coefficient], Field(max_length=MOST_HARMONICS)]


class SecondStage(Model):
    """The second pair's share of two pairs in series; this pair drives the crank, and the first pair has the rest."""

    cosine: Coefficients = optional("coefficients of cos(phi2), cos(2 phi2), ... in ln of the second pair's ratio", ())
    sine: Coefficients = optional("coefficients of sin(phi2), sin(2 phi2), ... in ln of the second pair's ratio", ())


class HarmonicRatio(LawKeys):
    """The logarithm of the ratio by harmonics of the driven angle; a constant that closes the cycle is added."""

    CHOICE = "the ratio by harmonics of the driven angle"
    BEGINS = Begins.FORMULA
    cosine: Coefficients = optional(
        "coefficients of cos(phi2), cos(2 phi2), ... in ln i12, phi2 being the driven angle", ()
    )
    sine: Coefficients = optional(
        "coefficients of sin(phi2), sin(2 phi2), ... in ln i12, phi2 being the driven angle", ()
    )
    second_stage: SecondStage | None = optional(
        "given: two pairs in series make i12, both as `gears` describes; left out: one pair"
    )

    @property
    def law_points(self) -> tuple[DraggedPoint, ...]:
        """Two points for each harmonic and one more, evenly spread; none for two pairs in series.

        A point bends the curve by the existing harmonics, with smaller weights for higher ones (Fejer's kernel), so
        that the curve beside it does not ring.
        """
        waves = range(1, max(len(self.cosine), len(self.sine)) + 1)
        if self.second_stage is not None or not waves:
            return ()
        count, weights = min(2 * len(waves) + 1, MOST_POINTS), [1.0 - wave / (len(waves) + 1) for wave in waves]
        found = []
        for place in range(count):
            share = place / count
            terms = (("cosine", self.cosine, cos), ("sine", self.sine, sin))
            coefficients = tuple(
                (
                    key,
                    (*own, *[0.0] * (len(waves) - len(own))),
                    tuple(w * of(2.0 * pi * k * share) / sum(weights) for k, w in zip(waves, weights, strict=True)),
                )
                for key, own, of in terms
            )
            found.append(DraggedPoint(f"point {place + 1}", "ratio", None, share, coefficients=coefficients))
        return tuple(found)

    def transmission(self, linkage: Mechanism, lobes: Lobes) -> Transmission:
        """The law of the whole machine, phi2(phi1)."""
        import numpy as np

        from ncgear.ratio.laws.harmonic import harmonic_law

        return harmonic_law(np.array(self.cosine), np.array(self.sine), lobes)

    def staged(self) -> StagedLaw:
        """The law of both pairs in series."""
        assert self.second_stage is not None
        import numpy as np

        from ncgear.ratio.laws.harmonic import staged_law

        coefficients = self.cosine, self.sine, self.second_stage.cosine, self.second_stage.sine
        return staged_law(*(np.array(values) for values in coefficients))

    def gentler(self, share: float, even_turn: str) -> dict[str, Any]:
        """A share of ln i12; empty for two pairs in series."""
        if self.second_stage is not None:
            return {}
        return {"cosine": tuple(share * c for c in self.cosine), "sine": tuple(share * s for s in self.sine)}
