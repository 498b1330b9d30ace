"""Real zeros of many polynomials of one degree at once, as the eigenvalues of their companion matrices."""

from __future__ import annotations

import numpy as np
from numpy.polynomial import Polynomial

from ncgear.numerics.arrays import Array


def real_roots(coefficients: Array, imaginary: float = np.inf) -> Array:
    """Real parts of the zeros of n polynomials, shape (degree, n), from the constant term upwards (degree + 1, n).

    NaN where a zero is missing, or where its imaginary part is over ``imaginary`` times 1 plus its size.
    """
    degree, count = len(coefficients) - 1, coefficients.shape[1]
    zeros = np.full((degree, count), np.nan, dtype=complex)
    with np.errstate(all="ignore"):
        # numpy's companion matrix with its rows and columns turned round, which keeps small zeros accurate.
        last = -coefficients[-2::-1] / coefficients[-1]
        regular = np.isfinite(last).all(axis=0)
        companion = np.zeros((int(regular.sum()), degree, degree))
        companion[:, np.arange(degree - 1), np.arange(1, degree)] = 1.0
        companion[:, :, 0] = last[:, regular].T
        zeros[:, regular] = np.linalg.eigvals(companion).T
        for number in np.nonzero(~regular & np.isfinite(coefficients).all(axis=0))[0]:
            found = Polynomial(np.trim_zeros(coefficients[:, number], "b")).roots()
            zeros[: found.size, number] = found
    size = imaginary * (1.0 + np.abs(zeros.real))
    return np.where(np.abs(zeros.imag) <= size, zeros.real, np.nan)
