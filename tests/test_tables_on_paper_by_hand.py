"""Numbers of teeth, pins and tables on paper, on plain values: places by plane geometry, rows by counting."""

from __future__ import annotations

from math import cos, pi, sin
from types import SimpleNamespace
from typing import Any

import numpy as np
import pytest
import shapely

import ncgear.files.workshop.sheets.gear_view as gear_view
from at_once import at_once
from ncgear.figures.tables import Table
from ncgear.files.workshop.drawing import Polyline
from ncgear.files.workshop.sheets import body, gear_tables
from ncgear.files.workshop.sheets.board import Board
from ncgear.files.workshop.sheets.body import PaperView
from ncgear.files.workshop.sheets.frame import ROW_MM, Box, ColumnWidths, PaperTable, Titles, framed
from ncgear.files.workshop.sheets.sheet import Pen, SheetLine, Text, text_width_mm
from ncgear.files.workshop.svg import _steps
from ncgear.pitch.shape import Gear

Made: Any = SimpleNamespace

WIDE = 0.0, 0.0, 400.0, 300.0


# --- numbers of teeth


def numbered(scale: float, patch: pytest.MonkeyPatch, *, fifths: bool, hole_mm: float = 0.0) -> dict[str, complex]:
    """Middles of the numbers of 20 teeth about a circle of 30 mm, as complex numbers about the axis in mm of paper."""
    turned = 2.0 * pi * np.arange(20) / 20.0
    around = np.column_stack([np.cos(turned), np.sin(turned)])
    patch.setattr(body, "tooth_places", lambda gear, height: (30.0 + height) * around)
    rack = Made(addendum_mm=3.0, dedendum_mm=4.0)
    gear: Any = Made(flanks=Made(rack=rack, curve=Made(length_mm=60.0 * pi), count=40))
    board = Board(WIDE)
    if hole_mm:
        fine = np.linspace(0.0, 2.0 * pi, 400)
        board.keep_clear([SheetLine(scale * hole_mm * np.column_stack([np.cos(fine), np.sin(fine)]) + [200.0, 150.0])])
    gear_view.number_teeth(board, gear, PaperView(scale, (200.0, 150.0)), "tooth", fifths=fifths)
    texts = [item for item in board.items if isinstance(item, Text)]
    assert [text.name for text in texts] == [f"tooth-{text.words}" for text in texts]
    middles = [np.mean(text.corners[[0, 2]], axis=0) for text in texts]
    # The box of a text includes what letters have below their line, 0.3 of 2.5 mm.
    return {text.words: complex(x - 200.0, y - 150.0 + 0.375) for text, (x, y) in zip(texts, middles, strict=True)}


@pytest.mark.judges("files")
def test_numbers_stand_inside_the_roots_of_their_teeth(monkeypatch: pytest.MonkeyPatch) -> None:
    """At true size 4 mm below the pitch circle, half a letter and 0.6 mm, in the middle of each tooth."""
    found = numbered(1.0, monkeypatch, fifths=False)
    assert list(found) == [str(number) for number in range(1, 21)]
    for number, place in found.items():
        middle = (30.0 - 4.0 - 1.25 - 0.6) * np.exp(2j * pi * (int(number) - 1) / 20.0)
        assert abs(place - middle) < 0.81
        assert abs(np.angle(place / middle)) < 1e-9
    assert abs(found["1"]) == pytest.approx(24.15)
    assert list(numbered(1.0, monkeypatch, fifths=True)) == ["1", "5", "10", "15", "20"]
    assert list(numbered(0.5, monkeypatch, fifths=False)) == ["1", "5", "10", "15", "20"]
    assert len(numbered(0.55, monkeypatch, fifths=False)) == 20


@pytest.mark.judges("files")
def test_numbers_stand_outside_where_the_body_has_a_hole(monkeypatch: pytest.MonkeyPatch) -> None:
    """A hole of 27 mm leaves no room within: the first numbers stand 4 mm and half a letter outside."""
    found = numbered(1.0, monkeypatch, fifths=True, hole_mm=27.0)
    for number, place in found.items():
        assert abs(place) >= 35.25 - 1e-9
        assert abs(np.angle(place / np.exp(2j * pi * (int(number) - 1) / 20.0))) < 1e-9
    assert abs(found["1"]) == pytest.approx(35.25)


