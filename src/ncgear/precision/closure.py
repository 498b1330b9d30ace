"""Study: the return closed, by the quadrature that its free coefficient is solved on."""

from __future__ import annotations

from collections.abc import Callable
from functools import cache

import numpy as np
from numpy.polynomial import Polynomial
from scipy.integrate import quad, trapezoid

from ncgear.numerics.arrays import Array
from ncgear.precision import baler, exact
from ncgear.precision.gauss import gauss_rule
from ncgear.precision.study import Level, Method, Study
from ncgear.ratio.return_stroke import ReturnEnds, ReturnLaw, published_family, return_with_constant
from ncgear.ratio.transmission import CLOSED

START = -5.0
"""The free coefficient that all but ncgear's own way start from; -5.62 closes, and below -8.6 the ratio is negative."""

MOST_STEPS = 12
SETTLED = 1e-15

Rule = Callable[[Callable[[Array], Array]], float]
"""Integral over [0, 1]."""


def study() -> Study:
    """The baler's return with e = 0; results are closed laws, phi2 ready to be read."""
    return Study(
        key="closure",
        title="Closure of the return",
        unit="rad missed after one turn",
        reference="30-digit quadrature of one over the polynomial found, whose coefficients are taken as exact",
        methods=(
            Method("panels, then spectral integral", "", (0,), lambda _: ncgears_own()),
            Method("Newton on the spectral integral", "steps", (1, 2, 3, 4, 5, 6), _spectral, adaptive=True),
            Method("Newton on Gauss-Legendre", "points", (4, 6, 8, 12, 16, 24, 32, 48, 64), _by_gauss),
            Method(
                "Newton on adaptive quadrature", "tolerance", (1e-2, 1e-4, 1e-8, 1e-12), _by_adaptive, adaptive=True
            ),
            Method("Newton on trapezoids", "samples", (17, 65, 257, 1025, 4097, 16385), _by_trapezoids, order=2.0),
        ),
        error=error,
        chosen=("panels, then spectral integral", 0),
        enough=CLOSED / 20.0,
        because="the integral that phi2 is read from afterwards is itself what closes; a start is not needed, and a "
        "return that cannot close is told from one that is not found",
    )


def error(law: ReturnLaw) -> float:
    """What the driven angle of the return misses, in rad."""
    from mpmath import mp

    with mp.workdps(30):
        turned = exact.return_turned(law, np.linspace(law.ends.start_rad, law.ends.end_rad, 5)[1:].tolist())[-1]
        return float(abs(turned - mp.mpf(law.ends.end_driven_rad) + mp.mpf(law.ends.start_driven_rad)))


def ncgears_own() -> ReturnLaw:
    """With the integral that phi2 is read from."""
    return _ready(return_with_constant(_ends(), baler.CONSTANT))


def _spectral(steps: Level) -> ReturnLaw:
    base, direction = published_family(_ends(), baler.CONSTANT)
    law = ReturnLaw(_ends(), base + START * direction, inverse=False)
    for _ in range(int(steps)):
        missed = law.closure_error_rad / _ends().length_rad
        step = missed / _sensitivity(_gauss(32), law.polynomial, direction)
        law = ReturnLaw(_ends(), law.polynomial + step * direction, inverse=False)
    return _ready(law)


def _by_gauss(points: Level) -> ReturnLaw:
    return _solved(_gauss(int(points)))


def _by_trapezoids(samples: Level) -> ReturnLaw:
    tau = np.linspace(0.0, 1.0, int(samples))
    return _solved(lambda integrand: float(trapezoid(integrand(tau), tau)))


def _by_adaptive(tolerance: Level) -> ReturnLaw:
    return _solved(lambda integrand: float(quad(integrand, 0.0, 1.0, epsabs=tolerance, epsrel=tolerance)[0]))


def _solved(rule: Rule) -> ReturnLaw:
    """Newton's method on a rule, until its steps are rounding."""
    base, direction = published_family(_ends(), baler.CONSTANT)
    target = _ends().driven_length_rad / _ends().length_rad
    polynomial = base + START * direction
    for _ in range(MOST_STEPS):
        step = (_turned(rule, polynomial) - target) / _sensitivity(rule, polynomial, direction)
        polynomial = polynomial + step * direction
        if abs(step) <= SETTLED:
            break
    return _ready(ReturnLaw(_ends(), polynomial, inverse=False))


def _turned(rule: Rule, polynomial: Polynomial) -> float:
    """Driven angle of the return as a share of its driving angle."""
    return rule(lambda tau: 1.0 / polynomial(tau))


def _sensitivity(rule: Rule, polynomial: Polynomial, direction: Polynomial) -> float:
    """How fast that falls as a multiple of the direction is added."""
    return rule(lambda tau: direction(tau) / polynomial(tau) ** 2)


def _ready(law: ReturnLaw) -> ReturnLaw:
    """With the integral that phi2 is read from made, as every use of the law needs it."""
    law.closure_error_rad  # noqa: B018
    return law


@cache
def _gauss(points: int) -> Rule:
    unit, weights = gauss_rule(points)
    tau, shares = (1.0 + unit) / 2.0, weights / 2.0
    return lambda integrand: float(shares @ integrand(tau))


@cache
def _ends() -> ReturnEnds:
    return baler.law().return_law.ends
