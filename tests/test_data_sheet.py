"""The data sheet: its values against the design and each other, its tables, its text."""

from __future__ import annotations

import re
from functools import cache
from math import cos, radians
from typing import Any

import numpy as np
import pytest
import trimesh
from pydantic import ValidationError
from shapely import Point, Polygon

from at_once import at_once
from drives import built, design_of, drive, loaded
from ncgear.drawings.charts.chart import joints_up_to
from ncgear.drawings.page.tables import sheet_tables
from ncgear.errors import NoSuchMechanism, WrongInput
from ncgear.figures.data_sheet import sheet as sheet_module
from ncgear.figures.data_sheet.entries import SheetEntry
from ncgear.figures.data_sheet.measured_tables import pitch_csv, turn_deg
from ncgear.figures.data_sheet.sheet import DataSheet, data_sheet, sheet_text
from ncgear.figures.tables import Table
from ncgear.project import workshop_measures
from ncgear.project.drive import Drive
from ncgear.project.workshop_measures import GearMeasures

LIMITS = {"standard": "ISO 1328-1", "tooth_thickness_upper_mm": -0.05, "tooth_thickness_lower_mm": -0.1}


def changed(name: str, **gears: Any) -> Drive:
    """A design with other keys of its gears."""
    data = loaded(name).data
    return Drive(design_of({**data, "gears": {**data["gears"], **gears}}))


@cache
def sheet(name: str) -> DataSheet:
    return data_sheet(drive(name).by_stage[0])


@cache
def toleranced() -> DataSheet:
    return data_sheet(changed("ellipse", tolerances=LIMITS))


def row(found: DataSheet, label: str) -> SheetEntry:
    return next(row for group in found.groups for row in group.entries if row.label == label)


def table(found: DataSheet, title: str) -> Table:
    return next(table for table in found.tables if table.title.startswith(title))


NAMES = ["ellipse", "internal-1-2", "helical-ellipse", "baler-66-two-stage", "uniform-crank"]


def test_flanks_at_the_limits_of_thickness_are_measured_once(monkeypatch: pytest.MonkeyPatch) -> None:
    """The sheet asks for them for pins over one gear and between two spaces."""
    asked: list[float] = []
    measure = workshop_measures.pins_in_spaces
    monkeypatch.setattr(workshop_measures, "pins_in_spaces", lambda *of: (asked.append(of[1]), measure(*of))[1])
    gear, _ = workshop_measures.measured_gears(changed("ellipse", tolerances=LIMITS, measuring_pin_mm=3.5))
    assert gear.at_limits is gear.at_limits
    assert asked == [3.5] * 3


@pytest.mark.slow
@pytest.mark.parametrize("name", NAMES)
def test_rows_fit_their_headings_and_every_number_is_finite(name: str) -> None:
    found = sheet(name)
    assert {table.title for table in found.tables} >= {"Pitch curves"}
    for one in found.tables:
        assert {len(cells) for cells in one.rows} == {len(one.columns)}
        numbers = [cell for cells in one.rows for cell in cells if isinstance(cell, float)]
        assert np.isfinite(numbers).all()


@pytest.mark.tiers(slow=["ellipse", "helical-ellipse", "uniform-crank"], rest="long")
@pytest.mark.parametrize("name", NAMES)
def test_the_pitch_table_has_a_row_for_each_tooth_and_radii_that_meet(name: str) -> None:
    found = sheet(name)
    rows = np.array(table(found, "Pitch curves").rows)
    told = str(row(found, "centre distance").pair)
    sense = -1.0 if "internal" in str(row(found, "kind of gear").driven) else 1.0
    distance = sense * rows[:, 3] + rows[:, 4]
    np.testing.assert_allclose(distance, distance[0], rtol=1e-12)
    assert float(told) == pytest.approx(distance[0], abs=0.51 * 10.0 ** -len(told.partition(".")[2]))
    np.testing.assert_allclose(rows[:, 4] / rows[:, 3], rows[:, 2], rtol=1e-12)
    assert len(rows) > int(str(row(found, "number of teeth").driving))
    assert rows[-1, 0] == 360.0
    assert abs(rows[0, 1]) < 1e-12


@at_once(("teeth", "rows"), [(37, 73), (73, 91), (100, 121), (10_000, 10_001)])
def test_the_step_of_the_pitch_table_follows_the_teeth(teeth: int, rows: int) -> None:
    assert turn_deg(teeth).size == rows


