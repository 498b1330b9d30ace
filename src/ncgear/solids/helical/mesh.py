"""Helical and herringbone gears as solids."""

from __future__ import annotations

import numpy as np

from ncgear.pitch.pair import PitchPair
from ncgear.pitch.shape import Gear, Mesh, meeting_direction_rad
from ncgear.solids.helical.helix import Helix
from ncgear.solids.helical.loft import lofted
from ncgear.solids.helical.sections import Sections
from ncgear.solids.helical.stack import OUTLINE, Stack, close_stacks
from ncgear.solids.mesh.finish import finished
from ncgear.solids.mesh.pair import GearSolid, SolidPair
from ncgear.solids.plan.body import Blank, bore_points, hole_points
from ncgear.solids.plan.plan import planned_within
from ncgear.solids.plan.room import common_disc, full_disc
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
    """A gear's mesh; everything cut keeps its walls in every section."""
    key, module = f"gears.{gear.value}", sections.form.rack.module_mm
    outlines = [sections.at(z).pieces[gear].points_mm[:-1] for z in stack.heights_mm]
    direction = meeting_direction_rad(gear, Mesh.EXTERNAL)
    room = common_disc(outlines, key)
    plan = planned_within(full_disc(outlines[0], key), room, blank, direction, module, tolerance, key)
    holes = [bore_points(plan.bore, tolerance)] if plan.bore is not None else []
    holes += [hole_points(hole, tolerance) for hole in plan.round_holes]
    rings, heights = stack.counter_clockwise(), stack.heights_mm
    if sections.helix.herringbone:
        rings = np.concatenate([rings, rings[-2::-1]])
        heights = np.concatenate([heights, sections.helix.face_width_mm - heights[-2::-1]])
    return GearSolid(finished(lofted(rings, heights, holes), plan), plan)
