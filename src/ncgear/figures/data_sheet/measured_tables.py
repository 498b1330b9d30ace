"""Tables of a data sheet for a workshop: pins, spans, tools that cut a gear, band of tooth thickness, pitch curves."""

from __future__ import annotations

from collections.abc import Sequence
from math import ceil, degrees, floor
from typing import TYPE_CHECKING

import numpy as np

from ncgear.figures.numbers import drawn, shown, to_digits, told
from ncgear.figures.tables import Column, Table, Value, cell_text, columns_of, csv_text
from ncgear.metrology.cut_by import CutBy
from ncgear.metrology.pins import Misfit, TwoPins, over_two_pins
from ncgear.metrology.span import MeasuredSpans
from ncgear.numerics.arrays import Array
from ncgear.numerics.highest import largest_from
from ncgear.pitch.pair import PitchPair
from ncgear.project.drive import Drive
from ncgear.project.workshop_measures import CutGear, GearMeasures
from ncgear.teeth.backlash import Play

if TYPE_CHECKING:
    from ncgear.project.thickness import AtThickness

SPACE = Column("space after tooth")

LIMITS = columns_of("least, mm", "greatest, mm")

Spaces = tuple[int, ...]
"""The space of one pin, or the spaces of two pins."""

Readings = dict[Spaces, float]


def pin_tables(gear: GearMeasures) -> tuple[Table, ...]:
    """The distances from the axis over single pins, and over two nearly opposite ones.

    Tables without rows or notes are left out.
    """
    return tuple(table for table in (one_pin_table(gear), two_pin_table(gear)) if table.rows or table.notes)


def one_pin_table(gear: GearMeasures) -> Table:
    """The distances from the axis over pins, in a ring to their near sides: space, centre, distance, its limits."""
    ring, pins, name, tool = gear.working.is_ring, gear.pins, gear.gear.value, gear.tool
    limits: list[Readings] = [
        {(space,): over for space, over in zip(pins.space.tolist(), pins.over_mm.tolist(), strict=True)}
        for _, pins in gear.at_limits
    ]
    found = zip(pins.space.tolist(), pins.center_mm.tolist(), pins.over_mm.tolist(), strict=True)
    rows = [(space, *center, over, *_among(limits, (space,))) for space, center, over in found]
    places = (Column(f"{axis} of the {tool}'s centre", "mm") for axis in "xy")
    far = Column(f"axis to the {tool}'s {'near' if ring else 'far'} side", "mm")
    columns = (SPACE, *places, far, *(LIMITS if limits else ()))
    title = f"{tool.capitalize()}s of {drawn(pins.diameter_mm, 'mm')} mm in the {name} gear"
    by_reason = {reason: [space for space, why in pins.misfits.items() if why is reason] for reason in Misfit}
    notes = tuple(
        f"not defined in the spaces after teeth {shown(spaces)}: {reason.value.replace('pin', tool)}"
        for reason, spaces in by_reason.items()
        if spaces
    )
    return Table(title, columns, tuple(rows), notes, long=True)


def two_pin_table(gear: GearMeasures) -> Table:
    """The distances over two nearly opposite pins, in a ring between them: both spaces, distance, its limits."""
    word = "between" if gear.working.is_ring else "over"
    columns = (SPACE, Column("and after tooth"), Column(f"{word} two {gear.tool}s", "mm"))
    limits = [_over_two(over_two_pins(working, pins)) for working, pins in gear.at_limits]
    nominal = _over_two(over_two_pins(gear.working, gear.pins))
    rows = tuple((*pair, distance, *_among(limits, pair)) for pair, distance in nominal.items())
    title = f"Measurement {word} two {gear.tool}s of {drawn(gear.pins.diameter_mm, 'mm')} mm, {gear.gear.value} gear"
    return Table(title, (*columns, *(LIMITS if limits else ())), rows, long=True)


def allowed_texts(values: Sequence[Value]) -> list[str]:
    """A length, or where its limits follow it, these alone; empty where they could not be computed."""
    return [cell_text(value, "mm") for value in (values[1:] or values)]


def _over_two(found: TwoPins) -> Readings:
    spaces = zip(found.first.tolist(), found.second.tolist(), strict=True)
    return dict(zip(spaces, found.distance_mm.tolist(), strict=True))


def _among(limits: list[Readings], spaces: Spaces) -> tuple[Value, ...]:
    """The least and the greatest reading in some spaces over both limits; empty where pins do not measure at both."""
    found = [readings[spaces] for readings in limits if spaces in readings]
    return tuple(sorted(found)) if len(found) == len(limits) else (None,) * len(limits)


