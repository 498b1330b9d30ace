"""The lower part of a gear's sheet, below its views: data, pitch radii, measurements, and the enlarged bore."""

from __future__ import annotations

from collections.abc import Callable
from functools import partial
from math import radians

import numpy as np

from ncgear.figures.data_sheet.entries import SheetEntry, bodies, bore_text, tolerances
from ncgear.figures.data_sheet.measured_tables import allowed_texts, one_pin_table, span_table, two_pin_table
from ncgear.figures.data_sheet.sheet import rack_data, rows_found, rows_or_why, sizes
from ncgear.figures.numbers import drawn
from ncgear.figures.tables import Table, cell_text
from ncgear.files.workshop.drawing import Circle, Cross, bore_shape
from ncgear.files.workshop.sheets import sheet as paper
from ncgear.files.workshop.sheets.board import Board
from ncgear.files.workshop.sheets.body import PaperView, drawn_shape
from ncgear.files.workshop.sheets.frame import ROW_MM, Box, ColumnWidths, PaperTable, evenly, width_for
from ncgear.files.workshop.sheets.gear_view import point_at_circle
from ncgear.files.workshop.sheets.sheet import Item, Pen, Text
from ncgear.pitch.shape import Gear
from ncgear.project.drive import Drive
from ncgear.project.workshop_measures import GearMeasures
from ncgear.solids.plan.body import BodyPlan, Bore

DATA = ColumnWidths((44.0, 35.0), (False, False))
"""The columns of the gear's data."""
DETAIL_MM, GAP_MM = 42.0, 2.0
"""Height of the view of the bore, and the gap between tables."""

LEFT_OUT = {
    *("bore", "diameter of index hole", "tip relief", "fit of the bore", "fit of the index hole"),
    *("deviation of the centre distance", "sizes without a tolerance"),
}
"""Rows of the data sheet that the sheet has elsewhere or does not need."""

NOTHING = ("helix angle", 0.0)
"""A row that is left out: it tells nothing."""


def gear_tables(drive: Drive, measured: GearMeasures, plan: BodyPlan, pitch_radii: Table, box: Box) -> list[Item]:
    """The data of the gear, its pitch radii, its measurements, and its bore enlarged."""
    gear = measured.gear
    items: list[Item] = [*_data(drive, gear, box.height).drawn(box.left, box.high)]
    left = box.left + DATA.width_mm + GAP_MM
    pitch = _pitch(drive, gear, pitch_radii, box.height)
    items += pitch.drawn(left, box.high)
    left += pitch.columns.width_mm + GAP_MM
    low = box.low + (DETAIL_MM if plan.bore else 0.0)
    for table in _measurements(measured, box.right - left, box.high - low):
        items += table.drawn(left, box.high)
        box = Box(box.left, box.low, box.right, box.high - table.height_mm())
    if plan.bore:
        items += _bore_view(drive, plan.bore, Box(left, box.low, box.right, box.high))
    return items


def _data(drive: Drive, gear: Gear, height_mm: float) -> PaperTable:
    """The rows of the data sheet that belong to the gear, as many as there is room for."""
    groups = [rows_or_why(partial(rows, drive)) for rows in (sizes, rack_data, tolerances, bodies)]
    rows = [row for group in groups for entry in group if (row := _row(entry, gear))]
    if drive.helix is not None:
        rows.append(("measured in the section z", f"{drawn(drive.helix.rise_mm / 2.0, 'mm')} mm"))
    while len(rows) > 1:
        table = PaperTable("Gear data (all: data_sheet.md)", (), tuple(rows), DATA)
        if table.height_mm() <= height_mm:
            return table
        rows.pop()
    return PaperTable("Gear data: data_sheet.md", (), (), DATA)


def _row(entry: SheetEntry, gear: Gear) -> tuple[str, str] | None:
    """Label and value of an entry for the gear."""
    value = entry.pair if entry.of_pair else entry.driving if gear is Gear.DRIVING else entry.driven
    if value is None or entry.label in LEFT_OUT or (entry.label, value) == NOTHING:
        return None
    return entry.label, f"{cell_text(value, entry.unit)} {entry.unit}".strip()


