"""phi2 by quadrature of 1/i12: the rules that studies compare, each made once and then read at any driving angles."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass

import numpy as np
from numpy.polynomial import Chebyshev
from scipy.integrate import cumulative_trapezoid, quad, solve_ivp
from scipy.interpolate import CubicSpline

from ncgear.numerics import chebyshev
from ncgear.numerics.arrays import Array
from ncgear.precision.gauss import gauss_rule
from ncgear.precision.study import Level

CALLS, ANGLES = 16, 16
"""phi2 is made once and then read at so many driving angles in each of so many calls, in no order.  That is less than
what a stage asks for: a check of the baler reads its return in 30 calls, its gears in 60 more, most at a few angles."""

GAPS = 128
"""Of the table beside which Gauss-Legendre rules integrate the rest of the way."""

Reader = Callable[[Array], Array]
"""phi2 in rad since the stretch's start at driving angles in rad, shape (n,)."""


@dataclass(frozen=True, eq=False)
class Stretch:
    """1/i12 on a stretch of the driving angle in rad, and by how much phi2 has risen at each of the readings."""

    slope: Callable[[Array], Array]
    start_rad: float
    end_rad: float
    reference: Callable[[], Array]

    @property
    def readings_rad(self) -> Array:
        """Spread evenly by the golden ratio, one row for each call."""
        shares: Array = (np.arange(1, CALLS * ANGLES + 1) * (np.sqrt(5.0) - 1.0) / 2.0) % 1.0
        return self.start_rad + (self.end_rad - self.start_rad) * shares.reshape(CALLS, ANGLES)


def read(stretch: Stretch, reader: Reader) -> Array:
    """phi2 at all readings, call by call, shape (CALLS, ANGLES)."""
    return np.array([reader(angles) for angles in stretch.readings_rad])


def panels(stretch: Stretch, degree: Level) -> Reader:
    """ncgear's own way, by the degree of its panels."""
    return chebyshev.fitted(stretch.slope, (stretch.start_rad, stretch.end_rad), int(degree)).integrated()


def series(stretch: Stretch, degree: Level) -> Reader:
    """The whole stretch in one Chebyshev series, integrated."""
    domain = stretch.start_rad, stretch.end_rad
    integral: Reader = Chebyshev.interpolate(stretch.slope, int(degree), domain=domain).integ(lbnd=stretch.start_rad)
    return integral


def gauss(stretch: Stretch, points: Level) -> Reader:
    """A table of phi2, and from its next row below to the angle by the same rule."""
    unit, weights = gauss_rule(int(points))
    knots = np.linspace(stretch.start_rad, stretch.end_rad, GAPS + 1)

    def turned(start: Array, end: Array) -> Array:
        half = (end - start)[:, None] / 2.0
        parts: Array = (stretch.slope(start[:, None] + half * (1.0 + unit)) * half) @ weights
        return parts

    table = np.concatenate([[0.0], np.cumsum(turned(knots[:-1], knots[1:]))])

    def read_at(angles: Array) -> Array:
        below = np.searchsorted(knots, angles, side="right") - 1
        values: Array = table[below] + turned(knots[below], angles)
        return values

    return read_at


def adaptive(stretch: Stretch, tolerance: Level) -> Reader:
    """QUADPACK from the stretch's start to each angle."""

    def turned(angle: float) -> float:
        return float(quad(stretch.slope, stretch.start_rad, angle, epsabs=tolerance, epsrel=tolerance, limit=200)[0])

    return lambda angles: np.array([turned(angle) for angle in angles.tolist()])


def spline(stretch: Stretch, samples: Level) -> Reader:
    """A cubic spline through samples of 1/i12, integrated."""
    knots = np.linspace(stretch.start_rad, stretch.end_rad, int(samples))
    integral: Reader = CubicSpline(knots, stretch.slope(knots)).antiderivative()
    return integral


def trapezoids(stretch: Stretch, samples: Level) -> Reader:
    """A table of phi2 by trapezoids, read linearly."""
    knots = np.linspace(stretch.start_rad, stretch.end_rad, int(samples))
    table = cumulative_trapezoid(stretch.slope(knots), knots, initial=0.0)
    return lambda angles: np.interp(angles, knots, table)


def stepped(stretch: Stretch, tolerance: Level) -> Reader:
    """The initial value problem of phi2 by Dormand and Prince's method of order 8, with its dense output.

    Raises ArithmeticError where the steps do not reach the end.
    """
    done = solve_ivp(
        lambda phi1, _: np.array([stretch.slope(phi1)]),
        (stretch.start_rad, stretch.end_rad),
        [0.0],
        method="DOP853",
        dense_output=True,
        rtol=tolerance,
        atol=tolerance,
    )
    if not done.success:
        raise ArithmeticError(f"Runge-Kutta stopped: {done.message}")
    return lambda angles: np.ravel(done.sol(angles))