SPAN_COLUMNS = columns_of(
    *("from the back of tooth", "to the front of tooth", "teeth between the plates", "phi1 at their middle, deg"),
    *("span, mm", "reading when the caliper is tilted"),
)


def span_table(gear: GearMeasures) -> tuple[Table, ...]:
    """The spans of a gear, in one row if it is circular; no table where no span is defined."""
    found = gear.spans
    if not found.first.size:
        return ()
    limits = [spans.tolist() for spans in gear.span_limits_mm()]
    columns = [
        found.first.tolist(),
        found.last.tolist(),
        found.teeth.tolist(),
        np.degrees(found.phi1_rad).tolist(),
        found.distance_mm.tolist(),
        ["stays" if found.everywhere else "grows" if least else "falls" for least in found.least],
        *limits,
    ]
    rows = tuple(zip(*columns, strict=True))[: 1 if found.everywhere else None]
    heads = (*SPAN_COLUMNS, *(LIMITS if limits else ()))
    return (Table(f"Span of the {gear.gear.value} gear", heads, rows, _span_notes(found), long=True),)


def _span_notes(found: MeasuredSpans) -> tuple[str, ...]:
    if found.everywhere:
        return ("a circular gear has the same span over as many teeth anywhere",)
    missed = f"; in {found.beyond} more they would touch beyond the flanks" if found.beyond else ""
    return (
        "only in these places do the plates of a caliper touch both flanks along one normal: elsewhere the reading "
        f"changes as it is tilted until a plate's edge or a tip is touched{missed}",
        "where the reading grows, the caliper settles at the span; where it falls, the span is the greatest reading",
    )


CUT_BY = columns_of("tool", "result", "because")


def cut_table(gear: CutGear) -> Table:
    """Tools with their sizes, what each makes of a gear, and why."""
    largest = gear.round_tool
    note = (
        f"least concave radius of the outline {drawn(largest.hollow_mm, 'mm')} mm, in the space after tooth "
        f"{largest.hollow_space}; a round tool as stated leaves {largest.left_mm:g} mm at most; of a wire the "
        "diameter counts with its spark gap"
    )
    rows = tuple((_named(cut), cut.verdict.value, cut.reason) for cut in gear.by)
    return Table(f"The {gear.gear.value} gear is cut by", CUT_BY, rows, (note,))


def _named(cut: CutBy) -> str:
    """The tool with its size; diameters are rounded down, so that the stated one fits."""
    if cut.teeth is not None:
        return f"{cut.tool.value} of {cut.teeth} teeth"
    if cut.diameter_mm is not None:
        return f"{cut.tool.value} of {floor(cut.diameter_mm * 1000.0) / 1000.0:g} mm or less"
    return cut.tool.value


BAND = "thinnest", "outlines", "thickest"
"""The teeth of a band, in the order of its values."""

TITLE = "Play and contact over the band of tooth thickness"

NOTE = (
    "outlines, drawings and solids stand in the middle of the band; idle flanks have the whole deviation, so that "
    "pushing flanks keep the law"
)


def play_figures(play: Play, least_rad: float, greatest_rad: float) -> dict[str, float]:
    """The play along the normal and of the driven gear, whose greatest is told where it is another than its least."""
    return {
        "backlash_mm": play.least_normal_mm.value,
        "backlash_max_mm": play.largest_normal_mm.value,
        "play_rad": least_rad,
        **({"play_greatest_rad": greatest_rad} if play.thicker_mm else {}),
    }


def thickness_summary(drive: Drive) -> dict[str, dict[str, float]]:
    """Figures of the pair by the teeth of ``BAND``; empty where the file gives no band."""
    return {name: _figures(at_thickness) for name, at_thickness in zip(BAND, drive.thickness_band, strict=False)}


def _figures(at_thickness: AtThickness) -> dict[str, float]:
    extremes, contact = at_thickness.extremes, at_thickness.contact
    play = extremes.backlash_rad
    return {
        "thickness_deviation_mm": at_thickness.deviation_mm,
        **play_figures(at_thickness.play, play.low.value, play.high.value),
        "play_greatest_rad": play.high.value,
        "contact_ratio_mean": contact.contact_ratio,
        "contact_ratio_min": contact.least_arc,
        "contact_ratio_back_min": contact.back.pairs.least_arc,
        "transmission_error_rad": extremes.pushing_error_rad.width,
        "transmission_error_back_rad": extremes.back_error_rad.width,
    }


