"""What the data sheet says of accuracy."""

from __future__ import annotations

from ncgear.figures.data_sheet.entry import Entry
from ncgear.project.drive import Drive


def tolerances(drive: Drive) -> tuple[Entry, ...]:
    """The tolerances; empty where the design gives none."""
    given = drive.gears.tolerances
    if given is None:
        return ()
    rows = (
        Entry("standard", pair=given.standard or None),
        Entry("accuracy grade", pair=given.grade or None),
        Entry("upper deviation of tooth thickness", "mm", pair=given.tooth_thickness_upper_mm),
        Entry("lower deviation of tooth thickness", "mm", pair=given.tooth_thickness_lower_mm),
        Entry("note", pair=given.note or None),
    )
    return tuple(row for row in rows if row.of_pair)
