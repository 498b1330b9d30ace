"""The studies of pitch curves: length and curvature of the driving curve, for an ellipse and for the baler.

All curves have unit centre distance.  The ellipse has closed forms as references.  The baler's phi2 is differentiated
with so many digits that a difference quotient is exact; r1 = w / (1 + w) with w = dphi2/dphi1, and length and curvature
follow from r1 and its derivatives in polar coordinates.
"""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass
from functools import cache
from itertools import pairwise

import numpy as np
from mpmath import mp
from numpy.polynomial import Chebyshev
from scipy.integrate import quad, trapezoid
from scipy.interpolate import CubicSpline

from ncgear.numerics.arrays import Array
from ncgear.numerics.chebyshev import DEGREE, fitted
from ncgear.pitch.shape import Gear, Mesh, curvature, radius, speed
from ncgear.ratio.laws.ellipse import elliptical_law
from ncgear.ratio.transmission import Lobes, Piece, Transmission
from speed_against_error.baler import DIGITS, Real, exact_driven_angle, exact_return_ratio, law
from speed_against_error.driven_angle import gauss_rule
from speed_against_error.study import Level, Method, Study

EXTERNAL_DRIVING = Gear.DRIVING, Mesh.EXTERNAL

ECCENTRICITY = 0.5
"""i12 runs from 1/3 to 3."""

LENGTH_DIGITS = 25


# --- the curves and their references ---------------------------------------------------------------------------------


@dataclass(frozen=True, eq=False)
class Curve:
    """A law's driving pitch curve, with its exact length and its exact curvatures at driving angles in rad."""

    name: str
    transmission: Transmission
    exact_length: Callable[[], Real]
    exact_curvature: Callable[[Array], Array]
    length_reference: str
    curvature_reference: str

    def radius(self, phi1: Array) -> Array:
        """The pitch radius, shape (n,)."""
        return radius(self.transmission.driven_angle(phi1, 1).differentiated(), *EXTERNAL_DRIVING).value

    def speed(self, phi1: Array) -> Array:
        """The arc length per driving angle, shape (n,)."""
        return speed(self.transmission.driven_angle(phi1, 2).differentiated(), *EXTERNAL_DRIVING).value


def ellipse_curve() -> Curve:
    """One of two equal ellipses."""
    return Curve(
        f"ellipse of eccentricity {ECCENTRICITY:g}",
        elliptical_law(ECCENTRICITY, 0.0, Lobes()),
        _ellipse_length,
        _ellipse_curvature,
        "4 a E(e), the complete elliptic integral in 50 digits",
        "the ellipse's closed form about a focus, in 50 digits",
    )


def baler_curve() -> Curve:
    """The published baler's."""
    return Curve(
        "the baler",
        law().transmission,
        _baler_length,
        _baler_curvature,
        "25-digit quadrature from joint to joint, of phi2 by the law of cosines and of the return's polynomial",
        "polar coordinates in 50 digits, of phi2 by the law of cosines and of the return's polynomial",
    )


def _ellipse_length() -> Real:
    """4 a E(e); a = 1/2 is the large semi-axis, because two vertices and two foci are one centre distance apart."""
    with mp.workdps(DIGITS):
        return 2 * mp.ellipe(mp.mpf(ECCENTRICITY) ** 2)


def _ellipse_curvature(phi1: Array) -> Array:
    """(1 + e cos t)^3 / (p (1 + 2 e cos t + e^2)^(3/2)) at the polar angle t about a focus, p = (1 - e^2) / 2."""

    def at(angle: float) -> Real:
        e, cosine = mp.mpf(ECCENTRICITY), mp.cos(mp.mpf(angle))
        return 2 * (1 + e * cosine) ** 3 / ((1 - e**2) * mp.sqrt(1 + 2 * e * cosine + e**2) ** 3)

    with mp.workdps(DIGITS):
        return np.array([float(at(angle)) for angle in phi1.tolist()])


@cache
def _baler_length() -> Real:
    """Gauss-Legendre quadrature from joint to joint; raises ArithmeticError if it misses 20 digits itself."""

    def exact_speed(phi1: Real) -> Real:
        at, first = _baler_radius(phi1, 1)
        return mp.sqrt(at**2 + first**2)

    with mp.workdps(LENGTH_DIGITS):
        joints = [mp.mpf(angle) for angle in law().transmission.joints_rad.tolist()]
        parts = [mp.quad(exact_speed, ends, method="gauss-legendre", error=True) for ends in pairwise(joints)]
        missed = max(part[1] for part in parts)
        if missed > mp.mpf(10) ** -20:
            raise ArithmeticError(f"the reference's own quadrature is only good to {mp.nstr(missed, 2)}")
        return sum(part[0] for part in parts)


