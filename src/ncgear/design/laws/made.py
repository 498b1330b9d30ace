"""The motions that ncgear itself gives a design: an even crank, and the ratios of a law that it has found."""

from __future__ import annotations

from collections.abc import Sequence
from typing import Any

from ncgear.design.laws.base import LawKeys
from ncgear.design.laws.harmonic_ratio import HarmonicRatio, SecondStage
from ncgear.design.laws.spline_ratio import SplineRatio


def even_motion(pairs: int) -> LawKeys:
    """A crank that turns evenly, by one pair of round gears or two."""
    return HarmonicRatio(law="harmonic_ratio", second_stage=SecondStage() if pairs > 1 else None)


def found_values(ratio: Sequence[float], second: Sequence[float] | None) -> dict[str, Any]:
    """The block ``motion`` of a design file with the ratios of a found law, and of its second pair where it has one."""
    return {
        "law": "spline_ratio",
        "ratio": list(ratio),
        **({} if second is None else {"second_stage": {"ratio": list(second)}}),
    }


def found_motion(ratio: Sequence[float], second: Sequence[float] | None) -> LawKeys:
    """The same as keys of a design."""
    return SplineRatio.model_validate(found_values(ratio, second))
