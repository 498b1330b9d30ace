"""Mass, centroid, moment of inertia and static unbalance of a gear's body, from its section or from its mesh."""

from __future__ import annotations

from dataclasses import dataclass

from shapely import Polygon
from trimesh import Trimesh

from ncgear.solids.inertia import KG_MM3, area_moments


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
    """Of a plate: a section in mm, about the origin, by its moments."""
    moments, per_area = area_moments(section), KG_MM3 * density_kg_m3 * thickness_mm
    return GearBody(per_area * moments.area_mm2, per_area * moments.first_mm3, per_area * moments.polar_mm4)


def mesh_body(mesh: Trimesh, density_kg_m3: float) -> GearBody:
    """Of a closed mesh in mm, by its volume integrals; for sections that change with height, and as a check."""
    density = KG_MM3 * density_kg_m3
    mass, center = density * float(mesh.volume), mesh.center_mass
    place = complex(center[0], center[1])
    inertia = density * mesh.moment_inertia
    about_axis = float(inertia[2, 2]) + mass * abs(place) ** 2
    return GearBody(mass, mass * place, about_axis, -complex(inertia[0, 2], inertia[1, 2]))
