"""Vectors of the plane: the few products that geometry needs.

Points of teeth and outlines are complex numbers x + i y.  ``Vector`` is for formulas that hold for numbers, arrays and
jets alike: it uses only the arithmetic that all three share.
"""

from __future__ import annotations

from typing import Any

import numpy as np

from ncgear.frozen import dataclass
from ncgear.numerics.arrays import Array, ComplexArray


def as_complex(points: Array) -> ComplexArray:
    """Points of shape (..., 2) as x + i y, shape (...): the same memory, where x and y are next to each other."""
    pairs = np.asarray(points, dtype=float)
    near = pairs if pairs.strides[-1] == pairs.itemsize else np.ascontiguousarray(pairs)
    return near.view(complex)[..., 0]


def as_points(places: ComplexArray) -> Array:
    """The inverse of ``as_complex``."""
    return np.asarray(places, order="C")[..., None].view(float)


def square(vector: ComplexArray) -> Array:
    """Squared length."""
    return vector.real * vector.real + vector.imag * vector.imag


def along(direction: ComplexArray, vector: ComplexArray) -> Array:
    """Scalar product; shapes broadcast."""
    return direction.real * vector.real + direction.imag * vector.imag


def across(direction: ComplexArray, vector: ComplexArray) -> Array:
    """Vector product, positive where ``vector`` points to the left of ``direction``; shapes broadcast."""
    return direction.real * vector.imag - direction.imag * vector.real


def angle_between(first: ComplexArray, second: ComplexArray) -> Array:
    """Angle in rad from the first vector to the second, from -pi to pi; shapes broadcast."""
    return np.arctan2(across(first, second), along(first, second))


def cross(first: Array, second: Array) -> Array:
    """As ``across``, for vectors of shape (..., 2)."""
    return first[..., 0] * second[..., 1] - first[..., 1] * second[..., 0]


def turned(vectors: Array, angle_rad: Array) -> Array:
    """Vectors of shape (..., 2) turned counter-clockwise by angles; shapes broadcast."""
    cosine, sine = np.cos(angle_rad), np.sin(angle_rad)
    x, y = vectors[..., 0], vectors[..., 1]
    return np.stack([cosine * x - sine * y, sine * x + cosine * y], axis=-1)


def signed_area(ring: Array) -> Array:
    """Areas, (...), of closed polygons, (..., n, 2), first point not repeated; positive counter-clockwise."""
    x, y = ring[..., 0], ring[..., 1]
    return np.asarray(np.sum(x * np.roll(y, -1, axis=-1) - y * np.roll(x, -1, axis=-1), axis=-1) / 2.0)


Term = Any
"""A number, an array of shape (n,), or a jet at n points; a formula does not mix arrays and jets."""


@dataclass(frozen=True, eq=False)
class Vector:
    """A vector by its coordinates.  A factor stands to the right of the vector."""

    x: Term
    y: Term

    def __add__(self, other: Vector) -> Vector:
        return Vector(self.x + other.x, self.y + other.y)

    def __sub__(self, other: Vector) -> Vector:
        return Vector(self.x - other.x, self.y - other.y)

    def __neg__(self) -> Vector:
        return Vector(-self.x, -self.y)

    def __mul__(self, factor: Term) -> Vector:
        return Vector(self.x * factor, self.y * factor)

    def dot(self, other: Vector) -> Term:
        """Scalar product."""
        return self.x * other.x + self.y * other.y

    def cross(self, other: Vector) -> Term:
        """Vector product: the counter-clockwise moment of a force ``other`` at this place."""
        return self.x * other.y - self.y * other.x


def bow_middles(points: Array, bulges: Array) -> Array:
    """Middles of lines and arcs of a closed contour, (n, 2), by points (n, 2) and bulges (n,) (teeth/arcs.py)."""
    chord = np.roll(points, -1, axis=0) - points
    across = np.stack([chord[:, 1], -chord[:, 0]], axis=1)
    return np.asarray(points + (chord + bulges[:, None] * across) / 2.0)


def corners(points: ComplexArray) -> ComplexArray:
    """The corners of the convex hull of points x + i y (shape (n,), n > 0), counter-clockwise, shape (c,)."""
    from shapely import convex_hull, get_coordinates, multipoints

    found = as_complex(get_coordinates(convex_hull(multipoints(as_points(points)))))
    found = found[1:] if found.size > 1 and found[0] == found[-1] else found
    return found if np.sum(across(found, np.roll(found, -1))) >= 0.0 else found[::-1]


def depths(hull: ComplexArray, points: ComplexArray) -> Array:
    """How deep points (n,) lie within a hull of corners (c,); below 0 outside of it, 0 in a hull of one point."""
    edges = np.roll(hull, -1) - hull
    normals = 1j * edges / np.maximum(np.abs(edges), np.finfo(float).tiny)
    into = np.stack([normals.real, normals.imag], axis=1) @ np.stack([points.real, points.imag])
    return np.min(into - np.real(np.conj(normals) * hull)[:, None], axis=0)
