"""Mass, centroid, moment of inertia and static unbalance of a gear's body, from its section or from its mesh."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
import shapely
from shapely import MultiPolygon, Polygon
from trimesh import Trimesh

from ncgear.numerics.arrays import Array
from ncgear.solids.inertia import KG_MM3


@dataclass(frozen=True)
class GearBody:
    """A rigid body on an axis along z.

    ``unbalance_kg_mm`` is mass times the centroid's place (x + i y), ``inertia_kg_mm2`` is about the axis.
    ``couple_kg_mm2`` is the sum of mass times place times height over the centroid: zero for a plate.
    """

    mass_kg: float
    unbalance_kg_mm: complex
    inertia_kg_mm2: float
    couple_kg_mm2: complex = 0j

    @property
    def centroid_mm(self) -> complex:
        """The centroid's place from the axis."""
        return self.unbalance_kg_mm / self.mass_kg

    @property
    def eccentricity_mm(self) -> float:
        """Its distance from the axis."""
        return abs(self.centroid_mm)


def plate_body(section: Polygon, thickness_mm: float, density_kg_m3: float) -> GearBody:
    """Of a plate: a section in mm, about the origin, by Green's theorem on its outlines."""
    area, first, polar = _moments(section)
    per_area = KG_MM3 * density_kg_m3 * thickness_mm
    return GearBody(per_area * area.real, per_area * first, per_area * polar.real)


def area_moment_mm3(section: Polygon | MultiPolygon) -> complex:
    """First moment of an area in mm about the origin, zero of an empty one."""
    return complex(sum(_moments(part)[1] for part in shapely.get_parts(section)))


def mesh_body(mesh: Trimesh, density_kg_m3: float) -> GearBody:
    """Of a closed mesh in mm, by its volume integrals; for sections that change with height, and as a check."""
    density = KG_MM3 * density_kg_m3
    mass, center = density * float(mesh.volume), mesh.center_mass
    place = complex(center[0], center[1])
    inertia = density * mesh.moment_inertia
    about_axis = float(inertia[2, 2]) + mass * abs(place) ** 2
    return GearBody(mass, mass * place, about_axis, -complex(inertia[0, 2], inertia[1, 2]))


def _moments(section: Polygon) -> tuple[complex, complex, complex]:
    """Area, first and polar moment of a section."""
    oriented = shapely.orient_polygons(section)
    rings = [_of_ring(shapely.get_coordinates(ring)) for ring in (oriented.exterior, *oriented.interiors)]
    area, first, polar = np.sum(rings, axis=0)
    return complex(area), complex(first), complex(polar)


def _of_ring(ring: Array) -> tuple[complex, complex, complex]:
    """Area, first and polar moment within a closed ring (shape (n, 2), first point repeated); negative clockwise.

    Edge by edge, the triangle of the origin, p and q: p x q times 1/2, (p + q)/6 and (p.p + p.q + q.q)/12.
    """
    p, q = ring[:-1, 0] + 1j * ring[:-1, 1], ring[1:, 0] + 1j * ring[1:, 1]
    across = (np.conj(p) * q).imag
    polar = np.abs(p) ** 2 + (np.conj(p) * q).real + np.abs(q) ** 2
    return complex(across.sum() / 2.0), complex((across * (p + q)).sum() / 6.0), complex((across * polar).sum() / 12.0)
