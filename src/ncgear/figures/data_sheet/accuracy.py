"""What the data sheet and the drawings say of accuracy: the tolerances of the file, and those that follow from it."""

from __future__ import annotations

from ncgear.figures.data_sheet.entry import Entry
from ncgear.figures.numbers import drawn
from ncgear.project.drive import Drive
from ncgear.project.usual_tolerances import tolerances_of
from ncgear.tolerances.iso286 import distance_deviation_mm, hole_text


def tolerances(drive: Drive) -> tuple[Entry, ...]:
    """The tolerances of a pair."""
    given, gears, lead = drive.gears.tolerances, drive.gears, drive.gears.lead
    pin = gears.driven.crank_pin
    pinned = None if pin is None else hole_text(given.crank_pin_fit, pin.diameter_mm)
    driving, driven = (
        None if body.bore_mm is None else bore_text(drive, body.bore_mm) for body in (gears.driving, gears.driven)
    )
    rows = (
        Entry("standard", pair=given.standard or None),
        Entry("accuracy grade", pair=given.grade or None),
        Entry("lead crowning of both gears together", "\u00b5m", pair=lead.crowning_um or None),
        Entry("end relief of both gears together", "\u00b5m", pair=lead.end_relief_um),
        Entry("length of the end relief", "mm", pair=lead.end_relief_length_mm),
        Entry("lower deviation of tooth thickness", "mm", pair=given.tooth_thickness_lower_mm),
        Entry("upper deviation of tooth thickness", "mm", pair=given.tooth_thickness_upper_mm),
        Entry("deviation of the centre distance", "mm", pair=distance_text(drive)),
        Entry("fit of the bore", "mm", driving=driving, driven=driven),
        Entry("fit of the crank pin's hole", "mm", driven=pinned),
        Entry("fit of the index hole", pair=given.index_hole_fit if gears.index_holes else None),
        Entry("sizes without a tolerance", pair=general_text(drive)),
        Entry("roughness Ra of flanks; elsewhere", "\u00b5m", pair=f"{given.flank_ra_um:g}; {given.ra_um:g}"),
        Entry("note", pair=given.note or None),
    )
    return tuple(row for row in rows if row.of_pair or row.driving or row.driven)


def distance_text(drive: Drive) -> str | None:
    """How far the centre distance may be off, either way, in mm: as assemblies are judged, or JS7 where they are exact.

    None where neither the file nor the standard says.
    """
    judged_mm = tolerances_of(drive)[0].center_distance_mm
    deviation_mm = judged_mm or distance_deviation_mm(drive.pitch.center_distance_mm)
    return f"\u00b1{drawn(deviation_mm, 'mm')}" if deviation_mm else None


def bore_text(drive: Drive, diameter_mm: float) -> str:
    """The fit of a bore."""
    return hole_text(drive.gears.tolerances.bore_fit, diameter_mm)


def general_text(drive: Drive) -> str:
    """The class of sizes without a tolerance of their own."""
    return f"ISO 2768-{drive.gears.tolerances.general}"
