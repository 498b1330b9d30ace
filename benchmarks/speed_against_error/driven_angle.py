"""The studies of phi2 by quadrature of 1/i12: over an ellipse's whole cycle, and over the baler's return.

Each method makes phi2 once, as a function, and then reads it at many driving angles, as a check does.
"""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass
from functools import cache
from math import pi

import numpy as np
from mpmath import mp
from numpy.polynomial import Chebyshev, legendre
from numpy.polynomial.polynomial import polyval
from scipy.integrate import cumulative_trapezoid, quad, solve_ivp
from scipy.interpolate import CubicSpline

from ncgear.numerics.arrays import Array
from ncgear.numerics.chebyshev import DEGREE, fitted
from ncgear.ratio.transmission import CLOSED
from speed_against_error.baler import DIGITS, exact_return_turned, law
from speed_against_error.study import Level, Method, Study

ECCENTRICITY = 0.98
"""i12 runs from 1/99 to 99, which is steeper than teeth can follow."""

CALLS, ANGLES = 16, 16
"""phi2 is read at this many angles, unsorted, in each of this many calls.  A design asks for more: a check of the baler
reads its return in 30 calls, its gears take 60 more, most of them at a few angles."""

GAPS = 128
"""Gaps between the rows of the table from which Gauss-Legendre rules start."""

Reader = Callable[[Array], Array]
"""phi2 in rad since the stretch's start at driving angles in rad, shape (n,)."""


@dataclass(frozen=True, eq=False)
class Stretch:
    """1/i12 as a function of the driving angle in rad, and exact values of phi2 at the readings."""

    slope: Callable[[Array], Array]
    start_rad: float
    end_rad: float
    exact: Callable[[], Array]

    @property
    def readings_rad(self) -> Array:
        """Driving angles spread evenly by the golden ratio, one row for each call."""
        shares: Array = (np.arange(1, CALLS * ANGLES + 1) * (np.sqrt(5.0) - 1.0) / 2.0) % 1.0
        return self.start_rad + (self.end_rad - self.start_rad) * shares.reshape(CALLS, ANGLES)


def ellipse_angle_study() -> Study:
    """phi2 of equal elliptical gears."""
    return _study(
        "driven-angle-ellipse",
        f"Driven angle by quadrature: ellipse of eccentricity {ECCENTRICITY:g}",
        "closed form, tan(phi2/2) = (1 - e)/(1 + e) tan(phi1/2), in 50 digits",
        ellipse(),
        enough=CLOSED,
    )


def return_angle_study() -> Study:
    """phi2 of the baler's return."""
    return _study(
        "driven-angle-return",
        "Driven angle by quadrature: the baler's return",
        "50-digit quadrature of one over the return's polynomial, whose coefficients are taken as exact",
        return_of_baler(),
        enough=CLOSED / 20.0,
    )


def _study(key: str, title: str, reference: str, stretch: Stretch, enough: float) -> Study:
    def reading(made: Callable[[Stretch, Level], Reader]) -> Callable[[Level], Array]:
        return lambda level: read(stretch, made(stretch, level))

    return Study(
        key=key,
        title=title,
        unit="rad",
        reference=reference,
        methods=(
            Method("Chebyshev panels", "degree", (6, 8, 12, 16, 24, 32, 48), reading(panels), adaptive=True),
            Method("one Chebyshev series", "degree", (8, 16, 32, 64, 128, 256, 512), reading(_series)),
            Method(f"Gauss-Legendre in {GAPS} gaps", "points", (1, 2, 4, 8, 16, 24, 32), reading(_gauss)),
            Method("adaptive quadrature", "tolerance", (1e-6, 1e-12), reading(_adaptive), adaptive=True),
            Method("cubic spline, integrated", "samples", (65, 129, 257, 513, 1025, 2049), reading(_spline), order=4.0),
            Method(
                "cumulative trapezoids", "samples", (257, 1025, 4097, 16385, 65537), reading(_trapezoids), order=2.0
            ),
            Method(
                "Runge-Kutta, order 8",
                "tolerance",
                (1e-4, 1e-6, 1e-8, 1e-10, 1e-12),
                reading(_runge_kutta),
                adaptive=True,
            ),
        ),
        error=lambda result: driven_angle_error_rad(stretch, result),
        chosen=("Chebyshev panels", DEGREE),
        enough=enough,
        because="panels are halved until they are resolved, a pole is told from a steep place, and the same form gives "
        "arc lengths, curves and their bounds",
    )


