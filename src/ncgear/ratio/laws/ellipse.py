"""Elliptical gears, and their relatives of higher order with any number of lobes.

The driving curve is r1 = p / (1 + e cos x), x = n1 (phi1 - phase); i12 = a / r1 - 1 = K + M cos x.  Closure of the
driven curve, K^2 - M^2 = (n2 / n1)^2, gives a / p, and the driven angle follows in closed form.  With n1 = n2 = 1
both curves are equal ellipses about a focus (F. L. Litvin et al., "Noncircular Gears", Cambridge 2009, chapters 4 and
5).
"""

from __future__ import annotations

from functools import partial
from math import sqrt

import numpy as np

from ncgear.numerics import jet
from ncgear.numerics.arrays import Array
from ncgear.numerics.jet import Jet
from ncgear.ratio.transmission import Lobes, Piece, Transmission


def elliptical_law(eccentricity: float, phase_rad: float, lobes: Lobes) -> Transmission:
    """The law of eccentricity e (0 <= e < 1), with the driving gear's smallest radius at phi1 = ``phase_rad``."""
    ratio = lobes.driven / lobes.driving
    squared = eccentricity**2
    size = (1.0 + sqrt(squared + ratio**2 * (1.0 - squared))) / (1.0 - squared)
    largest = size - 1.0 + eccentricity * size
    skew = (largest - ratio) / (largest + ratio)
    start = float(elliptical_angle(skew, phase_rad, lobes, 0.0, np.zeros(1), 0).value[0])
    driven_angle = partial(elliptical_angle, skew, phase_rad, lobes, start)
    return Transmission((Piece(0.0, lobes.driving_period_rad, driven_angle),), lobes)


def elliptical_angle(skew: float, phase_rad: float, lobes: Lobes, start_rad: float, phi1: Array, order: int) -> Jet:
    """phi2 in rad, with derivatives, less ``start_rad``, its value at phi1 = 0."""
    around = (Jet.variable(phi1, order) - phase_rad) * float(lobes.driving)
    sine, cosine = jet.sin_cos(around)
    return (around - 2.0 * jet.arctan(skew * sine / (skew * cosine + 1.0))) * (1.0 / lobes.driven) - start_rad
