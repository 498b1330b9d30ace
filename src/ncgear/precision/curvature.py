"""Studies: curvature of a pitch curve, from exact derivatives or from samples of its radius."""

from __future__ import annotations

from collections.abc import Callable

import numpy as np
from numpy.polynomial import Chebyshev
from scipy.interpolate import CubicSpline

from ncgear.numerics.arrays import Array
from ncgear.pitch import shape
from ncgear.precision import pitch_curves
from ncgear.precision.pitch_curves import DRIVING, Curve
from ncgear.precision.study import Level, Method, Study
from ncgear.ratio.transmission import Piece

POINTS = 24
"""Driving angles on each piece that curvature is wanted at, none on a joint."""

Derivatives = tuple[Array, Array, Array]
"""The radius and its first two derivatives by phi1 at the points of a piece."""


def of_ellipse() -> Study:
    """One piece."""
    return _study("curvature-ellipse", pitch_curves.of_ellipse())


def of_baler() -> Study:
    """Four pieces."""
    return _study("curvature-baler", pitch_curves.of_baler())


def _study(key: str, curve: Curve) -> Study:
    def sampled(derivatives: Callable[[Piece, Level], Derivatives]) -> Callable[[Level], Array]:
        return lambda level: _by_pieces(curve, lambda piece: _curvature(derivatives(piece, level)))

    return Study(
        key=key,
        title=f"Curvature of the pitch curve: {curve.name}",
        unit="share of the largest curvature",
        reference=curve.curvature_reference,
        methods=(
            Method("derivatives of the law", "", (0,), lambda _: closed_form(curve)),
            Method("central differences", "samples a piece", DIFFERENCED, sampled(_differences), order=2.0),
            Method("cubic spline", "samples a piece", SPLINED, sampled(_spline), order=2.0),
            Method("Chebyshev series", "degree", (8, 16, 32, 64, 128, 256), sampled(_series)),
        ),
        error=lambda result: error(curve, result),
        chosen=("derivatives of the law", 0),
        enough=1e-13,
        because="derivatives are as exact as values, and no sample has to be dense enough",
    )


DIFFERENCED = (65, 129, 257, 513, 1025, 2049, 4097, 8193)
SPLINED = (129, 257, 513, 1025, 2049, 4097)


def error(curve: Curve, result: Array) -> float:
    """Largest error as a share of the largest curvature."""
    exact = curve.curvature(np.concatenate([points_rad(piece) for piece in curve.transmission.pieces]))
    return float(np.max(np.abs(result - exact)) / np.max(np.abs(exact)))


def closed_form(curve: Curve) -> Array:
    """ncgear's own way."""
    return _by_pieces(curve, lambda piece: shape.curvature(piece.slope(points_rad(piece), 2), *DRIVING).value)


def points_rad(piece: Piece) -> Array:
    """Driving angles of the results on a piece."""
    return piece.start_rad + (piece.end_rad - piece.start_rad) * (np.arange(POINTS) + 0.5) / POINTS


def _by_pieces(curve: Curve, on_piece: Callable[[Piece], Array]) -> Array:
    return np.concatenate([on_piece(piece) for piece in curve.transmission.pieces])


def _curvature(derivatives: Derivatives) -> Array:
    """k = (r^2 + 2 r'^2 - r r'') / (r^2 + r'^2)^(3/2)."""
    radius, first, second = derivatives
    return (radius**2 + 2.0 * first**2 - radius * second) / (radius**2 + first**2) ** 1.5


def _differences(piece: Piece, samples: Level) -> Derivatives:
    knots = np.linspace(piece.start_rad, piece.end_rad, int(samples))
    radius, gap, at = _radius(piece, knots), knots[1] - knots[0], points_rad(piece)
    first = (radius[2:] - radius[:-2]) / (2.0 * gap)
    second = (radius[2:] - 2.0 * radius[1:-1] + radius[:-2]) / gap**2
    inner = knots[1:-1]
    return np.interp(at, knots, radius), np.interp(at, inner, first), np.interp(at, inner, second)


def _spline(piece: Piece, samples: Level) -> Derivatives:
    knots, at = np.linspace(piece.start_rad, piece.end_rad, int(samples)), points_rad(piece)
    spline = CubicSpline(knots, _radius(piece, knots))
    return spline(at), spline(at, 1), spline(at, 2)


def _series(piece: Piece, degree: Level) -> Derivatives:
    domain, at = (piece.start_rad, piece.end_rad), points_rad(piece)
    series = Chebyshev.interpolate(lambda phi1: _radius(piece, phi1), int(degree), domain=domain)
    return series(at), series.deriv()(at), series.deriv(2)(at)


def _radius(piece: Piece, phi1: Array) -> Array:
    return shape.radius(piece.slope(phi1, 0), *DRIVING).value
