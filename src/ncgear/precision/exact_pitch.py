"""References of driving pitch curves at unit centre distance: closed forms of an ellipse, the baler's in 50 digits.

Of the baler, phi2 is differentiated with so many digits that a difference quotient is exact; r1 = w / (1 + w) with
w = dphi2/dphi1, and length and curvature follow from r1 and its derivatives in polar coordinates.
"""

from __future__ import annotations

from functools import cache
from itertools import pairwise

import numpy as np

from ncgear.numerics.arrays import Array
from ncgear.precision import baler, exact
from ncgear.precision.exact import Real

LENGTH_DIGITS = 25


def ellipse_length(eccentricity: float) -> Real:
    """4 a E(e), a = 1/2 being the major half axis: the foci are one centre distance from vertex to vertex."""
    from mpmath import mp

    with mp.workdps(exact.DIGITS):
        return 2 * mp.ellipe(mp.mpf(eccentricity) ** 2)


def ellipse_curvature(eccentricity: float, phi1: Array) -> Array:
    """(1 + e cos t)^3 / (p (1 + 2 e cos t + e^2)^(3/2)) at the polar angle t about a focus, p = (1 - e^2) / 2."""
    from mpmath import mp

    def at(angle: float) -> Real:
        e, cosine = mp.mpf(eccentricity), mp.cos(mp.mpf(angle))
        return 2 * (1 + e * cosine) ** 3 / ((1 - e**2) * mp.sqrt(1 + 2 * e * cosine + e**2) ** 3)

    with mp.workdps(exact.DIGITS):
        return np.array([float(at(angle)) for angle in phi1.tolist()])


@cache
def baler_length() -> Real:
    """Gauss-Legendre quadrature from joint to joint; raises ArithmeticError where it misses 20 digits itself."""
    from mpmath import mp

    def speed(phi1: Real) -> Real:
        radius, slope = _radius(phi1, 1)
        return mp.sqrt(radius**2 + slope**2)

    with mp.workdps(LENGTH_DIGITS):
        joints = [mp.mpf(angle) for angle in baler.law().transmission.joints_rad.tolist()]
        parts = [mp.quad(speed, ends, method="gauss-legendre", error=True) for ends in pairwise(joints)]
        missed = max(part[1] for part in parts)
        if missed > mp.mpf(10) ** -20:
            raise ArithmeticError(f"the reference's own quadrature is only good to {mp.nstr(missed, 2)}")
        return sum(part[0] for part in parts)


def baler_curvature(phi1: Array) -> Array:
    """At driving angles in rad between the joints, shape (n,)."""
    from mpmath import mp

    def at(angle: float) -> Real:
        radius, first, second = _radius(mp.mpf(angle), 2)
        return (radius**2 + 2 * first**2 - radius * second) / mp.sqrt(radius**2 + first**2) ** 3

    with mp.workdps(exact.DIGITS):
        return np.array([float(at(angle)) for angle in phi1.tolist()])


def _radius(phi1: Real, order: int) -> list[Real]:
    """r1 and its derivatives by phi1, up to the second."""
    turned, bent, *third = _slopes(phi1, order)
    second = [last / (1 + turned) ** 2 - 2 * bent**2 / (1 + turned) ** 3 for last in third]
    return [turned / (1 + turned), bent / (1 + turned) ** 2, *second]


def _slopes(phi1: Real, order: int) -> list[Real]:
    """dphi2/dphi1 and its derivatives up to an order."""
    from mpmath import mp

    law = baler.law()
    if phi1 > law.return_law.ends.start_rad:
        return list(mp.diffs(lambda angle: 1 / exact.return_ratio(law.return_law, angle), phi1, order))
    return list(mp.diffs(lambda angle: exact.driven_angle(law.stroke, baler.linkage(), angle), phi1, order + 1))[1:]