def band_table(drive: Drive) -> tuple[Table, ...]:
    """The figures of the band side by side; no table where the file gives none."""
    band = tuple(thickness_summary(drive).values())
    if not band:
        return ()
    rows = [[told(key, figures[key]) for figures in band] for key in band[0]]
    heads = Column(""), *(Column(name) for name in BAND), Column("unit")
    cells = tuple((row[0][0], *(text for _, text, _ in row), row[0][2]) for row in rows)
    return (Table(TITLE, heads, cells, (NOTE,)),)


STEPS_DEG = (5.0, 4.0, 3.0, 2.0, 1.0, 0.5, 0.25, 0.2, 0.1)
"""Possible steps of the driving angle: whole parts of a turn that are easy to read."""

TURN_DEG = 360.0

ROUNDING = 1e-9
"""Part of a step by which a turn may exceed whole steps, so that no step is added for a rounding error."""

RADII = (f"pitch radius of {gear} gear, mm" for gear in ("driving", "driven"))
COLUMNS = columns_of("phi1, deg", "phi2, deg", "ratio i12", *RADII)


def pitch_table(pitch: PitchPair) -> Table:
    """Angles, ratio and both pitch radii over one turn of the driving gear, at least one row for each of its teeth.

    Gears that turn less than once have their range in place of a turn.  In the frame of a gear, the polar angle of a
    pitch point counts from the point where the gears meet at phi1 = 0.  It equals the gear's own turn, in the
    opposite sense.
    """
    phi1_deg = turn_deg(pitch.size.driving_teeth, _end_deg(pitch))
    columns = pitch_columns(pitch, np.radians(phi1_deg))
    columns[0] = phi1_deg
    columns[1] = np.degrees(columns[1])
    rows = tuple(tuple(map(float, row)) for row in columns.T)
    return Table("Pitch curves", COLUMNS, rows, (_interpolated(pitch, phi1_deg),), long=True)


def turn_deg(teeth: int, end_deg: float = TURN_DEG) -> Array:
    """Driving angles in deg over a turn or up to an end, in the coarsest step with at least one row for each tooth."""
    step = next((step for step in STEPS_DEG if end_deg / step >= teeth), end_deg / teeth)
    return np.linspace(0.0, end_deg, ceil(end_deg / step - ROUNDING) + 1)


def _end_deg(pitch: PitchPair) -> float:
    return TURN_DEG if pitch.toothed is None else degrees(pitch.toothed.covered_rad)


def pitch_columns(pitch: PitchPair, phi1_rad: Array) -> Array:
    """phi1, phi2 (rad), ratio and both pitch radii (mm) at driving angles of shape (n,), shape (5, n)."""
    driven = pitch.transmission.driven_angle(phi1_rad, 1)
    radii = [np.linalg.norm(curve.at_angle(phi1_rad).position, axis=1) for curve in (pitch.driving, pitch.driven)]
    return np.stack([phi1_rad, driven.value, 1.0 / driven.derivative(1), *radii])


OFF = [1, 3, 4]
"""The columns whose interpolation is judged: phi2 and both radii."""

PROBES, KNOWN = 4, 1e-3
"""Places between two rows where the search for the greatest error begins, and the accuracy of that error as a share."""


def _interpolated(pitch: PitchPair, phi1_deg: Array) -> str:
    """A note on the greatest error of straight interpolation between two rows."""
    rows = pitch_columns(pitch, np.radians(phi1_deg))

    def off(phi1_rad: Array) -> Array:
        found = pitch_columns(pitch, phi1_rad)
        straight = [np.interp(phi1_rad, rows[0], rows[column]) for column in OFF]
        return np.asarray(np.abs(straight - found[OFF]))

    inner = np.linspace(0.0, 1.0, PROBES, endpoint=False)
    places = np.append((rows[0, :-1, None] + np.diff(rows[0])[:, None] * inner).ravel(), rows[0, -1])
    values = off(places)
    angle, *radii = largest_from(off, places, values, KNOWN * values.max(axis=1))
    turned, moved = to_digits(degrees(angle.value), 2), to_digits(max(radius.value for radius in radii), 2)
    return (
        f"between two rows straight interpolation is off by up to {turned} deg of phi2 and {moved} mm of the radii; "
        "pitch.csv has more rows"
    )


CSV_STEPS = 720
"""Steps of half a degree over a turn of the driving gear; as many over a range."""

CSV_COLUMNS = ("phi1_deg", "phi2_deg", "ratio", "radius_driving_mm", "radius_driven_mm")


def pitch_csv(pitch: PitchPair) -> str:
    """Angles, ratio and pitch radii over one turn of the driving gear, every half degree."""
    angles = np.linspace(0.0, _end_deg(pitch), CSV_STEPS + 1)
    _, driven, *others = pitch_columns(pitch, np.radians(angles))
    return csv_text(CSV_COLUMNS, [angles, np.degrees(driven), *others])
