"""Study: the return's polynomial from its six conditions, by the basis that it is written in."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import replace
from functools import cache

import numpy as np
from numpy.polynomial import chebyshev, polynomial

from ncgear.numerics.arrays import Array
from ncgear.precision import baler, exact
from ncgear.precision.study import Method, Study
from ncgear.ratio.return_stroke import ReturnEnds, published_family

POINTS = 201

SHORT = 0.97
"""Share of the turn after which the second return starts: nearly all is working stroke."""

Rows = Callable[[ReturnEnds, Array, int], Array]
"""Values of six basis functions, or of their first derivatives by phi1, at points: shape (n, 6)."""


def study() -> Study:
    """Returns with e = 0 and a given ratio in their middle; results are i12 at POINTS points of each, shape (2, n)."""
    return Study(
        key="return-basis",
        title="Basis of the return's polynomial: the baler's, and one of 3 % of the turn",
        unit="share of i12",
        reference="the six conditions solved in 50 digits",
        methods=(
            Method("end conditions in closed form, [0, 1]", "", (0,), lambda _: ncgears_own()),
            Method("powers on [0, 1]", "", (0,), lambda _: solved(_local_powers)),
            Method("Chebyshev on [-1, 1]", "", (0,), lambda _: solved(_chebyshev)),
            Method("powers of phi1 from the start", "", (0,), lambda _: solved(_shifted_powers)),
            Method("powers of phi1, as published", "", (0,), lambda _: solved(global_powers)),
        ),
        error=error,
        chosen=("end conditions in closed form, [0, 1]", 0),
        enough=1e-14,
        because="values and slopes of the ends stand in the coefficients themselves, so that the joints are as exact "
        "as what they join, and no system of equations is solved",
    )


def error(result: Array) -> float:
    """Largest share of i12, joints included."""
    return float(np.max(np.abs(result / _reference() - 1.0)))


def ncgears_own() -> Array:
    """Hermite's cubic and two multiples of tau^2 (1 - tau)^2, one of them by the ratio in the middle."""
    found = []
    for ends in _returns():
        base, direction = published_family(ends, baler.CONSTANT)
        multiple = (_middle_ratio() - base(0.5)) / direction(0.5)
        found.append((base + multiple * direction)(_tau(ends, points_rad(ends))))
    return np.array(found)


def solved(rows: Rows) -> Array:
    """The six conditions as linear equations."""
    found = []
    for ends in _returns():
        joints = np.array([ends.start_rad, ends.end_rad])
        valued = np.array([*joints, joints.mean(), 0.0])
        matrix = np.vstack([rows(ends, valued, 0), rows(ends, joints, 1)])
        found.append(rows(ends, points_rad(ends), 0) @ np.linalg.solve(matrix, _conditions(ends)))
    return np.array(found)


def _conditions(ends: ReturnEnds) -> Array:
    """Ratio at both joints, in the middle and extrapolated to phi1 = 0, slopes at both joints."""
    ratios = ends.start_ratio, ends.end_ratio, _middle_ratio(), baler.CONSTANT
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


def points_rad(ends: ReturnEnds) -> Array:
    """Driving angles of the results, both joints included."""
    return np.linspace(ends.start_rad, ends.end_rad, POINTS)


def _tau(ends: ReturnEnds, phi1: Array) -> Array:
    return (phi1 - ends.start_rad) / ends.length_rad


@cache
def _returns() -> tuple[ReturnEnds, ReturnEnds]:
    ends = baler.law().return_law.ends
    return ends, replace(ends, start_rad=SHORT * ends.end_rad)


@cache
def _middle_ratio() -> float:
    return float(baler.law().return_law.polynomial(0.5))


@cache
def _reference() -> Array:
    """Powers of phi1 itself: with so many digits their bad condition does not matter."""
    return np.array([_exact(ends) for ends in _returns()])


def _exact(ends: ReturnEnds) -> list[float]:
    from mpmath import mp

    with mp.workdps(exact.DIGITS):
        joints = [mp.mpf(ends.start_rad), mp.mpf(ends.end_rad)]
        valued = [[at**k for k in range(6)] for at in (*joints, sum(joints) / 2, mp.mpf(0))]
        sloped = [[k * at ** (k - 1) if k else 0 for k in range(6)] for at in joints]
        found = mp.lu_solve(mp.matrix([*valued, *sloped]), mp.matrix(_conditions(ends).tolist()))
        return [float(mp.polyval(list(found)[::-1], mp.mpf(at))) for at in points_rad(ends).tolist()]
