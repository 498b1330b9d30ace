"""A quantity over one cycle as a piecewise Chebyshev form: mean, r.m.s., extremes and harmonics of the form itself.

Integrals are by Gauss-Legendre quadrature on each panel, exact for the polynomials there; nothing is sampled evenly, so
a joint of the law or a short return costs no accuracy.
"""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass
from functools import cached_property
from itertools import pairwise
from math import ceil, pi

import numpy as np
from numpy.polynomial import legendre
from scipy.integrate import tanhsinh

from ncgear.numerics import chebyshev
from ncgear.numerics.arrays import Array, ComplexArray
from ncgear.numerics.chebyshev import PiecewiseChebyshev
from ncgear.numerics.extrema import Extremum
from ncgear.numerics.zeros import all_zeros

NODES = 40
"""Gauss points of a panel: exact to degree 79, so for the square of a panel of degree 24, and for its product with half
a dozen radians of a wave to rounding error (tests/test_waveform.py)."""

RADIANS = 12.0
"""Largest advance of a wave on one panel when its harmonic is computed."""


MEAN_TOLERANCE = 1e-14
"""Relative tolerance of the quadrature of a vector's length: its estimate of its own error is too low, so that 1e-12
asked for gives 1e-10, and this gives 1e-12 (tests/test_waveform.py)."""


@dataclass(frozen=True)
class Statistics:
    """What tables give of a waveform."""

    mean: float
    rms: float
    minimum: float
    maximum: float

    @property
    def peak_to_peak(self) -> float:
        """Largest less smallest value."""
        return self.maximum - self.minimum


@dataclass(frozen=True, eq=False)
class Waveform:
    """A quantity on one cycle, from the first break of its form to the last."""

    form: PiecewiseChebyshev

    def __call__(self, angle_rad: Array) -> Array:
        """Values at angles within the cycle."""
        return self.form(angle_rad)

    @property
    def cycle_rad(self) -> float:
        """Length of the cycle."""
        return float(self.form.breaks[-1] - self.form.breaks[0])

    @property
    def mean(self) -> float:
        """Mean over the cycle."""
        angles, weights = gauss_points(self.form.breaks)
        return float(weights @ self.form(angles)) / self.cycle_rad

    @property
    def rms(self) -> float:
        """Root of the mean square."""
        angles, weights = gauss_points(self.form.breaks)
        return float(np.sqrt(weights @ self.form(angles) ** 2 / self.cycle_rad))

    @cached_property
    def extremes(self) -> tuple[Extremum, Extremum]:
        """Smallest and largest value, among the zeros of the derivative and both ends of every panel."""
        inner = all_zeros(self.form.differentiated())
        angles = np.concatenate([self.form.breaks, inner])
        values = np.concatenate([self.form(self.form.breaks), self.form(inner)])
        # At its left end a panel's value is the form's; at its right end it is the sum of the coefficients.
        angles = np.concatenate([angles, self.form.breaks[1:]])
        values = np.concatenate([values, self.form.coefficients.sum(axis=0)])
        low, high = int(np.argmin(values)), int(np.argmax(values))
        return Extremum(float(values[low]), float(angles[low])), Extremum(float(values[high]), float(angles[high]))

    @property
    def statistics(self) -> Statistics:
        """Mean, r.m.s., minimum and maximum."""
        lowest, highest = self.extremes
        return Statistics(self.mean, self.rms, lowest.value, highest.value)

    def harmonics(self, count: int) -> ComplexArray:
        """Fourier coefficients c_0 to c_count: f = c_0 + 2 Re sum of c_k exp(2 pi i k (phi - start) / cycle)."""
        breaks = _cut(self.form.breaks, RADIANS * self.cycle_rad / (2.0 * pi * max(count, 1)))
        angles, weights = gauss_points(breaks)
        turned = np.exp(-2j * pi / self.cycle_rad * np.outer(np.arange(count + 1), angles - breaks[0]))
        return np.asarray(turned @ (weights * self.form(angles)) / self.cycle_rad, dtype=np.complex128)


def waveform(function: Callable[[Array], Array], breaks: Array) -> Waveform:
    """A single quantity (shape (n,) to (n,)) that is smooth between breaks; raises NotSmooth as ``fitted`` does."""
    return Waveform(chebyshev.fitted(function, breaks))


def magnitude_statistics(along: Waveform, across: Waveform) -> Statistics:
    """Of the length of a vector given by two waveforms with the same breaks.

    Where the vector passes near zero its length has a kink; so the extremes are those of the smooth square, and the
    mean is taken between the square's minima, by tanh-sinh quadrature, which kinks at the ends do not hurt.
    """
    squared = squared_magnitude(along, across)
    lowest, highest = squared.extremes
    least, most = (float(np.sqrt(max(extremum.value, 0.0))) for extremum in (lowest, highest))
    return Statistics(_mean_root(squared), float(np.sqrt(max(squared.mean, 0.0))), least, most)


def squared_magnitude(along: Waveform, across: Waveform) -> Waveform:
    """The square of a vector's length."""
    return waveform(lambda angle: along(angle) ** 2 + across(angle) ** 2, along.form.breaks)


def gauss_points(breaks: Array) -> tuple[Array, Array]:
    """Points and weights of Gauss-Legendre quadrature on all panels, shape (NODES m,) each."""
    unit, weights = legendre.leggauss(NODES)
    left, right = breaks[:-1, None], breaks[1:, None]
    half = (right - left) / 2.0
    return ((left + right) / 2.0 + half * unit).ravel(), (half * weights).ravel()


def _mean_root(squared: Waveform) -> float:
    turns = np.unique(np.concatenate([squared.form.breaks, all_zeros(squared.form.differentiated())]))

    def length(angle: Array) -> Array:
        return np.sqrt(np.maximum(squared(angle), 0.0))

    tolerance = MEAN_TOLERANCE * float(np.ptp(turns)) * float(length(turns).max())
    parts = tanhsinh(length, turns[:-1], turns[1:], atol=tolerance, rtol=MEAN_TOLERANCE)
    return float(np.sum(parts.integral)) / squared.cycle_rad


def _cut(breaks: Array, widest: float) -> Array:
    """The breaks with more between them, so that no panel is wider."""
    parts = [np.linspace(a, b, ceil((b - a) / widest) + 1)[:-1] for a, b in pairwise(breaks.tolist())]
    return np.concatenate([*parts, breaks[-1:]])