def _baler_curvature(phi1: Array) -> Array:
    """At driving angles in rad between the joints, shape (n,)."""

    def at(angle: float) -> Real:
        here, first, second = _baler_radius(mp.mpf(angle), 2)
        return (here**2 + 2 * first**2 - here * second) / mp.sqrt(here**2 + first**2) ** 3

    with mp.workdps(DIGITS):
        return np.array([float(at(angle)) for angle in phi1.tolist()])


def _baler_radius(phi1: Real, order: int) -> list[Real]:
    """r1 and its derivatives by phi1, up to the first or the second."""
    of = law().return_law
    if phi1 > of.ends.start_rad:
        slopes = list(mp.diffs(lambda angle: 1 / exact_return_ratio(of, angle), phi1, order))
    else:
        slopes = list(mp.diffs(exact_driven_angle, phi1, order + 1))[1:]
    turned, bent, *third = slopes
    second = [last / (1 + turned) ** 2 - 2 * bent**2 / (1 + turned) ** 3 for last in third]
    return [turned / (1 + turned), bent / (1 + turned) ** 2, *second]


# --- length ----------------------------------------------------------------------------------------------------------

SAMPLES = (40, 80, 160, 320, 640, 1280, 2560)
"""Multiples of 20: the baler's joints then fall on samples, and the error falls evenly."""


def ellipse_length_study() -> Study:
    """The curve is smooth and periodic: trapezoids converge faster than any power."""
    return _length_study("pitch-length-ellipse", ellipse_curve(), None)


def baler_length_study() -> Study:
    """The curve is smooth only between its joints."""
    return _length_study("pitch-length-baler", baler_curve(), 2.0)


def _length_study(key: str, curve: Curve, trapezoid_order: float | None) -> Study:
    def on(rule: Callable[[Curve, Level], float]) -> Callable[[Level], float]:
        return lambda level: rule(curve, level)

    return Study(
        key=key,
        title=f"Pitch length: {curve.name}",
        unit="share of the length",
        reference=f"{curve.length_reference}; module and centre distance are in proportion to the length",
        methods=(
            Method("Chebyshev panels", "degree", (8, 12, 16, 24, 32, 48), on(length_by_panels), adaptive=True),
            Method("Gauss-Legendre from joint to joint", "points", (4, 8, 12, 16, 24, 32, 48, 64), on(_by_gauss)),
            Method("adaptive quadrature", "tolerance", (1e-3, 1e-6, 1e-9, 1e-12), on(_by_quadpack), adaptive=True),
            Method("trapezoids", "samples", SAMPLES, on(_by_trapezoids), order=trapezoid_order),
            Method("polygon", "chords", SAMPLES, on(_by_polygon), order=2.0),
        ),
        error=lambda length: length_error(curve, length),
        chosen=("Chebyshev panels", DEGREE),
        enough=1e-14,
        because="the arc length along the curve is wanted at every tooth, and its last value is the curve's length at "
        "no further cost; panels of a higher degree are found in fewer rounds, but cost more at every later "
        "reading, as the tables of the driven angle show",
    )


def length_error(curve: Curve, length: float) -> float:
    """The error as a share of the exact length."""
    return float(abs(length / curve.exact_length() - 1))


def length_by_panels(curve: Curve, degree: Level) -> float:
    """As ncgear does it, with panels of any degree."""
    return fitted(curve.speed, curve.transmission.joints_rad, int(degree)).integrated().final


def _by_gauss(curve: Curve, points: Level) -> float:
    unit, weights = gauss_rule(int(points))
    joints = curve.transmission.joints_rad
    half = np.diff(joints)[:, None] / 2.0
    angles = joints[:-1, None] + half * (1.0 + unit)
    return float(np.sum(curve.speed(angles.ravel()).reshape(angles.shape) * half * weights))


def _by_quadpack(curve: Curve, tolerance: Level) -> float:
    def at(phi1: float) -> float:
        return float(curve.speed(np.array([phi1]))[0])

    ends = pairwise(curve.transmission.joints_rad.tolist())
    return float(sum(quad(at, start, end, epsabs=tolerance, epsrel=tolerance)[0] for start, end in ends))


def _by_trapezoids(curve: Curve, samples: Level) -> float:
    angles = _around(curve, samples)
    return float(trapezoid(curve.speed(angles), angles))


def _by_polygon(curve: Curve, chords: Level) -> float:
    """The length of the closed polygon through points of the curve."""
    angles = _around(curve, chords)
    points = curve.radius(angles) * np.array([np.cos(angles), np.sin(angles)])
    return float(np.sum(np.hypot(*np.diff(points, axis=1))))


