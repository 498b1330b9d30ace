"""Polynomials on [0, 1]: where they are least, what they integrate to."""

from __future__ import annotations

from functools import cache

import numpy as np
from numpy.polynomial import Polynomial, legendre

from ncgear.numerics.arrays import Array


def lowest(polynomial: Polynomial) -> tuple[float, float]:
    """Smallest value on [0, 1] and where."""
    inner = polynomial.deriv().roots()
    candidates = np.clip(inner.real[np.abs(inner.imag) < 1e-9], 0.0, 1.0)
    points = np.concatenate([candidates, np.linspace(0.0, 1.0, 65)])
    values = polynomial(points)
    index = int(np.argmin(values))
    return float(values[index]), float(points[index])


def unit_integral(polynomial: Polynomial) -> float:
    """Its integral over [0, 1]."""
    antiderivative = polynomial.integ()
    return float(antiderivative(1.0) - antiderivative(0.0))


@cache
def panels(count: int = 16, points: int = 16) -> tuple[Array, Array]:
    """Composite Gauss-Legendre rule on [0, 1], panels shorter towards the ends."""
    edges = (1.0 - np.cos(np.linspace(0.0, np.pi, count + 1))) / 2.0
    unit, weights = legendre.leggauss(points)
    middle, half = (edges[1:] + edges[:-1]) / 2.0, np.diff(edges) / 2.0
    return (middle[:, None] + half[:, None] * unit).ravel(), (half[:, None] * weights).ravel()