def driven_angle_error_rad(stretch: Stretch, result: Array) -> float:
    """The largest error of phi2 at the readings."""
    return float(np.max(np.abs(result - stretch.exact())))


def read(stretch: Stretch, reader: Reader) -> Array:
    """phi2 at all readings, call by call, shape (CALLS, ANGLES)."""
    return np.array([reader(angles) for angles in stretch.readings_rad])


# --- the two stretches and their exact angles ------------------------------------------------------------------------


@cache
def ellipse() -> Stretch:
    """1/i12 = (1 - e^2) / (1 + e^2 + 2 e cos phi1), over one turn."""
    e = ECCENTRICITY
    return Stretch(lambda phi1: (1.0 - e**2) / (1.0 + e**2 + 2.0 * e * np.cos(phi1)), 0.0, 2.0 * pi, _exact_ellipse)


@cache
def return_of_baler() -> Stretch:
    """From the extended dead centre to the retracted one."""
    of = law().return_law

    def slope(phi1: Array) -> Array:
        values: Array = 1.0 / polyval((phi1 - of.ends.start_rad) / of.ends.length_rad, of.polynomial.coef)
        return values

    return Stretch(slope, of.ends.start_rad, of.ends.end_rad, _exact_return)


@cache
def _exact_ellipse() -> Array:
    readings = ellipse().readings_rad
    with mp.workdps(DIGITS):
        share = (1 - mp.mpf(ECCENTRICITY)) / (1 + mp.mpf(ECCENTRICITY))
        halves = [mp.mpf(angle) / 2 for angle in readings.ravel().tolist()]
        # From 0 to 2 pi the sine of the half angle is not negative, and atan2 finds the right quarter.
        values = [float(2 * mp.atan2(share * mp.sin(half), mp.cos(half))) for half in halves]
    return np.array(values).reshape(readings.shape)


@cache
def _exact_return() -> Array:
    readings = return_of_baler().readings_rad
    rising = np.argsort(readings, axis=None)
    values = np.empty(readings.size)
    with mp.workdps(DIGITS):
        turned = exact_return_turned(law().return_law, readings.ravel()[rising].tolist())
        values[rising] = [float(value) for value in turned]
    return values.reshape(readings.shape)


# --- methods ---------------------------------------------------------------------------------------------------------


def panels(stretch: Stretch, degree: Level) -> Reader:
    """As ncgear does it, with panels of any degree."""
    return fitted(stretch.slope, (stretch.start_rad, stretch.end_rad), int(degree)).integrated()


def _series(stretch: Stretch, degree: Level) -> Reader:
    """One Chebyshev series over the whole stretch, integrated."""
    domain = stretch.start_rad, stretch.end_rad
    integral: Reader = Chebyshev.interpolate(stretch.slope, int(degree), domain=domain).integ(lbnd=stretch.start_rad)
    return integral


def _gauss(stretch: Stretch, points: Level) -> Reader:
    """A table of phi2, and the same rule from the row below up to the angle."""
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


@cache
def gauss_rule(points: int) -> tuple[Array, Array]:
    """Nodes and weights on [-1, 1], shape (points,) each; their making does not count in the times."""
    nodes, weights = legendre.leggauss(points)
    return nodes, weights


def _adaptive(stretch: Stretch, tolerance: Level) -> Reader:
    """QUADPACK from the stretch's start to each angle."""

    def turned(angle: float) -> float:
        return float(quad(stretch.slope, stretch.start_rad, angle, epsabs=tolerance, epsrel=tolerance, limit=200)[0])

    return lambda angles: np.array([turned(angle) for angle in angles.tolist()])


def _spline(stretch: Stretch, samples: Level) -> Reader:
    """A cubic spline through samples of 1/i12, integrated."""
    knots = np.linspace(stretch.start_rad, stretch.end_rad, int(samples))
    integral: Reader = CubicSpline(knots, stretch.slope(knots)).antiderivative()
    return integral


def _trapezoids(stretch: Stretch, samples: Level) -> Reader:
    """A table of phi2 by trapezoids, read linearly."""
    knots = np.linspace(stretch.start_rad, stretch.end_rad, int(samples))
    table = cumulative_trapezoid(stretch.slope(knots), knots, initial=0.0)
    return lambda angles: np.interp(angles, knots, table)


def _runge_kutta(stretch: Stretch, tolerance: Level) -> Reader:
    """The initial value problem of phi2 by Dormand and Prince's method of order 8, read from its dense output.

    Raises ArithmeticError if the steps do not reach the end.
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
