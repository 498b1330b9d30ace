"""The teeth in a summary."""

from __future__ import annotations

from math import degrees
from typing import TYPE_CHECKING, Any

from ncgear.drive import Drive

if TYPE_CHECKING:
    from ncgear.teeth.gear import ToothedGear


def teeth_summary(drive: Drive) -> dict[str, Any]:
    """Numbers, sizes, undercut, shortened tips."""
    from ncgear.teeth.shift import teeth_free_of_undercut

    teeth, size = drive.teeth, drive.pitch.size
    racks = teeth.driving.flanks.rack, teeth.driven.flanks.rack
    return {
        "driving": size.driving_teeth,
        "driven": size.driven_teeth,
        "module_mm": size.module_mm,
        "backlash_mm": drive.rack.backlash_mm,
        **_helix(drive),
        "undercut_driving": teeth.driving.undercut,
        "undercut_driven": teeth.driven.undercut,
        "free_of_undercut_from_driving_teeth": teeth_free_of_undercut(drive.pitch, *racks),
        "method": drive.gears.method,
        "cutter": teeth.cutter.value,
        "profile_shift_driving_mm": racks[0].shift_mm,
        "profile_shift_driven_mm": racks[1].shift_mm,
        "tips_driving": _tips(teeth.driving),
        "tips_driven": _tips(teeth.driven),
        "points_driving": len(teeth.driving.outline_mm),
        "points_driven": len(teeth.driven.outline_mm),
    }


def _tips(gear: ToothedGear) -> dict[str, Any]:
    """Least height of the tips, and numbers of the teeth whose tips are shortened, by reason."""
    from ncgear.teeth.tips import Limit

    result: dict[str, Any] = {"least_height_mm": float(gear.flanks.tip_height_mm.min())}
    for reason in Limit:
        if reason is not Limit.FULL and (numbers := gear.shortened(reason)):
            result[f"shortened_for_{reason.name.lower()}"] = numbers
    return result


def _helix(drive: Drive) -> dict[str, Any]:
    helix = drive.helix
    if helix is None:
        return {}
    kind = "herringbone" if helix.herringbone else "helical"
    return {"helix_angle_deg": degrees(helix.angle_rad), "helix_kind": kind, "hand_driving": helix.hand}
