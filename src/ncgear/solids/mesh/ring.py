"""The body of an internal gear: a ring between its tooth outline and a circle about its axis."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from shapely import Polygon

from ncgear.numerics.arrays import Array
from ncgear.pitch.shape import Gear, Mesh, meeting_direction_rad
from ncgear.solids.mesh.pair import GearSolid, solid_of_plan
from ncgear.solids.plan.body import BodyPlan, circle_points
from ncgear.solids.plan.parallel import moved_inwards
from ncgear.solids.plan.plan import CLEARANCE_KEY
from ncgear.solids.plan.room import full_disc, rim_hole

KEY = "gears.driven"
"""Key of the only gear that can be a ring."""


@dataclass(frozen=True)
class RingBlank:
    """What makes a tooth outline a ring: face width, rim outside the roots, and whether an index hole is wanted.

    Chamfer and clearance are those of ``Blank``; the clearance is not taken off the outer circle.
    """

    face_width_mm: float
    rim_mm: float
    index_hole: bool = False
    chamfer_mm: float = 0.0
    clearance_mm: float = 0.0


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
    """The ring as a closed mesh, with its index hole in the rim if wanted.

    Raises as ``ring_section`` and ``solid_of_plan``, and WrongInput where the clearance takes teeth off.
    """
    disc = _cleared(outline_mm, blank, chord_tolerance_mm)
    direction = meeting_direction_rad(Gear.DRIVEN, Mesh.INTERNAL)
    mark = rim_hole(disc, direction, module_mm) if blank.index_hole else None
    plan = BodyPlan(
        disc,
        blank.face_width_mm,
        chord_tolerance_mm,
        index_hole=mark,
        chamfer_mm=blank.chamfer_mm,
        clearance_mm=blank.clearance_mm,
    )
    return solid_of_plan(plan)


def _cleared(outline: Array, blank: RingBlank, tolerance: float) -> Polygon:
    """The ring's section with the clearance taken off its teeth: off a ring as much thicker it leaves the circle."""
    clearance = blank.clearance_mm
    ring = ring_section(outline, blank.rim_mm + clearance, tolerance)
    return moved_inwards(ring, clearance, tolerance, CLEARANCE_KEY) if clearance > 0.0 else ring
