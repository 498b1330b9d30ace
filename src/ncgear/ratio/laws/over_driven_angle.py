"""Common part of laws given by ln i12 over the driven angle, for one pair of gears or two pairs in series.

One pair: the logarithm keeps every ratio positive whatever its values are, and the motion of the mechanism depends on
the driven angle; so laws are optimised and stored in this form.  A constant closes the cycle: with x = n1 phi1 and t =
n2 phi2, dx/dt = exp(f) / mean(exp(f)), whose integral over a turn is a turn.

Two pairs: ln i12 = ln iA + ln iB, both over the crank's angle phi2.

    ln i12 = f(phi2),   ln iB = g(phi2),   ln iA = f - g

The second pair drives the crank, so phi2 is its own driven angle and its ratio iB is such a law without conversion. The
first pair drives the intermediate shaft, whose angle phim = integral of exp(g) dphi2 comes round with the crank.  With
t = phi2, dphim/dphi1 = exp(g - f) and dt/dphi1 = exp(-f), each with the constant that closes its cycle.
"""

from __future__ import annotations

from math import log, pi
from typing import Protocol

import numpy as np

from ncgear.frozen import dataclass
from ncgear.numerics import jet
from ncgear.numerics.arrays import Array
from ncgear.numerics.jet import Jet
from ncgear.numerics.quadrature import TurnIntegral
from ncgear.ratio.transmission import STANDSTILL, Lobes, Pair, PairsInSeries, Piece, Transmission, on_driving_shaft

WIDEST = -log(STANDSTILL)
"""Largest span of ln i12: over a range of the ratio of 1:1e6 the driven gear stands still."""


class LogRatio(Protocol):
    """ln i12 without the constant that closes the cycle, as a function of t = n2 phi2."""

    def at(self, angle: Array, order: int) -> Jet:
        """Values with derivatives by t at angles t of [0, 2 pi] in rad, shape (n,)."""
        ...


@dataclass(frozen=True, eq=False)
class LogRatioLaw:
    """The driven angle of one period: the inverse of ``integral``, the driving angle over the driven angle.

    ``integral`` integrates exp(``series``); it counts both angles in turns of 2 pi a period.  ``joints`` (shape (m,))
    are angles t between 0 and 2 pi, rising: between two of them the law is analytic and has no detail finer than their
    distance.
    """

    series: LogRatio
    integral: TurnIntegral
    joints: Array
    lobes: Lobes

    def driven_angle(self, phi1: Array, order: int) -> Jet:
        """phi2 in rad with derivatives by phi1, at driving angles of one period in rad, shape (n,)."""
        turned = self.integral.inverse(np.clip(phi1 * self.lobes.driving, 0.0, 2.0 * pi))
        if not order:
            return Jet(turned[None, :] / self.lobes.driven)
        speed = self.speed(turned, order - 1)
        scale = float(self.lobes.driving) ** np.arange(order + 1) / self.lobes.driven
        return Jet(jet.by_other(turned, speed, speed).coefficients * scale[:, None])

    def speed(self, turned: Array, order: int) -> Jet:
        """w = dt/dx with derivatives by t, at t = n2 phi2 in rad, shape (n,)."""
        return jet.exp(-self.series.at(turned, order)) * self.integral.mean

    @property
    def transmission(self) -> Transmission:
        """The law with its range searched; raises NoSuchMechanism where the driven gear nearly stops."""
        return Transmission((Piece(0.0, self.lobes.driving_period_rad, self.driven_angle, self.knots_rad),), self.lobes)

    @property
    def knots_rad(self) -> tuple[float, ...]:
        """The driving angles of the joints."""
        return tuple((self.integral.at(self.joints) / self.lobes.driving).tolist())


@dataclass(frozen=True, eq=False)
class StagedLaw:
    """A law shared by two pairs in series, one lobe each: the law of the whole, and the law of the second pair."""

    whole: LogRatioLaw
    second: LogRatioLaw

    def shaft_angle(self, phi1: Array, order: int) -> Jet:
        """phim in rad with derivatives by phi1, at driving angles of one turn in rad, shape (n,)."""
        turned = self.whole.driven_angle(phi1, 0).value
        values = self.second.integral.at(turned)
        if not order:
            return Jet(values[None, :])
        speed = self.whole.speed(turned, order - 1)
        return jet.by_other(values, speed / self.second.speed(turned, order - 1), speed)

    def shaft_speed(self, phim: Array) -> Array:
        """Speed of the intermediate shaft over the driving shaft's, at angles of the former in rad, shape (n,)."""
        turned = self.second.driven_angle(np.mod(phim, 2.0 * pi), 0).value
        return self.whole.speed(turned, 0).value / self.second.speed(turned, 0).value

    def shaft_rad(self, phim: Array) -> Array:
        """phi1 in rad at angles of the intermediate shaft in rad, shape (n,)."""
        within = np.mod(phim, 2.0 * pi)
        return self.whole.integral.at(self.second.driven_angle(within, 0).value) + (phim - within)

    @property
    def first(self) -> Transmission:
        """The first pair's law phim(phi1)."""
        return Transmission((Piece(0.0, 2.0 * pi, self.shaft_angle, self._knots_rad),), Lobes())

    @property
    def _knots_rad(self) -> tuple[float, ...]:
        """Driving angles of the joints of both laws."""
        return tuple(self.whole.integral.at(np.union1d(self.whole.joints, self.second.joints)).tolist())

    @property
    def train(self) -> PairsInSeries:
        """Both pairs."""
        second = Pair(self.second.transmission, self.shaft_speed, self.shaft_rad)
        return PairsInSeries(self.whole.transmission, (on_driving_shaft(self.first), second))
