"""Faults of a gear's body that the gears' other sizes tell."""

from __future__ import annotations

from ncgear.design.faults import fault
from ncgear.design.gear_body import GearBody


def require_hub_wall(name: str, body: GearBody, clearance: float) -> None:
    """Raise the fault of a hub, or of what a web leaves about the axis, that bore and keyway break through."""
    least = 2.0 * body.reach_mm(clearance)
    if body.hub is not None and body.hub.diameter_mm <= least:
        problem = f"{body.hub.diameter_mm:g} mm leaves no wall around bore and keyway; over {least:.4g} mm is right"
        raise fault(f"{name}.hub.diameter_mm", problem)
    if body.web is not None and body.web.hub_mm is not None and body.web.hub_mm <= least:
        problem = f"{body.web.hub_mm:g} mm leaves no wall around bore and keyway; over {least:.4g} mm is right"
        raise fault(f"{name}.web.hub_mm", problem)


def require_height(name: str, body: GearBody, face_width: float, chamfer: float) -> None:
    """Raise the fault of a web as thick as the gear, or of a chamfer as high as the web or the gear."""
    web = body.web
    if web is not None and web.thickness_mm >= face_width:
        problem = f"{web.thickness_mm:g} mm is no thinner than the gear; under {face_width:g} mm is right"
        raise fault(f"{name}.web.thickness_mm", problem)
    lowest = face_width if web is None else web.thickness_mm
    if chamfer >= lowest:
        part = "gear" if web is None else f"{name} gear's web"
        raise fault("first_layer_chamfer_mm", f"{chamfer:g} mm is as high as the {part}; under {lowest:g} mm is right")