def _around(curve: Curve, gaps: Level) -> Array:
    return np.linspace(0.0, curve.transmission.lobes.driving_period_rad, int(gaps) + 1)


# --- curvature -------------------------------------------------------------------------------------------------------

POINTS = 24
"""Driving angles of the results on each piece of the law; none is on a joint."""

DIFFERENCED = (65, 129, 257, 513, 1025, 2049, 4097, 8193)
SPLINED = (129, 257, 513, 1025, 2049, 4097)

Derivatives = tuple[Array, Array, Array]
"""The radius and its first two derivatives by phi1 at the points of a piece."""


def ellipse_curvature_study() -> Study:
    """The law has one piece."""
    return _curvature_study("curvature-ellipse", ellipse_curve())


def baler_curvature_study() -> Study:
    """The law has four pieces."""
    return _curvature_study("curvature-baler", baler_curve())


def _curvature_study(key: str, curve: Curve) -> Study:
    def sampled(derivatives: Callable[[Piece, Level], Derivatives]) -> Callable[[Level], Array]:
        return lambda level: _by_pieces(curve, lambda piece: _polar_curvature(*derivatives(piece, level)))

    return Study(
        key=key,
        title=f"Curvature of the pitch curve: {curve.name}",
        unit="share of the largest curvature",
        reference=curve.curvature_reference,
        methods=(
            Method("derivatives of the law", "", (0,), lambda _: curvature_by_derivatives(curve)),
            Method("central differences", "samples a piece", DIFFERENCED, sampled(_differences), order=2.0),
            Method("cubic spline", "samples a piece", SPLINED, sampled(_spline), order=2.0),
            Method("Chebyshev series", "degree", (8, 16, 32, 64, 128, 256), sampled(_series)),
        ),
        error=lambda result: curvature_error(curve, result),
        chosen=("derivatives of the law", 0),
        enough=1e-13,
        because="derivatives are as exact as values, and no sample has to be dense enough",
    )


def curvature_error(curve: Curve, result: Array) -> float:
    """The largest error as a share of the largest curvature."""
    exact = curve.exact_curvature(_by_pieces(curve, _angles))
    return float(np.max(np.abs(result - exact)) / np.max(np.abs(exact)))


def curvature_by_derivatives(curve: Curve) -> Array:
    """As ncgear does it."""
    return _by_pieces(curve, lambda piece: curvature(piece.slope(_angles(piece), 2), *EXTERNAL_DRIVING).value)


def _by_pieces(curve: Curve, on_piece: Callable[[Piece], Array]) -> Array:
    return np.concatenate([on_piece(piece) for piece in curve.transmission.pieces])


def _angles(piece: Piece) -> Array:
    """The driving angles of the results on a piece."""
    return piece.start_rad + (piece.end_rad - piece.start_rad) * (np.arange(POINTS) + 0.5) / POINTS


def _polar_curvature(at: Array, first: Array, second: Array) -> Array:
    """k = (r^2 + 2 r'^2 - r r'') / (r^2 + r'^2)^(3/2)."""
    return (at**2 + 2.0 * first**2 - at * second) / (at**2 + first**2) ** 1.5


def _differences(piece: Piece, samples: Level) -> Derivatives:
    knots = np.linspace(piece.start_rad, piece.end_rad, int(samples))
    rows, gap, at = _piece_radius(piece, knots), knots[1] - knots[0], _angles(piece)
    first = (rows[2:] - rows[:-2]) / (2.0 * gap)
    second = (rows[2:] - 2.0 * rows[1:-1] + rows[:-2]) / gap**2
    inner = knots[1:-1]
    return np.interp(at, knots, rows), np.interp(at, inner, first), np.interp(at, inner, second)


def _spline(piece: Piece, samples: Level) -> Derivatives:
    knots, at = np.linspace(piece.start_rad, piece.end_rad, int(samples)), _angles(piece)
    spline = CubicSpline(knots, _piece_radius(piece, knots))
    return spline(at), spline(at, 1), spline(at, 2)


def _series(piece: Piece, degree: Level) -> Derivatives:
    domain, at = (piece.start_rad, piece.end_rad), _angles(piece)
    series = Chebyshev.interpolate(lambda phi1: _piece_radius(piece, phi1), int(degree), domain=domain)
    return series(at), series.deriv()(at), series.deriv(2)(at)


def _piece_radius(piece: Piece, phi1: Array) -> Array:
    return radius(piece.slope(phi1, 0), *EXTERNAL_DRIVING).value
