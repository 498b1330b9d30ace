"""The bodies of both gears in the summary: what was found room for, and what the process is left."""

from __future__ import annotations

from dataclasses import asdict
from math import degrees
from typing import TYPE_CHECKING, Any

from ncgear.drive import Drive

if TYPE_CHECKING:
    from ncgear.solids.body import BodyPlan, Hub
    from ncgear.solids.pair import GearSolid


def bodies_summary(drive: Drive) -> dict[str, Any]:
    """Both bodies as they are written, and the lag of parts that come out just so.

    A process that takes its clearance leaves the gears as designed.  One that takes nothing leaves a gap of two
    clearances along the normal, which the driven gear falls back by: over the lever of the force, the largest angle.
    """
    clearance, solids = drive.gears.process_clearance_mm, drive.solids
    lever_mm = drive.designed_contact.pushing.first.lever_mm
    return {
        "process_clearance_mm": clearance,
        "lag_max_without_process_rad": float((2.0 * clearance / lever_mm).max()),
        "first_layer_chamfer_mm": drive.gears.first_layer_chamfer_mm,
        "driving": _body(solids.driving),
        "driven": _body(solids.driven),
    }


def _body(solid: GearSolid) -> dict[str, Any]:
    plan = solid.plan
    return {
        "volume_mm3": float(solid.mesh.volume),
        "height_mm": plan.height_mm,
        **({"bore_mm": plan.bore.diameter_mm} if plan.bore else {}),
        **(_hub(plan.hub) if plan.hub else {}),
        **_cuts(plan),
    }


def _hub(hub: Hub) -> dict[str, Any]:
    found: dict[str, Any] = {"hub_diameter_mm": hub.diameter_mm, "hub_height_mm": hub.height_mm}
    if hub.set_screw is not None:
        screw = hub.set_screw
        found["set_screw"] = {
            "diameter_mm": screw.diameter_mm,
            "height_mm": screw.height_mm,
            "direction_deg": degrees(screw.direction_rad),
        }
    return found


def _cuts(plan: BodyPlan) -> dict[str, Any]:
    found: dict[str, Any] = {}
    if plan.web is not None:
        found["web_mm"] = plan.web.thickness_mm
        found["pocket_areas_mm2"] = [float(pocket.area) for pocket in plan.web.pockets]
    if plan.lightening_holes:
        found["lightening_holes"] = [asdict(hole) for hole in plan.lightening_holes]
    return found
