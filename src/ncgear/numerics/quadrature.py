"""Integrals: Gauss-Legendre between breaks, of slopes as judges, over one turn with their inverses; high harmonics.

A turn is divided into cells, and Taylor polynomials about one place of each cell give function and integral to rounding
error.  ``numerics/periodic_cubic.py`` makes them for exponentials of splines.

A smooth periodic function is resolved by its values at evenly spaced points: the coefficients of its Fourier series,
which the fast transform gives, die away to rounding error.  Integral and derivatives follow coefficient by
coefficient.  Method: L. N. Trefethen, J. A. C. Weideman, "The exponentially convergent trapezoidal rule", SIAM
Review 56 (2014), 385-458.
"""

from __future__ import annotations

from collections.abc import Callable
from functools import cache, cached_property
from math import fsum, pi, sqrt

import numpy as np
from numpy.polynomial import legendre

from ncgear.errors import Unanswered
from ncgear.frozen import dataclass
from ncgear.numerics.arrays import Array, ComplexArray
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


DEGREE = 12
"""Degree of the Taylor polynomials; the cells must be so short that these are exact to rounding."""

NEWTON_STEPS = 20
"""Most steps to an inverse; convergence is quadratic."""


@dataclass(frozen=True, eq=False)
class TurnIntegral:
    """F(t) = integral of f from 0 to t, divided by the mean of f, so that F(2 pi) = 2 pi.

    ``values`` (shape (N + 1,)) are F at N + 1 rising ``nodes`` from 0 to 2 pi; ``coefficients`` (shape (DEGREE + 1, N +
    1)) are the coefficients of f / mean in powers of the distance from each node; ``starts`` (shape (N + 1,)) are the
    arguments from which on each node counts; ``bend`` is the largest |f'/f| at a node.
    """

    mean: float
    nodes: Array
    starts: Array
    values: Array
    coefficients: Array
    bend: float

    def at(self, arguments: Array) -> Array:
        """F at arguments in [0, 2 pi], shape (n,), with the same relative accuracy at 1e-9 as at 1."""
        node = np.searchsorted(self.starts, arguments, side="right") - 1
        swing, _ = _integral_and_rate(self._pairs[..., node], arguments - self.nodes[node])
        return self.values[node] + swing

    def inverse(self, values: Array) -> Array:
        """Arguments in [0, 2 pi] at which F has the values (n,), by Newton's method in their short cells."""
        start = np.interp(values, self.values, self.nodes)
        node = np.searchsorted(self.starts, start, side="right") - 1
        base: Array = self.nodes[node]
        return base + self._local_inverse(self._pairs[..., node], values - self.values[node], start - base)

    @cached_property
    def _pairs(self) -> Array:
        """Coefficients of the integral from each node on over the distance, and of its rate; (DEGREE + 1, 2, N + 1)."""
        return np.stack([self.coefficients * INTEGRATING, self.coefficients], axis=1)

    def _local_inverse(self, pairs: Array, target: Array, distance: Array) -> Array:
        """Distance from the node at which the integral from the node on is ``target``."""
        for _ in range(NEWTON_STEPS):
            integral, rate = _integral_and_rate(pairs, distance)
            step = (integral - target) / rate
            distance = distance - step
            # Newton's next step is at most the square of this one times half the bend of the function.
            if not step.size or np.max(np.abs(step)) ** 2 * self.bend <= 1e-16:
                return distance
        raise Unanswered("the integral of a periodic function could not be inverted")


def closed(periodic: Array) -> Array:
    """The values at the nodes, shape (..., N), with the first value repeated at the end."""
    return np.concatenate([periodic, periodic[..., :1]], axis=-1)


def _integral_and_rate(pairs: Array, distance: Array) -> tuple[Array, Array]:
    """The integral from the node to ``distance`` beyond it, and the function there, by Horner's rule."""
    both = pairs[-1].copy()
    for row in pairs[-2::-1]:
        both *= distance
        both += row
    return both[0] * distance, both[1]


INTEGRATING = 1.0 / np.arange(1.0, DEGREE + 2.0)[:, None]
"""Factor of each coefficient in the integral."""


RESOLVED = 4e-15
"""Share of the largest coefficient below which the upper quarter of the coefficients counts as rounding error."""

MOST_NODES = 1 << 18
"""Most nodes; a function that needs more is noise.  A thousand harmonics with all their products need less."""


def turn_integral(sampled: Callable[[int], Array], fewest: int) -> TurnIntegral:
    """The integral of a positive function by its values ``sampled(N)`` at N even points of [0, 2 pi).

    N is doubled from ``fewest`` (a power of two) until it is enough; raises Unanswered where MOST_NODES are too few.
    """
    count = fewest
    while count <= MOST_NODES:
        samples = sampled(count)
        spectrum = np.fft.rfft(samples)
        sizes = np.abs(spectrum)
        if np.max(sizes[-(count // 8) :]) <= RESOLVED * np.max(sizes):
            return _integrated(samples, spectrum)
        count *= 2
    raise Unanswered(f"a periodic function is not resolved by {MOST_NODES} points")


def _integrated(samples: Array, spectrum: ComplexArray) -> TurnIntegral:
    """Each of the N nodes counts up to half a node away.

    There the Taylor polynomial misses wave j by (pi j/N)^13 / 13! of its size: by 2e-10 for the shortest wave, which is
    itself rounding error, and by 1e-17 or less for waves up to N/8.
    """
    count, mean = samples.size, float(spectrum[0].real) / samples.size
    waves = np.arange(spectrum.size)
    # The shortest wave is seen at its crests only, and has no derivative there.
    turning = 1j * np.where(waves < count // 2, waves, 0.0)
    orders = np.arange(1, DEGREE + 1)[:, None]
    powers = np.cumprod(np.broadcast_to(turning, (DEGREE, waves.size)) / orders, axis=0)
    rows = np.vstack([samples / mean, np.fft.irfft(powers * spectrum / mean, count)])
    swing = np.fft.irfft(np.divide(spectrum, turning * mean, out=np.zeros_like(spectrum), where=turning != 0.0), count)
    nodes = np.linspace(0.0, 2.0 * pi, count + 1)
    values = nodes + closed(swing - swing[0])
    starts = nodes - nodes[1] / 2.0
    return TurnIntegral(mean, nodes, starts, values, closed(rows), float(np.max(np.abs(rows[1]) / rows[0])))
