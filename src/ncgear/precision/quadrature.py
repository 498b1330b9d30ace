"""Studies: phi2 by quadrature of 1/i12, over an ellipse's whole cycle and over the baler's return."""

from __future__ import annotations

from collections.abc import Callable
from functools import cache
from math import pi

import numpy as np
from numpy.polynomial import polynomial

from ncgear.numerics import chebyshev
from ncgear.numerics.arrays import Array
from ncgear.precision import baler, exact
from ncgear.precision import quadrature_rules as rules
from ncgear.precision.quadrature_rules import Reader, Stretch, read
from ncgear.precision.study import Level, Method, Study
from ncgear.ratio.transmission import CLOSED

ECCENTRICITY = 0.98
"""i12 from 1/99 to 99: steeper than teeth can follow."""


def of_ellipse() -> Study:
    """phi2 of equal elliptical gears."""
    return _study(
        "driven-angle-ellipse",
        f"Driven angle by quadrature: ellipse of eccentricity {ECCENTRICITY:g}",
        "closed form, tan(phi2/2) = (1 - e)/(1 + e) tan(phi1/2), in 50 digits",
        ellipse(),
        enough=CLOSED,
    )


def of_return() -> Study:
    """phi2 of the baler's return."""
    return _study(
        "driven-angle-return",
        "Driven angle by quadrature: the baler's return",
        "50-digit quadrature of one over the return's polynomial, whose coefficients are taken as exact",
        return_of_baler(),
        enough=CLOSED / 20.0,
    )


def _study(key: str, title: str, reference: str, stretch: Stretch, enough: float) -> Study:
    return Study(
        key=key,
        title=title,
        unit="rad",
        reference=reference,
        methods=_methods(stretch),
        error=lambda result: error(stretch, result),
        chosen=("Chebyshev panels", chebyshev.DEGREE),
        enough=enough,
        because="panels are halved until they are resolved, a pole is told from a steep place, and the same form gives "
        "arc lengths, curves and their bounds",
    )


def error(stretch: Stretch, result: Array) -> float:
    """Largest error of phi2 at the readings in rad."""
    return float(np.max(np.abs(result - stretch.reference())))


def _methods(stretch: Stretch) -> tuple[Method, ...]:
    def reading(made: Callable[[Stretch, Level], Reader]) -> Callable[[Level], Array]:
        return lambda level: read(stretch, made(stretch, level))

    return (
        Method("Chebyshev panels", "degree", (6, 8, 12, 16, 24, 32, 48), reading(rules.panels), adaptive=True),
        Method("one Chebyshev series", "degree", (8, 16, 32, 64, 128, 256, 512), reading(rules.series)),
        Method(f"Gauss-Legendre in {rules.GAPS} gaps", "points", (1, 2, 4, 8, 16, 24, 32), reading(rules.gauss)),
        Method("adaptive quadrature", "tolerance", (1e-6, 1e-12), reading(rules.adaptive), adaptive=True),
        Method(
            "cubic spline, integrated", "samples", (65, 129, 257, 513, 1025, 2049), reading(rules.spline), order=4.0
        ),
        Method(
            "cumulative trapezoids", "samples", (257, 1025, 4097, 16385, 65537), reading(rules.trapezoids), order=2.0
        ),
        Method(
            "Runge-Kutta, order 8", "tolerance", (1e-4, 1e-6, 1e-8, 1e-10, 1e-12), reading(rules.stepped), adaptive=True
        ),
    )


@cache
def ellipse() -> Stretch:
    """1/i12 = (1 - e^2) / (1 + e^2 + 2 e cos phi1), over one turn."""
    e = ECCENTRICITY
    return Stretch(lambda phi1: (1.0 - e**2) / (1.0 + e**2 + 2.0 * e * np.cos(phi1)), 0.0, 2.0 * pi, _ellipse_reference)


@cache
def return_of_baler() -> Stretch:
    """From the extended dead centre to the retracted one."""
    law = baler.law().return_law
    start, length = law.ends.start_rad, law.ends.length_rad

    def slope(phi1: Array) -> Array:
        values: Array = 1.0 / polynomial.polyval((phi1 - start) / length, law.polynomial.coef)
        return values

    return Stretch(slope, start, law.ends.end_rad, _return_reference)


@cache
def _ellipse_reference() -> Array:
    from mpmath import mp

    readings = ellipse().readings_rad
    with mp.workdps(exact.DIGITS):
        share = (1 - mp.mpf(ECCENTRICITY)) / (1 + mp.mpf(ECCENTRICITY))
        halves = [mp.mpf(angle) / 2 for angle in readings.ravel().tolist()]
        # From 0 to 2 pi the sine of the half angle is not negative, and the quarter that atan2 finds is the right one.
        values = [float(2 * mp.atan2(share * mp.sin(half), mp.cos(half))) for half in halves]
    return np.array(values).reshape(readings.shape)


@cache
def _return_reference() -> Array:
    from mpmath import mp

    readings = return_of_baler().readings_rad
    order = np.argsort(readings, axis=None)
    values = np.empty(readings.size)
    with mp.workdps(exact.DIGITS):
        turned = exact.return_turned(baler.law().return_law, readings.ravel()[order].tolist())
        values[order] = [float(value) for value in turned]
    return values.reshape(readings.shape)
