"""The sheets of a pair on paper: one for each gear and one for the assembly."""

from __future__ import annotations

from ncgear.figures.data_sheet.pitch_table import pitch_table
from ncgear.files.workshop.sheets.gear_sheet import gear_sheet
from ncgear.files.workshop.sheets.pair_sheet import pair_sheet
from ncgear.files.workshop.sheets.sheet import Sheet
from ncgear.project.drive import Drive


def sheets_of(drive: Drive) -> dict[str, Sheet]:
    """The sheets of ``driving``, ``driven`` and ``pair``; raises the errors of the drive's solids."""
    radii = pitch_table(drive)
    sheets = {gear.gear.value: gear_sheet(drive, gear, radii) for gear in drive.measured}
    sheets["pair"] = pair_sheet(drive)
    return sheets
