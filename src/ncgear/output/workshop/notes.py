"""What is written beside a drawing, so that it needs no other paper."""

from __future__ import annotations

from ncgear.drive import Drive
from ncgear.pitch.shape import Gear
from ncgear.solids.body import BodyPlan


def gear_notes(drive: Drive, gear: Gear, plan: BodyPlan) -> tuple[str, ...]:
    """What the gear is, its scale and frame, and what lines cannot show."""
    return (
        f"{_title(drive)}: {gear.value} gear",
        _scale(drive),
        "axis at the origin, upper face towards you, pose of phi1 = 0",
        f"module {drive.pitch.size.module_mm:.10g} mm, face width {plan.face_width_mm:g} mm",
        *_depths(plan),
        *_changes(drive, plan),
    )


def pair_notes(drive: Drive) -> tuple[str, ...]:
    """The same of both gears as they go together."""
    return (
        f"{_title(drive)}: both gears assembled at phi1 = 0",
        _scale(drive),
        f"driving axis at the origin, driven axis at x = {drive.pitch.center_distance_mm:.6f} mm",
    )


def _title(drive: Drive) -> str:
    return drive.design.name if drive.stage is None else f"{drive.design.name}, stage {drive.stage}"


def _scale(drive: Drive) -> str:
    tolerance = drive.design.output.chord_tolerance_mm
    return f"1:1 in mm; chords no farther than {tolerance:g} mm from the exact curve, round holes exact"


def _depths(plan: BodyPlan) -> list[str]:
    """How far up and down the lines go that are not cut through."""
    found = []
    if plan.web:
        found.append(f"POCKETS from the upper face down to {plan.web.thickness_mm:g} mm over the lower one")
    if plan.hub:
        found.append(f"HUB {plan.hub.height_mm:g} mm over the upper face")
    return found


def _changes(drive: Drive, plan: BodyPlan) -> list[str]:
    """How lines differ from the gear as designed, and the body from the lines."""
    found = []
    if drive.helix is not None:
        found.append("helical teeth: section at z = 0, not to be cut upright")
    if plan.clearance_mm > 0.0:
        found.append(f"{plan.clearance_mm:g} mm taken off outline and bore for the process")
    if plan.chamfer_mm > 0.0:
        found.append(f"lower edges bevelled by {plan.chamfer_mm:g} mm")
    return found