@pytest.mark.slow
def test_pitch_radii_are_within_their_range() -> None:
    found = sheet("ellipse")
    radii = np.array(table(found, "Pitch curves").rows)[:, 3]
    least, greatest = row(found, "pitch radius").driving
    assert least == pytest.approx(radii.min(), rel=1e-3)
    assert greatest == pytest.approx(radii.max(), rel=1e-3)
    assert least <= radii.min()
    assert greatest >= radii.max()


def test_the_interpolation_of_the_pitch_table_is_as_good_as_it_says() -> None:
    pair = drive("ellipse")
    found = table(sheet("ellipse"), "Pitch curves")
    rows = np.array(found.rows)
    assert joints_up_to(pair.transmission, 6.0).size == 0
    phi1 = np.linspace(0.0, 360.0, 3601)
    off = np.interp(phi1, rows[:, 0], rows[:, 1]) - np.degrees(pair.transmission.driven_angle(np.radians(phi1)).value)
    said = float(found.notes[0].split(" deg of phi2")[0].split()[-1])
    assert np.abs(off).max() == pytest.approx(said, rel=0.05)


@pytest.mark.slow
def test_the_sheet_says_what_the_design_gives() -> None:
    found = data_sheet(changed("ellipse", rack={"tip_relief": {"amount": 0.02}, "addendum": 0.9}))
    assert row(found, "basic rack of ISO 53").pair == "profile A, coefficients as below"
    assert row(found, "addendum, dedendum, root radius").pair == "0.9, 1.25, 0.38"
    assert row(found, "tip relief at 0.9 modules").pair == pytest.approx(0.04)
    assert row(found, "bore").driving == 10
    assert row(found, "least normal backlash").pair == "0.06"


@pytest.mark.slow
def test_a_ring_has_pins_and_says_that_it_has_no_span() -> None:
    found = sheet("internal-1-2")
    assert "not defined" in str(row(found, "places of a span").driven)
    assert "near side" in table(found, "Pins of 4.25 mm in the driven").columns[-1].label
    assert "between two pins" in table(found, "Measurement between").columns[-1].label


@pytest.mark.slow
def test_flanks_of_equivalent_gears_have_pins_and_no_span() -> None:
    found = data_sheet(changed("ellipse", method="equivalent_gear", least_contact_ratio=0.0))
    assert "equivalent" in str(row(found, "places of a span").driving)
    assert row(found, "spaces in which they measure").driving == "all"


@pytest.mark.slow
def test_helical_gears_are_measured_with_balls_half_way_up() -> None:
    found = sheet("helical-ellipse")
    assert row(found, "section that is measured, z").pair == 5.0
    assert row(found, "diameter of measuring balls").driving == 2.75
    for title in ("Balls of 2.75 mm in the driving", "Measurement over two balls of 2.75 mm, driving"):
        assert not any("pin" in column.label for column in table(found, title).columns)


@pytest.mark.slow
def test_limits_of_the_tooth_thickness_are_limits_of_spans_and_pins() -> None:
    span = np.array([cells[4:5] + cells[6:] for cells in table(toleranced(), "Span of the driving").rows], dtype=float)
    # The gears of the sheet stand in the middle.
    half = 0.025 * cos(radians(20.0))
    np.testing.assert_allclose(span[:, 1:] - span[:, :1], [[-half, half]] * 4, rtol=1e-9)
    nominal = np.array([cells[4] for cells in table(sheet("ellipse"), "Span of the driving").rows], dtype=float)
    np.testing.assert_allclose(span[:, 0] - nominal, -3.0 * half, rtol=1e-9)
    for title in ("Pins of 4 mm in the driven", "Measurement over two pins"):
        rows = np.array([cells[-3:] for cells in table(toleranced(), title).rows], dtype=float)
        np.testing.assert_allclose(rows[:, 1:].mean(axis=1), rows[:, 0], atol=2e-4)
        assert np.all(rows[:, 1] < rows[:, 2])
    assert row(toleranced(), "standard").pair == "ISO 1328-1"


@pytest.mark.slow
def test_a_given_pin_is_taken_and_spaces_where_it_measures_nothing_are_named() -> None:
    found = data_sheet(changed("ellipse", measuring_pin_mm=3.25))
    assert row(found, "diameter of measuring pins").driving == 3.25
    notes = table(found, "Pins of 3.25 mm in the driving").notes
    assert any(note.startswith("not defined in the spaces after teeth") for note in notes)


