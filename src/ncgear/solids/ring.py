"""The body of an internal gear: a ring between its tooth outline and a circle about its axis."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from shapely import Polygon

from ncgear.numerics.arrays import Array
from ncgear.pitch.shape import Gear, Mesh, meeting_direction_rad
from ncgear.solids.bore import circle_points
from ncgear.solids.extrude import extruded
from ncgear.solids.index_hole import hole_points, rim_hole
from ncgear.solids.pair import GearSolid
from ncgear.solids.section import full_disc

KEY = "gears.driven"
"""Key of the only gear that can be a ring."""


@dataclass(frozen=True)
class RingBlank:
    """What makes a tooth outline a ring: face width, rim outside the roots, and whether an index hole is wanted."""

    face_width_mm: float
    rim_mm: float
    index_hole: bool = False


def outer_radius_mm(outline_mm: Array, rim_mm: float) -> float:
    """Radius of the circle about the axis that leaves the rim outside the root farthest out.

    A circle, and not a curve parallel to the teeth: rings are turned, clamped and borne on it.
    """
    return float(np.hypot(outline_mm[:, 0], outline_mm[:, 1]).max()) + rim_mm


def ring_section(outline_mm: Array, rim_mm: float, chord_tolerance_mm: float) -> Polygon:
    """The ring's section in mm: the circle, inside of which it stays by a chord tolerance at most, less the outline.

    ``outline_mm`` has shape (n, 2).  Raises NoSuchMechanism where it crosses itself.
    """
    hole = full_disc(outline_mm, KEY)
    return Polygon(circle_points(outer_radius_mm(outline_mm, rim_mm), chord_tolerance_mm), [hole.exterior])


def ring_solid(outline_mm: Array, blank: RingBlank, module_mm: float, chord_tolerance_mm: float) -> GearSolid:
    """The ring as a closed mesh, with its index hole in the rim if wanted; raises as ``ring_section`` does."""
    section = ring_section(outline_mm, blank.rim_mm, chord_tolerance_mm)
    direction = meeting_direction_rad(Gear.DRIVEN, Mesh.INTERNAL)
    mark = rim_hole(section, direction, module_mm) if blank.index_hole else None
    holes = [*section.interiors, *([hole_points(mark, chord_tolerance_mm)] if mark else [])]
    return GearSolid(extruded(Polygon(section.exterior, holes), blank.face_width_mm), mark)
