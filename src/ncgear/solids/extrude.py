"""A gear's section extruded along its axis into a solid that is known to be sound."""

from __future__ import annotations

import trimesh.creation
from shapely import Polygon
from trimesh import Trimesh

from ncgear.numerics.arrays import Array
from ncgear.solids.bore import Bore
from ncgear.solids.index_hole import IndexHole
from ncgear.solids.section import cut, disc_with_room

VOLUME_TOLERANCE = 1e-9
"""Relative difference allowed between the mesh's volume and section area times face width: rounding only."""


def gear_solid(
    outline_mm: Array,
    face_width_mm: float,
    bore: Bore | None,
    chord_tolerance_mm: float,
    *,
    mark: IndexHole | None = None,
    key: str = "gears.driving",
) -> Trimesh:
    """The gear as a closed mesh in mm, in the outline's frame, z from 0 to the face width.

    ``outline_mm`` has shape (n, 2), counter-clockwise, first point not repeated; ``key`` names the gear in errors.
    Raises NoSuchMechanism where the outline crosses itself, WrongInput when the bore does not fit.
    """
    disc = disc_with_room(outline_mm, bore, chord_tolerance_mm, key)
    return extruded(cut(disc, bore, mark, chord_tolerance_mm), face_width_mm)


def extruded(section: Polygon, face_width_mm: float) -> Trimesh:
    """A valid section in mm, extruded from z = 0; raises RuntimeError if the mesh is not sound, a fault of ncgear."""
    mesh = trimesh.creation.extrude_polygon(section, face_width_mm, engine="earcut")
    require_sound(mesh, section.area * face_width_mm, VOLUME_TOLERANCE)
    return mesh


def require_sound(mesh: Trimesh, volume_mm3: float, tolerance: float) -> None:
    """Raise RuntimeError unless a mesh is closed, evenly wound, and of the volume given to a relative tolerance."""
    if not mesh.is_watertight:
        raise RuntimeError("a gear's mesh is not watertight")
    if not mesh.is_winding_consistent:
        raise RuntimeError("a gear's mesh has facets that face the wrong way")
    if not abs(float(mesh.volume) - volume_mm3) <= tolerance * volume_mm3:
        raise RuntimeError(f"a gear's mesh holds {mesh.volume:.9g} mm3 instead of {volume_mm3:.9g} mm3")
