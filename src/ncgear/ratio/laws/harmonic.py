"""A law by harmonics of its ratio, for one pair of gears or shared by two pairs in series.

One pair: ln i12 is a trigonometric series over the driven angle.

    ln i12 = c0 + sum_k (cosine_k cos(k n2 phi2) + sine_k sin(k n2 phi2))

The logarithm keeps every ratio positive whatever the coefficients are, and the motion of the mechanism depends on the
driven angle; so this is the form in which laws are optimised and stored.  c0 closes the cycle: with x = n1 phi1 and
t = n2 phi2, dx/dt = exp(series) / mean(exp(series)), whose integral over a turn is a turn.

Two pairs: ln i12 = ln iA + ln iB, both as series over the crank's angle phi2.

    ln i12 = f(phi2),   ln iB = g(phi2),   ln iA = f - g

The second pair drives the crank, so phi2 is its own driven angle and its ratio iB is such a series without conversion.
The first pair drives the shaft between, whose angle phim = integral of exp(g) dphi2 comes round with the crank.  With
t = phi2, dphim/dphi1 = exp(g - f) and dt/dphi1 = exp(-f), each with the constant that closes it.
"""

from __future__ import annotations

from dataclasses import dataclass
from math import factorial, log, pi

import numpy as np

from ncgear.errors import NoSuchMechanism, WrongInput
from ncgear.numerics import jet
from ncgear.numerics.arrays import Array
from ncgear.numerics.fourier import TurnIntegral, turn_integral
from ncgear.numerics.jet import Jet
from ncgear.ratio.transmission import STANDSTILL, Lobes, Pair, Piece, Train, Transmission, on_driving_shaft

FEWEST_NODES = 64
"""Fewest nodes of the integral over a period; a law of many harmonics begins with 8 to 16 nodes for each."""

NODES_PER_KNOT = 8
"""Nodes of the integral between two knots, so that extrema are looked for as finely as the law is resolved."""


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
        values: Array = np.fft.irfft(spectrum, count)
        return values

    def at(self, angle: Array, order: int) -> Jet:
        """The series with derivatives by t at angles t in rad, shape (n,)."""
        waves = np.arange(1, self.harmonics + 1)
        turned = waves[:, None] * angle
        in_phase, quarter_on = self.cosine, self.sine
        rows = np.empty((2, order + 1, self.harmonics))
        for k in range(order + 1):
            rows[0, k], rows[1, k] = in_phase, quarter_on
            in_phase, quarter_on = quarter_on * waves / (k + 1), -in_phase * waves / (k + 1)
        return Jet(rows[0] @ np.cos(turned) + rows[1] @ np.sin(turned))


@dataclass(frozen=True, eq=False)
class HarmonicLaw:
    """The driven angle of one period: the inverse of ``integral``, which is the driving angle over the driven one.

    ``integral`` counts both angles in turns of 2 pi a period.
    """

    series: LogSeries
    integral: TurnIntegral
    lobes: Lobes

    def driven_angle(self, phi1: Array, order: int) -> Jet:
        """phi2 in rad with derivatives by phi1, at driving angles of one period in rad, shape (n,)."""
        turned = self.integral.inverse(np.clip(phi1 * self.lobes.driving, 0.0, 2.0 * pi))
        if not order:
            return Jet(turned[None, :] / self.lobes.driven)
        speed = self.speed(turned, order - 1)
        scale = float(self.lobes.driving) ** np.arange(order + 1) / self.lobes.driven
        return Jet(_jet_by_x(turned, speed, speed).coefficients * scale[:, None])

    def speed(self, turned: Array, order: int) -> Jet:
        """w = dt/dx with derivatives by t, at t = n2 phi2 in rad, shape (n,)."""
        return jet.exp(-self.series.at(turned, order)) * self.integral.mean

    @property
    def transmission(self) -> Transmission:
        """The law with its range looked for; raises NoSuchMechanism where the driven gear all but stops."""
        return Transmission((Piece(0.0, self.lobes.driving_period_rad, self.driven_angle, self.knots_rad),), self.lobes)

    @property
    def knots_rad(self) -> tuple[float, ...]:
        """Driving angles between which nothing happens that is finer than a few nodes."""
        inner = self.integral.values[NODES_PER_KNOT:-1:NODES_PER_KNOT]
        return tuple((inner / self.lobes.driving).tolist())


def _jet_by_x(values: Array, rate: Jet, speed: Jet) -> Jet:
    """The jet by x, one order more, of a function with these values, shape (n,), whose derivative by x is ``rate``.

    ``rate`` and ``speed`` = dt/dx are jets by t of the same order: the next derivative by x is ``speed`` times the
    derivative by t of the one before.
    """
    coefficients = np.empty((rate.order + 2, values.size))
    coefficients[0], coefficients[1] = values, rate.value
    for k in range(2, rate.order + 2):
        rate = speed.truncated(rate.order - 1) * rate.differentiated()
        coefficients[k] = rate.value / factorial(k)
    return Jet(coefficients)


