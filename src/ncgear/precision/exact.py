"""Fifty-digit references of the working stroke and the return, from their coefficients taken as exact.

The textbook's law of cosines is enough here: what it loses at a dead centre are digits there are plenty of.
mpmath is loaded where it is needed, and by nothing but the studies.
"""

from __future__ import annotations

from collections.abc import Iterable
from typing import Any

from ncgear.mechanisms.crank_slider import CrankSlider
from ncgear.ratio.return_stroke import ReturnLaw
from ncgear.ratio.working_stroke import WorkingStroke

DIGITS = 50

Real = Any
"""An mpf; mpmath carries no types."""


def displacement(stroke: WorkingStroke, phi1: Real) -> Real:
    """Slider displacement in mm within the working stroke."""
    if phi1 <= stroke.theta2_rad:
        return phi1**2 * _polynomial(stroke.approach_root, phi1)
    if phi1 <= stroke.theta3_rad:
        return stroke.pressing_start_mm + stroke.pressing_mm_rad * (phi1 - stroke.theta2_rad)
    before_end = stroke.theta4_rad - phi1
    return stroke.stroke_mm - before_end**2 * _polynomial(stroke.braking_root, before_end)


def driven_angle(stroke: WorkingStroke, linkage: CrankSlider, phi1: Real) -> Real:
    """phi2 in rad within the working stroke, by the law of cosines in the triangle crank, rod, slider's line.

    Raises ValueError for a linkage with an offset, which has no such triangle.
    """
    from mpmath import mp

    if linkage.offset_mm != 0.0:
        raise ValueError("only a linkage in line has its crank, rod and slider in one triangle")
    crank, rod = mp.mpf(linkage.crank_mm), mp.mpf(linkage.rod_mm)
    position = displacement(stroke, phi1) + rod - crank
    return mp.pi - mp.acos((position**2 + crank**2 - rod**2) / (2 * crank * position))


def return_ratio(law: ReturnLaw, phi1: Real) -> Real:
    """i12 of a return whose polynomial is the ratio."""
    ends = law.ends
    return _polynomial(law.polynomial.coef, (phi1 - ends.start_rad) / (_real(ends.end_rad) - ends.start_rad))


def return_turned(law: ReturnLaw, phi1: Iterable[float]) -> list[Real]:
    """Driven angle in rad covered since the return's start, at rising driving angles: quadrature from each to the next.

    Raises ArithmeticError where the quadrature itself says that it missed 30 digits.
    """
    from mpmath import mp

    covered, at, all_covered = mp.mpf(0), _real(law.ends.start_rad), []
    for angle in phi1:
        ends = [at, _real(angle)]
        part, missed = mp.quad(lambda t: 1 / return_ratio(law, t), ends, method="gauss-legendre", error=True)
        if missed > mp.mpf(10) ** -30:
            raise ArithmeticError(f"the reference's own quadrature is only good to {mp.nstr(missed, 2)}")
        covered, at = covered + part, ends[1]
        all_covered.append(covered)
    return all_covered


def _real(value: float) -> Real:
    from mpmath import mp

    return mp.mpf(value)


def _polynomial(coefficients: Iterable[float], at: Real) -> Real:
    """Powers from the constant term upwards."""
    from mpmath import mp

    return mp.polyval([mp.mpf(float(value)) for value in reversed(list(coefficients))], at)
