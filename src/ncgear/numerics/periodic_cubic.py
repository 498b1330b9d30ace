"""Periodic cubic splines over one turn, and the integral of their exponential.

The spline is made from its second derivatives at the knots, so both sides of a knot have the same to the last digit: C.
de Boor, "A Practical Guide to Splines", Springer 1978, chapter IV.  Its exponential has Taylor series that converge
everywhere; a majorant series finds the cells on which a short series is exact to rounding (A. Griewank, A. Walther,
"Evaluating Derivatives", 2nd edition, SIAM 2008, chapter 13).
"""

from __future__ import annotations

from collections.abc import Callable
from math import pi

import numpy as np

from ncgear.frozen import dataclass
from ncgear.numerics import jet
from ncgear.numerics.arrays import Array, IndexArray, Mask
from ncgear.numerics.extrema import Extremum
from ncgear.numerics.jet import Jet
from ncgear.numerics.quadrature import DEGREE, INTEGRATING, TurnIntegral, closed

FEWEST_KNOTS = 3
"""Fewest knots of a turn: each then has two different neighbours."""

NEGLIGIBLE = 2.0**-54
"""Largest sum of the left out terms of a cell's Taylor series, as a share of the function: half a rounding error."""

BEYOND = 12
"""Terms of the majorant beyond ``DEGREE`` that are summed; further terms are far smaller, each than the last."""


@dataclass(frozen=True, eq=False)
class PeriodicCubic:
    """A cubic spline of period 2 pi with continuous second derivative.

    ``knots`` (shape (n + 1,)) rise from 0 to 2 pi; ``coefficients`` (shape (4, n)) belong to 1, x, x^2 and x^3, where x
    is the distance from the knot below.
    """

    knots: Array
    coefficients: Array

    def at(self, angle: Array, order: int) -> Jet:
        """Values with derivatives at angles in [0, 2 pi] rad, (n,); third derivatives hold after a knot (2 pi:
        before)."""
        cell = np.minimum(np.searchsorted(self.knots, angle, side="right"), self.knots.size - 1) - 1
        third = self.coefficients[3, cell]
        beyond = angle - self.knots[cell]
        value, slope, bend = self._moved(cell, beyond)
        rows = np.zeros((max(order, 3) + 1, beyond.size))
        rows[0], rows[1], rows[2], rows[3] = value, slope, bend, third
        return Jet(rows[: order + 1])

    def _moved(self, cell: IndexArray, beyond: Array) -> tuple[Array, Array, Array]:
        """The coefficients of 1, x and x^2 about places ``beyond`` the lower knots of cells; shape (n,) all."""
        value, slope, bend, third = self.coefficients[:, cell]
        return (
            value + beyond * (slope + beyond * (bend + beyond * third)),
            slope + beyond * (2.0 * bend + beyond * 3.0 * third),
            bend + beyond * 3.0 * third,
        )

    @property
    def extremes(self) -> tuple[Extremum, Extremum]:
        """Smallest and largest value, from the zeros of the slope, which is a parabola between two knots."""
        _, slope, bend, third = self.coefficients
        cells, widths = np.arange(slope.size), np.diff(self.knots)
        with np.errstate(invalid="ignore", divide="ignore"):
            # Both zeros of slope + 2 bend x + 3 third x^2 without loss of digits
            steep = -(bend + np.copysign(np.sqrt(bend**2 - 3.0 * third * slope), bend))
            zeros = np.concatenate([slope / steep, steep / (3.0 * third)])
            cells = np.tile(cells, 2)
            inside = (zeros > 0.0) & (zeros < widths[cells])
        points = np.concatenate([self.knots[:-1], self.knots[cells[inside]] + zeros[inside]])
        values = np.concatenate([self.coefficients[0], self._moved(cells[inside], zeros[inside])[0]])
        low, high = (Extremum(float(values[at]), float(points[at])) for at in (np.argmin(values), np.argmax(values)))
        return low, high

    def places(self, swing: float) -> Array:
        """The knots, and places between them so that the spline changes by ``swing`` at most from one to the next."""
        starts, _, _ = self._cells(lambda sizes: sizes.sum(axis=0) <= swing)
        return starts

    def exponential_integral(self) -> TurnIntegral:
        """The integral of the spline's exponential; the spline's values must be within the range of exponents."""
        starts, widths, pieces = self._cells(lambda sizes: _left_out(sizes) <= NEGLIGIBLE)
        rows = jet.exp(Jet(np.vstack([pieces, np.zeros((DEGREE - 3, starts.size))]))).coefficients
        powers = np.cumprod(np.broadcast_to(widths, (DEGREE + 1, widths.size)), axis=0)
        ends = np.cumsum((rows * INTEGRATING * powers).sum(axis=0))
        mean = float(ends[-1]) / (2.0 * pi)
        nodes = np.append(starts, 2.0 * pi)
        values = np.concatenate([[0.0], ends / ends[-1] * (2.0 * pi)])
        return TurnIntegral(mean, nodes, nodes, values, closed(rows / mean), float(np.max(np.abs(pieces[1]))))

    def _cells(self, short: Callable[[Array], Mask]) -> tuple[Array, Array, Array]:
        """Starts and widths of cells that are short enough, shape (m,), and the cubics there, shape (4, m).

        The cells between two knots are halved until they are short: ``short`` judges the sizes of the terms of x, x^2
        and x^3 at the far end of each cell, shape (3, m).
        """
        cell, shift, width = np.arange(self.knots.size - 1), np.zeros(self.knots.size - 1), np.diff(self.knots)
        done: list[tuple[Array, Array, Array]] = []
        while cell.size:
            cubics = np.vstack([*self._moved(cell, shift), self.coefficients[3, cell]])
            kept = short(np.abs(cubics[1:]) * width ** np.arange(1.0, 4.0)[:, None])
            done.append((self.knots[cell[kept]] + shift[kept], width[kept], cubics[:, kept]))
            cell, width = np.repeat(cell[~kept], 2), np.repeat(width[~kept] / 2.0, 2)
            shift = np.repeat(shift[~kept], 2) + width * (np.arange(width.size) % 2)
        starts, widths, pieces = (np.concatenate(parts, axis=-1) for parts in zip(*done, strict=True))
        order = np.argsort(starts)
        return starts[order], widths[order], pieces[:, order]


