"""Contours as path data of an SVG, in as few characters as their places need."""

from __future__ import annotations

from collections.abc import Sequence
from math import floor, log10

import numpy as np

from ncgear.numerics.arrays import Array

PLACES_PER_TOLERANCE = 5.0
"""Grid lines to the tolerance, at least: rounding to the grid moves a point by a seventh of the tolerance."""


def grid_mm(tolerance_mm: float) -> float:
    """The power of ten that coordinates are whole multiples of."""
    return float(10.0 ** floor(log10(tolerance_mm / PLACES_PER_TOLERANCE)))


def closed_path(contours: Sequence[Array], grid: float) -> str:
    """Path data of closed contours in whole steps of the grid.

    Steps are told from point to point: browsers hold them in single precision, which whole numbers bear exactly.
    """
    return "".join(_contour(np.rint(contour / grid).astype(int)) + "z" for contour in contours)


def strokes_path(strokes: Array, grid: float) -> str:
    """Path data of separate strokes, shape (n, 2, 2)."""
    return "".join(_contour(stroke) for stroke in np.rint(strokes / grid).astype(int))


def _contour(points: np.ndarray) -> str:
    steps = np.diff(points, axis=0)
    moved = steps[np.any(steps != 0, axis=1)]
    text = " ".join(map(str, moved.ravel().tolist()))
    return f"M{points[0, 0]} {points[0, 1]}l{text}".replace(" -", "-")
