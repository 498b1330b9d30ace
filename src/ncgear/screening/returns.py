"""The returns of many three-segment strokes, closed to rounding; equations as in ``ratio/compensation/``."""

from __future__ import annotations

from dataclasses import dataclass
from math import pi

import numpy as np

from ncgear.machine.linkage import Linkages
from ncgear.machine.stroke import WorkingStrokes
from ncgear.numerics.arrays import Array
from ncgear.numerics.sampled import integration, shares
from ncgear.optimum.family.returns import ends_of, harmonic_lift, hermite

CLOSING_STEPS = 24
"""Newton's steps on the harmonic mean; from next to a zero of the polynomial some ten are needed."""

PIECES = 3
"""Equal pieces of tau that a return is cut into: where its ratio is small, a polynomial's inverse varies fast."""

BUMP = np.array([0.0, 0.0, 1.0, -2.0, 1.0, 0.0])
"""tau^2 (1 - tau)^2, which changes neither end."""


@dataclass(frozen=True, eq=False)
class Returns:
    """i12 as polynomials in tau (shape (6, n)) on returns of ``length_rad`` (shape (n,)) of the driving angle."""

    polynomial: Array
    length_rad: Array

    def slopes(self, count: int) -> tuple[Array, Array, Array]:
        """dphi2/dphi1 and two derivatives by phi1 at Chebyshev points of each piece, shape (n, PIECES, count)."""
        length = self.length_rad[:, None, None]
        value, first, second = _derivatives(self.polynomial, count)
        first, second = first / length, second / length**2
        return 1.0 / value, -first / value**2, 2.0 * first**2 / value**3 - second / value**2


def returns_with_constant(
    strokes: WorkingStrokes[Array], linkage: Linkages[Array], period_rad: float, constant: Array, count: int
) -> Returns:
    """i12 polynomials whose value extrapolated to phi1 = 0 is ``constant`` (shape (n,)), the published method's e."""
    length = period_rad - strokes.theta4_rad
    cubic = _with_ends(strokes, linkage, length)
    origin = -strokes.theta4_rad / length
    bump = origin**2 * (1.0 - origin) ** 2
    base = cubic + BUMP[:, None] * ((constant - _value(cubic, origin)) / bump)
    direction = np.roll(BUMP, 1)[:, None] - BUMP[:, None] * origin
    return _closed(base, direction, length, linkage, count)


def _with_ends(strokes: WorkingStrokes[Array], linkage: Linkages[Array], length: Array) -> Array:
    """The Hermite cubic of the end conditions, shape (6, n)."""
    cubic = hermite(ends_of(strokes.approach_slope, strokes.braking_slope, linkage), length, inverse=False)
    return np.vstack([cubic, np.zeros((2, length.size))])


def _closed(base: Array, direction: Array, length: Array, linkage: Linkages[Array], count: int) -> Returns:
    """i12 = base + c direction, c from the driven angle that the return must cover."""
    mean = length / (2.0 * pi - linkage.working_angle_rad)
    powers = _powers(count)
    weights = np.tile(integration(count)[-1] / PIECES, PIECES)
    lift = harmonic_lift(base.T @ powers, direction.T @ powers, mean, weights, CLOSING_STEPS)
    return Returns(base + lift * direction, length)


def _value(polynomial: Array, argument: Array) -> Array:
    value: Array = (polynomial * argument ** np.arange(len(polynomial))[:, None]).sum(axis=0)
    return value


def _powers(count: int) -> Array:
    """Powers of tau at the points of all pieces, shape (6, PIECES * count)."""
    tau = ((np.arange(PIECES)[:, None] + shares(count)) / PIECES).ravel()
    powers: Array = tau ** np.arange(6.0)[:, None]
    return powers


def _derivatives(polynomial: Array, count: int) -> tuple[Array, Array, Array]:
    """Values and two derivatives by tau, shape (n, PIECES, count) each."""
    powers, order = _powers(count), np.arange(6.0)[:, None]
    rows = polynomial, (order * polynomial)[1:], (order * (order - 1.0) * polynomial)[2:]
    value, first, second = ((row.T @ powers[: len(row)]).reshape(-1, PIECES, count) for row in rows)
    return value, first, second