def _left_out(sizes: Array) -> Array:
    """Bound of an exponential's Taylor terms beyond ``DEGREE``, as a share, by a majorant of positive terms; (m,)."""
    majorant = np.zeros((DEGREE + BEYOND + 1, sizes.shape[1]))
    majorant[1:4] = sizes
    with np.errstate(over="ignore"):
        left_out: Array = jet.exp(Jet(majorant)).coefficients[DEGREE + 1 :].sum(axis=0)
    return left_out


def periodic_cubic(knots: Array, values: Array) -> PeriodicCubic:
    """The spline through values at three or more knots, rising from 0 to under 2 pi, (n,); else raises ValueError."""
    closing = np.append(knots, 2.0 * pi)
    widths = np.diff(closing)
    if knots.size < FEWEST_KNOTS or knots[0] != 0.0 or not np.all(widths > 0.0):
        raise ValueError("knots must rise from 0 to under 2 pi, three or more of them")
    slopes = np.diff(closed(values)) / widths
    # Second derivatives M: before M_(k-1) + 2 (before + after) M_k + after M_(k+1) = 6 times the turn of the chords
    bends = closed(_cyclic(np.roll(widths, 1), widths, 6.0 * (slopes - np.roll(slopes, 1))))
    here, there = bends[:-1], bends[1:]
    slope = slopes - widths * (2.0 * here + there) / 6.0
    return PeriodicCubic(closing, np.vstack([values, slope, here / 2.0, (there - here) / (6.0 * widths)]))


def _cyclic(before: Array, after: Array, right: Array) -> Array:
    """x of before_k x_(k-1) + 2 (before_k + after_k) x_k + after_k x_(k+1) = right_k, all periodic, shape (n,).

    Gauss elimination without pivoting, which the dominant diagonal allows; the two corners are a change of rank one
    (Sherman and Morrison).  Numbers in lists are quicker here than arrays.
    """
    corner = float(before[0])
    diagonal = 2.0 * (before + after)
    # The corners' change is u v^T with u = (-d, 0, ..., after_n) and v = (1, 0, ..., -before_0 / d), d the first pivot
    pivot = float(diagonal[0])
    share = -corner / pivot
    diagonal[0] += pivot
    diagonal[-1] -= share * float(after[-1])
    spike = np.zeros_like(right)
    spike[0], spike[-1] = -pivot, after[-1]
    plain, spiked = _tridiagonal(before, diagonal, after, right), _tridiagonal(before, diagonal, after, spike)
    factor = (plain[0] + share * plain[-1]) / (1.0 + spiked[0] + share * spiked[-1])
    return plain - factor * spiked


def _tridiagonal(below: Array, diagonal: Array, above: Array, right: Array) -> Array:
    """x of below_k x_(k-1) + diagonal_k x_k + above_k x_(k+1) = right_k without the corners, shape (n,)."""
    lower, upper = below.tolist(), above.tolist()
    pivots, values = diagonal.tolist(), right.tolist()
    for k in range(1, len(values)):
        share = lower[k] / pivots[k - 1]
        pivots[k] -= share * upper[k - 1]
        values[k] -= share * values[k - 1]
    values[-1] /= pivots[-1]
    for k in range(len(values) - 2, -1, -1):
        values[k] = (values[k] - upper[k] * values[k + 1]) / pivots[k]
    return np.array(values)
