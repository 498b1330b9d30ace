"""Harmonics of a periodic function: what is left of it beyond an order."""

from __future__ import annotations

from math import pi, sqrt

import numpy as np

from ncgear.numerics.arrays import Array


def rms_above(points: Array, weights: Array, values: Array, order: int) -> float:
    """Root mean square of a function's harmonics above an order.

    Points of a quadrature over one period, their weights and the function's values have shape (n,); with order 0 only
    the mean is left out.  The harmonics are taken off the values before these are squared, so that little is lost where
    little is left.
    """
    period = float(np.sum(weights))
    rest = values - float(np.sum(weights * values)) / period
    for number in range(1, order + 1):
        angle = 2.0 * pi * number / period * points
        for wave in (np.cos(angle), np.sin(angle)):
            rest = rest - 2.0 / period * float(np.sum(weights * values * wave)) * wave
    return sqrt(float(np.sum(weights * rest**2)) / period)
