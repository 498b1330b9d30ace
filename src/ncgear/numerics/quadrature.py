"""Gauss-Legendre quadrature between breaks, the integral of a slope as a judge of its function, high harmonics."""

from __future__ import annotations

from collections.abc import Callable
from functools import cache
from math import fsum, pi, sqrt

import numpy as np
from numpy.polynomial import legendre

from ncgear.numerics.arrays import Array
from ncgear.numerics.jet import Jet

NODES = 16
"""Gauss points of a panel of ``integrated_slope``: exact to degree 31."""

PANELS = 48
"""Fewest panels between both ends, so that some 800 points judge a function of one panel."""

SHARE = 0.382
"""Share of a panel at which it is cut: its points then differ from those of halves, which other forms use."""

AGREED = 1e-14
"""Difference between a panel's integral and the function's growth, relative to all growth, that needs no cut."""

CUTS = 12
"""Most cuts of a panel, to a hundred thousandth of it; a difference then is a fault of the function or its slope."""

MOST = 400
"""Most panels beyond the first ones that are cut at once; more panels differ only by rounding errors of the values."""


def gauss_points(breaks: Array, nodes: int) -> tuple[Array, Array]:
    """Points and weights of all panels between breaks (shape (m + 1,)), shape (m nodes,) each."""
    points, weights = _panels(breaks[:-1], breaks[1:], nodes)
    return points.ravel(), weights.ravel()


def integrated_slope(function: Callable[[Array], Jet], breaks: Array) -> float:
    """Integral of a function's derivative between the first and the last break, by points of its own.

    ``function`` maps points (shape (n,)) to a jet of order 1 or more; it is smooth between breaks.  Panels on which the
    integral differs from the growth of the function's values are cut until they agree or are too narrow.  A remaining
    difference of the result from the growth over the whole is a disagreement of value and derivative.
    """
    each = -(-PANELS // (breaks.size - 1))
    starts = breaks[:-1, None] + np.diff(breaks)[:, None] * np.arange(each) / each
    edges = np.append(starts.ravel(), breaks[-1])
    left, right = edges[:-1], edges[1:]
    parts: list[float] = []
    for cut in range(CUTS + 1):
        points, weights = _panels(left, right, NODES)
        integral = np.sum(function(points.ravel()).derivative(1).reshape(points.shape) * weights, axis=1)
        growth = function(right).value - function(left).value
        if not cut:
            whole = np.abs(growth).sum()
        final = (np.abs(integral - growth) <= AGREED * whole) | (cut == CUTS) | (left.size > edges.size + MOST)
        parts.extend(integral[final].tolist())
        left, right = left[~final], right[~final]
        if not left.size:
            break
        inner = left + SHARE * (right - left)
        left, right = np.concatenate([left, inner]), np.concatenate([inner, right])
    return fsum(parts)


def _panels(left: Array, right: Array, nodes: int) -> tuple[Array, Array]:
    unit, weights = _rule(nodes)
    half = (right - left)[:, None] / 2.0
    return (left + right)[:, None] / 2.0 + half * unit, half * weights


@cache
def _rule(nodes: int) -> tuple[Array, Array]:
    unit, weights = legendre.leggauss(nodes)
    return unit, weights


def rms_above(points: Array, weights: Array, values: Array, order: int) -> float:
    """Root mean square of a function's harmonics above an order; with order 0 only the mean is left out.

    Points of a quadrature over one period, their weights and the function's values have shape (n,).  Harmonics are
    subtracted from the values before these are squared, so that little is lost where little is left.
    """
    period = float(np.sum(weights))
    rest = values - float(np.sum(weights * values)) / period
    for number in range(1, order + 1):
        angle = 2.0 * pi * number / period * points
        for wave in (np.cos(angle), np.sin(angle)):
            rest = rest - 2.0 / period * float(np.sum(weights * values * wave)) * wave
    return sqrt(float(np.sum(weights * rest**2)) / period)
