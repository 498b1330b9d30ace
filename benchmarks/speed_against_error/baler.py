"""The published baler, which most studies measure, and its law to fifty digits.

The baler is that of designs/baler.yaml: J. Wang, C. Wang, L. Miao, "Design of a non-circular gear-crank slider baler
mechanism considering slider acceleration", Table 1, with the law speed solved for, a1 given at 20 r/min, and e = 0.

The exact law takes the coefficients of ncgear's polynomials as exact.  It uses the textbook's law of cosines, which
loses half the digits at a dead centre; fifty are enough for that.
"""

from __future__ import annotations

from collections.abc import Iterable
from functools import cache
from math import pi
from typing import Any

from mpmath import mp

from ncgear.mechanisms.crank_slider import CrankSlider
from ncgear.mechanisms.resistance import PolynomialResistance
from ncgear.mechanisms.slider_load import SliderLoad
from ncgear.optimum.task import Task
from ncgear.ratio.laws.three_segment import StrokeLaw, stroke_law
from ncgear.ratio.return_stroke import ReturnLaw
from ncgear.ratio.transmission import Lobes
from ncgear.ratio.working_stroke import ClosedStroke, StrokeRequest, solved_stroke

CONSTANT = 0.0
"""The return's e."""

LINKAGE = CrankSlider(380.0, 960.0)

COEFFICIENTS_N = (-131.2779, 3.447, 1.846e-2, -1.575e-4, 2.498e-7)
"""The resistance as a polynomial of the displacement in mm."""

TASK = Task(LINKAGE, SliderLoad(PolynomialResistance(COEFFICIENTS_N)), 2.0 * pi)
"""What studies of best laws ask for: this linkage and resistance at 60 r/min."""

DIGITS = 50

Real = Any
"""A number of mpmath, which has no types."""


@cache
def stroke() -> ClosedStroke:
    """The working stroke."""
    return solved_stroke(
        StrokeRequest(
            theta1_rad=0.4 * pi,
            theta2_rad=0.7 * pi,
            theta3_rad=pi,
            theta4_rad=1.3 * pi,
            v1=1600.0,
            v2=1100.0,
            a1=-1500.0,
            law_speed_rad_s=None,
            stroke_mm=LINKAGE.stroke_mm,
            a1_speed_rad_s=2.0 * pi / 3.0,
        )
    )


@cache
def law() -> StrokeLaw:
    """The closed law."""
    return stroke_law(stroke(), LINKAGE, Lobes(), constant=CONSTANT)


# --- to fifty digits -------------------------------------------------------------------------------------------------


def exact_driven_angle(phi1: Real) -> Real:
    """phi2 in rad within the working stroke, by the law of cosines in the triangle of crank, rod and slider's line."""
    crank, rod = mp.mpf(LINKAGE.crank_mm), mp.mpf(LINKAGE.rod_mm)
    position = _exact_displacement(phi1) + rod - crank
    return mp.pi - mp.acos((position**2 + crank**2 - rod**2) / (2 * crank * position))


def _exact_displacement(phi1: Real) -> Real:
    """Slider displacement in mm within the working stroke."""
    segments = stroke()
    if phi1 <= segments.theta2_rad:
        return phi1**2 * _polynomial(segments.approach_root, phi1)
    if phi1 <= segments.theta3_rad:
        return segments.pressing_start_mm + segments.pressing_mm_rad * (phi1 - segments.theta2_rad)
    before_end = segments.theta4_rad - phi1
    return segments.stroke_mm - before_end**2 * _polynomial(segments.braking_root, before_end)


def exact_return_ratio(of: ReturnLaw, phi1: Real) -> Real:
    """i12 of a return whose polynomial is the ratio."""
    ends = of.ends
    return _polynomial(of.polynomial.coef, (phi1 - ends.start_rad) / (mp.mpf(ends.end_rad) - ends.start_rad))


def exact_return_turned(of: ReturnLaw, phi1: Iterable[float]) -> list[Real]:
    """The driven angle in rad since the return's start, at rising driving angles, by quadrature from each to the next.

    Raises ArithmeticError if the quadrature itself misses 30 digits.
    """
    covered, at, all_covered = mp.mpf(0), mp.mpf(of.ends.start_rad), []
    for angle in phi1:
        gap = [at, mp.mpf(angle)]
        part, missed = mp.quad(lambda t: 1 / exact_return_ratio(of, t), gap, method="gauss-legendre", error=True)
        if missed > mp.mpf(10) ** -30:
            raise ArithmeticError(f"the reference's own quadrature is only good to {mp.nstr(missed, 2)}")
        covered, at = covered + part, gap[1]
        all_covered.append(covered)
    return all_covered


def _polynomial(coefficients: Iterable[float], at: Real) -> Real:
    """The value of a polynomial whose coefficients start with the constant."""
    return mp.polyval([mp.mpf(float(value)) for value in reversed(list(coefficients))], at)
