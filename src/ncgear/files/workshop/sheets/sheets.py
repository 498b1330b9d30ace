"""The sheets of a pair on paper, one for each gear and one for the assembly, as values and as files.

The sheet of a gear has its views with numbered teeth above, its tables and its bore below them.
"""

from __future__ import annotations

from collections.abc import Mapping

from ncgear.figures.data_sheet.accuracy import general_text
from ncgear.figures.data_sheet.pitch_table import pitch_table
from ncgear.figures.tables import Table
from ncgear.files.workshop.dxf import sheet_dxf
from ncgear.files.workshop.pdf import sheet_pdf
from ncgear.files.workshop.sheets.body import finished, material_of, title_of
from ncgear.files.workshop.sheets.frame import TITLE_HEIGHT_MM, Box, Titles, framed, inside
from ncgear.files.workshop.sheets.gear_tables import gear_tables
from ncgear.files.workshop.sheets.gear_view import gear_views
from ncgear.files.workshop.sheets.pair_sheet import pair_sheet
from ncgear.files.workshop.sheets.sheet import A4_MM, Sheet
from ncgear.files.workshop.svg import sheet_svg
from ncgear.project.drive import Drive
from ncgear.project.measured import MeasuredGear

WRITERS = {"svg": sheet_svg, "pdf": sheet_pdf, "dxf": sheet_dxf}

TABLES_MM, GAP_MM = 108.0, 2.0
"""Height of the tables, a title, two lines of heads and 24 rows; and what is left free beside them."""


def gear_sheet(drive: Drive, measured: MeasuredGear, pitch_radii: Table) -> Sheet:
    """The sheet of a gear, in its own frame and in the pose of phi1 = 0, seen from its upper face.

    ``pitch_radii`` is the data sheet's table of both gears.
    """
    gear = measured.gear
    plan = finished(drive, gear)
    frame = inside(A4_MM)
    low = frame.low + TITLE_HEIGHT_MM + GAP_MM
    tables = Box(frame.left, low, frame.right, low + TABLES_MM)
    area = Box(frame.left + GAP_MM, tables.high + GAP_MM, frame.right - GAP_MM, frame.high - GAP_MM)
    view, items = gear_views(drive, measured, plan, area)
    items += gear_tables(drive, measured, plan, pitch_radii, tables)
    name = title_of(drive)
    titles = Titles(
        f"{gear.value.capitalize()} gear",
        name,
        material_of(drive, gear),
        "seen from z > 0, pose of phi1 = 0" + (", section of teeth at z = 0" if drive.helix else ""),
        view.scale,
        general_text(drive),
    )
    return Sheet(f"{name}: {gear.value} gear", A4_MM, view.scale, view.origin, (*framed(A4_MM, titles), *items))


def sheets_of(drive: Drive) -> dict[str, Sheet]:
    """The sheets of ``driving``, ``driven`` and ``pair``; raises the errors of the drive's solids."""
    radii = pitch_table(drive)
    sheets = {gear.gear.value: gear_sheet(drive, gear, radii) for gear in drive.measured}
    sheets["pair"] = pair_sheet(drive)
    return sheets


def drawing_files(sheets: Mapping[str, Sheet]) -> dict[str, bytes]:
    """``driving_drawing``, ``driven_drawing`` and ``pair_drawing`` of each kind by their names."""
    return {f"{name}_drawing.{kind}": write(sheet) for name, sheet in sheets.items() for kind, write in WRITERS.items()}
