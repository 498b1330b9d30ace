"""Periodic cubic splines over one turn of the crank: their matrices, and a smoothing spline for a rough motion.

A spline with n knots has n coefficients; the k-th belongs to the B-spline centred on the k-th knot.  At any angle four
of them count, so that all matrices are sparse.  B-splines and their derivatives follow the recursion of C. de Boor, "A
Practical Guide to Splines" (1978), chapters IX and X.
"""

from __future__ import annotations

from functools import cached_property
from math import pi
from typing import Any

import numpy as np
from scipy import sparse
from scipy.sparse.linalg import splu

from ncgear.frozen import dataclass
from ncgear.numerics.arrays import Array, IndexArray
from ncgear.ratio.laws.spline import even_steps

TURN = 2.0 * pi

NEAR = 4
"""Coefficients that count at an angle."""

FEWEST_KNOTS = 5
"""With fewer, a B-spline would meet itself around the turn."""


@dataclass(frozen=True, eq=False)
class SplineRows:
    """Values, first and second derivatives of the B-splines that count at m angles, and their numbers; (m, 4) each."""

    columns: IndexArray
    value: Array
    first: Array
    second: Array

    def of(self, coefficients: Array) -> tuple[Array, Array, Array]:
        """Value, first and second derivative of a spline at the angles, shape (m,) each."""
        own = coefficients[self.columns]
        value, first, second = (np.sum(order * own, axis=1) for order in (self.value, self.first, self.second))
        return value, first, second


@dataclass(frozen=True, eq=False)
class Knots:
    """Angles in rad of the joints of a spline's pieces, shape (n,): rising from 0, below a turn, five or more."""

    angle_rad: Array

    @property
    def count(self) -> int:
        """Number of knots."""
        return self.angle_rad.size

    def rows(self, angle_rad: Array) -> SplineRows:
        """The B-splines at angles in rad between 0 and a turn, shape (m,)."""
        count = self.count
        piece = np.searchsorted(self.angle_rad, angle_rad, side="right") - 1
        # The knots t[-2] .. t[3] around each angle; t[0] is at the angle or before it
        number = piece[:, None] + np.arange(-2, 4)
        knot = self.angle_rad[number % count] + TURN * (number // count)
        linear = _raised(np.ones((angle_rad.size, 1)), knot[:, 2:4], angle_rad)
        square = _raised(linear, knot[:, 1:5], angle_rad)
        cubic = _raised(square, knot, angle_rad)
        first = _derivative(square, knot)
        second = _derivative(_derivative(linear, knot[:, 1:5]), knot)
        return SplineRows((piece[:, None] + np.arange(-1, 3)) % count, cubic, first, second)

    def values(self, coefficients: Array) -> Array:
        """The spline's values at its knots, shape (n,)."""
        return np.asarray(self._at_knots @ coefficients)

    def coefficients(self, values: Array) -> Array:
        """Coefficients of the spline through values at the knots, shape (n,)."""
        return np.asarray(self._factors.solve(values))

    def smoothed(self, angle_rad: Array, values: Array) -> Array:
        """Coefficients of a spline along a rough function that joins values at rising angles of one turn by lines.

        Each coefficient is a mean from the knot before to the knot after, so that the spline is nowhere rougher than
        the function (I. J. Schoenberg's variation diminishing splines).
        """
        own = self.angle_rad
        before, after = np.roll(own, 1), np.roll(own, -1)
        before[0] -= TURN
        after[-1] += TURN
        share, weight = np.polynomial.legendre.leggauss(8)
        out = (1.0 + share) / 2.0
        coefficients = np.zeros(self.count)
        for end in (before, after):
            at = own[:, None] + (end - own)[:, None] * out
            coefficients += np.interp(at, angle_rad, values, period=TURN) @ (weight * (1.0 - out)) / 2.0
        return coefficients

    @cached_property
    def _at_knots(self) -> Any:
        rows = self.rows(self.angle_rad)
        number = np.repeat(np.arange(self.count), NEAR)
        triplets = rows.value.ravel(), (number, rows.columns.ravel())
        return sparse.csc_matrix(triplets, shape=(self.count, self.count))

    @cached_property
    def _factors(self) -> Any:
        return splu(self._at_knots)


def even_knots(count: int) -> Knots:
    """A number of knots at even steps."""
    return Knots(even_steps(count))


def _raised(lower: Array, knot: Array, angle: Array) -> Array:
    """B-splines of degree d, shape (m, d + 1), from B-splines of degree d - 1 and 2 d knots, shape (m, 2 d)."""
    degree = lower.shape[1]
    before, after = knot[:, :degree], knot[:, degree:]
    left = lower * (angle[:, None] - before) / (after - before)
    raised = np.zeros((angle.size, degree + 1))
    raised[:, :-1] = lower - left
    raised[:, 1:] += left
    return raised


def _derivative(lower: Array, knot: Array) -> Array:
    """Derivatives of B-splines of degree d, shape (m, d + 1), from splines of degree d - 1 or their derivatives."""
    degree = lower.shape[1]
    slope = degree * lower / (knot[:, degree:] - knot[:, :degree])
    rows = np.zeros((lower.shape[0], degree + 1))
    rows[:, :-1] = -slope
    rows[:, 1:] += slope
    return rows
