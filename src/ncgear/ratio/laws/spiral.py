"""Gears whose pitch curves are logarithmic spirals: open gears with the same pressure angle everywhere.

r1 = r0 exp(m phi1) makes the angle between the curve and the normal to its radius constant; its tangent is m.  With i12
= a / r1 - 1 the driven angle has a closed form, phi2 = ln((a - r0) / (a - r1)) / m, and the driven curve, r2 = a - r1,
is a logarithmic spiral as well, which falls as exp(-m phi2) (F. L. Litvin, A. Fuentes-Aznar, I. Gonzalez-Perez, K.
Hayasaka, "Noncircular Gears", Cambridge 2009).
"""

from __future__ import annotations

from functools import partial
from math import log

import numpy as np

from ncgear.errors import WrongInput
from ncgear.numerics import jet
from ncgear.numerics.arrays import Array
from ncgear.numerics.jet import Jet
from ncgear.ratio.transmission import OpenRange, Piece, Transmission

LEAST_GROWTH = 1e-6
"""Least tangent m of a spiral's angle: with less it is a circle to any tool, and the closed form loses digits."""


def logarithmic_spirals(ratio_start: float, ratio_end: float, driving_rad: float) -> Transmission:
    """The law whose ratio i12 runs from one value to another, both over 0, while the driving gear turns by an angle.

    Raises WrongInput for the key ``motion.ratio_end`` where both are equal.
    """
    # At unit centre distance r1 = 1 / (1 + i12).
    growth = log((1.0 + ratio_start) / (1.0 + ratio_end)) / driving_rad
    if abs(growth) < LEAST_GROWTH:
        raise WrongInput(
            f"{ratio_end:g}, nearly as much as ratio_start: the gears would be circles; another ratio is right, or the "
            "law ratio_expression with range_deg",
            key="motion.ratio_end",
        )

    driven_angle = partial(spiral_angle, ratio_start, growth)
    driven_rad = float(driven_angle(np.array([driving_rad]), 0).value[0])
    covered = OpenRange(driving_rad=driving_rad, driven_rad=driven_rad)
    return Transmission((Piece(0.0, driving_rad, driven_angle),), covered)


def spiral_angle(ratio_start: float, growth: float, phi1: Array, order: int) -> Jet:
    """phi2 in rad, with derivatives; ``growth`` is m."""
    # (1 - r0) / (1 - r1) = 1 / (1 - r0 (e^(m phi1) - 1) / (1 - r0)), whose logarithm is exact near phi1 = 0 too.
    values = -np.log1p(-np.expm1(growth * np.asarray(phi1, dtype=float)) / ratio_start) / growth
    if order == 0:
        return Jet(values[None, :])
    radius = jet.exp(Jet.variable(phi1, order - 1) * growth) * (1.0 / (1.0 + ratio_start))
    return (radius / (1.0 - radius)).integrated(values)
