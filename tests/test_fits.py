"""Widths of tolerance against the formulas that ISO 286 was made from, and what sheets say of fits."""

from __future__ import annotations

from math import sqrt

import pytest

from at_once import at_once
from drives import design_of, loaded
from ncgear.figures.data_sheet.entries import tolerances
from ncgear.project.drive import Drive
from ncgear.tolerances.iso286 import STANDARD_UM, UP_TO_MM, hole_text, standard_tolerance_mm

UNITS = {6: 10.0, 7: 16.0, 8: 25.0, 9: 40.0, 11: 100.0}
"""Tolerance units in each grade (ISO 286-1, annex: IT6 is 10 i, and each fifth grade is ten times as wide)."""


@at_once("grade", UNITS)
def test_widths_are_those_of_the_standards_formulas(grade: int) -> None:
    """i = 0.45 D^(1/3) + 0.001 D up to 500 mm, I = 0.004 D + 2.1 beyond, D the geometric mean of a range's ends."""
    for least, most, width in zip((1.0, *UP_TO_MM), UP_TO_MM, STANDARD_UM[grade], strict=False):
        mean = sqrt(least * most)
        unit = 0.45 * mean ** (1.0 / 3.0) + 0.001 * mean if most <= 500.0 else 0.004 * mean + 2.1
        # The standard rounds, most of all up to 3 mm; the next range is 20 % wider or more.
        assert width == pytest.approx(UNITS[grade] * unit, rel=0.16), (most, grade)


def test_a_size_at_the_end_of_a_range_belongs_to_it() -> None:
    assert (standard_tolerance_mm(7, 50.0), standard_tolerance_mm(7, 50.001)) == (0.025, 0.03)
    assert standard_tolerance_mm(7, 3150.1) is None
    assert hole_text("H8", 25.0) == "H8 (0 to +0.033)"
    assert hole_text("H8", 4000.0) == "H8"


def told(assembly: dict[str, float], **given: object) -> dict[str, object]:
    data = loaded("ellipse").data
    gears = {**data["gears"], "tolerances": given, "index_holes": True}
    one = Drive(design_of({**data, "gears": gears, **({"tolerances": assembly} if assembly else {})}))
    return {row.label: row.pair or (row.driving, row.driven) for row in tolerances(one)}


def test_what_the_file_leaves_out_has_its_default_and_what_it_gives_counts() -> None:
    usual = told({})
    # 74.6 mm apart: half of IT7 is 0.015 mm, and housings are usually 0.03 mm off, by which assemblies are judged
    assert usual["deviation of the centre distance"] == "\u00b10.03"
    assert usual["fit of the bore"] == ("H7 (0 to +0.015)", "H7 (0 to +0.015)")
    assert (usual["fit of the index hole"], usual["sizes without a tolerance"]) == ("H7", "ISO 2768-m")
    other = told(
        {}, center_distance_mm=0.04, bore_fit="H8", index_hole_fit="H11", general="c", flank_ra_um=0.8, ra_um=12.5
    )
    assert other["deviation of the centre distance"] == "\u00b10.04"
    assert other["fit of the bore"] == ("H8 (0 to +0.022)", "H8 (0 to +0.022)")
    assert (other["fit of the index hole"], other["sizes without a tolerance"]) == ("H11", "ISO 2768-c")
    assert other["roughness Ra, flanks; others"] == "0.8; 12.5"
    # What assemblies are drawn with is what the sheet says.
    assert told({"center_distance_mm": 0.025})["deviation of the centre distance"] == "\u00b10.025"