@pytest.mark.judges("files")
@pytest.mark.parametrize("ring", [False, True])
def test_pins_are_drawn_with_what_is_measured_over_or_between_them(ring: bool, monkeypatch: pytest.MonkeyPatch) -> None:
    """Two pairs of pins of 5 mm at half size: the more upright pair is tried first, beside the gear or on its line."""
    centers = np.array([[30.0, 0.0], [3.0, -29.0], [-30.0, 4.0], [-1.0, 31.0]])
    rows = ((1, 3, 65.0), (4, 2, 65.2))
    monkeypatch.setattr(gear_view, "two_pin_table", lambda measured: Table("", (), rows))
    asked: list[Any] = []
    monkeypatch.setattr(Board, "put_dimension", lambda self, some: asked.extend(some))
    around = np.exp(2j * pi * np.arange(90) / 90.0)
    toothed = Made(outline_mm=33.0 * np.column_stack([around.real, around.imag]))
    pins = Made(diameter_mm=5.0, space=np.array([1, 2, 3, 4]), center_mm=centers)
    measured: Any = Made(pins=pins, working=Made(is_ring=ring), toothed=toothed)
    gear_view._draw_pins(Board(WIDE), measured, PaperView(0.5, (100.0, 80.0)))
    one, first, second = asked[0]
    low, high = centers[1], centers[3]
    apart = float(np.hypot(*(high - low)))
    way = (high - low) / apart
    assert one.value_mm == pytest.approx(apart - 5.0 if ring else apart + 5.0)
    assert "(4, 2)" in one.text.words
    assert ("between" if ring else "over") in one.text.words
    assert (first.center, second.center) == (
        pytest.approx(tuple([100.0, 80.0] + 0.5 * low)),
        pytest.approx(tuple([100.0, 80.0] + 0.5 * high)),
    )
    assert (first.radius, first.pen) == (1.25, Pen.THIN)
    left = np.array([-way[1], way[0]])
    offsets = [float((tried[0].base - tried[0].ends[0]) @ left) for tried in asked if "(4, 2)" in tried[0].text.words]
    # The line over both pins is one of points 1.0 mm to the right of the axis on paper.
    axis = float((np.array([100.0, 80.0]) - one.ends[0]) @ left)
    wanted = [0.0] if ring else [sense * (16.5 + more) + axis for more in (6.0, 10.0) for sense in (1.0, -1.0)]
    assert offsets == pytest.approx(wanted, abs=0.02)
    assert "(1, 3)" in asked[-1][0].text.words


# --- tables


@pytest.mark.judges("files")
@at_once("count", [1, 12, 36, 37, 72, 90])
@at_once("most", [1, 9, 24])
def test_a_step_leaves_no_more_rows_than_there_is_room_for(count: int, most: int) -> None:
    """It divides the count where at least half as many rows remain as there is room for."""
    step = gear_tables._even_step(count, most)
    least = min(step for step in range(1, count + 1) if len(range(0, count, step)) <= most)
    dividing = [step for step in range(least, 2 * least + 1) if count / step == round(count / step)]
    assert step == min(dividing, default=least)


@pytest.mark.judges("files")
@at_once("gear", list(Gear))
def test_pitch_radii_are_those_of_the_gear_at_even_angles(gear: Gear) -> None:
    """A turn in 36 steps where 24 rows have room: every second step, the end of the turn left out."""
    rows = tuple((10.0 * step, 10.5 * step, 0.0, 20.0 + step, 60.0 - step) for step in range(37))
    made: Any = Made(pitch=Made(toothed=None))
    found = gear_tables._pitch(made, gear, Table("", (), rows), 27.0 * ROW_MM + 1.0)
    assert [row[0] for row in found.rows] == [f"{20 * step}" for step in range(18)]
    radii = [float(row[-1]) for row in found.rows]
    assert radii == [20.0 + 2 * step if gear is Gear.DRIVING else 60.0 - 2 * step for step in range(18)]
    assert len(found.heads) == (2 if gear is Gear.DRIVING else 3)
    if gear is Gear.DRIVEN:
        assert [float(row[1]) for row in found.rows] == [21.0 * step for step in range(18)]
    assert all(width >= 12.0 for width in found.columns.widths_mm)
    # Gears that turn less than once have both ends of their range.
    open_gear: Any = Made(pitch=Made(toothed=object()))
    ends = gear_tables._pitch(open_gear, gear, Table("", (), rows[:35]), 27.0 * ROW_MM + 1.0).rows
    assert [ends[0][0], ends[1][0], ends[-2][0], ends[-1][0], len(ends)] == ["0", "20", "320", "340", 18]


