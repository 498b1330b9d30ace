"""Study: the working stroke inverted through the linkage, to phi2 and i12."""

from __future__ import annotations

from functools import cache

import numpy as np
from scipy.interpolate import CubicSpline

from ncgear.numerics import jet
from ncgear.numerics.arrays import Array, Mask
from ncgear.numerics.jet import Jet
from ncgear.precision import baler, exact
from ncgear.precision.study import Method, Study
from ncgear.ratio.laws.three_segment import working_pieces
from ncgear.ratio.transmission import Piece

NEAR_RAD = np.array([1e-9, 1e-7, 1e-5, 1e-3])
"""How near to both dead centres the error is looked at as well."""

GRID = 321

START_ROWS = 33
"""Rows of the table that Newton's method starts from."""


def study() -> Study:
    """The baler's working stroke; rows of results are phi2 in rad and i12, shape (2, n)."""
    return Study(
        key="inversion",
        title="Working stroke to driven angle and ratio",
        unit="rad, or share of i12",
        reference="50-digit inversion by the law of cosines, of the same stroke coefficients taken as exact; "
        "the larger of both errors",
        methods=(
            Method("half angle, zeros divided out", "", (0,), lambda _: closed_form(angles())),
            Method("law of cosines, as in textbooks", "", (0,), lambda _: textbook(angles())),
            Method("cubic splines", "samples a segment", (8, 16, 32, 64, 128, 256, 512), _splined, order=4.0),
            Method("linear table", "rows a segment", (16, 64, 256, 1024, 4096, 16384), _tabled, order=2.0),
            Method("Newton from a table", "steps", (0, 1, 2, 3, 5, 8, 16, 32), _newton),
        ),
        error=error,
        chosen=("half angle, zeros divided out", 0),
        enough=1e-14,
        because="it is exact to rounding up to and including both dead centres, has derivatives of any order, and "
        "needs neither a table nor a start",
    )


def error(result: Array) -> float:
    """Largest error in rad of phi2 and share of i12, at driving angles up to 1e-9 rad from both dead centres."""
    driven, ratio = _reference()
    return float(max(np.max(np.abs(result[0] - driven)), np.max(np.abs(result[1] / ratio - 1.0))))


def closed_form(phi1: Array) -> Array:
    """ncgear's own way."""
    return np.hstack([_rows(piece, phi1[_on(piece, phi1)]) for piece in _pieces()])


def textbook(phi1: Array) -> Array:
    """phi2 by the law of cosines, i12 from velocities: the slider's by phi2 over the slider's by phi1."""
    linkage, (moved, velocity) = baler.linkage(), _displacement(phi1)
    crank, rod = linkage.crank_mm, linkage.rod_mm
    position = moved + (rod - crank)
    cosine = (position**2 + crank**2 - rod**2) / (2.0 * crank * position)
    driven = np.pi - np.arccos(np.clip(cosine, -1.0, 1.0))
    lateral = crank * np.sin(driven)
    by_driven = lateral * (1.0 - crank * np.cos(driven) / np.sqrt(rod**2 - lateral**2))
    return np.array([driven, by_driven / velocity])


def _splined(samples: int) -> Array:
    return np.hstack([CubicSpline(knots, rows, axis=1)(at) for at, knots, rows in _sampled(samples)])


def _tabled(rows: int) -> Array:
    found = [[np.interp(at, knots, row) for row in table] for at, knots, table in _sampled(rows)]
    return np.hstack([np.array(rows) for rows in found])


def _newton(steps: int) -> Array:
    """Steps on the linkage's displacement, from a table of phi2."""
    phi1 = angles()
    moved, velocity = _displacement(phi1)
    driven = np.hstack([np.interp(at, knots, table[0]) for at, knots, table in _sampled(START_ROWS)])
    for _ in range(steps):
        now = baler.linkage().displacement(Jet.variable(driven, 1))
        driven = driven - (now.value - moved) / now.derivative(1)
    return np.array([driven, baler.linkage().displacement(Jet.variable(driven, 1)).derivative(1) / velocity])


def _sampled(samples: int) -> list[tuple[Array, Array, Array]]:
    """On each segment the angles asked for, the knots and exact values at them: made anew, as a table would be."""
    phi1, found = angles(), []
    for piece in _pieces():
        knots = np.linspace(piece.start_rad, piece.end_rad, samples)
        found.append((phi1[_on(piece, phi1)], knots, _rows(piece, knots)))
    return found


def _rows(piece: Piece, phi1: Array) -> Array:
    found = piece.driven_angle(phi1, 1)
    return np.array([found.value, 1.0 / found.derivative(1)])


def _displacement(phi1: Array) -> tuple[Array, Array]:
    """Slider displacement in mm and its derivative by phi1, by segments."""
    stroke, angle = baler.stroke(), Jet.variable(phi1, 1)
    before_end = -(angle - stroke.theta4_rad)
    segments = [
        angle * angle * jet.polynomial(stroke.approach_root, angle),
        (angle - stroke.theta2_rad) * stroke.pressing_mm_rad + stroke.pressing_start_mm,
        stroke.stroke_mm - before_end * before_end * jet.polynomial(stroke.braking_root, before_end),
    ]
    rows = [segment.coefficients for segment in segments]
    moved, velocity = np.select([phi1 <= stroke.theta2_rad, phi1 <= stroke.theta3_rad], rows[:2], rows[2])
    return moved, velocity


def _on(piece: Piece, phi1: Array) -> Mask:
    """Joints belong to the segment before them, as in the reference."""
    return (phi1 > piece.start_rad) & (phi1 <= piece.end_rad)


@cache
def _pieces() -> tuple[Piece, ...]:
    return working_pieces(baler.stroke(), baler.linkage())


@cache
def angles() -> Array:
    """Driving angles in rad that results are wanted at, rising, shape (n,)."""
    end = baler.stroke().theta4_rad
    inner = np.linspace(0.0, end, GRID)[1:-1]
    return np.concatenate([NEAR_RAD, inner, end - NEAR_RAD[::-1]])


@cache
def _reference() -> tuple[Array, Array]:
    """phi2 in rad and i12, which is one over the derivative of phi2."""
    from mpmath import mp

    def driven(phi1: exact.Real) -> exact.Real:
        return exact.driven_angle(baler.stroke(), baler.linkage(), phi1)

    with mp.workdps(exact.DIGITS):
        rows = [(float(driven(at)), float(1 / mp.diff(driven, at))) for at in map(mp.mpf, angles().tolist())]
    values, ratios = np.array(rows).T
    return values, ratios
