"""Moments of inertia of gear bodies: layers of one section each, by their outlines."""

from __future__ import annotations

import numpy as np
from shapely.geometry.base import BaseGeometry

from ncgear.numerics.arrays import Array
from ncgear.solids.body import BodyPlan
from ncgear.solids.sheets import rings

KG_MM3 = 1e-9
"""One kg/m3 in kg/mm3."""


def polar_moment_mm4(polygon_mm: Array) -> float:
    """Second moment of a polygon's area (shape (n, 2)) about the origin, negative of a clockwise one.

    Green's theorem, edge by edge: the triangle of origin, p and q has (p x q)(p.p + p.q + q.q) / 12.
    """
    start, end = polygon_mm, np.roll(polygon_mm, -1, axis=0)
    across = start[:, 0] * end[:, 1] - start[:, 1] * end[:, 0]
    squares = np.sum(start * start + start * end + end * end, axis=1)
    return float(np.sum(across * squares)) / 12.0


def body_kg_mm2(plan: BodyPlan, density_kg_m3: float) -> float:
    """Moment of inertia of a gear's body about its axis, layer by layer, without its chamfer and set screw.

    Of helical teeth, the section at z = 0 stands for all.
    """
    polar = (layer.thickness_mm * _polar_mm4(layer.section) for layer in plan.layers)
    return KG_MM3 * density_kg_m3 * sum(polar)


def _polar_mm4(section: BaseGeometry) -> float:
    """Of a section with holes: these run clockwise and count as negative."""
    return sum(polar_moment_mm4(ring[:-1]) for ring in rings(section))