@pytest.mark.judges("files")
@pytest.mark.parametrize("ring", [False, True])
def test_measurements_share_the_lines_that_are_there(ring: bool, monkeypatch: pytest.MonkeyPatch) -> None:
    """Twenty lines: a title, heads and eight rows over pins, and as many of spans with their limits."""
    pins = tuple((number, number + 20, 65.0 + number) for number in range(1, 21))
    spans = tuple((n, n + 3, 4, 0.0, 30.0 + n, None, 29.0 + n, 31.0 + n) for n in range(1, 21))
    monkeypatch.setattr(gear_tables, "two_pin_table", lambda measured: Table("", (), pins))
    monkeypatch.setattr(gear_tables, "one_pin_table", lambda measured: Table("", (), ((7, 1.0, 2.0, 33.0),)))
    monkeypatch.setattr(gear_tables, "span_table", lambda measured: (Table("", (), spans),))
    measured: Any = Made(pins=Made(diameter_mm=5.0), section_z_mm=6.0, working=Made(is_ring=ring), tool="ball")
    over, span = gear_tables._measurements(measured, 70.0, 20.0 * ROW_MM + 1.0)
    assert over.title == f"{'Between' if ring else 'Over'} two balls \u00d85, centres at z = 6"
    assert [row[0] for row in over.rows] == ["1, 21", "3, 23", "6, 26", "8, 28", "11, 31", "13, 33", "16, 36", "18, 38"]
    assert over.heads == ("spaces after teeth", "mm")
    assert [row[0] for row in span.rows] == [f"{n} to {n + 3}" for n in (1, 3, 6, 8, 11, 13, 16, 18)]
    assert [tuple(map(float, row[1:])) for row in span.rows[:2]] == [(30.0, 32.0), (32.0, 34.0)]
    assert (over.columns.width_mm, span.columns.width_mm) == pytest.approx((70.0, 70.0))
    monkeypatch.setattr(gear_tables, "two_pin_table", lambda measured: Table("", (), ()))
    one, _ = gear_tables._measurements(measured, 70.0, 20.0 * ROW_MM + 1.0)
    assert (one.heads[0], one.rows) == ("space after tooth", (("7", "33"),))


@pytest.mark.judges("files")
@pytest.mark.parametrize("bored", [False, True])
def test_tables_of_a_gear_stand_side_by_side_and_measurements_below_each_other(
    bored: bool, monkeypatch: pytest.MonkeyPatch
) -> None:
    """The bore is under the measurements, which leave 2 mm between tables."""
    columns = ColumnWidths((20.0,), (False,))
    tall = [PaperTable("one", (), (("a",), ("b",)), columns), PaperTable("two", (), (("c",),), columns)]
    monkeypatch.setattr(gear_tables, "_data", lambda drive, gear, height: PaperTable("d", (), (), columns))
    monkeypatch.setattr(gear_tables, "_pitch", lambda *_: PaperTable("p", (), (), columns))
    room: list[tuple[float, float]] = []
    monkeypatch.setattr(gear_tables, "_measurements", lambda gear, wide, high: room.append((wide, high)) or tall)
    boxes: list[Any] = []
    monkeypatch.setattr(gear_tables, "_bore_view", lambda drive, bore, box: boxes.append(box.bounds) or [])
    plan: Any = Made(bore="bore" if bored else None)
    items = gear_tables.gear_tables(Made(), Made(gear=Gear.DRIVING), plan, Made(), Box(20.0, 44.0, 200.0, 152.0))
    places = {item.words: item.place for item in items if isinstance(item, Text)}
    second = 20.0 + gear_tables.DATA.width_mm + 2.0
    third = second + 22.0
    assert [places[name][0] for name in ("d", "p", "one", "two")] == [21.0, second + 1.0, third + 1.0, third + 1.0]
    assert places["one"][1] - places["two"][1] == pytest.approx(3.0 * ROW_MM)
    assert room == [(200.0 - third, 108.0 - (gear_tables.DETAIL_MM if bored else 0.0))]
    assert boxes == ([(third, 44.0, 200.0, 152.0 - 5.0 * ROW_MM)] if bored else [])


