"""The gears of a drive as a workshop measures them: section, pins that fit, spans, and tolerances' limits."""

from __future__ import annotations

from dataclasses import dataclass
from functools import cached_property
from math import cos

import numpy as np

from ncgear.metrology.pins import Pins, nominal_pin_mm, pins_in_spaces, pins_to_try
from ncgear.metrology.span import Spans, spans
from ncgear.metrology.working import WorkingFlanks, working_flanks
from ncgear.numerics.arrays import Array
from ncgear.pitch.shape import Gear
from ncgear.project.drive import Drive
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

    @cached_property
    def spans(self) -> Spans:
        """The spans over teeth that a caliper measures."""
        return spans(self.working)

    def span_limits_mm(self) -> list[Array]:
        """Least and greatest of every span, shape (n,) each; none where no limits are given.

        The thickness along the pitch curve adds its cos(alpha) share to every span.
        """
        share = np.cos(self.working.flanks.rack.pressure_angle_rad) * self.working.base_cosine
        return [self.spans.distance_mm + limit * share for limit in self.limits_mm or ()]

    @property
    def at_limits(self) -> tuple[tuple[WorkingFlanks, Pins], ...]:
        """Flanks and pins of the thinnest and of the thickest teeth; none where no limits are given."""
        thicker = [(limit, self.working.thicker(limit)) for limit in self.limits_mm or ()]
        return tuple((working, self._pins_of(working, limit)) for limit, working in thicker)

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
    """The pins given; else those that measure in the most spaces, the smallest of them."""
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
