"""The sheet of one gear: its views with numbered teeth above, its tables and its bore below them."""

from __future__ import annotations

from ncgear.figures.data_sheet.accuracy import general_text
from ncgear.figures.tables import Table
from ncgear.files.workshop.sheets.body import (
    finished,
)
from ncgear.files.workshop.sheets.frame import (
    TITLE_HEIGHT_MM,
    Box,
    Titles,
    framed,
    inside,
)
from ncgear.files.workshop.sheets.gear_tables import gear_tables
from ncgear.files.workshop.sheets.gear_view import gear_views
from ncgear.files.workshop.sheets.sheet import (
    A4_MM,
    Sheet,
)
from ncgear.pitch.shape import Gear
from ncgear.project.drive import Drive
from ncgear.project.measured import MeasuredGear

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


def title_of(drive: Drive) -> str:
    """The name of the design, with the number of the pair where there are two."""
    return drive.design.name if drive.stage is None else f"{drive.design.name}, stage {drive.stage}"


def material_of(drive: Drive, gear: Gear) -> str:
    """The name of a gear's material; or that the design names none."""
    if drive.gears.material is None:
        return "not given"
    driving, driven = drive.gears.material.each
    return (driving if gear is Gear.DRIVING else driven).name
