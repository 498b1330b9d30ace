"""The solids of a drive's gears with exact faces."""

from __future__ import annotations

from dataclasses import dataclass

from OCP.TopoDS import TopoDS_Shape

from ncgear.drive import Drive
from ncgear.pitch.shape import Gear
from ncgear.recipe.bodies import rim_mm_of
from ncgear.solids.brep.gear import gear_shape, helical_gear_shape, ring_shape
from ncgear.solids.helix import Helix
from ncgear.solids.patches import patches_of
from ncgear.solids.ring import outer_radius_mm
from ncgear.solids.sections import Sections
from ncgear.teeth.contour import contour_of

SHARE = 0.1
"""Of the chord tolerance, which faces may stray from the exact ones: even where the working flanks of an outline get
the least share of it, 0.15, the faces are the closer ones, so that gears made of them miss the law no more."""


@dataclass(frozen=True, eq=False)
class Solid:
    """A gear's solid in its own frame, and how far its tooth faces were found from the exact ones at most."""

    shape: TopoDS_Shape
    deviation_mm: float


def solids_of_drive(drive: Drive) -> dict[Gear, Solid]:
    """Both gears; raises as the teeth's contact does, and WrongInput for helical teeth that do not go up smoothly."""
    drive.require_sound_teeth()
    if drive.helix is None:
        return {gear: _straight(drive, gear) for gear in Gear}
    sections = Sections(drive.pitch, drive.tooth_form, drive.helix, drive.design.output.chord_tolerance_mm)
    return {gear: _helical(drive, sections, drive.helix, gear) for gear in Gear}


def _straight(drive: Drive, gear: Gear) -> Solid:
    own = drive.teeth.of(gear)
    contour = contour_of(own, SHARE * drive.design.output.chord_tolerance_mm)
    plan = drive.solids.of(gear).plan
    if gear is Gear.DRIVING or not drive.pitch.driven.is_ring:
        return Solid(gear_shape(contour, plan), contour.deviation_mm)
    radius = outer_radius_mm(own.outline_mm, rim_mm_of(drive.gears, drive.pitch.size.module_mm))
    return Solid(ring_shape(contour, plan, radius), contour.deviation_mm)


def _helical(drive: Drive, sections: Sections, helix: Helix, gear: Gear) -> Solid:
    patches = patches_of(sections, gear, SHARE * drive.design.output.chord_tolerance_mm)
    shape = helical_gear_shape(patches, drive.solids.of(gear).plan, herringbone=helix.herringbone)
    return Solid(shape, patches.deviation_mm)
