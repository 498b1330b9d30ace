"""Units of the design files and the papers in those of the code, and angles as messages write them."""

from __future__ import annotations

from math import degrees, pi

RAD_S_PER_RPM = pi / 30.0
"""One turn per minute in rad/s."""

N_PER_KG_MM_S2 = 1e-3
"""One kg mm/s^2 in N; likewise one kg mm^2/s^2 in N mm."""

N_M_PER_N_MM = 1e-3
"""One N mm in N m."""


def in_words(angle_rad: float) -> str:
    """``4.465 rad (255.8 deg)``; rounding errors about zero are shown as zero."""
    rounded = round(angle_rad, 9) + 0.0
    return f"{rounded:.6g} rad ({degrees(rounded):.4g} deg)"
