"""The sheet put together: general data, sizes, teeth, bodies, and the table of the pitch curves."""

from __future__ import annotations

from ncgear.drive import Drive
from ncgear.output.data_sheet.bodies import bodies
from ncgear.output.data_sheet.pitch_table import pitch_table
from ncgear.output.data_sheet.sizes import sizes
from ncgear.output.data_sheet.teeth import rack_data, tooth_data
from ncgear.output.data_sheet.values import DataSheet


def data_sheet(pair: Drive) -> DataSheet:
    """The sheet of one pair of gears; of a design in two stages, of one of ``by_stage``.

    Raises WrongInput or NoSuchMechanism as the drive's stages do up to the contact of the teeth.
    """
    name = pair.design.name if pair.stage is None else f"{pair.design.name}, stage {pair.stage}"
    groups = (sizes(pair), rack_data(pair), tooth_data(pair), bodies(pair))
    return DataSheet(name, groups, (pitch_table(pair),))
