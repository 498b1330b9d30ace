"""Numbers in all texts for people: no zero with a minus, no rounding errors, and no more digits than a drawing needs.

The texts are those of builds as they are written, read here as text: whatever a number was computed from, this is what
a person reads.  Tables for programs (CSV, summary.json) have all digits and are not among them.
"""

from __future__ import annotations

import html
import json
import re
from collections.abc import Callable
from pathlib import Path
from typing import Any

import numpy as np
import pytest

import ncgear
import reports
from at_once import at_once
from drives import drive
from ncgear.errors import Unanswered
from ncgear.figures.advice.verdict import KnownParts, judged
from ncgear.figures.assembly import assembly_of
from ncgear.figures.data_sheet.sheet import data_sheet, sheet_text
from ncgear.figures.numbers import SIZES, drawn, fixed, json_text, name_of, shown, to_digits, told
from ncgear.figures.summary.build_summary import build_summary
from ncgear.figures.terminal import figures_text
from ncgear.files.workshop.drawing import pair_drawings, written
from ncgear.files.workshop.dxf import dxf_files
from ncgear.files.workshop.svg import svg_files
from oracles import dxf

NUMBER = re.compile(r"(?<![\w.#])([-\u2212]?)(\d+)(?:\.(\d+))?(?:e([-+]\d+))?(?![\w.]*\d)")
"""Sign, digits before and behind the point, exponent; not the digits of a name, a version or a file."""

SMALLEST = -10
"""No figure of a machine is so small in any unit of the program, but for errors of the computation."""

ERRORS = ("residual", "energy error")
"""Lines that tell an error of the computation, which may be as small as rounding."""

SIGNIFICANT = 6
"""Digits in text: five, and six of a value that belongs into a design file."""


def noise(text: str) -> list[str]:
    """Numbers of a text that are a zero with a minus or a rounding error."""
    found = []
    for line in text.splitlines():
        honest = any(word in line for word in ERRORS)
        for number in NUMBER.finditer(line):
            sign, before, behind, exponent = number.groups()
            zero = not (before + (behind or "")).strip("0")
            if (sign and zero) or (exponent and int(exponent) <= SMALLEST and not honest):
                found.append(number[0])
    return found


def longest(text: str) -> int:
    """Most significant digits of a number with a decimal point."""
    numbers = (before + behind for _, before, behind, _ in map(re.Match.groups, NUMBER.finditer(text)) if behind)
    return max((len(digits.lstrip("0")) for digits in numbers), default=0)


def decimals(text: str) -> int:
    """Most decimals of a number."""
    return max((len(number[3] or "") for number in NUMBER.finditer(text)), default=0)


def rows_in(unit: str, sheet: str) -> str:
    """The cells of a data sheet whose row or column is in a unit."""
    cells, heads, lines = [], [], sheet.splitlines()
    for line, after in zip(lines, [*lines[1:], ""], strict=True):
        row = [cell.strip() for cell in line.strip("|").split("|")]
        if len(row) < 2 or set(line) <= set("| -"):
            continue
        if after.startswith("|") and set(after) <= set("| -"):
            heads = row
        elif heads[-1] == "unit":
            cells += row[1:-1] if row[-1] == unit else []
        else:
            cells += [cell for cell, head in zip(row, heads, strict=True) if head.endswith(f" in {unit}")]
    return "\n".join(cells)


NAMES = ["baler", "internal-1-2"]
"""Index holes, keyways and a law solved for; a ring with lobes, whose phi2 begins at a rounding error below zero."""

NOT_IN_SUMMARY = ("face_width_mm", "play_greatest_rad", "thickness_deviation_mm")
"""Sizes that a summary does not tell, or only where teeth have a band of thickness."""

both = pytest.mark.parametrize("name", NAMES)


@pytest.mark.slow
@both
def test_the_terminal_has_no_rounding_errors(name: str) -> None:
    """Sizes of gears have the decimals of a drawing, all other figures five digits."""
    text = figures_text(build_summary(drive(name), reports.contacts(name)[0], judged(drive(name), KnownParts.TEETH)))
    assert noise(text) == []
    lines = text.splitlines()
    sizes = [line for line in lines if line.startswith(tuple(f"  {name_of(key)}  " for key in SIZES))]
    assert len(sizes) == len(SIZES) - len(NOT_IN_SUMMARY)
    assert all(decimals(line) <= 5 for line in sizes)
    assert longest("\n".join(line for line in lines if line not in sizes)) <= SIGNIFICANT
    assert re.search(r"\d rad\b", text) is None, "places are in deg; errors and play in millionths"
    assert "\u00b5rad" in text


@pytest.mark.slow
@both
def test_a_data_sheet_has_the_decimals_of_a_drawing(name: str) -> None:
    text = sheet_text(data_sheet(drive(name)))
    assert noise(text) == []
    # Lengths of less than a tenth of a millimetre have four digits
    assert 4 <= decimals(rows_in("mm", text)) <= 5
    assert decimals(rows_in("deg", text)) == decimals(text) == 5


@pytest.mark.slow
@both
def test_the_report_says_the_same(name: str) -> None:
    page = reports.page(name)
    for part in ("script", "style", "svg", "pre"):
        page = re.sub(rf"<{part}\b.*?</{part}>", "", page, flags=re.DOTALL)
    text = html.unescape(re.sub(r"<[^>]*>", "\n", page.split('<section id="made">')[0]))
    assert len(text) > 5000
    assert noise(text) == []
    sizes = [number[0] for number in NUMBER.finditer(text) if decimals(number[0]) <= 5]
    assert len(sizes) > 500
    assert all(longest(number[0]) <= SIGNIFICANT for number in NUMBER.finditer(text) if number[0] not in sizes)


