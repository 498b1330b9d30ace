"""A pair's gears as they are measured: section, pins that fit, and the same with the tooth thickness at its limits.

The tables of pins in the spaces of one gear, and over two of them.

The table of spans of one gear.
"""

from __future__ import annotations

from dataclasses import dataclass
from math import cos

import numpy as np

from ncgear.figures.data_sheet.values import Column, Table, Value
from ncgear.figures.numbers import shown
from ncgear.metrology.pins import Misfit, Pins, TwoPins, nominal_pin_mm, over_two_pins, pins_in_spaces, pins_to_try
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


SINGLE = (
    Column("space after tooth"),
    Column("x of the pin's centre", "mm"),
    Column("y of the pin's centre", "mm"),
)

LIMITS = (Column("least", "mm"), Column("greatest", "mm"))

Place = tuple[int, ...]
"""The space of a pin, or those of two."""

Readings = dict[Place, float]


def pin_tables(gear: MeasuredGear) -> tuple[Table, ...]:
    """The distances from the axis over single pins, and over two nearly opposite ones.

    Tables without rows or notes are left out.
    """
    return tuple(table for table in (_single(gear), _double(gear)) if table.rows or table.notes)


def _single(gear: MeasuredGear) -> Table:
    ring, pins, name = gear.working.is_ring, gear.pins, gear.gear.value
    limits = [_over_one(pins_there) for _, pins_there in gear.at_limits]
    found = zip(pins.space.tolist(), pins.center_mm.tolist(), pins.over_mm.tolist(), strict=True)
    rows = [(space, *center, over, *_among(limits, (space,))) for space, center, over in found]
    far = Column("axis to the pin's near side" if ring else "axis to the pin's far side", "mm")
    columns = (*SINGLE, far, *(LIMITS if limits else ()))
    return Table(f"Pins of {pins.diameter_mm:g} mm in the {name} gear", columns, tuple(rows), _notes(pins))


def _double(gear: MeasuredGear) -> Table:
    word = "between" if gear.working.is_ring else "over"
    columns = (SINGLE[0], Column("and after tooth"), Column(f"{word} two pins", "mm"))
    limits = [_over_two(over_two_pins(working, pins)) for working, pins in gear.at_limits]
    nominal = _over_two(over_two_pins(gear.working, gear.pins))
    rows = tuple((*pair, distance, *_among(limits, pair)) for pair, distance in nominal.items())
    title = f"Measurement {word} two pins of {gear.pins.diameter_mm:g} mm, {gear.gear.value} gear"
    return Table(title, (*columns, *(LIMITS if limits else ())), rows)


def _over_one(pins: Pins) -> Readings:
    return {(space,): over for space, over in zip(pins.space.tolist(), pins.over_mm.tolist(), strict=True)}


def _over_two(found: TwoPins) -> Readings:
    places = zip(found.first.tolist(), found.second.tolist(), strict=True)
    return dict(zip(places, found.distance_mm.tolist(), strict=True))


def _among(limits: list[Readings], place: Place) -> tuple[Value, ...]:
    """The least and the greatest reading in a place at both limits; nothing where pins measure at one limit only."""
    found = [readings[place] for readings in limits if place in readings]
    return tuple(sorted(found)) if len(found) == len(limits) else (None,) * len(limits)


def _notes(pins: Pins) -> tuple[str, ...]:
    """In which spaces pins measure nothing, and why."""
    by_reason = {reason: [space for space, why in pins.misfits.items() if why is reason] for reason in Misfit}
    return tuple(
        f"not defined in the spaces after teeth {shown(spaces)}: {reason.value}"
        for reason, spaces in by_reason.items()
        if spaces
    )


COLUMNS = (
    Column("from the back of tooth"),
    Column("to the front of tooth"),
    Column("teeth between the plates"),
    Column("phi1 at their middle", "deg"),
    Column("span", "mm"),
    Column("reading when the caliper is tilted"),
)

SETTLES, SWINGS, EVEN = "grows", "falls", "stays"


def span_table(gear: MeasuredGear, found: Spans) -> tuple[Table, ...]:
    """The spans of a gear; none of one on which no span is defined."""
    if not found.first.size:
        return ()
    limits = _limits_of_span_table(gear, found)
    columns = (*COLUMNS, Column("least", "mm"), Column("greatest", "mm")) if limits else COLUMNS
    rows = zip(*_cells(found), *limits, strict=True)
    return (
        Table(
            f"Span of the {gear.gear.value} gear", columns, tuple(rows)[: _shown(found)], _notes_of_span_table(found)
        ),
    )


def _shown(found: Spans) -> int:
    """One row stands for all of a circular gear."""
    return 1 if found.everywhere else found.first.size


def _cells(found: Spans) -> list[list[Value]]:
    tilted = [EVEN if found.everywhere else SETTLES if least else SWINGS for least in found.least]
    return [
        found.first.tolist(),
        found.last.tolist(),
        found.teeth.tolist(),
        np.degrees(found.phi1_rad).tolist(),
        found.distance_mm.tolist(),
        tilted,
    ]


def _limits_of_span_table(gear: MeasuredGear, found: Spans) -> list[list[float]]:
    """Least and greatest spans: the thickness along the pitch curve adds its cos(alpha) share to every span."""
    if gear.limits_mm is None:
        return []
    share = np.cos(gear.working.flanks.rack.pressure_angle_rad) * gear.working.base_cosine
    moved: list[Array] = [found.distance_mm + limit * share for limit in gear.limits_mm]
    return [column.tolist() for column in moved]


def _notes_of_span_table(found: Spans) -> tuple[str, ...]:
    if found.everywhere:
        return ("a circular gear has the same span over as many teeth anywhere",)
    missed = f"; in {found.beyond} more they would touch beyond the flanks" if found.beyond else ""
    return (
        "only in these places do the plates of a caliper touch both flanks along one normal: elsewhere the reading "
        f"changes as it is tilted until a plate's edge or a tip is touched{missed}",
        "where the reading grows, the caliper settles at the span; where it falls, the span is the greatest reading",
    )


def spans_of(gear: MeasuredGear) -> Spans:
    """The gear's spans."""
    return spans(gear.working)
