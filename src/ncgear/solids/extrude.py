"""A gear's section extruded along its axis into a solid that is known to be sound."""

from __future__ import annotations

from shapely import Polygon
from trimesh import Trimesh

from ncgear.numerics.arrays import Array
from ncgear.solids.body import BodyPlan, Layer
from ncgear.solids.bore import Bore
from ncgear.solids.layered import layered
from ncgear.solids.section import disc_with_room


def gear_solid(
    outline_mm: Array, face_width_mm: float, bore: Bore | None, chord_tolerance_mm: float, *, key: str = "gears.driving"
) -> Trimesh:
    """The gear as a closed mesh in mm, in the outline's frame, z from 0 to the face width.

    ``outline_mm`` has shape (n, 2), counter-clockwise, first point not repeated; ``key`` names the gear in errors.
    Raises NoSuchMechanism where the outline crosses itself, WrongInput when the bore does not fit.
    """
    disc = disc_with_room(outline_mm, bore, chord_tolerance_mm, key)
    return extruded(BodyPlan(disc, face_width_mm, chord_tolerance_mm, bore).section, face_width_mm)


def extruded(section: Polygon, face_width_mm: float) -> Trimesh:
    """A valid section in mm, extruded from z = 0; raises RuntimeError if the mesh is not sound, a fault of ncgear."""
    return layered((Layer(section, 0.0, face_width_mm),))
