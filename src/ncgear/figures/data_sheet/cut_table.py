"""The table of a data sheet that says which tools cut a gear."""

from __future__ import annotations

from math import floor

from ncgear.figures.numbers import drawn
from ncgear.figures.tables import Column, Table
from ncgear.metrology.cut_by import CutBy
from ncgear.project.workshop_measures import CutGear

COLUMNS = (Column("tool"), Column("result"), Column("because"))


def cut_table(gear: CutGear) -> Table:
    """Tools with their sizes, what each makes of a gear, and why."""
    largest = gear.round_tool
    note = (
        f"least concave radius of the outline {drawn(largest.hollow_mm, 'mm')} mm, in the space after tooth "
        f"{largest.hollow_space}; a round tool as stated leaves {largest.left_mm:g} mm at most; of a wire the "
        "diameter counts with its spark gap"
    )
    rows = tuple((_named(one), one.verdict.value, one.reason) for one in gear.by)
    return Table(f"The {gear.gear.value} gear is cut by", COLUMNS, rows, (note,))


def _named(one: CutBy) -> str:
    """The tool with its size; diameters are rounded down, so that the stated one fits."""
    if one.teeth is not None:
        return f"{one.tool.value} of {one.teeth} teeth"
    if one.diameter_mm is not None:
        return f"{one.tool.value} of {floor(one.diameter_mm * 1000.0) / 1000.0:g} mm or less"
    return one.tool.value