@pytest.mark.judges("files")
def test_a_title_block_stands_in_the_lower_right_corner() -> None:
    """Rows of 7.5 mm, the last of 9.5 mm; columns of 105, 40 and 35 mm; each text fits into its cell."""
    words = "a very long name of a part " * 9
    items = list(framed((297.0, 210.0), Titles(words, words, "steel", "from above", 0.5, "ISO 2768")))
    frame, block = (item.points for item in items[:2] if isinstance(item, SheetLine))
    assert frame.tolist() == [[20.0, 10.0], [287.0, 10.0], [287.0, 200.0], [20.0, 200.0]]
    assert block.tolist() == [[107.0, 10.0], [287.0, 10.0], [287.0, 42.0], [107.0, 42.0]]
    inner = [item.points for item in items[2:7] if isinstance(item, SheetLine)]
    assert [line[:, 1].tolist() for line in inner[:3]] == [[17.5] * 2, [25.0] * 2, [32.5] * 2]
    assert [line[:, 0].tolist() for line in inner[3:]] == [[212.0] * 2, [252.0] * 2]
    texts = [item for item in items if isinstance(item, Text)]
    columns, rows = (107.0, 212.0, 252.0, 287.0), (10.0, 17.5, 25.0, 32.5)
    for text in texts:
        column = max(number for number in range(3) if columns[number] < text.place[0])
        assert text.place[0] == columns[column] + 1.5
        assert text.place[1] - 2.5 in rows
        assert text.place[0] + text.width_mm <= columns[column + 1] - 1.5
        assert text.letter_mm == (3.5 if text.place[1] == 35.0 else 2.5)
    assert [text.place[:2] for text in texts if text.words.startswith("a very")] == [(108.5, 27.5), (108.5, 35.0)]
    cut = next(text for text in texts if text.letter_mm == 2.5 and text.words.startswith("a very"))
    assert 102.0 - text_width_mm("mm") < cut.width_mm <= 102.0


@pytest.mark.judges("files")
def test_arcs_of_a_path_have_the_radius_of_their_circle() -> None:
    """Arcs of a circle of 10 mm of 60, 200 and 100 deg, the last of them to the right, and a line."""
    turns = np.radians([60.0, 200.0, -100.0, 0.0])
    points = [0j]
    for turn in turns[:3]:
        points.append(points[-1] + 20.0 * sin(abs(turn) / 2.0) * np.exp(1j * (0.3 + len(points))))
    chain = Polyline(np.array([[one.real, one.imag] for one in points]), np.tan(turns / 4.0))
    steps = list(_steps(chain, 4))
    assert [step.split(" ")[0] for step in steps[:3]] == ["A10,10"] * 3
    assert [step.split(" ")[2:4] for step in steps[:3]] == [["0", "1"], ["1", "1"], ["0", "0"]]
    ends = [complex(*map(float, step.split(" ")[-1].lstrip("L").split(","))) for step in steps]
    assert ends == pytest.approx([*points[1:], 0j], abs=1e-4)
    assert steps[3].startswith("L")


@pytest.mark.judges("files")
@pytest.mark.parametrize("angle", [0.4, 2.9])
def test_a_gears_tip_is_pointed_at_from_outside(angle: float) -> None:
    """The farthest corner of a gear, and for a ring a place on its rim at 40 deg first."""
    far = 12.0 * np.array([cos(angle), sin(angle)])
    asked: list[Any] = []
    board: Any = Made(pointed=lambda *given: asked.append(given))
    disc = shapely.Polygon([far, *(5.0 * np.array([cos(angle + one), sin(angle + one)]) for one in (1.0, 3.0, 5.0))])
    gear_view._point_at_tip(board, Made(disc=disc, is_ring=False), PaperView(2.0, (50.0, 40.0)), 12.0)
    ((target, towards, words),) = asked
    assert target == pytest.approx([50.0, 40.0] + 2.0 * far)
    assert (towards, words) == (pytest.approx(angle), "R12 over all")
    asked.clear()
    gear_view._point_at_tip(board, Made(disc=disc, is_ring=True), PaperView(2.0, (50.0, 40.0)), 30.0)
    assert len(asked) == 24
    assert np.degrees(asked[0][1]) == pytest.approx(40.0)
    assert all(np.hypot(*(given[0] - [50.0, 40.0])) == pytest.approx(60.0) for given in asked)
