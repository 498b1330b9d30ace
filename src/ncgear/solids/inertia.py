"""Moments of sections, and moments of inertia of the bodies that are made of them."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from shapely.geometry.base import BaseGeometry

from ncgear.numerics.arrays import Array
from ncgear.solids.mesh.sheets import rings
from ncgear.solids.plan.body import BodyPlan

KG_MM3 = 1e-9
"""One kg/m3 in kg/mm3."""


@dataclass(frozen=True)
class AreaMoments:
    """Area, first moment (x + i y) and polar second moment about the origin."""

    area_mm2: float
    first_mm3: complex
    polar_mm4: float


def area_moments(section: BaseGeometry) -> AreaMoments:
    """Of polygons in mm, one or more or none, with their holes, by Green's theorem on their outlines."""
    found = [_within(ring) for ring in rings(section)]
    area, first, polar = np.sum(found, axis=0) if found else (0.0, 0.0, 0.0)
    return AreaMoments(float(np.real(area)), complex(first), float(np.real(polar)))


def _within(ring: Array) -> tuple[complex, complex, complex]:
    """Area, first and polar moment within a closed ring (shape (n, 2), first point repeated); negative clockwise.

    Edge by edge, the triangle of the origin, p and q: p x q times 1/2, (p + q)/6 and (p.p + p.q + q.q)/12.
    """
    p, q = ring[:-1, 0] + 1j * ring[:-1, 1], ring[1:, 0] + 1j * ring[1:, 1]
    across = (np.conj(p) * q).imag
    polar = np.abs(p) ** 2 + (np.conj(p) * q).real + np.abs(q) ** 2
    return complex(across.sum() / 2.0), complex((across * (p + q)).sum() / 6.0), complex((across * polar).sum() / 12.0)


def body_kg_mm2(plan: BodyPlan, density_kg_m3: float) -> float:
    """Moment of inertia of a gear's body about its axis, layer by layer, without its chamfer and set screw.

    Of helical teeth, the section at z = 0 stands for all.
    """
    polar = (layer.thickness_mm * area_moments(layer.section).polar_mm4 for layer in plan.layers)
    return KG_MM3 * density_kg_m3 * sum(polar)
