"""A pitch curve by a spline of its radius, its mate, and the slopes of their figures by the spline.

With r(phi) the radius, a the centre distance and w = r^2 + r'^2, the curvatures k1 and k2 of both curves, positive
where they are convex, are

    k1 = (r^2 + 2 r'^2 - r r'') / w^(3/2),    k1 + k2 = a / ((a - r) sqrt(w)),

the second by Euler and Savary (with cos(mu) = r / sqrt(w), mu the angle between the tangent and the common
perpendicular of the radii, it is cos(mu) a / (r1 r2)).  The mate closes where the mean of r / (a - r) over a turn is 1.
"""

from __future__ import annotations

from functools import cached_property
from math import comb, pi, tau

import numpy as np
from scipy import sparse
from scipy.interpolate import BSpline

from ncgear.frozen import dataclass
from ncgear.numerics.arrays import Array, IndexArray, counted_up

DEGREE = 5
"""Degree of the spline: curvature and its change are continuous."""

PER_COEFFICIENT, FINER = 3, 8
"""Places for each coefficient at which conditions apply, and points for each such place."""


WINDOW_PITCHES = 1.0
"""Pitches to either side of the mean over a concave stretch, with weights that fall to the ends."""


@dataclass(frozen=True, eq=False)
class SplineBasis:
    """The periodic uniform quintic B-splines of the polar angle, ``count`` of them, at even places."""

    count: int

    @cached_property
    def phi_rad(self) -> Array:
        """The points' polar angles; conditions apply at every ``FINER``-th."""
        total = self.count * PER_COEFFICIENT * FINER
        return tau * np.arange(total) / total

    def at(self, phi_rad: Array, order: int = 0) -> sparse.csr_array:
        """The basis, or a derivative of it, at angles of shape (n,): shape (n, count)."""
        step, degree = tau / self.count, DEGREE - order
        knots = step * np.arange(-degree, self.count + degree + 1)
        rows = sparse.csr_array(BSpline.design_matrix(np.mod(phi_rad, tau), knots, degree))
        columns = np.arange(self.count + degree)
        # The derivative of a uniform spline is a spline of a degree less, with differences as coefficients.
        shape = columns.size, self.count
        differences = sum(
            (-1.0) ** (order - k)
            * comb(order, k)
            * sparse.csr_array((np.ones(columns.size), (columns, (columns + k) % self.count)), shape=shape)
            for k in range(order + 1)
        )
        return sparse.csr_array(rows @ differences) / step**order

    @cached_property
    def fine(self) -> tuple[sparse.csr_array, sparse.csr_array]:
        """The basis and its first derivative at all points."""
        return self.at(self.phi_rad), self.at(self.phi_rad, 1)

    @cached_property
    def places(self) -> tuple[sparse.csr_array, sparse.csr_array, sparse.csr_array]:
        """The basis and two derivatives at the places of conditions."""
        return self.fine[0][::FINER], self.fine[1][::FINER], self.at(self.phi_rad[::FINER], 2)

    def through(self, values: Array) -> Array:
        """Coefficients of the spline through values at the ``count`` even angles from 0 on, shape (count,) or more."""
        first = self.at(np.zeros(1)).toarray()[0]
        # The values at even angles are a circular convolution of the coefficients.
        return _deconvolved(values, first)


@dataclass(frozen=True, eq=False)
class MatePlace:
    """The place of the mate in its own drawing: its axis (shape (2,)) in mm of the pair, the turn of the mate, and the
    number of mm of the pair for a mm of the drawing."""

    axis_mm: Array
    turned_rad: float
    scale: float


