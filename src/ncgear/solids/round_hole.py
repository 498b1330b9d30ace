"""A round hole through a gear, parallel to its axis."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from ncgear.numerics.arrays import Array
from ncgear.solids.bore import circle_points


@dataclass(frozen=True)
class RoundHole:
    """A round through hole; centre in the gear's own frame."""

    x_mm: float
    y_mm: float
    diameter_mm: float


def hole_points(hole: RoundHole, chord_tolerance_mm: float) -> Array:
    """The hole's polygon in mm, shape (n, 2), counter-clockwise, first point not repeated."""
    center = np.array([hole.x_mm, hole.y_mm])
    return center + circle_points(hole.diameter_mm / 2.0, chord_tolerance_mm)
