"""Angles in messages."""

from __future__ import annotations

from math import degrees


def in_words(angle_rad: float) -> str:
    """``4.465 rad (255.8 deg)``; rounding errors about zero are shown as zero."""
    rounded = round(angle_rad, 9) + 0.0
    return f"{rounded:.6g} rad ({degrees(rounded):.4g} deg)"
