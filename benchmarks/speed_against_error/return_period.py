"""The studies of the return period: its polynomial closes the cycle, and is written in some basis.

Both take the baler's return with e = 0.  The first study solves for the free coefficient, so that the driven gear makes
one turn.  The second has the ratio in the middle given instead, and six conditions.
"""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import replace
from functools import cache

import numpy as np
from mpmath import mp
from numpy.polynomial import Polynomial, chebyshev, polynomial
from scipy.integrate import quad, trapezoid

from ncgear.numerics.arrays import Array
from ncgear.ratio.return_stroke import ReturnEnds, ReturnLaw, published_family, return_with_constant
from ncgear.ratio.transmission import CLOSED
from speed_against_error.baler import CONSTANT, DIGITS, exact_return_turned, law
from speed_against_error.driven_angle import gauss_rule
from speed_against_error.study import Level, Method, Study

# --- closure ---------------------------------------------------------------------------------------------------------

START = -5.0
"""The free coefficient from which Newton's method starts: -5.62 closes, and below -8.6 the ratio is negative."""

MOST_STEPS = 12
SETTLED = 1e-15

Rule = Callable[[Callable[[Array], Array]], float]
"""A quadrature over [0, 1]."""


def closure_study() -> Study:
    """Results are closed laws, with the integral that phi2 is read from."""
    return Study(
        key="closure",
        title="Closure of the return",
        unit="rad missed after one turn",
        reference="30-digit quadrature of one over the polynomial found, whose coefficients are taken as exact",
        methods=(
            Method("panels, then spectral integral", "", (0,), lambda _: closed_by_ncgear()),
            Method(
                "Newton on the spectral integral", "steps", (1, 2, 3, 4, 5, 6), _by_spectral_integral, adaptive=True
            ),
            Method(
                "Newton on Gauss-Legendre",
                "points",
                (4, 6, 8, 12, 16, 24, 32, 48, 64),
                lambda points: _by_newton(_gauss(points)),
            ),
            Method(
                "Newton on adaptive quadrature",
                "tolerance",
                (1e-2, 1e-4, 1e-8, 1e-12),
                lambda tolerance: _by_newton(_adaptive(tolerance)),
                adaptive=True,
            ),
            Method(
                "Newton on trapezoids",
                "samples",
                (17, 65, 257, 1025, 4097, 16385),
                lambda samples: _by_newton(_trapezoids(samples)),
                order=2.0,
            ),
        ),
        error=closure_error_rad,
        chosen=("panels, then spectral integral", 0),
        enough=CLOSED / 20.0,
        because="the integral that phi2 is read from afterwards is itself what closes; a start is not needed, and a "
        "return that cannot close is told from one that is not found",
    )


def closure_error_rad(closed: ReturnLaw) -> float:
    """By how much the driven gear misses its turn."""
    ends = closed.ends
    with mp.workdps(30):
        turned = exact_return_turned(closed, np.linspace(ends.start_rad, ends.end_rad, 5)[1:].tolist())[-1]
        return float(abs(turned - mp.mpf(ends.end_driven_rad) + mp.mpf(ends.start_driven_rad)))


def closed_by_ncgear() -> ReturnLaw:
    """As ncgear does it."""
    return _ready(return_with_constant(_ends(), CONSTANT))


def _by_spectral_integral(steps: int) -> ReturnLaw:
    base, direction = published_family(_ends(), CONSTANT)
    found = ReturnLaw(_ends(), base + START * direction, inverse=False)
    for _ in range(steps):
        missed = found.closure_error_rad / _ends().length_rad
        step = missed / _sensitivity(_gauss(32), found.polynomial, direction)
        found = ReturnLaw(_ends(), found.polynomial + step * direction, inverse=False)
    return _ready(found)


def _by_newton(rule: Rule) -> ReturnLaw:
    """Newton's method on a quadrature, until its steps are rounding."""
    base, direction = published_family(_ends(), CONSTANT)
    target = _ends().driven_length_rad / _ends().length_rad
    ratio = base + START * direction
    for _ in range(MOST_STEPS):
        turned = rule(lambda tau, ratio=ratio: 1.0 / ratio(tau))  # type: ignore[misc]
        step = (turned - target) / _sensitivity(rule, ratio, direction)
        ratio = ratio + step * direction
        if abs(step) <= SETTLED:
            break
    return _ready(ReturnLaw(_ends(), ratio, inverse=False))


def _sensitivity(rule: Rule, ratio: Polynomial, direction: Polynomial) -> float:
    """How fast the driven angle falls, as a share of the driving angle, if a multiple of ``direction`` is added."""
    return rule(lambda tau: direction(tau) / ratio(tau) ** 2)


def _ready(closed: ReturnLaw) -> ReturnLaw:
    """The law after it has computed the integral of phi2, which every use of the law needs."""
    closed.closure_error_rad  # noqa: B018
    return closed


@cache
def _gauss(points: int) -> Rule:
    unit, weights = gauss_rule(points)
    tau, shares = (1.0 + unit) / 2.0, weights / 2.0
    return lambda integrand: float(shares @ integrand(tau))


def _adaptive(tolerance: Level) -> Rule:
    return lambda integrand: float(quad(integrand, 0.0, 1.0, epsabs=tolerance, epsrel=tolerance)[0])


def _trapezoids(samples: int) -> Rule:
    tau = np.linspace(0.0, 1.0, samples)
    return lambda integrand: float(trapezoid(integrand(tau), tau))