@pytest.mark.slow
def test_a_pin_that_measures_in_no_space_is_refused_with_those_that_do() -> None:
    with pytest.raises(WrongInput, match=r"pins of 20 mm measure in no space .*; (\S+) to (\S+) mm do") as told:
        _ = changed("ellipse", measuring_pin_mm=20.0).measured
    assert told.value.key == "gears.measuring_pin_mm"
    least, largest = (float(word) for word in re.findall(r"(\S+) to (\S+) mm do", told.value.problem)[0])
    for size in (least, largest):
        assert all(gear.pins.space.size for gear in changed("ellipse", measuring_pin_mm=size).measured)


@pytest.mark.parametrize(
    ("given", "key"),
    [
        ({"tooth_thickness_upper_mm": -0.1}, "tooth_thickness_upper_mm"),
        ({"tooth_thickness_upper_mm": -0.1, "tooth_thickness_lower_mm": -0.05}, "tooth_thickness_lower_mm"),
    ],
)
def test_limits_of_the_tooth_thickness_that_are_no_range_are_refused(given: dict[str, float], key: str) -> None:
    with pytest.raises(ValidationError) as refused:
        changed("ellipse", tolerances=given)
    assert refused.value.errors()[0]["ctx"]["key"] == key


@pytest.mark.slow
def test_the_text_has_every_group_and_table() -> None:
    found = toleranced()
    text = sheet_text(found)
    for title in [*(group.title for group in found.groups), *(table.title for table in found.tables)]:
        assert f"\n## {title}\n" in text
    assert "| module | 2 |  | mm |" in text
    assert "None" not in text


@pytest.mark.slow
def test_the_report_shows_measurements_to_a_tenth_of_a_micrometre() -> None:
    shown = next(table for table in sheet_tables(toleranced()) if table.title.startswith("Span of the driving"))
    nominal = [cells[4] for cells in table(toleranced(), "Span of the driving").rows]
    assert [float(row.cells[4]) for row in shown.html_rows] == pytest.approx(nominal, abs=1e-4)


def test_the_pitch_file_is_the_law() -> None:
    pair = drive("ellipse")
    rows = np.array([line.split(",") for line in pitch_csv(pair.pitch).splitlines()[1:]], dtype=float)
    assert rows.shape == (721, 5)
    expected = np.degrees(pair.transmission.driven_angle(np.radians(rows[:, 0])).value)
    np.testing.assert_allclose(rows[:, 1], expected, atol=1e-12)


HOSTILE = "</script><b>x'); DROP\nsecond line | third cell `code` *bold* \\| end"


@pytest.mark.slow
def test_text_of_the_design_stays_within_its_cell() -> None:
    """A table's row is one line of as many cells as its heading, whatever the note says."""
    text = sheet_text(data_sheet(changed("ellipse", tolerances={"note": HOSTILE})))
    line = next(line for line in text.splitlines() if line.startswith("| note |"))
    cells = re.split(r"(?<!\\)(?:\\\\)*\|", line)[1:-1]
    assert len(cells) == 4
    assert "end" in cells[1]
    assert not re.search(r"(?<!\\)[<*`]", cells[1])


FIGURES = [
    ("spans", "places of a span", "Span of the driven gear"),
    ("pins", "spaces in which they measure", "Pins in the driving gear"),
]


@pytest.mark.thorough
@pytest.mark.parametrize(("figure", "label", "title"), FIGURES)
def test_a_figure_that_cannot_be_computed_says_why_and_ends_nothing(
    figure: str, label: str, title: str, monkeypatch: pytest.MonkeyPatch
) -> None:
    def failing(gear: GearMeasures) -> None:
        raise ArithmeticError(f"no zero for the {gear.gear.value} gear | in 3 steps")

    monkeypatch.setattr(GearMeasures, figure, property(failing))
    found = data_sheet(drive("ellipse"))
    assert row(found, label).driven == "could not be computed: no zero for the driven gear | in 3 steps"
    assert table(found, title).notes[0].startswith("could not be computed: no zero")
    assert row(found, "module").pair == "2"
    assert f"## {title}\n\nCould not be computed: no zero" in sheet_text(found)
    assert [one.title for one in sheet_tables(found)][-1].startswith("Pins in" if figure == "pins" else "Measurement")


