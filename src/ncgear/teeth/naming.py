"""Flanks and teeth in the words of messages."""

from __future__ import annotations

from ncgear.numerics.angles import in_words
from ncgear.teeth.flank import Flanks


def tooth_name(flanks: Flanks, flank: int) -> str:
    """A flank in words, with the driving angle at which it crosses the pitch point."""
    facing = "front" if flanks.side[flank] > 0 else "back"
    phi1 = float(flanks.curve.driving_angle(flanks.crossing_mm[flank : flank + 1])[0])
    gear = flanks.curve.gear.value
    return f"the {facing} flank of tooth {flanks.tooth[flank]} of the {gear} gear (phi1 = {in_words(phi1)})"
