"""ln i12 over the driven angle in as many digits as mpmath works with: trigonometric series, and splines."""

from __future__ import annotations

from abc import ABC, abstractmethod
from collections.abc import Callable, Sequence
from dataclasses import dataclass
from functools import cached_property
from itertools import accumulate, pairwise

from mpmath import mp

from oracles.quadrature import Real, integral
from oracles.stroke import polynomial

NODES = 1024


class LogRatio(ABC):
    """ln i12 but for a constant, over t = n2 phi2; with x = n1 phi1, dt/dx = mean(i12) / i12."""

    @property
    @abstractmethod
    def knots(self) -> tuple[Real, ...]:
        """Places from 0 to 2 pi between which it is analytic."""

    @abstractmethod
    def log(self, t: Real) -> Real:
        """Its value."""

    @abstractmethod
    def slope(self, t: Real) -> Real:
        """Its derivative."""

    @abstractmethod
    def turned(self, t: Real) -> Real:
        """x at t, times the mean: the integral of the exponential."""

    @cached_property
    def mean(self) -> Real:
        """Mean of the exponential."""
        return self.turned(2 * mp.pi) / (2 * mp.pi)

    def speed(self, t: Real) -> tuple[Real, Real]:
        """dt/dx and its derivative by x."""
        speed = self.mean * mp.exp(-self.log(t))
        return speed, -self.slope(t) * speed**2

    def inverse(self, x: Real) -> Real:
        """t at x, by Newton's method from a bracket."""
        wanted, (low, high) = x * self.mean, (mp.mpf(0), 2 * mp.pi)
        for _ in range(12):
            middle = (low + high) / 2
            low, high = (middle, high) if self.turned(middle) < wanted else (low, middle)
        t = (low + high) / 2
        for _ in range(8):
            step = (self.turned(t) - wanted) / mp.exp(self.log(t))
            t -= step
            if abs(step) < mp.mpf(10) ** (6 - mp.dps):
                return t
        raise ArithmeticError("the law's inverse was not found")


@dataclass(frozen=True)
class Harmonics(LogRatio):
    """A trigonometric series."""

    cosine: tuple[float, ...]
    sine: tuple[float, ...]

    @property
    def knots(self) -> tuple[Real, ...]:
        """Both ends of the turn."""
        return mp.mpf(0), 2 * mp.pi

    def log(self, t: Real) -> Real:
        """The series without its constant."""
        waves = [a * mp.cos(k * t) for k, a in enumerate(self.cosine, 1)]
        return mp.fsum(waves + [b * mp.sin(k * t) for k, b in enumerate(self.sine, 1)])

    @cached_property
    def spectrum(self) -> tuple[tuple[Real, ...], tuple[Real, ...]]:
        """Cosine and sine coefficients of exp(series), by the trapezium rule, whose error is the coefficients beyond.

        The 256 that are kept fall below 1e-40 where the series' coefficients add up to ten.
        """
        around = [mp.expj(2 * mp.pi * k / NODES) for k in range(NODES)]
        values = [mp.exp(self.log(2 * mp.pi * k / NODES)) for k in range(NODES)]
        waves = ([around[wave * k % NODES] for k in range(NODES)] for wave in range(NODES // 4))
        sums = [2 * mp.fdot(values, wave) / NODES for wave in waves]
        return tuple(mp.re(each) for each in sums), tuple(mp.im(each) for each in sums)

    @cached_property
    def _antiderivative(self) -> list[Real]:
        """Coefficients of falling powers of exp(it): the imaginary part is the waves' antiderivative."""
        cosine, sine = self.spectrum
        rising = [mp.mpc(cosine[k], -sine[k]) / k for k in range(1, len(cosine))]
        return [*reversed(rising), -mp.fsum(rising)]

    def slope(self, t: Real) -> Real:
        """Derivative of the series."""
        return mp.diff(self.log, t)

    def turned(self, t: Real) -> Real:
        """x at t, times the mean: the antiderivative of exp(series), term by term."""
        return self.spectrum[0][0] / 2 * t + mp.im(mp.polyval(self._antiderivative, mp.expj(t)))


@dataclass(frozen=True)
class Splined(LogRatio):
    """A cubic spline by its cells: polynomials in rising powers of the distance from the knot below."""

    angles: tuple[Real, ...]
    cells: tuple[tuple[Real, ...], ...]

    @classmethod
    def through(cls, angles: Sequence[Real], values: Sequence[Real]) -> Splined:
        """The periodic spline through values at angles, the first of them 0."""
        whole = spline(list(angles), list(values), 3)
        cells = tuple(tuple(whole(at, order) / mp.factorial(order) for order in range(4)) for at in angles)
        return cls(tuple(angles), cells)

    @property
    def knots(self) -> tuple[Real, ...]:
        """The angles, and the end of the turn."""
        return *self.angles, 2 * mp.pi

    def _cell(self, t: Real) -> int:
        return max(k for k in range(len(self.cells)) if k == 0 or self.angles[k] <= t)

    def log(self, t: Real) -> Real:
        """The spline."""
        return polynomial(self.cells[k := self._cell(t)], t - self.angles[k])

    def slope(self, t: Real) -> Real:
        """Its derivative."""
        return polynomial(self.cells[k := self._cell(t)], t - self.angles[k], 1)

    @cached_property
    def _before(self) -> tuple[Real, ...]:
        """The integral up to each knot."""
        return (mp.mpf(0), *accumulate(integral(lambda t: mp.exp(self.log(t)), *ends) for ends in pairwise(self.knots)))

    def turned(self, t: Real) -> Real:
        """The integral of the exponential, from the knot below on."""
        if t in self.knots:
            return self._before[self.knots.index(t)]
        k = self._cell(t)
        return self._before[k] + integral(lambda at: mp.exp(self.log(at)), self.angles[k], t)


def spline(angles: list[Real], values: list[Real], degree: int = 5) -> Callable[..., Real]:
    """The periodic spline through points, its knots at the points, by collocation of B-splines."""
    count, turn = len(angles), 2 * mp.pi
    knots = [angles[k % count] + turn * (k // count) for k in range(-degree, count + degree + 1)]

    def row(at: Real, order: int) -> list[Real]:
        local = at - turn * mp.floor((at - angles[0]) / turn)
        cell = max(k for k in range(degree, degree + count) if knots[k] <= local)
        total = [mp.mpf(0)] * count
        for k in range(cell - degree, cell + 1):
            total[k % count] += _basis(knots, k, degree, local, order, cell)
        return total

    weights = mp.lu_solve(mp.matrix([row(at, 0) for at in angles]), mp.matrix(values))
    return lambda at, order=0: mp.fdot(row(at, order), weights)


def _basis(knots: list[Real], k: int, degree: int, at: Real, order: int, cell: int) -> Real:
    """Derivative of an order of B-spline k at a place in a cell, by the recurrences of Cox and de Boor."""
    if not degree:
        return mp.mpf(k == cell)
    left, right = knots[k + degree] - knots[k], knots[k + degree + 1] - knots[k + 1]
    fewer = order - 1 if order else 0
    first, second = (_basis(knots, j, degree - 1, at, fewer, cell) for j in (k, k + 1))
    if order:
        return degree * (first / left - second / right)
    return (at - knots[k]) / left * first + (knots[k + degree + 1] - at) / right * second
