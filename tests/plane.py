"""Vectors and outlines in the plane, and derivatives by differences, as tests compute them for themselves."""

from __future__ import annotations

from collections.abc import Callable
from math import pi

import numpy as np
from numpy.typing import NDArray

Array = NDArray[np.float64]


def cross(one: Array, other: Array) -> Array:
    """Plane cross product of rows, each of shape (n, 2)."""
    return one[:, 0] * other[:, 1] - one[:, 1] * other[:, 0]


def steps(outline: Array) -> Array:
    """Chords of a closed outline, shape (n, 2)."""
    return np.roll(outline, -1, axis=0) - outline


def turns(outline: Array) -> Array:
    """Angle turned at each vertex, -pi to pi."""
    after = steps(outline)
    before = np.roll(after, 1, axis=0)
    return np.arctan2(before[:, 0] * after[:, 1] - before[:, 1] * after[:, 0], np.sum(before * after, axis=1))


def turned(vectors: Array, angles: Array) -> Array:
    """Vectors (n, 2) turned counter-clockwise by angles (n,)."""
    c, s = np.cos(angles), np.sin(angles)
    return np.column_stack([c * vectors[:, 0] - s * vectors[:, 1], s * vectors[:, 0] + c * vectors[:, 1]])


def wave_ring(radius: float, height: float, teeth: int, points: int, phase: float = 0.0) -> Array:
    """A gear-like ring of radius + height cos(teeth angle + phase), shape (points, 2)."""
    angle = np.linspace(0.0, 2.0 * pi, points, endpoint=False)
    rim = radius + height * np.cos(teeth * angle + phase)
    return np.asarray(rim[:, None] * np.column_stack([np.cos(angle), np.sin(angle)]))


def fourth_order(function: Callable[[Array], Array], at: Array, step: float) -> Array:
    """Derivative by a central difference of order 4."""
    near, far = (function(at + k * step) - function(at - k * step) for k in (1, 2))
    return (8.0 * near - far) / (12.0 * step)
