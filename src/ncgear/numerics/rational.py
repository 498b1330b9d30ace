"""Rational B-splines in the plane, as polynomials of each span, with derivatives by their parameter.

A rational B-spline of degree 2 is exactly a circle or an ellipse, one of degree 1 a line; so contours of all kinds are
chains of them (L. Piegl and W. Tiller, "The NURBS Book", 2nd edition, Springer 1997, chapters 4 and 7).
"""

from __future__ import annotations

from collections.abc import Sequence
from itertools import pairwise
from math import cos

import numpy as np
from scipy.interpolate import BSpline, PPoly

from ncgear.frozen import dataclass
from ncgear.numerics import jet
from ncgear.numerics.arrays import Array
from ncgear.numerics.jet import Jet


@dataclass(frozen=True, eq=False)
class Spans:
    """Consecutive spans of one curve: ``breaks`` (shape (m + 1,)) rise strictly.

    ``coefficients`` (shape (degree + 1, m, 3)) belong to w x, w y and w in rising powers of the distance from the
    span's start.
    """

    breaks: Array
    coefficients: Array

    def at(self, parameter: Array, order: int) -> tuple[Jet, Jet]:
        """x and y with derivatives by the parameter, shape (n,); the outermost spans go on beyond their ends."""
        span = np.searchsorted(self.breaks[1:-1], parameter, side="right")
        beyond = Jet.variable(parameter - self.breaks[span], order)
        x, y, weight = (jet.polynomial(self.coefficients[:, span, k], beyond) for k in range(3))
        return x / weight, y / weight


@dataclass(frozen=True, eq=False)
class RationalSpline:
    """A curve by knots (shape (n + degree + 1,)), control points (shape (n, 2)) and positive weights (shape (n,))."""

    degree: int
    knots: Array
    points: Array
    weights: Array

    def clamped(self) -> RationalSpline:
        """The same curve on knots that make its first and last control points its ends."""
        degree, start, end = self.degree, self.knots[self.degree], self.knots[-self.degree - 1]
        spline = BSpline(self.knots, np.column_stack([self.points * self.weights[:, None], self.weights]), degree)
        for knot in (start, end):
            missing = degree + 1 - int(np.count_nonzero(self.knots == knot))
            for _ in range(min(missing, degree)):
                spline = spline.insert_knot(knot) if np.count_nonzero(spline.t == knot) < degree else spline
        first = int(np.searchsorted(spline.t, start, side="right")) - degree
        last = int(np.searchsorted(spline.t, end, side="left"))
        weighted = spline.c[first - 1 : last]
        knots = np.concatenate([[start], spline.t[first : last + degree], [end]])
        return RationalSpline(degree, knots, weighted[:, :2] / weighted[:, 2:], weighted[:, 2])

    def reversed(self) -> RationalSpline:
        """The same curve from its end to its start."""
        return RationalSpline(self.degree, -self.knots[::-1], self.points[::-1], self.weights[::-1])

    def chords(self, per_span: int) -> Array:
        """Ends of chords along the curve, ``per_span`` for each span, shape (n, 2); of a chain of chords these."""
        if self.degree == 1:
            return self.points
        spans, weights = np.unique(self.knots[self.degree : len(self.points) + 1]), self.weights[:, None]
        count = len(spans) - 1
        at = np.interp(np.linspace(0.0, count, count * per_span + 1), np.arange(count + 1), spans)
        weighted = BSpline(self.knots, np.hstack([self.points * weights, weights]), self.degree)(at)
        return weighted[:, :2] / weighted[:, 2:]

    def smooth_parts(self) -> list[Spans]:
        """The spans, cut at the knots at which the second derivative may jump."""
        weighted = np.column_stack([self.points * self.weights[:, None], self.weights])
        forms = [PPoly.from_spline(BSpline(self.knots, column, self.degree)) for column in weighted.T]
        start, end = self.knots[self.degree], self.knots[-self.degree - 1]
        breaks, count = np.unique(self.knots, return_counts=True)
        inside = (breaks >= start) & (breaks <= end)
        breaks, count = breaks[inside], count[inside]
        span = np.searchsorted(forms[0].x, breaks[:-1], side="right") - 1
        rising = np.stack([form.c[::-1, span] for form in forms], axis=-1)
        joints = np.flatnonzero(self.degree - count[1:-1] < 2) + 1
        edges = pairwise([0, *map(int, joints), breaks.size - 1])
        return [Spans(breaks[a : b + 1], rising[:, a:b]) for a, b in edges]


def line(start: Sequence[float], end: Sequence[float]) -> RationalSpline:
    """A straight line."""
    return RationalSpline(1, np.array([0.0, 0.0, 1.0, 1.0]), np.array([start, end], dtype=float), np.ones(2))


def arc(center: Sequence[float], radius: float, start_rad: float, turned_rad: float) -> RationalSpline:
    """A circular arc of under half a turn, counter-clockwise where ``turned_rad`` is positive."""
    middle, half = start_rad + turned_rad / 2.0, turned_rad / 2.0
    angles, reach = np.array([start_rad, middle, start_rad + turned_rad]), np.array([1.0, 1.0 / cos(half), 1.0])
    points = np.asarray(center) + radius * (reach * np.stack([np.cos(angles), np.sin(angles)])).T
    return RationalSpline(2, np.array([0.0, 0.0, 0.0, 1.0, 1.0, 1.0]), points, np.array([1.0, cos(half), 1.0]))


def closed_uniform(points: Array, degree: int) -> RationalSpline:
    """The closed uniform B-spline of a ring of control points (shape (n, 2)), n over the degree."""
    around = np.concatenate([points, points[:degree]])
    knots = np.arange(-float(degree), len(points) + degree + 1.0)
    return RationalSpline(degree, knots, around, np.ones(len(around)))
