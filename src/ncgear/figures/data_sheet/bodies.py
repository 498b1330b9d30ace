"""What the data sheet says of the gears' bodies: bores, keyways, hubs, webs, holes, end stops and rims."""

from __future__ import annotations

from typing import TYPE_CHECKING

from ncgear.design.keys.bodies import GearBody, Hub, Web
from ncgear.figures.data_sheet.entry import Entry
from ncgear.figures.numbers import drawn
from ncgear.figures.tables import Value
from ncgear.project.drive import Drive
from ncgear.project.gear_solids import rim_mm_of

if TYPE_CHECKING:
    from ncgear.solids.plan.body import BodyPlan, RoundHole


def bodies(drive: Drive) -> tuple[Entry, ...]:
    """Bores, keyways and the other parts of the bodies."""
    driving, driven = drive.gears.driving, drive.gears.driven
    rim = rim_mm_of(drive.gears, drive.rack.module_mm) if drive.pitch.driven.is_ring else None
    rows = [
        Entry("bore", "mm", driving=driving.bore_mm, driven=driven.bore_mm),
        Entry("keyway, width x depth", "mm", driving=_keyway(driving), driven=_keyway(driven)),
        Entry("hub, diameter x height", "mm", driving=_hub(driving.hub), driven=_hub(driven.hub)),
        Entry("thickness of web", "mm", driving=_thickness(driving.web), driven=_thickness(driven.web)),
        *_round_holes(drive),
        Entry("pin of the end stop, diameter, distance from the axis", "mm", None, _stop(driving), _stop(driven)),
        Entry("rim outside the deepest root", "mm", driven=rim),
        Entry("bevel of the edges at z = 0", "mm", pair=drive.gears.first_layer_chamfer_mm or None),
        _process(drive.gears.process_clearance_mm),
    ]
    return tuple(row for row in rows if row.of_pair or row.driving or row.driven)


def _process(clearance_mm: float) -> Entry:
    if clearance_mm < 0.0:
        return Entry("kerf that drawings allow for, half on each side of the lines", "mm", -2.0 * clearance_mm)
    return Entry("clearance for the process", "mm", pair=clearance_mm or None)


def _keyway(body: GearBody) -> Value:
    return f"{_mm(body.keyway.width_mm)} x {_mm(body.keyway.depth_mm)}" if body.keyway else None


def _mm(size_mm: float) -> str:
    return drawn(size_mm, "mm")


def _hub(hub: Hub | None) -> Value:
    return f"{_mm(hub.diameter_mm)} x {_mm(hub.height_mm)}" if hub else None


def _stop(body: GearBody) -> Value:
    return f"{_mm(body.end_stop.pin_mm)}, {_mm(body.end_stop.radius_mm)}" if body.end_stop else None


def _thickness(web: Web | None) -> Value:
    return web.thickness_mm if web else None


def _round_holes(drive: Drive) -> list[Entry]:
    """The round holes as they are made; solids are made only where a gear has some."""
    gears = drive.gears
    asked = gears.index_holes, gears.driving.lightening_holes, gears.driven.lightening_holes, gears.driven.crank_pin
    if not any(asked):
        return []
    driving, driven = drive.solids.driving.plan, drive.solids.driven.plan
    pin = driven.crank_pin
    rows = [
        Entry("diameter of the crank pin's hole", "mm", driven=pin.diameter_mm if pin else None),
        Entry("centre of the crank pin's hole, x and y", "mm", driven=_place(pin) if pin else None),
        Entry("lightening holes, number x diameter", "mm", driving=_lightening(driving), driven=_lightening(driven)),
    ]
    if gears.index_holes:
        sizes, places = zip(_marked(driving.index_hole), _marked(driven.index_hole), strict=True)
        rows.append(Entry("diameter of index hole", "mm", None, *sizes))
        rows.append(Entry("centre of index hole, x and y", "mm", None, *places))
    return rows


def _lightening(plan: BodyPlan) -> Value:
    holes = plan.lightening_holes
    return f"{len(holes)} x {_mm(holes[0].diameter_mm)}" if holes else None


def _marked(hole: RoundHole | None) -> tuple[Value, Value]:
    """Diameter and centre of an index hole."""
    return ("no room for one", None) if hole is None else (hole.diameter_mm, _place(hole))


def _place(hole: RoundHole) -> str:
    return f"{_mm(hole.x_mm)}, {_mm(hole.y_mm)}"