@dataclass(frozen=True, eq=False)
class Rolled:
    """A curve with its mate: coefficients of the radius in mm (shape (n,)), axis (shape (2,)), centre distance, teeth.

    Arrays are over the places of conditions, shape (m,), Jacobians have shape (m, n).  ``mate_place`` is known where
    the mate follows an outline, too.
    """

    basis: SplineBasis
    coefficients: Array
    axis_mm: Array
    center_distance_mm: float
    teeth: int
    mate_place: MatePlace | None = None

    @property
    def phi_rad(self) -> Array:
        """Polar angles of the places."""
        return self.basis.phi_rad[::FINER]

    @cached_property
    def radius(self) -> tuple[Array, Array, Array]:
        """Radius with two derivatives by the angle, mm."""
        zero, first, second = (rows @ self.coefficients for rows in self.basis.places)
        return zero, first, second

    @cached_property
    def speed_mm(self) -> Array:
        """Arc length per rad."""
        r, r1, _ = self.radius
        return np.sqrt(r * r + r1 * r1)

    @property
    def length_mm(self) -> float:
        """Length of either curve."""
        return float(np.mean(self.speed_mm)) * tau

    @property
    def module_mm(self) -> float:
        """Length over pi times the number of teeth."""
        return self.length_mm / (pi * self.teeth)

    @cached_property
    def curvature(self) -> tuple[Array, Array]:
        """Curvatures of the curve and of its mate in 1/mm, positive where convex."""
        r, r1, r2 = self.radius
        own = (r * r + 2.0 * r1 * r1 - r * r2) / self.speed_mm**3
        return own, self.together - own

    @cached_property
    def together(self) -> Array:
        """Sum of both curvatures, 1/mm."""
        distance = self.center_distance_mm
        return distance / (self.speed_mm * (distance - self.radius[0]))

    @cached_property
    def turned(self) -> Array:
        """How fast the mate turns."""
        r = self.radius[0]
        return r / (self.center_distance_mm - r)

    @cached_property
    def speed_rows(self) -> sparse.csr_array:
        """Jacobian of the arc length per rad."""
        b0, b1, _ = self.basis.places
        r, r1, _ = self.radius
        return scaled(r / self.speed_mm, b0) + scaled(r1 / self.speed_mm, b1)

    @cached_property
    def curvature_rows(self) -> sparse.csr_array:
        """Jacobian of the curve's own curvature."""
        b0, b1, b2 = self.basis.places
        r, r1, r2 = self.radius
        cube, own = self.speed_mm**3, self.curvature[0]
        rows = scaled((2.0 * r - r2) / cube, b0) + scaled(4.0 * r1 / cube, b1) - scaled(r / cube, b2)
        return rows - scaled(3.0 * own / self.speed_mm, self.speed_rows)

    @cached_property
    def together_rows(self) -> sparse.csr_array:
        """Jacobian of the sum of both curvatures."""
        own = scaled(self.together / (self.center_distance_mm - self.radius[0]), self.basis.places[0])
        return own - scaled(self.together / self.speed_mm, self.speed_rows)

    @property
    def together_by_distance(self) -> Array:
        """Slope of the sum of both curvatures by the centre distance, shape (m,)."""
        distance = self.center_distance_mm
        return self.together * (1.0 / distance - 1.0 / (distance - self.radius[0]))

    def points(self) -> tuple[Array, Array]:
        """Points of the curve in the drawing and outward normals there, shape (p, 2) each."""
        r, r1 = (rows @ self.coefficients for rows in self.basis.fine)
        outwards, along = rays(self.basis.phi_rad)
        tangent = r1[:, None] * outwards + r[:, None] * along
        tangent /= np.hypot(*tangent.T)[:, None]
        return self.axis_mm + r[:, None] * outwards, np.column_stack([tangent[:, 1], -tangent[:, 0]])

    @cached_property
    def _mate_fine(self) -> tuple[Array, Array, Array]:
        """At all points the curve's radius, how fast the mate turns, and the angle that it has turned since the first.

        Shape (p,) each.
        """
        r = self.basis.fine[0] @ self.coefficients
        turned = r / (self.center_distance_mm - r)
        steps = (turned + np.roll(turned, 1)) * (pi / len(turned))
        return r, turned, np.cumsum(steps) - steps[0]

    def mate_points(self) -> Array:
        """Points of the mate's curve about its own axis, shape (p, 2); the first faces the first point of the curve."""
        r, _, angle = self._mate_fine
        return (self.center_distance_mm - r)[:, None] * rays(pi - angle)[0]

    def mate_in_drawing(self) -> tuple[Array, Array]:
        """Points of the mate's curve in its drawing of the pair's size, and outward normals, shape (p, 2) each."""
        assert self.mate_place is not None
        r, turned, angle = self._mate_fine
        r1 = self.basis.fine[1] @ self.coefficients
        outwards, along = rays(self.mate_place.turned_rad - angle)
        # The mate runs clockwise.
        tangent = -r1[:, None] * outwards - ((self.center_distance_mm - r) * turned)[:, None] * along
        tangent /= np.hypot(*tangent.T)[:, None]
        points = self.mate_place.axis_mm + (self.center_distance_mm - r)[:, None] * outwards
        return points, np.column_stack([-tangent[:, 1], tangent[:, 0]])

    def mate_rows(self, index: IndexArray, way: Array) -> tuple[Array, Array, Array]:
        """How the mate's points of an index move along ``way``, unit vectors of shape (k, 2), with the unknowns.

        Returns rows of coefficients of shape (k, n), and columns of the centre distance and of the turn, shape (k,).
        """
        assert self.mate_place is not None
        r, _, angle = self._mate_fine
        away, b0 = self.center_distance_mm - r, self.basis.places[0]
        # The angle is the integral of r / (a - r), whose slopes are added up from place to place.
        rough, step = away[::FINER, None], tau * FINER / len(r)
        steps = step * np.hstack([scaled(1.0 / rough[:, 0], b0).toarray(), -(r[::FINER, None] / rough)]) / rough
        steps[:, :-1] *= self.center_distance_mm
        steps = np.vstack([steps, steps[:1]])
        added = np.cumsum(steps, axis=0) - (steps + steps[:1]) / 2.0
        place, share = np.divmod(index, FINER)
        angle_rows = added[place] + (share / FINER)[:, None] * (added[place + 1] - added[place])
        outwards, along = rays(self.mate_place.turned_rad - angle[index])
        out, across = np.sum(way * outwards, axis=1), np.sum(way * along, axis=1) * away[index]
        rows = -out[:, None] * self.basis.fine[0][index].toarray() - across[:, None] * angle_rows[:, :-1]
        return rows, out - across * angle_rows[:, -1], across

    @cached_property
    def arc_mm(self) -> Array:
        """Arc length at the places, by the rectangle about each."""
        steps = self.speed_mm * (tau / len(self.speed_mm))
        return np.cumsum(steps) - steps / 2.0

    def apart_mm(self, at_mm: Array) -> Array:
        """Distance along the curve from each place to arc lengths of shape (k,), the shorter way: shape (m, k)."""
        away = np.abs(self.arc_mm[:, None] - at_mm[None, :])
        return np.minimum(away, self.length_mm - away)

    @cached_property
    def mean_over_window(self) -> sparse.csr_array:
        """Weights of all places in the mean about each, shape (m, m)."""
        reach, arc, count = WINDOW_PITCHES * self.length_mm / self.teeth, self.arc_mm, self.arc_mm.size
        around = np.concatenate([arc - self.length_mm, arc, arc + self.length_mm])
        first, after = np.searchsorted(around, arc - reach), np.searchsorted(around, arc + reach)
        row, place = counted_up(first, after - first)
        weight = (1.0 - np.abs(around[place] - arc[row]) / reach) * self.speed_mm[place % count]
        share = weight / np.bincount(row, weight)[row]
        ends = np.concatenate([[0], np.cumsum(after - first)])
        return sparse.csr_array((share, place % count, ends), shape=(count, count))


