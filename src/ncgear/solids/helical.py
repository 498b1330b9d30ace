"""Helical and herringbone gears as solids."""

from __future__ import annotations

import numpy as np

from ncgear.pitch.pair import PitchPair
from ncgear.pitch.shape import Gear, Mesh, meeting_direction_rad
from ncgear.solids.bore import bore_points
from ncgear.solids.closeness import OUTLINE, close_stacks
from ncgear.solids.helix import Helix
from ncgear.solids.index_hole import hole_points, index_hole
from ncgear.solids.loft import lofted
from ncgear.solids.pair import Blank, GearSolid, SolidPair
from ncgear.solids.section import common_disc, require_room
from ncgear.solids.sections import Sections
from ncgear.solids.stack import Stack
from ncgear.teeth.form import ToothForm


def helical_pair(
    pitch: PitchPair, form: ToothForm, helix: Helix, blanks: dict[Gear, Blank], tolerance_mm: float
) -> SolidPair:
    """Both gears as meshes that stray from the exact surfaces by no more than the chord tolerance.

    Raises NoSuchMechanism, naming the height, where a section cannot be made or changes too abruptly with height;
    WrongInput when a bore does not fit into every section, or when there would be too many of them.
    """
    sections = Sections(pitch, form, helix, OUTLINE * tolerance_mm)
    stacks = close_stacks(sections, tolerance_mm)
    solids = {gear: _solid(sections, stacks[gear], gear, blanks[gear], tolerance_mm) for gear in Gear}
    return SolidPair(solids[Gear.DRIVING], solids[Gear.DRIVEN])


def _solid(sections: Sections, stack: Stack, gear: Gear, blank: Blank, tolerance: float) -> GearSolid:
    """A gear's mesh; bore and index hole keep their walls in every section."""
    key, module = f"gears.{gear.value}", sections.form.rack.module_mm
    disc = common_disc([sections.at(z).pieces[gear].points_mm[:-1] for z in stack.heights_mm], key)
    if blank.bore is not None:
        require_room(disc, blank.bore, tolerance, key)
    mark = (
        index_hole(disc, blank.bore, meeting_direction_rad(gear, Mesh.EXTERNAL), module) if blank.index_hole else None
    )
    holes = [bore_points(blank.bore, tolerance)] if blank.bore is not None else []
    holes += [hole_points(mark, tolerance)] if mark is not None else []
    rings, heights = stack.counter_clockwise(), stack.heights_mm
    if sections.helix.herringbone:
        rings = np.concatenate([rings, rings[-2::-1]])
        heights = np.concatenate([heights, sections.helix.face_width_mm - heights[-2::-1]])
    return GearSolid(lofted(rings, heights, holes), mark)
