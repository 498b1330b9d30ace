"""The drawings of a pair on paper: a sheet for each gear and one for the assembly, as SVG, PDF and DXF."""

from __future__ import annotations

from collections.abc import Mapping

from ncgear.figures.data_sheet.pitch_table import pitch_table
from ncgear.files.workshop.sheets.gear_sheet import gear_sheet
from ncgear.files.workshop.sheets.pair_sheet import pair_sheet
from ncgear.files.workshop.sheets.pdf import pdf_bytes
from ncgear.files.workshop.sheets.sheet import Sheet
from ncgear.files.workshop.sheets.svg import svg_bytes
from ncgear.project.drive import Drive


def sheets_of(drive: Drive) -> dict[str, Sheet]:
    """The sheets of ``driving``, ``driven`` and ``pair``; raises the errors of the drive's solids."""
    radii = pitch_table(drive)
    sheets = {gear.gear.value: gear_sheet(drive, gear, radii) for gear in drive.measured}
    sheets["pair"] = pair_sheet(drive)
    return sheets


def drawing_files(sheets: Mapping[str, Sheet]) -> dict[str, bytes]:
    """``driving_drawing``, ``driven_drawing`` and ``pair_drawing`` of each kind by their names."""
    from ncgear.files.workshop.sheets.dxf import dxf_bytes

    writers = {"svg": svg_bytes, "pdf": pdf_bytes, "dxf": dxf_bytes}
    return {f"{name}_drawing.{kind}": write(sheet) for name, sheet in sheets.items() for kind, write in writers.items()}
