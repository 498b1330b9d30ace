"""The area of a circular gear by Green's theorem on the closed form of its boundary."""

from __future__ import annotations

from functools import cache
from math import pi
from typing import Any

from ncgear.precision.circular_gear import CircularGear

DIGITS = 30
"""Twice those of the numbers that the area is compared with."""


@cache
def area_mm2(gear: CircularGear) -> float:
    """Arcs and involutes in closed form, fillets by quadrature.

    An involute unwound from t to t' rad sweeps rb^2 (t'^3 - t^3) / 6 about the axis.
    """
    from mpmath import mp, mpf

    with mp.workdps(DIGITS):
        base, tip, root = mpf(gear.base_radius_mm), mpf(gear.tip_radius_mm), mpf(gear.root_radius_mm)
        unwound = [mp.sqrt((mpf(radius) / base) ** 2 - 1) for radius in (gear.tip_radius_mm, gear.joint_radius_mm)]
        involute = base**2 * (unwound[0] ** 3 - unwound[1] ** 3) / 6
        low, high = gear.fillet_mm
        arcs = (tip**2 * gear.tip_angle_rad + root**2 * (pi / gear.teeth - low / gear.pitch_radius_mm)) / 2
        fillet = mp.quad(lambda sigma: _swept(gear, sigma), [mpf(high), mpf(low)])
        return float(2 * gear.teeth * (arcs + involute + fillet))


def _swept(gear: CircularGear, sigma: Any) -> Any:
    """Half the product of a fillet's point and its derivative across, at a number of mpmath."""
    from mpmath import mp

    return mp.im(mp.conj(_fillet(gear, sigma)) * mp.diff(lambda at: _fillet(gear, at), sigma)) / 2


def _fillet(gear: CircularGear, sigma: Any) -> Any:
    """The point one radius of the rounding beyond its centre, as seen from the pitch point."""
    from mpmath import mp, mpf

    along, depth = mpf(gear.center_along_mm) - sigma, mpf(gear.center_depth_mm)
    reach = 1 + mpf(gear.rack.root_radius_mm) / mp.hypot(along, depth)
    turned = mp.expj(sigma / mpf(gear.pitch_radius_mm))
    return turned * mp.mpc(mpf(gear.pitch_radius_mm) - reach * depth, reach * along)
