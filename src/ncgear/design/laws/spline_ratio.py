"""The law ``spline_ratio``: ln i12 as a spline of the driven angle, for one pair of gears or two."""

from __future__ import annotations

from math import pi
from typing import TYPE_CHECKING, Annotated, Any, ClassVar

from pydantic import Field

from ncgear.design.keys.base import (
    FULL_TURN,
    Faults,
    Model,
    Numbers,
    Positive,
    Several,
    angle,
    fault,
    key_of,
    not_rising,
    optional,
    required,
    unkept,
)
from ncgear.design.laws.base import Begins, DraggedPoint, LawKeys
from ncgear.numerics.bounds import shown_below

if TYPE_CHECKING:
    from ncgear.mechanisms.mechanism import Mechanism
    from ncgear.ratio.laws.over_driven_angle import StagedLaw
    from ncgear.ratio.transmission import Lobes, Transmission

FEWEST_POINTS, MOST_POINTS = 4, 2000
"""A spline through points h apart magnifies the rounding of their digits by 1/h^2 in the curvature of the pitch curves:
to 1e-5 for the ten digits of a file and 2000 points."""

NEAREST_TURNS = 1e-7
"""Least distance of driven angles, in turns.  With nearer angles the slope of the spline has fewer than nine digits."""

Ratios = Annotated[Several[Positive], Field(min_length=FEWEST_POINTS, max_length=MOST_POINTS)]
Angles = Annotated[Numbers, Field(min_length=FEWEST_POINTS, max_length=MOST_POINTS)]


class SecondStageRatios(Model):
    """The second pair's share of two pairs in series; this pair drives the crank, and the first pair has the rest."""

    ratio: Ratios = required(
        "ratios of the second pair at the same driven angles, up to a common factor that closes the cycle"
    )


class SplineRatio(LawKeys):
    """The logarithm of the ratio as a smooth curve over the driven angle; a common factor closes the cycle."""

    CHOICE = "the ratio as a smooth curve over the driven angle"
    BEGINS = Begins.POINTS
    EXAMPLES: ClassVar[dict[str, str]] = {"driven_angle_rad": "[0, 1.5, 3, 4.5]", "driven_angle_pi": "[0, 0.5, 1, 1.5]"}
    RULES = ("second_stage.ratio as many as ratio",)

    ratio: Ratios = required(
        "transmission ratios i12 = dphi1/dphi2 at the driven angles, up to a common factor that closes the cycle"
    )
    driven_angles: tuple[float, ...] = angle(
        "driven angles {unit}, strictly rising from 0 to under {turn}; left out: even steps",
        "driven_angle",
        of=Angles,
        absent=(),
    )
    second_stage: SecondStageRatios | None = optional(
        "given: two pairs in series make i12, both as `gears` describes; left out: one pair"
    )

    def _faults(self) -> Faults:
        if key := key_of(self, "driven_angle"):
            yield from unkept(self, f"{key} as many as ratio")
            angles, turn = getattr(self, key), FULL_TURN[key.removeprefix("driven_angle_")]
            if angles[0] != 0.0:
                yield fault(f"{key}.0", f"{angles[0]:g} is the first angle; 0 is right")
            yield from not_rising(key, angles, NEAREST_TURNS * turn)
            last = next((i for i, angle in enumerate(angles) if not angle <= (1.0 - NEAREST_TURNS) * turn), None)
            if last is not None:
                said = f"{angles[last]:g} is the end of the turn or beyond it, and the curve closes by itself"
                yield fault(f"{key}.{last}", f"{said}; under {shown_below(turn)} is right")

    @property
    def driven_angle(self) -> tuple[float, ...]:
        """Driven angles in rad."""
        # The same numbers, bit for bit, as even_steps of ratio/laws/spline.py, which the search for laws uses
        return self.driven_angles or tuple(step * (2.0 * pi / len(self.ratio)) for step in range(len(self.ratio)))

    @property
    def law_points(self) -> tuple[DraggedPoint, ...]:
        """Every point of the ratio; none for two pairs in series, which share the ratio."""
        if self.second_stage is not None:
            return ()
        return tuple(
            DraggedPoint(f"point {place + 1}", "ratio", None, angle / (2.0 * pi), "", f"ratio.{place}", value)
            for place, (angle, value) in enumerate(zip(self.driven_angle, self.ratio, strict=True))
        )

    def transmission(self, linkage: Mechanism, lobes: Lobes) -> Transmission:
        """The law of the whole machine, phi2(phi1)."""
        import numpy as np

        from ncgear.ratio.laws.spline import spline_ratio_law

        return spline_ratio_law(np.array(self.driven_angle), np.array(self.ratio), lobes)

    def staged(self) -> StagedLaw:
        """The law of both pairs in series."""
        assert self.second_stage is not None
        import numpy as np

        from ncgear.ratio.laws.spline import spline_ratio_staged

        lists = self.driven_angle, self.ratio, self.second_stage.ratio
        return spline_ratio_staged(*(np.array(values) for values in lists))

    def gentler(self, share: float, even_turn: str) -> dict[str, Any]:
        """A share of ln i12; empty for two pairs in series."""
        if self.second_stage is not None:
            return {}
        return {"ratio": tuple(value**share for value in self.ratio)}
