"""Zeros of functions, from piecewise Chebyshev forms resolved to rounding error."""

from __future__ import annotations

from collections.abc import Callable

import numpy as np
from numpy.polynomial import chebyshev as series

from ncgear.numerics import chebyshev
from ncgear.numerics.arrays import Array, IndexArray
from ncgear.numerics.chebyshev import PiecewiseChebyshev

NEGLIGIBLE = 1e-14
"""Trailing coefficients, relative to the largest, that are dropped before roots are sought: rounding errors."""

REAL = 1e-7
"""Imaginary part of a double zero that rounding has split: the square root of the coefficients' accuracy."""


def first_zeros(function: Callable[[IndexArray, Array], Array], cuts: list[Array]) -> Array:
    """For each interval number i, the smallest t at which ``function(i, t)`` is no longer positive.

    ``cuts[i]`` holds the interval's ends and, between them, where the function may jump; the function takes interval
    numbers and arguments of shape (n,).  The interval's end where the function stays positive.
    """
    first = np.concatenate([cut[:-1] for cut in cuts])
    last = np.concatenate([cut[1:] for cut in cuts])
    owner = np.repeat(np.arange(len(cuts)), [len(cut) - 1 for cut in cuts])

    def stacked(place: Array) -> Array:
        piece = np.clip(place.astype(int), 0, first.size - 1)
        return function(owner[piece], first[piece] + (last - first)[piece] * (place - piece))

    form = chebyshev.fitted(stacked, np.arange(first.size + 1.0))
    zeros = np.array([cut[-1] for cut in cuts], dtype=float)
    doubtful = form.coefficients[0] <= np.abs(form.coefficients[1:]).sum(axis=0)
    for panel in np.nonzero(doubtful)[0][::-1]:
        place = _first_zero(form.coefficients[:, panel])
        if place is not None:
            start, end = form.breaks[panel], form.breaks[panel + 1]
            piece = int((start + end) / 2.0)
            share = start + (end - start) * (place + 1.0) / 2.0 - piece
            zeros[owner[piece]] = first[piece] + (last - first)[piece] * share
    return zeros


def all_zeros(form: PiecewiseChebyshev) -> Array:
    """Every zero of a single function, in rising order, shape (n,); none of a panel on which it is zero throughout."""
    doubtful = np.abs(form.coefficients[0]) <= np.abs(form.coefficients[1:]).sum(axis=0)
    found = [np.empty(0)]
    for panel in np.nonzero(doubtful & np.any(form.coefficients != 0.0, axis=0))[0]:
        start, end = form.breaks[panel], form.breaks[panel + 1]
        found.append(start + (end - start) * (_real_roots(form.coefficients[:, panel]) + 1.0) / 2.0)
    return np.unique(np.concatenate(found))


def _first_zero(coefficients: Array) -> float | None:
    """Smallest place in [-1, 1] at which a Chebyshev series is not positive, None where it is positive throughout."""
    if series.chebval(-1.0, coefficients) <= 0.0:
        return -1.0
    real = _real_roots(coefficients)
    return float(real.min()) if real.size else None


def _real_roots(coefficients: Array) -> Array:
    """Real zeros of a Chebyshev series in [-1, 1]."""
    kept = series.chebtrim(coefficients, NEGLIGIBLE * np.abs(coefficients).max())
    roots = np.atleast_1d(series.chebroots(kept))
    real: Array = roots.real[(np.abs(roots.imag) <= REAL) & (np.abs(roots.real) <= 1.0)]
    return real
