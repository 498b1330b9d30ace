"""The gears of a drive as a workshop measures and cuts them: section, pins, spans, limits from tolerances, tools."""

from __future__ import annotations

from functools import cached_property
from math import cos

import numpy as np

from ncgear.errors import WrongInput
from ncgear.frozen import dataclass
from ncgear.metrology.cut_by import CutBy, cut_by
from ncgear.metrology.pins import (
    SOLD_MM,
    Pins,
    WorkingFlanks,
    nominal_pin_mm,
    pins_in_spaces,
    pins_to_try,
    working_flanks,
)
from ncgear.metrology.round_tool import RoundTool, round_tool
from ncgear.metrology.span import MeasuredSpans, spans
from ncgear.numerics.arrays import Array
from ncgear.pitch.shape import Gear
from ncgear.project.geared import Geared
from ncgear.project.tooth_form import thickness_limits_mm
from ncgear.shown import Shown
from ncgear.solids.helical.helix import Helix
from ncgear.teeth.gear import ToothedGear, ToothedPair


@dataclass(frozen=True, eq=False)
class GearMeasures:
    """One gear in the measured section.

    ``tool`` lies in its spaces: a pin or, for helical teeth, a ball.  ``pins_mm`` are the diameters to choose from.
    ``section_z_mm`` is the height of the balls' centres, None where all heights are equal.  ``limits_mm`` are the lower
    and upper deviation of its tooth thickness, None where they are not given; the teeth are in the middle of both.
    """

    gear: Gear
    tool: str
    working: WorkingFlanks
    toothed: ToothedGear
    pins_mm: tuple[float, ...]
    tolerance_mm: float
    limits_mm: tuple[float, float] | None
    section_z_mm: float | None = None

    @cached_property
    def pins(self) -> Pins:
        """The pins that fit into the most spaces; the first of several such pins."""
        return max(map(self.pins_of, self.pins_mm), key=lambda pins: pins.space.size)

    def pins_of(self, diameter_mm: float) -> Pins:
        """Pins of a diameter in all spaces."""
        return pins_in_spaces(self.working, diameter_mm, self.toothed.outline_mm, self.tolerance_mm)

    @cached_property
    def spans(self) -> MeasuredSpans:
        """The spans over teeth that a caliper measures."""
        return spans(self.working)

    def span_limits_mm(self) -> list[Array]:
        """Least and greatest length of every span in mm, shape (n,) each; empty where no limits are given.

        A thickness that is greater by t along the pitch curve makes a span longer by t cos(alpha).
        """
        share = np.cos(self.working.flanks.rack.pressure_angle_rad) * self.working.base_cosine[0]
        return [self.spans.distance_mm + thicker * share for thicker in self._thicker_mm]

    @property
    def _thicker_mm(self) -> list[float]:
        """Added thickness of the thinnest and of the thickest teeth over the gear's own; empty without limits."""
        limits = self.limits_mm or ()
        return [limit - sum(limits) / 2.0 for limit in limits]

    @cached_property
    def at_limits(self) -> tuple[tuple[WorkingFlanks, Pins], ...]:
        """Flanks and pins of the thinnest and of the thickest teeth; empty where no limits are given."""
        found = []
        for thicker in self._thicker_mm:
            working = self.working.thicker(thicker)
            # The teeth of the outline are in the middle of the thickness limits.
            astray_mm = self.tolerance_mm + abs(thicker)
            outline_mm = self.toothed.outline_mm
            found.append((working, pins_in_spaces(working, self.pins.diameter_mm, outline_mm, astray_mm)))
        return tuple(found)


def measured_gears(drive: Geared) -> tuple[GearMeasures, GearMeasures]:
    """The driving and the driven gear, in the section of ``measured_section``.

    Raises WrongInput where given pins measure in no space, with the least and the largest commercial or near-nominal
    pins that do.
    """
    teeth = measured_section(drive)
    gears = _measured(drive, Gear.DRIVING, teeth.driving), _measured(drive, Gear.DRIVEN, teeth.driven)
    given = drive.gears.measuring_pin_mm
    if given is None or any(gear.pins.space.size for gear in gears):
        return gears
    sizes = sorted({*SOLD_MM, *(size for gear in gears for size in pins_to_try(_nominal_mm(drive, gear.working)))})
    fitting = [size for size in sizes if all(gear.pins_of(size).space.size for gear in gears)]
    right = f"{fitting[0]:g} to {fitting[-1]:g} mm do" if fitting else "leave it out"
    raise WrongInput(
        f"{gears[0].tool}s of {given:g} mm measure in no space of either gear; {right}", key="gears.measuring_pin_mm"
    )


@dataclass(frozen=True)
class CutGear(Shown):
    """One gear as tools cut it: the largest round tool that follows its outline, and the result of each kind of tool.

    For helical gears the section at z = 0 is tried.
    """

    gear: Gear
    round_tool: RoundTool
    by: tuple[CutBy, ...]


def cut_gears(drive: Geared) -> tuple[CutGear, CutGear]:
    """The driving and the driven gear as tools cut them, to the chord tolerance."""
    helix = "" if drive.helix is None else "herringbone" if drive.helix.herringbone else "helical"

    def of(gear: Gear) -> CutGear:
        largest = round_tool(drive.teeth.of(gear), drive.chord_tolerance_mm)
        return CutGear(gear, largest, tuple(cut_by(drive.pitch, drive.teeth, gear, largest, helix=helix)))

    return of(Gear.DRIVING), of(Gear.DRIVEN)


def measured_section(drive: Geared) -> ToothedPair:
    """Both gears in the measured section.

    Straight teeth have one section.  Helical gears are measured half way up, herringbone gears half way up their lower
    half.
    """
    if drive.helix is None:
        return drive.teeth
    advance = drive.helix.advance_mm(section_z_mm(drive.helix))
    return drive.toothed(drive.chord_tolerance_mm, advance_mm=advance)


def section_z_mm(helix: Helix) -> float:
    """Height of the measured section: half way up helical teeth, or up the lower half of herringbone teeth."""
    return helix.rise_mm / 2.0


def _measured(drive: Geared, gear: Gear, toothed: ToothedGear) -> GearMeasures:
    tolerance = drive.chord_tolerance_mm
    working = working_flanks(toothed, drive.helix.angle_rad if drive.helix else 0.0)
    limits, given = thickness_limits_mm(drive.gears), drive.gears.measuring_pin_mm
    tool = "ball" if drive.helix else "pin"
    z_mm = section_z_mm(drive.helix) if drive.helix else None
    pins_mm = (given,) if given is not None else pins_to_try(_nominal_mm(drive, working))
    return GearMeasures(gear, tool, working, toothed, pins_mm, tolerance, limits, z_mm)


def _nominal_mm(drive: Geared, working: WorkingFlanks) -> float:
    normal_module = drive.rack.module_mm * (cos(drive.helix.angle_rad) if drive.helix else 1.0)
    return nominal_pin_mm(normal_module, internal=working.is_ring)
