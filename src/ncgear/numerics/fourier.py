"""Integrals of smooth positive periodic functions over one turn, to rounding error.

A smooth periodic function is resolved by its values at evenly spaced points: the coefficients of its Fourier series,
which the fast transform gives, die away to rounding error.  Integral and derivatives follow coefficient by
coefficient.  Method: L. N. Trefethen, J. A. C. Weideman, "The exponentially convergent trapezoidal rule", SIAM
Review 56 (2014), 385-458.
"""

from __future__ import annotations

from collections.abc import Callable
from math import pi

import numpy as np

from ncgear.errors import Unanswered
from ncgear.numerics.arrays import Array, ComplexArray
from ncgear.numerics.turn_integral import DEGREE, TurnIntegral, closed

RESOLVED = 4e-15
"""Share of the largest coefficient below which the upper quarter of them counts as rounding error."""

MOST_NODES = 1 << 18
"""Most nodes; a function that needs more is noise.  A thousand harmonics with all their products need less."""


def turn_integral(sampled: Callable[[int], Array], fewest: int) -> TurnIntegral:
    """The integral of a positive function given by its values at N points of [0, 2 pi), ``sampled(N)``.

    The points are evenly spaced.  N is doubled from ``fewest`` (a power of two) on until the function is resolved;
    raises Unanswered where MOST_NODES do not resolve it.
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
    """Each of the N nodes is the one to count from up to half a node away.

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
