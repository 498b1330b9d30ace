"""Moments of inertia of gear bodies: plates of one section, by their outlines."""

from __future__ import annotations

import numpy as np

from ncgear.numerics.arrays import Array
from ncgear.solids.bore import Bore, bore_points

KG_MM3 = 1e-9
"""One kg/m3 in kg/mm3."""


def polar_moment_mm4(polygon_mm: Array) -> float:
    """Second moment of a polygon's area (shape (n, 2), counter-clockwise) about the origin.

    Green's theorem, edge by edge: the triangle of origin, p and q has (p x q)(p.p + p.q + q.q) / 12.
    """
    start, end = polygon_mm, np.roll(polygon_mm, -1, axis=0)
    across = start[:, 0] * end[:, 1] - start[:, 1] * end[:, 0]
    squares = np.sum(start * start + start * end + end * end, axis=1)
    return float(np.sum(across * squares)) / 12.0


def plate_kg_mm2(polar_mm4: float, thickness_mm: float, density_kg_m3: float) -> float:
    """Moment of inertia of a plate about the axis across it."""
    return KG_MM3 * density_kg_m3 * thickness_mm * polar_mm4


def gear_polar_mm4(outline_mm: Array, bore: Bore | None, chord_tolerance_mm: float) -> float:
    """Of a gear's section: its outline (shape (n, 2), counter-clockwise) less bore and keyway."""
    whole = polar_moment_mm4(outline_mm)
    return whole if bore is None else whole - polar_moment_mm4(bore_points(bore, chord_tolerance_mm))


def ring_polar_mm4(outline_mm: Array, outer_radius_mm: float) -> float:
    """Of a ring's section: a circle less its outline."""
    return np.pi / 2.0 * outer_radius_mm**4 - polar_moment_mm4(outline_mm)
