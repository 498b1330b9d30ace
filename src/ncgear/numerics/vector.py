"""Vectors of the plane in arithmetic that numbers, arrays and jets share, so that a formula is written once for all."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Any

Term = Any
"""A number, an array of shape (n,), or a jet at n points; in one formula all are of one kind, or numbers."""


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
