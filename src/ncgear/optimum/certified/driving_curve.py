"""Three places in a row of a convex driving curve: what their values keep, as linear relations.

The driving curve, 1/r1 = (1 + 1/s)/a, is convex where q'' <= 2 + 2 sqrt(q) + q'^2/q, with q = s^2 and primes by phi2.
With y = ln q that is y'' <= 2 exp(-y) + 2 exp(-y/2).
"""

from __future__ import annotations

from math import pi

import numpy as np

from ncgear.numerics.arrays import Array, IndexArray


def curved(low: Array, high: Array, before: Array, after: Array) -> tuple[Array, Array, Array, IndexArray]:
    """y0 >= first y- + second y+ + rest where y'' <= 2 exp(-y) + 2 exp(-y/2) and y lies between ``low`` and ``high``.

    The lengths of the cells on both sides, shape (k,); the last tells for which places it holds.  The right side lies
    below its chord, a - c y.  The solutions of y'' + c y = a are a/c and waves of sqrt(c) per rad; the maximum
    principle holds while the places are less than half a wave apart.
    """
    wide = np.maximum(high - low, 1e-12)
    c = -(2.0 * np.exp(-low) * np.expm1(-wide) + 2.0 * np.exp(-low / 2.0) * np.expm1(-wide / 2.0)) / wide
    a = 2.0 * np.exp(-low) + 2.0 * np.exp(-low / 2.0) + c * low
    k = np.sqrt(c)
    whole = np.sin(k * (before + after))
    rest = -2.0 * np.sin(k * before / 2.0) * np.sin(k * after / 2.0) / np.cos(k * (before + after) / 2.0) * a / c
    good = np.nonzero(k * (before + after) < 0.9 * pi)[0]
    return np.sin(k * after) / whole, np.sin(k * before) / whole, rest, good


def along(rate: Array, about: Array, before: Array, after: Array) -> tuple[Array, Array, Array]:
    """q0 >= first q- + second q+ + rest where q'' <= 2 + 2 sqrt(q) + 2 rate q' - rate^2 q, shape (k,).

    The root of q lies below its tangent at ``about``, a value near q0; where that would lose digits, it is taken
    elsewhere.  With c = rate^2 - 1/sqrt(tangent) and k^2 = rate^2 - c the solutions are exp(rate t) times sinh of k t.
    """
    tangent = _tangent(rate**2, about)
    c, d = rate**2 - 1.0 / np.sqrt(tangent), 2.0 + np.sqrt(tangent)
    k = tangent**-0.25
    whole = np.sinh(k * (before + after))
    first = np.exp(rate * before) * np.sinh(k * after) / whole
    second = np.exp(-rate * after) * np.sinh(k * before) / whole
    rest: Array = d * (1.0 - first - second) / c
    return first, second, rest


LEAST_C = 0.3
"""Size of c from which 1 - first - second, about c h^2/2, keeps twelve digits on cells of a degree or two."""


def _tangent(product: Array, about: Array) -> Array:
    """The value of q whose tangent is used: the one given, or the nearest with a c that is not too small."""
    c = product - 1.0 / np.sqrt(about)
    lifted = np.where(c >= 0.0, product - LEAST_C, product + LEAST_C)
    lifted = np.where(lifted > 0.0, lifted, product + LEAST_C)
    moved = 1.0 / np.maximum(lifted, 1e-3) ** 2
    found: Array = np.where(np.abs(c) < LEAST_C, moved, about)
    return found
