"""A pair's gears as they are measured: section, pins that fit, and the same with the tooth thickness at its limits."""

from __future__ import annotations

from dataclasses import dataclass
from math import cos

from ncgear.drive import Drive
from ncgear.metrology.diameters import nominal_pin_mm, pins_to_try
from ncgear.metrology.pins import Pins, pins_in_spaces
from ncgear.metrology.working import WorkingFlanks, working_flanks
from ncgear.pitch.shape import Gear
from ncgear.teeth.gear import ToothedGear, ToothedPair, toothed_pair


@dataclass(frozen=True, eq=False)
class MeasuredGear:
    """One gear with the pins chosen for it; ``limits_mm`` are the lower and upper deviation of its tooth thickness."""

    gear: Gear
    working: WorkingFlanks
    toothed: ToothedGear
    pins: Pins
    tolerance_mm: float
    limits_mm: tuple[float, float] | None

    @property
    def at_limits(self) -> tuple[tuple[WorkingFlanks, Pins], ...]:
        """Flanks and pins of the thinnest and of the thickest teeth; none where no limits are given."""
        return tuple((working, self._pins_of(working, limit)) for limit, working in self._thicker())

    def _thicker(self) -> list[tuple[float, WorkingFlanks]]:
        return [(limit, self.working.thicker(limit)) for limit in self.limits_mm or ()]

    def _pins_of(self, working: WorkingFlanks, limit_mm: float) -> Pins:
        """The same pins; the outline is that of the teeth without their deviation."""
        astray = self.tolerance_mm + abs(limit_mm) / 2.0
        return pins_in_spaces(working, self.pins.diameter_mm, self.toothed.outline_mm, astray)


def measured_gears(drive: Drive) -> tuple[MeasuredGear, MeasuredGear]:
    """The driving and the driven gear; helical ones in the section half way up (of the lower half, of herringbone)."""
    teeth = measured_section(drive)
    return _measured(drive, Gear.DRIVING, teeth.driving), _measured(drive, Gear.DRIVEN, teeth.driven)


def measured_section(drive: Drive) -> ToothedPair:
    """Both gears in that section."""
    if drive.helix is None:
        return drive.teeth
    advance = drive.helix.advance_mm(drive.helix.rise_mm / 2.0)
    return toothed_pair(drive.pitch, drive.tooth_form, drive.design.output.chord_tolerance_mm, advance_mm=advance)


def _measured(drive: Drive, gear: Gear, toothed: ToothedGear) -> MeasuredGear:
    tolerance = drive.design.output.chord_tolerance_mm
    working = working_flanks(toothed, drive.helix.angle_rad if drive.helix else 0.0)
    return MeasuredGear(gear, working, toothed, _fitting(drive, working, toothed, tolerance), tolerance, _limits(drive))


def _fitting(drive: Drive, working: WorkingFlanks, toothed: ToothedGear, tolerance: float) -> Pins:
    """The pins given or, of those that are tried, the smallest ones that measure in the most spaces."""
    helix, given = drive.helix, drive.gears.measuring_pin_mm
    normal_module = drive.rack.module_mm * (cos(helix.angle_rad) if helix else 1.0)
    nominal = nominal_pin_mm(normal_module, internal=working.is_ring)
    tried = (given,) if given is not None else pins_to_try(nominal)
    found = [pins_in_spaces(working, diameter, toothed.outline_mm, tolerance) for diameter in tried]
    return max(found, key=lambda pins: pins.space.size)


def _limits(drive: Drive) -> tuple[float, float] | None:
    given = drive.gears.tolerances
    if given is None or given.tooth_thickness_lower_mm is None or given.tooth_thickness_upper_mm is None:
        return None
    return given.tooth_thickness_lower_mm, given.tooth_thickness_upper_mm
