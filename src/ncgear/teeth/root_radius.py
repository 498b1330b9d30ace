"""The rounding at the tip of a rack cutter's tooth: how large it can be.  Plain numbers, so that keys can ask too."""

from __future__ import annotations

from math import cos, floor, sin, tan

PER_MODULE = 100
"""Root radii that are chosen are whole hundredths of the module, as those of ISO 53 are."""

ROUNDING = 1e-9
"""Share by which a chosen radius stays clear of the greatest one, where rounding would decide whether it fits."""


def largest_root_radius(pressure_angle_rad: float, dedendum: float, half_width: float) -> float:
    """The greatest radius of the rounding, in the unit of the other lengths.

    ``half_width`` is half the width of the cutter's tooth at the mid line; it has no backlash where it is a quarter of
    the pitch.  A greater radius would leave the tip no flat (the formula of ISO 53) or begin above the mid line.  The
    result is negative where the tooth is pointed before it is ``dedendum`` high.
    """
    flat = (half_width - dedendum * tan(pressure_angle_rad)) / (1.0 / cos(pressure_angle_rad) - tan(pressure_angle_rad))
    return min(flat, dedendum / (1.0 - sin(pressure_angle_rad)))


def fitting_root_radius(wanted: float, largest: float) -> float:
    """A radius in modules: the one that is ``wanted`` or, where that exceeds the ``largest``, what fits; 0 at least."""
    return wanted if wanted <= largest else max(floor(largest * (1.0 - ROUNDING) * PER_MODULE) / PER_MODULE, 0.0)
