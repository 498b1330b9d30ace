"""The study of inversion: from the slider's displacement in the working stroke to phi2 and i12."""

from __future__ import annotations

from functools import cache

import numpy as np
from mpmath import mp
from scipy.interpolate import CubicSpline

from ncgear.numerics.arrays import Array, Mask
from ncgear.numerics.jet import Jet, polynomial
from ncgear.ratio.laws.three_segment import working_pieces
from ncgear.ratio.transmission import Piece
from speed_against_error.baler import DIGITS, LINKAGE, exact_driven_angle, stroke
from speed_against_error.study import Method, Study

NEAR_RAD = np.array([1e-9, 1e-7, 1e-5, 1e-3])
"""The error is also taken at these distances from both dead centres."""

GRID = 321

START_ROWS = 33
"""Rows of the table from which Newton's method starts."""


def inversion_study() -> Study:
    """The baler's working stroke; the rows of results are phi2 in rad and i12, shape (2, n)."""
    return Study(
        key="inversion",
        title="Working stroke to driven angle and ratio",
        unit="rad, or share of i12",
        reference="50-digit inversion by the law of cosines, of the same stroke coefficients taken as exact; "
        "the larger of both errors",
        methods=(
            Method("half angle, zeros divided out", "", (0,), lambda _: by_half_angle(angles())),
            Method("law of cosines, as in textbooks", "", (0,), lambda _: by_law_of_cosines(angles())),
            Method("cubic splines", "samples a segment", (8, 16, 32, 64, 128, 256, 512), _by_splines, order=4.0),
            Method("linear table", "rows a segment", (16, 64, 256, 1024, 4096, 16384), _by_table, order=2.0),
            Method("Newton from a table", "steps", (0, 1, 2, 3, 5, 8, 16, 32), _by_newton),
        ),
        error=inversion_error,
        chosen=("half angle, zeros divided out", 0),
        enough=1e-14,
        because="it is exact to rounding up to and including both dead centres, has derivatives of any order, and "
        "needs neither a table nor a start",
    )


def inversion_error(result: Array) -> float:
    """The largest error: in rad of phi2, or as a share of i12."""
    driven, ratio = _exact()
    return float(max(np.max(np.abs(result[0] - driven)), np.max(np.abs(result[1] / ratio - 1.0))))


@cache
def angles() -> Array:
    """The driving angles in rad of the results, rising, shape (n,)."""
    end = stroke().theta4_rad
    inner = np.linspace(0.0, end, GRID)[1:-1]
    return np.concatenate([NEAR_RAD, inner, end - NEAR_RAD[::-1]])


@cache
def _exact() -> tuple[Array, Array]:
    """phi2 in rad and i12, which is one over the derivative of phi2."""
    with mp.workdps(DIGITS):
        found = [
            (float(exact_driven_angle(at)), float(1 / mp.diff(exact_driven_angle, at)))
            for at in map(mp.mpf, angles().tolist())
        ]
    driven, ratio = np.array(found).T
    return driven, ratio


def by_half_angle(phi1: Array) -> Array:
    """As ncgear does it."""
    return np.hstack([_rows(piece, phi1[_on(piece, phi1)]) for piece in _pieces()])


def by_law_of_cosines(phi1: Array) -> Array:
    """phi2 by the law of cosines, i12 from the slider's velocities by phi2 and by phi1."""
    moved, velocity = _displacement(phi1)
    crank, rod = LINKAGE.crank_mm, LINKAGE.rod_mm
    position = moved + (rod - crank)
    cosine = (position**2 + crank**2 - rod**2) / (2.0 * crank * position)
    driven = np.pi - np.arccos(np.clip(cosine, -1.0, 1.0))
    lateral = crank * np.sin(driven)
    by_driven = lateral * (1.0 - crank * np.cos(driven) / np.sqrt(rod**2 - lateral**2))
    return np.array([driven, by_driven / velocity])


def _by_splines(samples: int) -> Array:
    return np.hstack([CubicSpline(knots, rows, axis=1)(at) for at, knots, rows in _sampled(samples)])


def _by_table(rows: int) -> Array:
    found = [[np.interp(at, knots, row) for row in table] for at, knots, table in _sampled(rows)]
    return np.hstack([np.array(rows) for rows in found])


def _by_newton(steps: int) -> Array:
    """Newton's method on the linkage's displacement, which starts from a table of phi2."""
    phi1 = angles()
    moved, velocity = _displacement(phi1)
    driven = np.hstack([np.interp(at, knots, table[0]) for at, knots, table in _sampled(START_ROWS)])
    for _ in range(steps):
        now = LINKAGE.displacement(Jet.variable(driven, 1))
        driven = driven - (now.value - moved) / now.derivative(1)
    return np.array([driven, LINKAGE.displacement(Jet.variable(driven, 1)).derivative(1) / velocity])


def _sampled(samples: int) -> list[tuple[Array, Array, Array]]:
    """For each segment the angles asked for, the knots, and exact values at the knots, computed anew for each table."""
    phi1, found = angles(), []
    for piece in _pieces():
        knots = np.linspace(piece.start_rad, piece.end_rad, samples)
        found.append((phi1[_on(piece, phi1)], knots, _rows(piece, knots)))
    return found


def _rows(piece: Piece, phi1: Array) -> Array:
    found = piece.driven_angle(phi1, 1)
    return np.array([found.value, 1.0 / found.derivative(1)])


def _on(piece: Piece, phi1: Array) -> Mask:
    """Which angles are on a segment; a joint belongs to the segment before it, as in the reference."""
    return (phi1 > piece.start_rad) & (phi1 <= piece.end_rad)


@cache
def _pieces() -> tuple[Piece, ...]:
    return working_pieces(stroke(), LINKAGE)


def _displacement(phi1: Array) -> tuple[Array, Array]:
    """Slider displacement in mm and its derivative by phi1."""
    segments, angle = stroke(), Jet.variable(phi1, 1)
    before_end = -(angle - segments.theta4_rad)
    jets = [
        angle * angle * polynomial(segments.approach_root, angle),
        (angle - segments.theta2_rad) * segments.pressing_mm_rad + segments.pressing_start_mm,
        segments.stroke_mm - before_end * before_end * polynomial(segments.braking_root, before_end),
    ]
    rows = [one.coefficients for one in jets]
    moved, velocity = np.select([phi1 <= segments.theta2_rad, phi1 <= segments.theta3_rad], rows[:2], rows[2])
    return moved, velocity
