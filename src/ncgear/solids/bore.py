"""The bore of a gear, with or without a keyway, as a polygon."""

from __future__ import annotations

from dataclasses import dataclass, replace
from math import acos, asin, ceil, pi

import numpy as np

from ncgear.numerics.arrays import Array

FEWEST_CHORDS = 24
"""Chords of a full circle however coarse the tolerance, so that a small bore still looks round."""


@dataclass(frozen=True)
class Keyway:
    """A keyway cut along +x of the gear's frame; ``depth_mm`` counts from the bore's circle at the keyway's middle."""

    width_mm: float
    depth_mm: float


@dataclass(frozen=True)
class Bore:
    """A bore on the gear's axis; raises ValueError for a keyway that is no narrower than the bore."""

    diameter_mm: float
    keyway: Keyway | None = None

    def __post_init__(self) -> None:
        if self.keyway is not None and self.keyway.width_mm >= self.diameter_mm:
            raise ValueError(f"a keyway of {self.keyway.width_mm} mm in a bore of {self.diameter_mm} mm")

    @property
    def reach_mm(self) -> float:
        """Distance from the axis to the keyway's floor, or to the bore's circle where there is no keyway."""
        return self.diameter_mm / 2.0 + (self.keyway.depth_mm if self.keyway else 0.0)

    def widened(self, distance_mm: float) -> Bore:
        """The bore with its circle and all sides of its keyway moved outwards by a distance."""
        keyway = replace(self.keyway, width_mm=self.keyway.width_mm + 2.0 * distance_mm) if self.keyway else None
        return Bore(self.diameter_mm + 2.0 * distance_mm, keyway)


def bore_points(bore: Bore, chord_tolerance_mm: float) -> Array:
    """The bore's polygon in mm, shape (n, 2), counter-clockwise, first point not repeated.

    Its points lie on the circle and no chord is farther from it than ``chord_tolerance_mm``.
    """
    radius = bore.diameter_mm / 2.0
    if bore.keyway is None:
        return circle_points(radius, chord_tolerance_mm)
    half_width = bore.keyway.width_mm / 2.0
    start = asin(half_width / radius)
    floor = np.array([[bore.reach_mm, -half_width], [bore.reach_mm, half_width]])
    return np.concatenate([_arc(radius, start, 2.0 * pi - start, chord_tolerance_mm), floor])


def circle_points(radius_mm: float, chord_tolerance_mm: float) -> Array:
    """A circle about the origin as a polygon in mm, like ``bore_points``."""
    return _arc(radius_mm, 0.0, 2.0 * pi, chord_tolerance_mm)[:-1]


def _arc(radius: float, start: float, end: float, tolerance: float) -> Array:
    """Points of an arc, both ends included: a chord that spans 2 t misses the circle by radius (1 - cos t)."""
    widest = 2.0 * acos(max(1.0 - tolerance / radius, 0.0))
    chords = ceil((end - start) / min(widest, 2.0 * pi / FEWEST_CHORDS))
    angle = np.linspace(start, end, chords + 1)
    return radius * np.column_stack([np.cos(angle), np.sin(angle)])