def scaled(by: Array, rows: sparse.csr_array) -> sparse.csr_array:
    """Rows multiplied by a number each."""
    data = rows.data * np.repeat(by, np.diff(rows.indptr))
    return sparse.csr_array((data, rows.indices, rows.indptr), shape=rows.shape)


def _deconvolved(values: Array, first: Array) -> Array:
    """Coefficients c with values[k] = sum over j of first[j] c[k + j], around the ring."""
    kernel = np.conj(np.fft.fft(first))
    kernel = kernel if values.ndim == 1 else kernel[:, None]
    return np.fft.ifft(np.fft.fft(values, axis=0) / kernel, axis=0).real


def rays(phi_rad: Array) -> tuple[Array, Array]:
    """Unit vectors at polar angles, and across them; shape (n, 2) each."""
    cosine, sine = np.cos(phi_rad), np.sin(phi_rad)
    return np.column_stack([cosine, sine]), np.column_stack([-sine, cosine])


def closing_distance_mm(radius_mm: Array) -> float:
    """The centre distance at which the mate of radii at even angles closes, by bisection; at least twice the mean."""
    low, high = max(float(np.mean(radius_mm)) * 2.0, float(np.max(radius_mm))), 2.0 * float(np.max(radius_mm))
    for _ in range(60):
        middle = (low + high) / 2.0
        with np.errstate(divide="ignore"):
            wide = np.mean(radius_mm / (middle - radius_mm)) > 1.0
        low, high = (middle, high) if wide else (low, middle)
    return high