@cache
def _ends() -> ReturnEnds:
    return law().return_law.ends


# --- basis -----------------------------------------------------------------------------------------------------------

POINTS = 201

SHORT = 0.97
"""The second return starts after this share of the turn: nearly all of the turn is working stroke."""

Rows = Callable[[ReturnEnds, Array, int], Array]
"""Values of six basis functions, or of their first derivatives by phi1, at driving angles: shape (n, 6)."""


def basis_study() -> Study:
    """Results are i12 at POINTS points of each of two returns, shape (2, POINTS)."""
    return Study(
        key="return-basis",
        title="Basis of the return's polynomial: the baler's, and one of 3 % of the turn",
        unit="share of i12",
        reference="the six conditions solved in 50 digits",
        methods=(
            Method("end conditions in closed form, [0, 1]", "", (0,), lambda _: by_end_conditions()),
            Method("powers on [0, 1]", "", (0,), lambda _: by_linear_system(_local_powers)),
            Method("Chebyshev on [-1, 1]", "", (0,), lambda _: by_linear_system(_chebyshev)),
            Method("powers of phi1 from the start", "", (0,), lambda _: by_linear_system(_shifted_powers)),
            Method("powers of phi1, as published", "", (0,), lambda _: by_linear_system(global_powers)),
        ),
        error=basis_error,
        chosen=("end conditions in closed form, [0, 1]", 0),
        enough=1e-14,
        because="values and slopes of the ends stand in the coefficients themselves, so that the joints are as exact "
        "as what they join, and no system of equations is solved",
    )


def basis_error(result: Array) -> float:
    """The largest error as a share of i12, joints included."""
    return float(np.max(np.abs(result / _exact_ratios() - 1.0)))


@cache
def _exact_ratios() -> Array:
    """Solved with powers of phi1 itself: with fifty digits their bad condition does no harm."""

    def of(ends: ReturnEnds) -> list[float]:
        joints = [mp.mpf(ends.start_rad), mp.mpf(ends.end_rad)]
        valued = [[at**k for k in range(6)] for at in (*joints, sum(joints) / 2, mp.mpf(0))]
        sloped = [[k * at ** (k - 1) if k else 0 for k in range(6)] for at in joints]
        found = mp.lu_solve(mp.matrix([*valued, *sloped]), mp.matrix(_conditions(ends).tolist()))
        return [float(mp.polyval(list(found)[::-1], mp.mpf(at))) for at in _angles(ends).tolist()]

    with mp.workdps(DIGITS):
        return np.array([of(ends) for ends in _returns()])


def by_end_conditions() -> Array:
    """As ncgear does it: Hermite's cubic and two multiples of tau^2 (1 - tau)^2, one of them by the middle ratio."""
    found = []
    for ends in _returns():
        base, direction = published_family(ends, CONSTANT)
        multiple = (_middle_ratio() - base(0.5)) / direction(0.5)
        found.append((base + multiple * direction)(_tau(ends, _angles(ends))))
    return np.array(found)


def by_linear_system(rows: Rows) -> Array:
    """The six conditions as linear equations."""
    found = []
    for ends in _returns():
        joints = np.array([ends.start_rad, ends.end_rad])
        valued = np.array([*joints, joints.mean(), 0.0])
        matrix = np.vstack([rows(ends, valued, 0), rows(ends, joints, 1)])
        found.append(rows(ends, _angles(ends), 0) @ np.linalg.solve(matrix, _conditions(ends)))
    return np.array(found)


def _conditions(ends: ReturnEnds) -> Array:
    """The ratio at both joints, in the middle and extrapolated to phi1 = 0; its slopes at both joints."""
    ratios = ends.start_ratio, ends.end_ratio, _middle_ratio(), CONSTANT
    return np.array([*ratios, ends.start_ratio_slope, ends.end_ratio_slope])


def global_powers(_: ReturnEnds, phi1: Array, order: int) -> Array:
    """1, phi1, phi1^2, ..., or their derivatives."""
    powers = np.asarray(polynomial.polyvander(phi1, 5), dtype=np.float64)
    return powers if order == 0 else np.hstack([np.zeros((phi1.size, 1)), powers[:, :-1] * np.arange(1.0, 6.0)])


def _shifted_powers(ends: ReturnEnds, phi1: Array, order: int) -> Array:
    return global_powers(ends, phi1 - ends.start_rad, order)


def _local_powers(ends: ReturnEnds, phi1: Array, order: int) -> Array:
    return global_powers(ends, _tau(ends, phi1), order) / ends.length_rad**order


def _chebyshev(ends: ReturnEnds, phi1: Array, order: int) -> Array:
    series = chebyshev.chebder(np.eye(6), m=order, axis=0)
    rows = np.asarray(chebyshev.chebval(2.0 * _tau(ends, phi1) - 1.0, series).T, dtype=np.float64)
    return rows * (2.0 / ends.length_rad) ** order


def _angles(ends: ReturnEnds) -> Array:
    """The driving angles of the results, both joints included."""
    return np.linspace(ends.start_rad, ends.end_rad, POINTS)


def _tau(ends: ReturnEnds, phi1: Array) -> Array:
    return (phi1 - ends.start_rad) / ends.length_rad


@cache
def _returns() -> tuple[ReturnEnds, ReturnEnds]:
    return _ends(), replace(_ends(), start_rad=SHORT * _ends().end_rad)


@cache
def _middle_ratio() -> float:
    return float(law().return_law.polynomial(0.5))
