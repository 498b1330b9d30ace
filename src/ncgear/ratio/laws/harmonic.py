"""A law by harmonics of its ratio: ln i12 is a trigonometric series over the driven angle.

    ln i12 = c0 + sum_k (cosine_k cos(k n2 phi2) + sine_k sin(k n2 phi2))

c0 closes the cycle (``ratio/laws/over_driven_angle.py``).  Two pairs in series have a series each.
"""

from __future__ import annotations

from math import log

import numpy as np

from ncgear.errors import NoSuchMechanism, WrongInput
from ncgear.frozen import dataclass
from ncgear.numerics.arrays import Array, powers
from ncgear.numerics.jet import Jet
from ncgear.numerics.quadrature import TurnIntegral, turn_integral
from ncgear.ratio.laws.over_driven_angle import WIDEST, LogRatioLaw, StagedLaw
from ncgear.ratio.transmission import Lobes, Transmission

FEWEST_NODES = 64
"""Fewest nodes of the integral over a period; a law of many harmonics begins with 8 to 16 nodes for each."""

NODES_PER_KNOT = 8
"""Nodes of the integral between two knots, so that extrema are searched as finely as the law is resolved."""


@dataclass(frozen=True, eq=False)
class LogSeries:
    """sum_k (cosine_k cos kt + sine_k sin kt), k from 1; both of shape (harmonics,)."""

    cosine: Array
    sine: Array

    @property
    def harmonics(self) -> int:
        """Number of harmonics."""
        return self.cosine.size

    def sampled(self, count: int) -> Array:
        """Values at ``count`` evenly spaced points of [0, 2 pi), more than two for each harmonic."""
        spectrum = np.zeros(count // 2 + 1, dtype=complex)
        spectrum[1 : self.harmonics + 1] = (self.cosine - 1j * self.sine) * (count / 2.0)
        return np.fft.irfft(spectrum, count)

    def at(self, angle: Array, order: int) -> Jet:
        """The series with derivatives by t at angles t in rad, shape (n,)."""
        waves = np.arange(1, self.harmonics + 1)
        turned = powers(np.exp(1j * angle), self.harmonics + 1)[1:]
        in_phase, quarter_on = self.cosine, self.sine
        rows = np.empty((2, order + 1, self.harmonics))
        for k in range(order + 1):
            rows[0, k], rows[1, k] = in_phase, quarter_on
            in_phase, quarter_on = quarter_on * waves / (k + 1), -in_phase * waves / (k + 1)
        return Jet(rows[0] @ turned.real + rows[1] @ turned.imag)


def series_of(values: Array, most: int) -> LogSeries:
    """The series, of at most ``most`` harmonics, through values at evenly spaced points of [0, 2 pi), shape (n,).

    The mean is left out, and so are the last harmonics below NOISE.
    """
    waves = np.fft.rfft(values)[1 : most + 1] * (2.0 / values.size)
    heard = np.nonzero(np.abs(waves) > NOISE)[0]
    kept = waves[: heard[-1] + 1 if heard.size else 0]
    return LogSeries(kept.real, -kept.imag)


NOISE = 1e-13
"""Harmonics below this are rounding, which some thousand values leave."""


def harmonic_law(cosine: Array, sine: Array, lobes: Lobes) -> Transmission:
    """The law of coefficients from the first harmonic on, shapes (m,) and (n,); no coefficients are the uniform law.

    Raises WrongInput for coefficients that are not finite, NoSuchMechanism where the ratio's range is beyond 1e6; keys
    ``motion.cosine`` and ``motion.sine``.
    """
    return closed_harmonics(cosine, sine, lobes).transmission


def closed_harmonics(cosine: Array, sine: Array, lobes: Lobes, key: str = "motion") -> LogRatioLaw:
    """The law of ``harmonic_law`` with its series at hand and without a search for its extrema.

    Raises the same errors, with ``key`` in place of ``motion``.
    """
    series = _series(cosine, sine, key)
    integral = _closing_integral(series, key)
    return LogRatioLaw(series, integral, integral.nodes[NODES_PER_KNOT:-1:NODES_PER_KNOT], lobes)


def _series(cosine: Array, sine: Array, key: str) -> LogSeries:
    """Both lists of coefficients at the length of the longer; raises WrongInput where one is not finite."""
    for name, values in (("cosine", cosine), ("sine", sine)):
        wrong = np.nonzero(~np.isfinite(values))[0]
        if wrong.size:
            raise WrongInput(f"{values[wrong[0]]} given; a finite number is needed", key=f"{key}.{name}.{wrong[0]}")
    harmonics = max(cosine.size, sine.size)
    padded = [np.concatenate([values, np.zeros(harmonics - values.size)]) for values in (cosine, sine)]
    return LogSeries(*padded)


def _closing_integral(series: LogSeries, key: str) -> TurnIntegral:
    """x over t; raises NoSuchMechanism where the ratio's range is beyond 1e6."""
    fewest = max(FEWEST_NODES, 1 << (8 * series.harmonics - 1).bit_length())
    with np.errstate(all="ignore"):
        span = float(np.ptp(series.sampled(fewest)))
    if not span <= WIDEST:
        raise _beyond_sense(series, span, key)
    # No overflow: the series' mean is zero, so within a span of ln 1e6 its values stay below that.
    return turn_integral(lambda count: np.exp(series.sampled(count)), fewest)


def _beyond_sense(series: LogSeries, span: float, key: str) -> NoSuchMechanism:
    """The refusal of a range of the ratio of e^span, at the largest coefficient."""
    name, values = max((("cosine", series.cosine), ("sine", series.sine)), key=lambda named: np.max(np.abs(named[1])))
    worst = int(np.argmax(np.abs(values)))
    # As a power of ten: e^span may be more than a number can hold.
    return NoSuchMechanism(
        f"{values[worst]:g} is the largest coefficient, and ln i12 spans {span:.4g}, which is a range of the ratio of "
        f"1:1e{span / log(10.0):.4g}; over 1:1e6 the driven gear stands still. Make the coefficients smaller",
        key=f"{key}.{name}.{worst}",
    )


def staged_law(cosine: Array, sine: Array, second_cosine: Array, second_sine: Array) -> StagedLaw:
    """The law of the coefficients of f and g from the first harmonic on; the lists, shape (n,), may differ in length.

    Raises WrongInput for coefficients that are not finite and NoSuchMechanism where a ratio's range is beyond 1e6; keys
    ``motion.cosine``, ``motion.second_stage.cosine`` and the like.
    """
    return StagedLaw(
        closed_harmonics(cosine, sine, Lobes()),
        closed_harmonics(second_cosine, second_sine, Lobes(), "motion.second_stage"),
    )