def deepest(content: Any, ending: str, key: str = "") -> int:
    """Most decimals of the numbers whose keys have an ending."""
    if isinstance(content, dict):
        return max((deepest(value, ending, name) for name, value in content.items()), default=0)
    return decimals(repr(content)) if key.endswith(ending) else 0


@pytest.mark.slow
@both
def test_the_assembly_has_eight_digits_of_its_largest_length(name: str) -> None:
    text = json_text(assembly_of(drive(name)))
    assert noise(text) == []
    assert deepest(json.loads(text), "_mm") <= 6
    assert deepest(json.loads(text), "_rad") <= 7


DXF_COORDINATES = {*range(10, 40), 40}
DXF_BULGE = 42


@pytest.mark.slow
@both
def test_drawings_have_coordinates_without_rounding_errors(name: str) -> None:
    for data in dxf_files(pair_drawings(drive(name))).values():
        for entity in dxf.entities(data.decode()):
            for code, value in entity.codes:
                if code in DXF_COORDINATES or code == DXF_BULGE:
                    assert noise(value) == []
                    assert decimals(value) <= (9 if code == DXF_BULGE else 6), value
    for data in svg_files(pair_drawings(drive(name))).values():
        numbers = "\n".join(re.findall(r'(?: d|viewBox|width|height)="([^"]*)"', data.decode()))
        spaced = re.sub(r"[MLAZ,]", " ", numbers)
        assert noise(spaced) == []
        assert decimals(spaced) <= 6


FIGURES = Path(ncgear.__file__).parent / "figures"
ROUNDED = re.compile(r"\{[^{}]*:,?\.\d[efg]\}")


def test_no_text_rounds_a_figure_past_the_check_that_it_is_finite() -> None:
    """All of ``figures`` rounds by the functions of numbers.py, which raise for what is no number."""
    found = {path.name: ROUNDED.findall(path.read_text(encoding="utf-8")) for path in FIGURES.rglob("*.py")}
    assert found.pop("numbers.py")
    assert [text for texts in found.values() for text in texts if not text.startswith("{finite(")] == []
    assert len(ROUNDED.findall('f"{100.0 * share:.1f} % and {force[0]:,.5g} N"')) == 2


@at_once("wrong", [float("nan"), float("-inf"), np.float64("inf")])
@at_once(
    "way",
    [
        lambda value: fixed(value, 2),
        lambda value: to_digits(value, 3),
        lambda value: drawn(value, "mm"),
        lambda value: told("peak_power_w", value),
        lambda value: told("residual_rad", value),
        lambda value: told("concave_driven_rad", [[0.0, value]]),
        lambda value: written(np.array([1.0, value]), 6),
    ],
)
def test_no_way_of_rounding_tells_what_is_no_number(way: Callable[[float], object], wrong: float) -> None:
    assert way(1.25) is not None
    with pytest.raises(Unanswered):
        way(wrong)


def test_what_these_tests_look_for_is_seen() -> None:
    """Each fault that a text has had; and an error of the computation is none."""
    texts = "x -0.0000 mm", "centre 29.033, -0.000", "at \u22120 deg", "least 7.1206e-14 deg", "3.6e-15", "-0"
    assert [len(noise(text)) for text in texts] == [1] * len(texts)
    assert noise("residual  1.7764e-15 rad\nat phi1 = 0 deg, 1.5e-6 mm, baler-0, -0.5, 1e-09") == []
    assert longest("center distance 74.88525 mm") > SIGNIFICANT
    sheet = "| | one | other | unit |\n| - | - | - | - |\n| bore | 16.12345 | 3 | mm |\n| at | 7.5 | | deg |"
    table = "| phi1 in deg | span in mm |\n| --- | --- |\n| 1.25 | 22.973171 |"
    assert (decimals(rows_in("mm", sheet)), decimals(rows_in("deg", sheet))) == (5, 1)
    assert (decimals(rows_in("mm", table)), decimals(rows_in("deg", table))) == (6, 2)
    assert deepest({"a": {"x_mm": 1.23456, "angle_rad": 0.1}}, "_mm") == 5


def test_errors_of_a_computation_keep_their_digits_and_other_rounding_errors_are_zero() -> None:
    assert told("residual_rad", 1.7764e-15) == ("residual", "1.7764e-09", "\u00b5rad")
    assert told("stroke_residual_mm", -2.2737e-13) == ("stroke residual", "-2.2737e-13", "mm")
    assert told("transmission_error_rad", 5.8992e-4) == ("transmission error", "589.92", "\u00b5rad")
    assert told("transmission_error_rad", 2.1e-14) == ("transmission error", "0", "\u00b5rad")
    assert told("concave_driven_rad", [[0.0, 0.5]]) == ("concave driven", "0..28.648", "deg")
    assert told("inertia_for_speed_fluctuation_kg_m2", 3.25e-9)[1:] == ("3.25e-09", "kg m2")
    assert told("pressure_angle_min_deg", -7.1206e-14)[1:] == ("0", "deg")
    assert told("penetration_tooth_driving", None)[1:] == ("-", "")
    assert shown([1.0, -1e-17, [2.5, -1e-12]]) == "1, 0, 2.5..0"
