"""Hub, pockets and set screw on a mesh that has been made without them."""

from __future__ import annotations

from trimesh import Trimesh

from ncgear.solids.body import BodyPlan, Layer
from ncgear.solids.booleans import mesh_of, solid_of
from ncgear.solids.layered import layered
from ncgear.solids.set_screw import drilled_hub
from ncgear.solids.sound import require_sound

VOLUME_TOLERANCE = 1e-9
"""Relative difference allowed between the mesh's volume and that of its parts: rounding only."""


def finished(toothed: Trimesh, plan: BodyPlan) -> Trimesh:
    """A toothed mesh of the plan's face width and through cuts with the plan's pockets, hub and set screw.

    Raises RuntimeError if the mesh is not sound, a fault of ncgear.
    """
    if plan.is_plate:
        return toothed
    solid, volume = solid_of(toothed), float(toothed.volume)
    for pocket in _pockets(plan):
        solid -= solid_of(layered((pocket,)))
        volume -= pocket.section.intersection(plan.section).area * (plan.face_width_mm - pocket.low_mm)
    if plan.hub is not None:
        top = plan.layers[-1]
        # From within the gear, so that both have a volume in common and not just a face.
        solid += solid_of(layered((Layer(top.section, plan.face_width_mm / 2.0, top.high_mm),)))
        volume += top.section.area * top.thickness_mm
    made = mesh_of(solid)
    require_sound(made, volume, VOLUME_TOLERANCE)
    return drilled_hub(made, plan)


def _pockets(plan: BodyPlan) -> list[Layer]:
    """Prisms that the pockets cut, to beyond the upper face."""
    if plan.web is None:
        return []
    low, high = plan.web.thickness_mm, plan.face_width_mm
    return [Layer(pocket, low, 2.0 * high - low) for pocket in plan.web.pockets]
