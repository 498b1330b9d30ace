"""Studies: length of a pitch curve, which module and centre distance are in proportion to."""

from __future__ import annotations

from collections.abc import Callable
from itertools import pairwise

import numpy as np
from scipy.integrate import quad, trapezoid

from ncgear.numerics import chebyshev
from ncgear.numerics.arrays import Array
from ncgear.precision import pitch_curves
from ncgear.precision.gauss import gauss_rule
from ncgear.precision.pitch_curves import Curve
from ncgear.precision.study import Level, Method, Study

SAMPLES = (40, 80, 160, 320, 640, 1280, 2560)
"""Multiples of 20: the baler's joints fall on samples, which makes the error fall evenly."""


def of_ellipse() -> Study:
    """Smooth and periodic."""
    return _study("pitch-length-ellipse", pitch_curves.of_ellipse(), None)


def of_baler() -> Study:
    """Smooth between joints."""
    return _study("pitch-length-baler", pitch_curves.of_baler(), 2.0)


def _study(key: str, curve: Curve, trapezoid_order: float | None) -> Study:
    """``trapezoid_order`` None: trapezoids converge faster than any power, as on smooth periodic functions."""

    def on(rule: Callable[[Curve, Level], float]) -> Callable[[Level], float]:
        return lambda level: rule(curve, level)

    return Study(
        key=key,
        title=f"Pitch length: {curve.name}",
        unit="share of the length",
        reference=f"{curve.length_reference}; module and centre distance are in proportion to the length",
        methods=(
            Method("Chebyshev panels", "degree", (8, 12, 16, 24, 32, 48), on(panels), adaptive=True),
            Method("Gauss-Legendre from joint to joint", "points", (4, 8, 12, 16, 24, 32, 48, 64), on(_by_gauss)),
            Method("adaptive quadrature", "tolerance", (1e-3, 1e-6, 1e-9, 1e-12), on(_adaptive), adaptive=True),
            Method("trapezoids", "samples", SAMPLES, on(_by_trapezoids), order=trapezoid_order),
            Method("polygon", "chords", SAMPLES, on(polygon), order=2.0),
        ),
        error=lambda length: error(curve, length),
        chosen=("Chebyshev panels", chebyshev.DEGREE),
        enough=1e-14,
        because="the arc length along the curve is wanted at every tooth, and its last value is the curve's length at "
        "no further cost; panels of a higher degree are found in fewer rounds, but cost more at every later "
        "reading, as the tables of the driven angle show",
    )


def error(curve: Curve, length: float) -> float:
    """Share of the exact length."""
    return float(abs(length / curve.length() - 1))


def panels(curve: Curve, degree: Level) -> float:
    """ncgear's own way, by the degree of its panels."""
    return chebyshev.fitted(curve.speed, curve.transmission.joints_rad, int(degree)).integrated().final


def _by_gauss(curve: Curve, points: Level) -> float:
    unit, weights = gauss_rule(int(points))
    joints = curve.transmission.joints_rad
    half = np.diff(joints)[:, None] / 2.0
    angles = joints[:-1, None] + half * (1.0 + unit)
    return float(np.sum(curve.speed(angles.ravel()).reshape(angles.shape) * half * weights))


def _adaptive(curve: Curve, tolerance: Level) -> float:
    def speed(phi1: float) -> float:
        return float(curve.speed(np.array([phi1]))[0])

    ends = pairwise(curve.transmission.joints_rad.tolist())
    return float(sum(quad(speed, start, end, epsabs=tolerance, epsrel=tolerance)[0] for start, end in ends))


def _by_trapezoids(curve: Curve, samples: Level) -> float:
    angles = _around(curve, samples)
    return float(trapezoid(curve.speed(angles), angles))


def polygon(curve: Curve, chords: Level) -> float:
    """Length of the closed polygon through points of the curve."""
    angles = _around(curve, chords)
    points = curve.radius(angles) * np.array([np.cos(angles), np.sin(angles)])
    return float(np.sum(np.hypot(*np.diff(points, axis=1))))


def _around(curve: Curve, gaps: Level) -> Array:
    return np.linspace(0.0, curve.transmission.lobes.driving_period_rad, int(gaps) + 1)
