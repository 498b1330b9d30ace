"""The gears' bodies: bores, keyways, hubs, webs, holes, and the rim of a ring."""

from __future__ import annotations

from ncgear.design.gear_body import GearBody, Hub, LighteningHoles, Web
from ncgear.drive import Drive
from ncgear.output.data_sheet.values import Group, Row, Value
from ncgear.recipe.bodies import rim_mm_of


def bodies(drive: Drive) -> Group:
    """Bores and keyways, and what else is asked of a body."""
    driving, driven = drive.gears.driving, drive.gears.driven
    rows = [
        Row("bore", "mm", driving=driving.bore_mm, driven=driven.bore_mm),
        Row("keyway, width x depth", "mm", driving=_keyway(driving), driven=_keyway(driven)),
        Row("hub, diameter x height", "mm", driving=_hub(driving.hub), driven=_hub(driven.hub)),
        Row("thickness of web", "mm", driving=_web(driving.web), driven=_web(driven.web)),
        Row("lightening holes", driving=_holes(driving.lightening_holes), driven=_holes(driven.lightening_holes)),
        Row("rim outside the deepest root", "mm", driven=_rim(drive)),
        Row("bevel of the edges at z = 0", "mm", pair=drive.gears.first_layer_chamfer_mm or None),
        Row("clearance for the process", "mm", pair=drive.gears.process_clearance_mm or None),
    ]
    return Group("Bodies", tuple(row for row in rows if row.of_pair or row.driving or row.driven))


def _keyway(body: GearBody) -> Value:
    return f"{body.keyway.width_mm:g} x {body.keyway.depth_mm:g}" if body.keyway else None


def _hub(hub: Hub | None) -> Value:
    return f"{hub.diameter_mm:g} x {hub.height_mm:g}" if hub else None


def _web(web: Web | None) -> Value:
    return web.thickness_mm if web else None


def _holes(holes: LighteningHoles | None) -> Value:
    if holes is None:
        return None
    size = "the largest that fit" if holes.diameter_mm is None else f"{holes.diameter_mm:g} mm"
    return f"{holes.count}, {size}"


def _rim(drive: Drive) -> Value:
    return rim_mm_of(drive.gears, drive.rack.module_mm) if drive.pitch.driven.is_ring else None
