"""The stage of a drive that makes bodies of the teeth."""

from __future__ import annotations

from typing import TYPE_CHECKING

from ncgear.drive.stage import stage
from ncgear.drive.teeth import ToothStages
from ncgear.errors import WrongInput

if TYPE_CHECKING:
    from ncgear.solids.helix import Helix
    from ncgear.solids.pair import GearSolid, SolidPair


class SolidStages(ToothStages):
    """Both gears as bodies."""

    @stage
    def solids(self) -> SolidPair:
        """Both gears as closed meshes."""
        return self._straight_solids() if self.helix is None else self._helical_solids(self.helix)

    def _helical_solids(self, helix: Helix) -> SolidPair:
        from ncgear.pitch.shape import Gear
        from ncgear.recipe.bodies import blank_of
        from ncgear.solids.helical import helical_pair

        gears, pitch, form = self.gears, self.pitch, self.tooth_form
        if pitch.driven.is_ring:
            raise WrongInput("helical teeth of internal pairs are not made; leave it out", key="gears.helix")
        blanks = {Gear.DRIVING: blank_of(gears, gears.driving), Gear.DRIVEN: blank_of(gears, gears.driven)}
        with self.stopwatch("solids"):
            return helical_pair(pitch, form, helix, blanks, self.design.output.chord_tolerance_mm)

    def _straight_solids(self) -> SolidPair:
        from ncgear.solids.pair import SolidPair

        with self.stopwatch("solids"):
            return SolidPair(_driving_solid(self), _driven_solid(self))


def _driving_solid(drive: SolidStages) -> GearSolid:
    from ncgear.recipe.bodies import blank_of
    from ncgear.solids.pair import driving_solid

    pitch, blank = drive.pitch, blank_of(drive.gears, drive.gears.driving)
    tolerance = drive.design.output.chord_tolerance_mm
    return driving_solid(drive.teeth.driving.outline_mm, blank, pitch.size.module_mm, tolerance, pitch.mesh)


def _driven_solid(drive: SolidStages) -> GearSolid:
    from ncgear.recipe.bodies import blank_of, ring_blank_of
    from ncgear.solids.pair import driven_solid
    from ncgear.solids.ring import ring_solid

    gears, outline, module = drive.gears, drive.teeth.driven.outline_mm, drive.pitch.size.module_mm
    tolerance = drive.design.output.chord_tolerance_mm
    if drive.pitch.driven.is_ring:
        return ring_solid(outline, ring_blank_of(gears, module), module, tolerance)
    return driven_solid(outline, blank_of(gears, gears.driven), module, tolerance)
