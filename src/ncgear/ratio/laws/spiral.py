"""Gears whose pitch curves are logarithmic spirals: open gears with the same pressure angle everywhere.

r1 = r0 exp(k phi1) makes the angle between the curve and its radius constant, cot = k.  With i12 = a / r1 - 1 the
driven angle has a closed form, phi2 = ln((a - r0) / (a - r1)) / k, and the driven curve, r2 = a - r1, is a logarithmic
spiral as well, with -k by its own angle (F. L. Litvin et al., "Noncircular Gears", Cambridge 2009, chapter 6).
"""

from __future__ import annotations

from math import log

import numpy as np

from ncgear.numerics import jet
from ncgear.numerics.arrays import Array
from ncgear.numerics.jet import Jet
from ncgear.ratio.transmission import Piece, Range, Transmission


def logarithmic_spirals(ratio_start: float, ratio_end: float, driving_rad: float) -> Transmission:
    """The law whose ratio i12 runs from one value to another, both over 0 and not equal, over a driving angle."""
    # At unit centre distance r1 = 1 / (1 + i12).
    start, growth = 1.0 / (1.0 + ratio_start), log((1.0 + ratio_start) / (1.0 + ratio_end)) / driving_rad

    def driven_angle(phi1: Array, order: int) -> Jet:
        angle = Jet.variable(phi1, order)
        # (1 - r0) / (1 - r1) = 1 / (1 - r0 (e^(k phi1) - 1) / (1 - r0)), whose logarithm is exact near phi1 = 0 too.
        grown = jet.exp(angle * growth) - 1.0
        values = -np.log1p(-np.expm1(growth * np.asarray(phi1, dtype=float)) / ratio_start) / growth
        if order == 0:
            return Jet(values[None, :])
        slope = (1.0 + grown) * start / (1.0 - (1.0 + grown) * start)
        return slope.truncated(order - 1).integrated(values)

    driven_rad = float(driven_angle(np.array([driving_rad]), 0).value[0])
    covered = Range(driving_rad=driving_rad, driven_rad=driven_rad)
    return Transmission((Piece(0.0, driving_rad, driven_angle),), covered)


def constant_angle_rad(ratio_start: float, ratio_end: float, driving_rad: float) -> float:
    """The angle between the curves' tangent and the normal to the centre line."""
    return float(np.arctan(log((1.0 + ratio_start) / (1.0 + ratio_end)) / driving_rad))
