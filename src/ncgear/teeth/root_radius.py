"""The rounding at the tip of a rack cutter's tooth: how large it can be.  Plain numbers, so that keys can ask too."""

from __future__ import annotations

from math import cos, floor, sin, tan

PER_MODULE = 100
"""Steps of chosen root radii in a module: whole hundredths, like the radii of ISO 53."""

ROUNDING = 1e-9
"""Distance of a chosen radius from the greatest radius, as a share: at the greatest, rounding would decide its fit."""


def largest_root_radius(angles_rad: tuple[float, float], dedendum: float, half_width: float) -> float:
    """The greatest radius of the roundings at both corners, in the unit of the other lengths.

    ``angles_rad`` are the pressure angles of both flanks.  ``half_width`` is half the width of the cutter's tooth at
    the mid line; it has no backlash where it is a quarter of the pitch.  A greater radius would leave the tip no flat
    (the formula of ISO 53; of unequal flanks the mean of both sides counts) or begin above the mid line.  The result is
    negative where the tooth is pointed before it is ``dedendum`` high.
    """
    one, other = angles_rad
    slope, length = (tan(one) + tan(other)) / 2.0, (1.0 / cos(one) + 1.0 / cos(other)) / 2.0
    flat = (half_width - dedendum * slope) / (length - slope)
    return min(flat, dedendum / (1.0 - sin(min(one, other))))


def deepest_rounded(angles_rad: tuple[float, float], radius: float, half_width: float) -> float:
    """The greatest dedendum with room for roundings of a radius, lengths as above; 0 where there is none."""
    one, other = angles_rad
    slope, length = (tan(one) + tan(other)) / 2.0, (1.0 / cos(one) + 1.0 / cos(other)) / 2.0
    deepest = (half_width - radius * (length - slope)) / slope * (1.0 - ROUNDING)
    return deepest if deepest >= radius * (1.0 - sin(min(one, other))) else 0.0


def fitting_root_radius(wanted: float, largest: float) -> float:
    """A radius in modules: the ``wanted`` radius or, above the ``largest``, a radius that fits; at least 0."""
    return wanted if wanted <= largest else max(floor(largest * (1.0 - ROUNDING) * PER_MODULE) / PER_MODULE, 0.0)