def _pitch(drive: Drive, gear: Gear, pitch_radii: Table, height_mm: float) -> PaperTable:
    """Pitch radii against the angle turned, in steps of the data sheet's table."""
    rows, most = pitch_radii.rows, int(height_mm // ROW_MM) - 3
    if drive.pitch.toothed is None:
        chosen = rows[: -1 : _even_step(len(rows) - 1, most)]
    else:
        # Both ends of the range; the last step may be shorter.
        step = _even_step(len(rows) - 1, most - 1)
        chosen = (*rows[: len(rows) - 1 : step], rows[-1])
    driving, heads = gear is Gear.DRIVING, ("phi1, deg", "phi2, deg", "radius, mm")
    texts = [
        (cell_text(phi1, "deg"), cell_text(phi2, "deg"), cell_text(first if driving else second, "mm"))
        for phi1, phi2, _, first, second in chosen
    ]
    kept = (0, 2) if driving else (0, 1, 2)
    shown = [tuple(row[column] for column in kept) for row in (heads, *texts)]
    widths = tuple(max(width_for(row[column] for row in shown), 12.0) for column in range(len(kept)))
    columns = ColumnWidths(widths, (True,) * len(kept))
    return PaperTable("Pitch curve (pitch.csv)", shown[0], tuple(shown[1:]), columns)


def _even_step(count: int, most: int) -> int:
    """The step that leaves at most ``most`` of ``count`` rows; it divides ``count`` where half as many remain."""
    least = -(-count // most)
    return next((step for step in range(least, 2 * least + 1) if count % step == 0), least)


def _measurements(measured: GearMeasures, width_mm: float, height_mm: float) -> list[PaperTable]:
    """Some sizes over two pins or balls (over one where no two lie opposite each other), and some spans."""
    two, one = (rows_found(partial(_alone, of, measured)) for of in (two_pin_table, one_pin_table))
    spans = rows_found(partial(span_table, measured))
    found: list[tuple[str, str, list[tuple[str, ...]]]] = []
    if two or one:
        size = f"\u00d8{drawn(measured.pins.diameter_mm, 'mm')}"
        if measured.section_z_mm is not None:
            size += f", centres at z = {drawn(measured.section_z_mm, 'mm')}"
        over_two = f"{'Between' if measured.working.is_ring else 'Over'} two {measured.tool}s {size}"
        two_rows = [(f"{row[0]}, {row[1]}", *allowed_texts(row[2:])) for row in two]
        one_rows = [(f"{row[0]}", *allowed_texts(row[3:])) for row in one]
        of_one = f"Axis to {measured.tool} {size}", "space after tooth", one_rows
        found.append((over_two, "spaces after teeth", two_rows) if two else of_one)
    if spans:
        rows = [(f"{row[0]} to {row[1]}", *allowed_texts((row[4], *row[6:]))) for row in spans]
        found.append(("Span, back to front", "teeth", rows))
    lines, made = int(height_mm // ROW_MM), list[PaperTable]()
    for place, (title, head, rows) in enumerate(found):
        # The remaining tables share the lines; each has a title and heads.
        most = max(2, lines // (len(found) - place) - 2)
        heads = (head, "least, mm", "greatest, mm") if len(rows[0]) > 2 else (head, "mm")
        numbers = range(1, len(heads))
        widths = [max(width_for([heads[column], *(row[column] for row in rows)]), 14.0) for column in numbers]
        columns = ColumnWidths((width_mm - sum(widths), *widths), (False, *(True for _ in numbers)))
        made.append(PaperTable(title, heads, evenly(rows, most), columns))
        lines -= round(made[-1].height_mm() / ROW_MM)
    return made


def _alone(table: Callable[[GearMeasures], Table], measured: GearMeasures) -> tuple[Table, ...]:
    return (table(measured),)


AGAINST_KEYWAY_RAD = radians(80.0)
"""Direction of the text of a bore's diameter."""


def _bore_view(drive: Drive, bore: Bore, box: Box) -> list[Item]:
    """The bore with its keyway in a scale of its own, with its dimensions."""
    room = min(box.width - 30.0, box.height - 20.0)
    size = bore.diameter_mm / 2.0 + bore.reach_mm
    scale = next((scale for scale in paper.SCALES if scale * size <= room), paper.SCALES[-1])
    shift = scale * (bore.reach_mm - bore.diameter_mm / 2.0) / 2.0
    view = PaperView(
        scale, ((box.left + box.right) / 2.0 - 1.0 - shift, box.low + 9.0 + scale * bore.diameter_mm / 2.0 + 1.5)
    )
    board = Board((box.left, box.low, box.right, box.high))
    board.add(
        Text(f"Bore {paper.scale_text(scale)}", (box.left + 1.0, box.high - ROW_MM - 0.5), letter_mm=paper.LETTER_MM)
    )
    board.add(*drawn_shape(bore_shape(bore), view, Pen.VISIBLE))
    board.add(*drawn_shape(Cross(0.0, 0.0, 1.2 * bore.diameter_mm), view, Pen.CHAIN))
    radius = bore.diameter_mm / 2.0
    if bore.keyway:
        half, reach = bore.keyway.width_mm / 2.0, bore.reach_mm
        width = view.on_paper(np.array([[reach, -half], [reach, half]]))
        board.add(paper.length(width, -6.0, drawn(bore.keyway.width_mm, "mm"), scale))
        across = np.array([view.on_paper(np.array([-radius, 0.0])), view.on_paper(np.array([reach, -half]))])
        across[1, 1] = across[0, 1]
        apart = scale * radius + 5.0
        board.add(paper.length(across, -apart, drawn(radius + reach, "mm"), scale))
    words = f"\u00d8{drawn(bore.diameter_mm, 'mm')} {bore_text(drive, bore.diameter_mm)}"
    point_at_circle(board, view, [Circle(0.0, 0.0, radius)], words, AGAINST_KEYWAY_RAD)
    return board.items