def test_a_section_that_cannot_be_measured_leaves_all_other_figures(monkeypatch: pytest.MonkeyPatch) -> None:
    def failing(*given: object) -> None:
        raise NoSuchMechanism("tooth 3 of the driven gear is too thin", key="gears.teeth")

    monkeypatch.setattr(Drive, "measured", property(failing))
    monkeypatch.setattr(sheet_module, "pitch_table", failing)
    monkeypatch.setattr(sheet_module, "cut_gears", failing)
    found = data_sheet(drive("ellipse"))
    assert (
        row(found, "these figures").pair == "could not be computed: gears.teeth: tooth 3 of the driven gear is too thin"
    )
    assert [one.rows for one in found.tables] == [()] * 6
    assert row(found, "pitch radius").driving[1] == pytest.approx(sheet_radius("ellipse"))


def sheet_radius(name: str) -> float:
    """Largest pitch radius of the driving gear, by the law's ratio: r1 = a / (i + 1)."""
    pair = drive(name)
    return pair.pitch.center_distance_mm / (1.0 + pair.transmission.ratio_range[0].value)


@pytest.mark.slow
def test_round_holes_are_told_as_they_are_made() -> None:
    """Diameters and places of the sheet are those of the circles in the solids' plan, whatever the keys say."""
    found, solids = sheet("printed-pump"), drive("printed-pump").solids
    count, size = str(row(found, "lightening holes, number x diameter").driven).split(" x ")
    section = solids.driven.plan.section
    areas = sorted(Polygon(ring).area for ring in section.interiors)
    assert int(count) == 5
    assert np.sqrt(4.0 * areas[-2] / np.pi) == pytest.approx(float(size), rel=2e-3)  # the largest is the bore
    assert row(found, "diameter of index hole").driving == solids.driving.index_hole.diameter_mm
    x, y = map(float, str(row(found, "index hole, x and y").driven).split(", "))
    assert not section.contains(Point(x, y))
    assert section.distance(Point(x, y)) == pytest.approx(
        float(row(found, "diameter of index hole").driven) / 2, rel=0.02
    )


# --- tips and roots against the written solid ------------------------------------------------------------------------


def read_radii_mm(name: str, gear: str, module_mm: float) -> tuple[np.ndarray, np.ndarray]:
    """Distances from the axis of all tips and of all roots, by trimesh, half way up the written solid."""
    # It loads all of scipy's statistics, for this slow test alone.
    from scipy.signal import find_peaks

    solid = trimesh.load(built(name).folder / f"{gear}.stl")
    section = solid.section(plane_origin=[0.0, 0.0, solid.bounds[:, 2].mean()], plane_normal=[0.0, 0.0, 1.0])
    outline = max((np.asarray(ring)[:-1, :2] for ring in section.discrete), key=lambda ring: np.ptp(ring, axis=0).sum())
    radii = np.hypot(*outline.T)
    around = np.tile(np.roll(radii, -int(np.argmin(radii))), 3)
    found = []
    for side in (around, -around):
        at, _ = find_peaks(side, prominence=module_mm)
        found.append(around[at[(at >= radii.size) & (at < 2 * radii.size)]])
    return found[0], found[1]


@pytest.mark.tiers(slow=["pump-1-2-driving"], rest="long")
@pytest.mark.parametrize("gear", ["driving", "driven"])
@pytest.mark.parametrize("name", ["ellipse", "pump-1-2"])
def test_tips_and_roots_are_those_of_the_written_solid(name: str, gear: str) -> None:
    """The sheet's are the farthest places of teeth and the nearest of spaces; a chord strays by a twelfth of this."""
    found = sheet(name)
    module = float(str(row(found, "module").pair))
    tips, roots = read_radii_mm(name, gear, module)
    teeth = int(getattr(row(found, "number of teeth"), gear))
    assert (tips.size, roots.size) == (teeth, teeth)
    ends = (tips.min(), tips.max(), roots.min(), roots.max())
    said = [end for label in ("radius of tips", "radius of roots") for end in getattr(row(found, label), gear)]
    assert said == pytest.approx(ends, abs=drive(name).chord_tolerance_mm)
    assert max(said) == pytest.approx(tips.max(), abs=1e-5)
    # The negative control: neither the other end nor tips for roots would do.
    assert said != pytest.approx(ends[::-1], abs=module)
