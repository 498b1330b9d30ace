"""A quantity over one cycle as a piecewise Chebyshev form, with its mean, r.m.s. value, extremes and harmonics.

Integrals use Gauss-Legendre quadrature on each panel, which is exact for the polynomials there.  Nothing is sampled at
even steps, so a joint of the law or a short return costs no accuracy.
"""

from __future__ import annotations

from collections.abc import Callable
from functools import cached_property
from itertools import pairwise
from math import ceil, pi

import numpy as np
from scipy.integrate import tanhsinh

from ncgear.frozen import dataclass
from ncgear.numerics import chebyshev, quadrature
from ncgear.numerics.arrays import Array, ComplexArray
from ncgear.numerics.chebyshev import PiecewiseChebyshev
from ncgear.numerics.extrema import Extremum
from ncgear.numerics.zeros import all_zeros

NODES = 40
"""Gauss points of a panel: exact to degree 79, which is enough for the square of a panel of degree 24, and to rounding
error for its product with a wave over half a dozen radians (tests/test_waveform.py)."""

RADIANS = 12.0
"""Most radians of a wave on one panel when its harmonic is computed; wider panels are cut."""

MEAN_TOLERANCE = 1e-14
"""Relative tolerance of the quadrature of a vector's length.  It underestimates its own error: 1e-12 gives 1e-10, and
1e-14 gives 1e-12 (tests/test_waveform.py)."""


@dataclass(frozen=True)
class Statistics:
    """Mean, r.m.s. value and extremes of a quantity, as the tables give them."""

    mean: float
    rms: float
    minimum: float
    maximum: float

    @property
    def peak_to_peak(self) -> float:
        """Largest minus smallest value."""
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
        """Smallest and largest value with their angles: at zeros of the derivative or at an end of a panel."""
        inner = all_zeros(self.form.differentiated())
        angles = np.concatenate([self.form.breaks, inner])
        values = np.concatenate([self.form(self.form.breaks), self.form(inner)])
        # At a break the form has the value of the panel to the right; the panel to the left ends at the sum of its
        # coefficients.
        angles = np.concatenate([angles, self.form.breaks[1:]])
        values = np.concatenate([values, self.form.coefficients.sum(axis=0)])
        low, high = int(np.argmin(values)), int(np.argmax(values))
        return Extremum(float(values[low]), float(angles[low])), Extremum(float(values[high]), float(angles[high]))

    def harmonics(self, count: int) -> ComplexArray:
        """Fourier coefficients c_0 to c_count: f = c_0 + 2 Re sum of c_k exp(2 pi i k (phi - start) / cycle)."""
        widest = RADIANS * self.cycle_rad / (2.0 * pi * max(count, 1))
        panels = pairwise(self.form.breaks.tolist())
        starts = [np.linspace(a, b, ceil((b - a) / widest) + 1)[:-1] for a, b in panels]
        breaks = np.concatenate([*starts, self.form.breaks[-1:]])
        angles, weights = gauss_points(breaks)
        turned = np.exp(-2j * pi / self.cycle_rad * np.outer(np.arange(count + 1), angles - breaks[0]))
        return np.asarray(turned @ (weights * self.form(angles)) / self.cycle_rad, dtype=np.complex128)


def waveform(function: Callable[[Array], Array], breaks: Array) -> Waveform:
    """A quantity, of shapes (n,) to (n,), that is smooth between breaks; raises NotSmooth as ``fitted`` does."""
    return Waveform(chebyshev.fitted(function, breaks))


def waveforms(form: PiecewiseChebyshev) -> list[Waveform]:
    """One waveform for each function of a form with values of shape (m,)."""
    return [Waveform(PiecewiseChebyshev(form.breaks, column)) for column in np.moveaxis(form.coefficients, 2, 0)]


def magnitude_statistics(along: Waveform, across: Waveform) -> Statistics:
    """Statistics of the length of a vector given by two waveforms with the same breaks.

    Extremes are those of its smooth square; the mean is integrated between turning points, where the length may
    have kinks, by tanh-sinh quadrature.
    """
    squared = squared_magnitude(along, across)
    lowest, highest = squared.extremes
    least, most = (float(np.sqrt(max(extremum.value, 0.0))) for extremum in (lowest, highest))
    return Statistics(_mean_root(squared), float(np.sqrt(max(squared.mean, 0.0))), least, most)


def squared_magnitude(along: Waveform, across: Waveform) -> Waveform:
    """The square of the length of a vector given by two waveforms with the same breaks."""
    return waveform(lambda angle: along(angle) ** 2 + across(angle) ** 2, along.form.breaks)


def gauss_points(breaks: Array) -> tuple[Array, Array]:
    """Points and weights of Gauss-Legendre quadrature on all panels, shape (NODES m,) each."""
    return quadrature.gauss_points(breaks, NODES)


def _mean_root(squared: Waveform) -> float:
    """Mean of the square root, integrated between the turning points and the breaks."""
    turns = np.unique(np.concatenate([squared.form.breaks, all_zeros(squared.form.differentiated())]))

    def length(angle: Array) -> Array:
        return np.sqrt(np.maximum(squared(angle), 0.0))

    tolerance = MEAN_TOLERANCE * float(np.ptp(turns)) * float(length(turns).max())
    parts = tanhsinh(length, turns[:-1], turns[1:], atol=tolerance, rtol=MEAN_TOLERANCE)
    return float(np.sum(parts.integral)) / squared.cycle_rad
