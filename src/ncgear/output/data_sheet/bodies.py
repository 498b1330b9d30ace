"""What is cut into the gears around their axes."""

from __future__ import annotations

from ncgear.design.gear_body import GearBody
from ncgear.drive import Drive
from ncgear.output.data_sheet.values import Group, Row, Value
from ncgear.recipe.bodies import rim_mm_of


def bodies(drive: Drive) -> Group:
    """Bores, keyways, and the rim of a ring."""
    driving, driven = drive.gears.driving, drive.gears.driven
    rows = [
        Row("bore", "mm", driving=driving.bore_mm, driven=driven.bore_mm),
        Row("keyway, width x depth", "mm", driving=_keyway(driving), driven=_keyway(driven)),
    ]
    if drive.pitch.driven.is_ring:
        rows.append(Row("rim outside the deepest root", "mm", driven=rim_mm_of(drive.gears, drive.rack.module_mm)))
    return Group("Bodies", tuple(rows))


def _keyway(body: GearBody) -> Value:
    return f"{body.keyway.width_mm:g} x {body.keyway.depth_mm:g}" if body.keyway else None