def harmonic_law(cosine: Array, sine: Array, lobes: Lobes) -> Transmission:
    """The law of coefficients from the first harmonic on, shapes (m,) and (n,); none at all is the uniform law.

    Raises WrongInput for coefficients that are not finite, NoSuchMechanism where the ratio's range is beyond 1e6; keys
    ``motion.cosine`` and ``motion.sine``.
    """
    return closed_harmonics(cosine, sine, lobes).transmission


def closed_harmonics(cosine: Array, sine: Array, lobes: Lobes, key: str = "motion") -> HarmonicLaw:
    """The law of ``harmonic_law`` with its series at hand and without a search for its extrema.

    Raises the same errors, with ``key`` in place of ``motion``.
    """
    series = _series(cosine, sine, key)
    return HarmonicLaw(series, _closing_integral(series, key), lobes)


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
    if not span <= -log(STANDSTILL):
        raise _beyond_sense(series, span, key)
    # No overflow: the series' mean is zero, so within a span of ln 1e6 its values are below that.
    return turn_integral(lambda count: np.exp(series.sampled(count)), fewest)


def _beyond_sense(series: LogSeries, span: float, key: str) -> NoSuchMechanism:
    """The refusal of a range of the ratio of e^span, at the largest coefficient."""
    name, values = max((("cosine", series.cosine), ("sine", series.sine)), key=lambda named: np.max(np.abs(named[1])))
    worst = int(np.argmax(np.abs(values)))
    # As a power of ten, for e^span may be more than a number can hold.
    return NoSuchMechanism(
        f"{values[worst]:g} is the largest coefficient, and ln i12 spans {span:.4g}, which is a range of the ratio of "
        f"1:1e{span / log(10.0):.4g}; over 1:1e6 the driven gear stands still. Make the coefficients smaller",
        key=f"{key}.{name}.{worst}",
    )


@dataclass(frozen=True, eq=False)
class StagedLaw:
    """A law shared by two pairs in series, one lobe each: the law of the whole, and that of the second pair."""

    whole: HarmonicLaw
    second: HarmonicLaw

    def shaft_angle(self, phi1: Array, order: int) -> Jet:
        """phim in rad with derivatives by phi1, at driving angles of one turn in rad, shape (n,)."""
        turned = self.whole.driven_angle(phi1, 0).value
        values = self.second.integral.at(turned)
        if not order:
            return Jet(values[None, :])
        speed = self.whole.speed(turned, order - 1)
        return _jet_by_x(values, speed / self.second.speed(turned, order - 1), speed)

    def shaft_speed(self, phim: Array) -> Array:
        """Speed of the shaft between over the driving shaft's, at angles of the shaft between in rad, shape (n,)."""
        turned = self.second.driven_angle(np.mod(phim, 2.0 * pi), 0).value
        speed: Array = self.whole.speed(turned, 0).value / self.second.speed(turned, 0).value
        return speed

    def shaft_rad(self, phim: Array) -> Array:
        """phi1 in rad at angles of the shaft between in rad, shape (n,)."""
        within = np.mod(phim, 2.0 * pi)
        phi1: Array = self.whole.integral.at(self.second.driven_angle(within, 0).value) + (phim - within)
        return phi1

    @property
    def first(self) -> Transmission:
        """The first pair's law phim(phi1)."""
        return Transmission((Piece(0.0, 2.0 * pi, self.shaft_angle, self._knots_rad),), Lobes())

    @property
    def _knots_rad(self) -> tuple[float, ...]:
        """Driving angles at every eighth node of the finer of both integrals."""
        nodes = max(self.whole.integral.nodes, self.second.integral.nodes, key=len)
        return tuple(self.whole.integral.at(nodes[NODES_PER_KNOT:-1:NODES_PER_KNOT]).tolist())

    @property
    def train(self) -> Train:
        """Both pairs."""
        second = Pair(self.second.transmission, self.shaft_speed, self.shaft_rad)
        return Train(self.whole.transmission, (on_driving_shaft(self.first), second))


def staged_law(cosine: Array, sine: Array, second_cosine: Array, second_sine: Array) -> StagedLaw:
    """The law of f's and g's coefficients from the first harmonic on; the lists, shape (n,), may differ in length.

    Raises WrongInput for coefficients that are not finite and NoSuchMechanism where a ratio's range is beyond 1e6; keys
    ``motion.cosine``, ``motion.second_stage.cosine`` and the like.
    """
    return StagedLaw(
        closed_harmonics(cosine, sine, Lobes()),
        closed_harmonics(second_cosine, second_sine, Lobes(), "motion.second_stage"),
    )
