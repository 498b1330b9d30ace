"""The sheet put together: general data, sizes, teeth, bodies, and the table of the pitch curves."""

from __future__ import annotations

from ncgear.drive import Drive
from ncgear.output.data_sheet.bodies import bodies
from ncgear.output.data_sheet.measured import measured_gears
from ncgear.output.data_sheet.pin_tables import pin_tables
from ncgear.output.data_sheet.pitch_table import pitch_table
from ncgear.output.data_sheet.sizes import sizes
from ncgear.output.data_sheet.span_table import span_table, spans_of
from ncgear.output.data_sheet.teeth import rack_data, tooth_data
from ncgear.output.data_sheet.tolerances import measurements, tolerances
from ncgear.output.data_sheet.values import DataSheet


def data_sheet(pair: Drive) -> DataSheet:
    """The sheet of one pair of gears; of a design in two stages, of one of ``by_stage``.

    Raises WrongInput or NoSuchMechanism as the drive's stages do up to the contact of the teeth.
    """
    name = pair.design.name if pair.stage is None else f"{pair.design.name}, stage {pair.stage}"
    gears = measured_gears(pair)
    found = spans_of(gears[0]), spans_of(gears[1])
    groups = (sizes(pair), rack_data(pair), tooth_data(pair), bodies(pair), *tolerances(pair))
    measured = [(*span_table(gear, of), *pin_tables(gear)) for gear, of in zip(gears, found, strict=True)]
    tables = [table for of_gear in measured for table in of_gear]
    filled = tuple(group for group in (*groups, measurements(pair, gears, found)) if group.rows)
    return DataSheet(name, filled, (pitch_table(pair), *tables))
