"""A gear's section as a drive has it: tooth outline, bore with keyway, index hole."""

from __future__ import annotations

from shapely import Polygon

from ncgear.drive import Drive
from ncgear.pitch.shape import Gear, meeting_direction_rad
from ncgear.recipe.gears import bore_of, rim_mm_of
from ncgear.solids.index_hole import hole_points, index_hole, rim_hole
from ncgear.solids.ring import ring_section
from ncgear.solids.section import cut, disc_with_room


def gear_section(drive: Drive, gear: Gear) -> Polygon:
    """The section in mm, own frame, pose of phi1 = 0; raises as the teeth and the solids do."""
    if gear is Gear.DRIVEN and drive.pitch.driven.is_ring:
        return _ring(drive)
    teeth, gears, tolerance = drive.sound_teeth, drive.gears, drive.design.output.chord_tolerance_mm
    outline, body = (teeth.driving, gears.driving) if gear is Gear.DRIVING else (teeth.driven, gears.driven)
    bore, module = bore_of(body), drive.pitch.size.module_mm
    disc = disc_with_room(outline.outline_mm, bore, tolerance, f"gears.{gear.value}")
    direction = meeting_direction_rad(gear, drive.pitch.mesh)
    mark = index_hole(disc, bore, direction, module) if gears.index_holes else None
    return cut(disc, bore, mark, tolerance)


def _ring(drive: Drive) -> Polygon:
    gears, module, tolerance = drive.gears, drive.pitch.size.module_mm, drive.design.output.chord_tolerance_mm
    section = ring_section(drive.sound_teeth.driven.outline_mm, rim_mm_of(gears, module), tolerance)
    direction = meeting_direction_rad(Gear.DRIVEN, drive.pitch.mesh)
    mark = rim_hole(section, direction, module) if gears.index_holes else None
    return Polygon(section.exterior, [*section.interiors, *([hole_points(mark, tolerance)] if mark else [])])
