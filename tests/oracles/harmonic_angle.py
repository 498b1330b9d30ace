"""The driven angle of ln i12 = a sum of harmonics of phi2, in many digits, by the Fourier series of i12 itself."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from typing import Any

from mpmath import mp

Real = Any

ORDERS = 40
"""Harmonics of i12: with two harmonics of ln i12 under 0.4 the last one is under 1e-20 of the first."""

LEAST = 1e-45
"""Harmonics under this share of the mean do not count."""


class HarmonicAngle:
    """phi1 by phi2, the integral of i12 from zero, scaled so that a turn makes a turn; and its inverse."""

    def __init__(self, cosine: Sequence[float], sine: Sequence[float]) -> None:
        # c cos k phi + s sin k phi is the real part of (c - j s) exp(j k phi)
        longest = max(len(cosine), len(sine))
        padded = [[*values, *[0.0] * (longest - len(values))] for values in (cosine, sine)]
        self.logarithm = [mp.mpc(c, -s) for c, s in zip(*padded, strict=True)]
        self.known: dict[int, tuple[Real, list[Real]]] = {}

    def rate(self, phi2: Real) -> Real:
        """dphi1/dphi2 but for its scale."""
        turn = mp.expj(phi2)
        return mp.exp(sum((one * turn**order).real for order, one in enumerate(self.logarithm, start=1)))

    def series(self, digits: int) -> tuple[Real, list[Real]]:
        """Mean of the rate, and its harmonics over it, as complex numbers from the first one on."""
        if digits not in self.known:
            self.known[digits] = self._series(digits)
        return self.known[digits]

    def _series(self, digits: int) -> tuple[Real, list[Real]]:
        with mp.workdps(digits + 10):
            count = 4 * ORDERS
            values = [self.rate(2 * mp.pi * place / count) for place in range(count)]
            roots = [mp.expjpi(-mp.mpf(2) * place / count) for place in range(count)]
            sums = [mp.fsum(v * roots[k * n % count] for n, v in enumerate(values)) for k in range(ORDERS)]
            harmonics = [2 * one / sums[0].real for one in sums[1:]]
            while harmonics and abs(harmonics[-1]) < LEAST:
                harmonics.pop()
            return sums[0].real / count, harmonics

    def driving(self, phi2: Real) -> Real:
        """phi1 by phi2."""
        turn, power, total = mp.expj(phi2), mp.mpc(1), mp.mpf(phi2)
        for order, one in enumerate(self.series(mp.dps)[1], start=1):
            power *= turn
            total += (one * (power - 1) / mp.mpc(0, order)).real
        return total

    def driven(self, phi1: Real) -> Real:
        """phi2 by phi1, by Newton's steps."""
        found = mp.mpf(phi1)
        for _ in range(60):
            step = (self.driving(found) - phi1) / self.rate(found) * self.series(mp.dps)[0]
            found -= step
            if abs(step) < mp.mpf(10) ** (-mp.dps // 2 - 3):
                return found
        raise AssertionError("no driven angle")


def driven_angle(cosine: Sequence[float], sine: Sequence[float]) -> Callable[[Real], Real]:
    """phi2 by phi1."""
    return HarmonicAngle(cosine, sine).driven
