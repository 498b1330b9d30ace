"""Sheets of paper as values, before any format: dimensions by plane geometry, room by shapely, sizes of a design.

``test_drawings_on_paper.py`` reads the files of the same sheets.
"""

from __future__ import annotations

import re
from collections.abc import Callable
from functools import cache, partial
from itertools import pairwise
from math import hypot, pi

import numpy as np
import pytest
import shapely
import shapely.affinity
from shapely import LineString, Point, Polygon

from at_once import at_once
from drives import drive
from ncgear.files.workshop.drawing import Circle
from ncgear.files.workshop.sheets.board import SLACK_MM, Board, _widened
from ncgear.files.workshop.sheets.body import PaperView
from ncgear.files.workshop.sheets.frame import ColumnWidths, PaperTable, evenly, fitted
from ncgear.files.workshop.sheets.gear_view import point_at_circle
from ncgear.files.workshop.sheets.sheet import (
    Dimension,
    Measured,
    Pen,
    Ring,
    Sheet,
    SheetLine,
    Text,
    leader,
    length,
    text_width_mm,
)
from ncgear.files.workshop.sheets.sheets import sheets_of
from ncgear.numerics.arrays import Array
from ncgear.pitch.shape import Gear

# --- one dimension ---------------------------------------------------------------------------------------------------


def tips(dimension: Dimension) -> list[tuple[Array, Array]]:
    """Tip and direction of every arrowhead."""
    heads = [line.points for line in dimension.lines if line.filled]
    return [(points[0], points[0] - points[1:].mean(axis=0)) for points in heads]


@pytest.mark.judges("files")
@at_once("degrees", [*range(-180, 180, 30), -89.9, 89.9, 7.0])
@at_once("apart_mm", [12.0, -12.0, 0.0])
@at_once("long_mm", [40.0, 12.0, 5.0])
def test_a_dimension_stands_beside_its_ends_and_is_read_from_below_or_the_right(
    degrees: float, apart_mm: float, long_mm: float
) -> None:
    """ISO 129: lines go beyond the dimension line, arrows meet on it, from outside where it is short."""
    way = np.exp(1j * np.radians(degrees))
    ends = np.array([[3.0, 4.0], [3.0 + long_mm * way.real, 4.0 + long_mm * way.imag]])
    found = length(ends, apart_mm, "12.3456", 0.5)
    assert found.value_mm == pytest.approx(2.0 * long_mm)
    aside = apart_mm * np.array([-way.imag, way.real])
    feet = ends + aside
    (one, first), (other, second) = tips(found)
    assert [one, other] == [pytest.approx(foot) for foot in feet]
    along = np.array([way.real, way.imag]) * (1.0 if long_mm < 9.0 else -1.0)
    assert (first @ along, second @ along) == (pytest.approx(2.5), pytest.approx(-2.5))
    plain = [line.points for line in found.lines if not line.filled]
    assert any(np.allclose(points, feet) for points in plain)
    beyond = [points for points in plain if abs((points[1] - points[0]) @ along) < 1e-9]
    assert len(beyond) == (2 if apart_mm else 0)
    for end, points in zip(ends, beyond, strict=False):
        assert [np.sign(apart_mm) * (aside / abs(apart_mm)) @ (point - end) for point in points] == pytest.approx(
            [0.8 * np.sign(apart_mm), (abs(apart_mm) + 1.5) * np.sign(apart_mm)]
        )
    # The text is upright, or is read from the right, 0.8 mm above its line.
    assert -pi / 2.0 + 1e-5 < found.text.turned_rad <= pi / 2.0 + 1e-5
    up = np.array([-np.sin(found.text.turned_rad), np.cos(found.text.turned_rad)])
    place, wide = np.array(found.text.place), found.text.width_mm
    if long_mm > wide + 1.6:
        assert place - 0.8 * up == pytest.approx(feet.mean(axis=0))
    else:
        # Beyond both arrows outside, on a line that goes on under all of it.
        out = np.array([way.real, way.imag])
        assert place - 0.8 * up == pytest.approx(feet[1] + (5.0 + wide / 2.0) * out)
        assert plain[-1] == pytest.approx(np.array([feet[1], feet[1] + (5.0 + wide) * out]))
    assert not any(Polygon(found.text.corners).intersects(LineString(line.points)) for line in found.lines)


@at_once("degrees", range(10, 360, 40))
@at_once("back", [False, True])
def test_a_leader_points_at_its_target_and_bears_its_text_on_a_shoulder(degrees: float, back: bool) -> None:
    target, way = np.array([50.0, 60.0]), np.exp(1j * np.radians(degrees))
    elbow = target + 9.0 * np.array([way.real, way.imag])
    (bent, head), text = leader(target, elbow, "12 mm", back=back)
    assert (bent.points[:2] == [target, elbow]).all()
    assert head.points[0] == pytest.approx(target)
    assert (target - head.points[1:].mean(axis=0)) @ (target - elbow) / 9.0 == pytest.approx(2.5)
    shoulder = bent.points[2] - elbow
    assert shoulder[1] == 0.0
    assert abs(shoulder[0]) == pytest.approx(text.width_mm + 1.6)
    assert (shoulder[0] > 0.0) == ((way.real > 0.0) != back)
    low, high = sorted([elbow[0], bent.points[2, 0]])
    left, bottom, right, _ = Polygon(text.corners).bounds
    assert (left - low, high - right) == pytest.approx((0.8, 0.8))
    assert text.place[1] == pytest.approx(elbow[1] + 0.8)
    assert bottom < text.place[1]


# --- room on a board -------------------------------------------------------------------------------------------------

BOX = 0.0, 0.0, 120.0, 80.0


def room_about(text: Text) -> Polygon:
    """The box of a text with the room around it."""
    return Polygon(text.corners).buffer(SLACK_MM, join_style="mitre")


class Crowded:
    """A board with a line, a circle, a hole and a text, and the same as shapes."""

    def __init__(self) -> None:
        self.board, self.hole = Board(BOX), Ring((95.0, 20.0), 9.0)
        self.text = Text("in the way", (30.0, 60.0), turned_rad=0.4)
        waves = np.column_stack([np.linspace(5.0, 115.0, 120), 40.0 + 5.0 * np.sin(np.arange(120) / 6.0)])
        self.board.add(SheetLine(waves), Ring((30.0, 20.0), 10.0), self.text)
        self.board.keep_clear([self.hole])
        around = 10.0 * np.exp(1j * np.linspace(0.0, 2.0 * pi, 73))
        self.lines = shapely.union_all(
            [LineString(waves), LineString(np.column_stack([30.0 + around.real, 20.0 + around.imag]))]
        )
        self.shapes = shapely.union_all(
            [self.lines, Polygon(self.text.corners), Polygon(self.hole.points), shapely.box(*BOX).exterior]
        )

    def has_room(self, text: Text) -> bool:
        """Whether a text is inside and covers nothing."""
        area = room_about(text)
        return bool(shapely.box(*BOX).covers(area) and not area.intersects(self.shapes))

    def is_free(self, line: LineString) -> bool:
        """Whether a line is inside and crosses no text."""
        return bool(shapely.box(*BOX).covers(line) and not line.intersects(Polygon(self.text.corners)))


@pytest.mark.judges("files")
def test_a_text_has_room_where_shapely_finds_some() -> None:
    crowded, found = Crowded(), []
    for place in np.random.default_rng(3).uniform([-2.0, -2.0], [118.0, 80.0], (400, 2)):
        text = Text("4 holes", (float(place[0]), float(place[1])), turned_rad=float(place[0] % 1.5))
        found.append(crowded.board.has_room(text))
        assert found[-1] == crowded.has_room(text), place
    assert 100 < sum(found) < 300


@at_once("seed", range(8))
def test_the_first_place_that_has_room_and_suits_is_taken(seed: int) -> None:
    crowded = Crowded()
    places = np.random.default_rng(seed).uniform([0.0, 0.0], [110.0, 76.0], (60, 2))
    text = Text("tooth", (1.0, -2.0), turned_rad=0.3)
    moved = [Text("tooth", (float(x) + 1.0, float(y) - 2.0), turned_rad=0.3) for x, y in places]
    first, second, *_ = (one for one in moved if crowded.has_room(one))
    assert not crowded.board.put_text_at(text, places, lambda some: np.zeros(len(some), dtype=bool))
    assert crowded.board.put_text_at(text, places, lambda some: some[:, 0] + 1.0 != first.place[0])
    assert crowded.board.items[-1] == second


@at_once("seed", range(12))
def test_a_leader_is_the_shortest_that_covers_nothing(seed: int) -> None:
    """Those to the side before those that go back, short ones first, and of these the least turned."""
    crowded, rng = Crowded(), np.random.default_rng(seed)
    target, wanted = rng.uniform([10.0, 10.0], [110.0, 70.0]), float(rng.uniform(-pi, pi))
    turns, lengths = np.radians([0.0, 12.0, -12.0, 60.0, -60.0]), (5.0, 12.0, 32.0)
    found = crowded.board.pointed(target, wanted, "\u00d88", turns.tolist(), lengths)
    for back in (False, True):
        for long in lengths:
            for turn in turns:
                elbow = target + long * np.array([np.cos(wanted + turn), np.sin(wanted + turn)])
                lines, text = leader(target, elbow, "\u00d88", back=back)
                own, area = LineString(lines[0].points), room_about(text)
                head = LineString(np.vstack([lines[1].points, lines[1].points[:1]]))
                clear = not Polygon(text.corners).intersects(LineString(lines[0].points[:2]))
                if clear and crowded.has_room(text) and crowded.is_free(own) and crowded.is_free(head):
                    assert found is not None
                    assert found[1] == text
                    assert (found[0][0].points == lines[0].points).all()
                    assert not area.intersects(crowded.shapes)
                    return
    assert found is None


# --- the sheets of a pump --------------------------------------------------------------------------------------------

PUMP = "pump-1-2"
"""A crank of 30 mm and a rod of 120 mm; the crank pin of 8 mm and a keyway of 4 x 1.8 mm are in the driven gear."""


@cache
def sheets() -> dict[str, Sheet]:
    return sheets_of(drive(PUMP))


def sizes(sheet: str) -> dict[str, Dimension]:
    """Dimensions by their words."""
    return {item.text.words: item for item in sheets()[sheet].items if isinstance(item, Dimension)}


def words(sheet: str) -> list[str]:
    return [item.words for item in sheets()[sheet].items if isinstance(item, Text)]


def every_dimension_measures_what_it_says() -> None:
    for sheet in sheets():
        measures_what_it_says(sizes(sheet))


def measures_what_it_says(found: dict[str, Dimension]) -> None:
    assert len(found) >= 4
    for said, one in found.items():
        (number,) = re.findall(r"^[R\u00d8]?([\d.]+)", said)
        assert one.value_mm == pytest.approx(float(number), abs=6e-5), said


def dimensions_of_both_gears_are_those_of_the_design() -> None:
    driving, driven = sizes("driving"), sizes("driven")
    # H7 from 6 to 10 mm is +0.015, from 10 to 18 mm +0.018; the keyway's bottom is 6 + 6 + 1.8 from the other side.
    assert {"10", "\u00d88 H7 (0 to +0.015)"} <= set(driving)
    hole, bore = "\u00d88 H7 (0 to +0.015) hole for the crank pin", "\u00d812 H7 (0 to +0.018)"
    assert {"10", "4", "13.8", hole, bore} <= set(driven)
    # The holes that are drawn: circles between opposite points of their diameters.
    pin, origin, scale = driven[hole], np.array(sheets()["driven"].origin), sheets()["driven"].scale
    assert (pin.ends.mean(axis=0) - origin) / scale == pytest.approx([-30.0, 0.0], abs=1e-9)
    assert pin.measured is Measured.DIAMETER
    assert hypot(*(pin.base - pin.ends[0])) == 0.0
    for gear, found in (("driving", driving), ("driven", driven)):
        (said,) = (said for said in found if "over all" in said)
        one, outline = found[said], drive(PUMP).teeth.of(Gear(gear)).outline_mm
        assert one.value_mm == pytest.approx(np.hypot(*outline.T).max(), abs=1e-9)
        assert one.ends[0] == pytest.approx(sheets()[gear].origin)
        farthest = (one.ends[1] - one.ends[0]) / sheets()[gear].scale
        assert np.hypot(*(outline - farthest).T).min() == pytest.approx(0.0, abs=1e-9)


def pins_lie_in_the_spaces_that_are_named(gear: Gear) -> None:
    """Two circles of the pins' size between teeth, touching the dimension's ends from inside, and no tooth."""
    sheet = sheets()[gear.value]
    ((said, one),) = ((said, one) for said, one in sizes(gear.value).items() if "pins" in said)
    size, *spaces = map(float, re.findall(r"[\d.]+", said.partition("2 pins")[2]))
    rings = [item for item in sheet.items if isinstance(item, Ring) and item.pen is Pen.THIN]
    pins = [ring for ring in rings if ring.radius == pytest.approx(sheet.scale * size / 2.0)]
    centers = np.array(sorted(ring.center for ring in pins if Point(ring.center).distance(Point(sheet.origin)) > 10.0))
    assert len(centers) == 2
    along = (one.ends[1] - one.ends[0]) / np.hypot(*(one.ends[1] - one.ends[0]))
    inside = sorted(map(tuple, [one.ends[0] + pins[0].radius * along, one.ends[1] - pins[0].radius * along]))
    assert centers == pytest.approx(np.array(inside))
    outline = Polygon(sheet.origin + sheet.scale * drive(PUMP).teeth.of(gear).outline_mm)
    names = {item.name: np.array(item.place) for item in sheet.items if isinstance(item, Text) and item.name}
    for center in centers:
        # Both flanks are touched: to the chord tolerance and the backlash, on paper.
        assert outline.distance(Point(center)) == pytest.approx(pins[0].radius, abs=0.02 * sheet.scale)
        if len(names) == drive(PUMP).teeth.of(gear).teeth:
            near = min(names, key=lambda name: hypot(*(names[name] - center)))
            assert float(near.removeprefix("tooth-")) in {*spaces, *(space + 1.0 for space in spaces)}


def the_section_shows_the_widths_of_the_material() -> None:
    """The material on x = 0 is the body's width at every y; its lines stand under one another beside the view."""
    sheet = sheets()["driven"]
    width = sizes("driven")["10"]
    low, high = sorted(width.ends[:, 0])
    assert high - low == pytest.approx(10.0 * sheet.scale)
    plan = drive(PUMP).solids.driven.plan
    on_plane = plan.disc.intersection(LineString([(0.0, -99.0), (0.0, 99.0)]))
    level = sheet.origin[1] + sheet.scale * np.array([on_plane.bounds[1], on_plane.bounds[3]])
    upright = [
        item.points
        for item in sheet.items
        if isinstance(item, SheetLine)
        and item.pen is Pen.VISIBLE
        and len(item.points) == 2
        and np.ptp(item.points[:, 0]) == 0
    ]
    at = {round(float(points[0, 0]), 6): sorted(points[:, 1]) for points in upright}
    for x in (low, high):
        assert at[round(x, 6)] == pytest.approx(level)
    chain = [item.points for item in sheet.items if isinstance(item, SheetLine) and item.pen is Pen.CHAIN]
    wanted = np.array([[low - 2.0, sheet.origin[1]], [high + 2.0, sheet.origin[1]]])
    assert any(points.shape == (2, 2) and np.allclose(points, wanted) for points in chain)


def the_assembly_is_the_machine_at_its_first_pose() -> None:
    found, sheet = sizes("pair"), sheets()["pair"]
    (said,) = (said for said in found if "\u00b1" in said)
    assert found[said].value_mm == pytest.approx(drive(PUMP).pitch.center_distance_mm, abs=1e-9)
    assert {"30", "120", "60 stroke"} <= set(found)
    crank, rod, stroke = found["30"].ends, found["120"].ends, found["60 stroke"].ends
    # The crank ends where the rod begins, which ends on the line of the stroke, at its near end: 120 - 30.
    assert crank[1] == pytest.approx(rod[0])
    assert rod[1] == pytest.approx(stroke[0], abs=1e-9)
    scale = found["60 stroke"].view
    assert (stroke - crank[0]) / scale == pytest.approx(np.array([[90.0, 0.0], [150.0, 0.0]]), abs=1e-9)
    assert any("crank 30, rod 120, offset 0; crank at 180 deg" in one for one in words("pair"))
    # Driving gear first; the pin's hole of the driven gear stands where the crank's pin does.
    axes = found[said].ends
    holes = [np.array(item.center) for item in sheet.items if isinstance(item, Ring) and item.pen is Pen.VISIBLE]
    (pin,) = (center for center in holes if not any(np.allclose(center, axis) for axis in axes) and center[1] > 150.0)
    assert (pin - axes[1]) / sheet.scale == pytest.approx([-30.0, 0.0], abs=1e-9)


def texts_cover_neither_lines_nor_one_another(sheet: str) -> None:
    plain = list(sheets()[sheet].plain())
    boxes = {one: Polygon(one.corners) for one in plain if isinstance(one, Text)}
    frame = shapely.box(20.0, 10.0, 200.0, 287.0)
    for one, area in boxes.items():
        assert frame.covers(area), one.words
    tree = shapely.STRtree(list(boxes.values()))
    assert not [
        pair for pair in tree.query(list(boxes.values()), predicate="intersects").T.tolist() if len({*pair}) > 1
    ]
    lines = [np.vstack([one.points, one.points[:1]]) for one in plain if isinstance(one, Ring) or one in closed(plain)]
    lines += [one.points for one in plain if isinstance(one, SheetLine) and not one.closed]
    assert not len(tree.query([LineString(points) for points in lines], predicate="intersects").T)


def tables_stand_beside_one_another() -> None:
    """Their upright rules, by where they begin and end: 2 mm at least are left between tables side by side."""
    for gear in Gear:
        rules: dict[tuple[float, float], list[float]] = {}
        for item in sheets()[gear.value].items:
            if isinstance(item, SheetLine) and item.pen is Pen.THIN and len(item.points) == 2:
                (x, high), (other, low) = np.round(item.points, 6).tolist()
                if x == other and 100.0 < high < 160.0:
                    rules.setdefault((high, low), []).append(x)
        beside = sorted((min(xs), max(xs)) for (high, _), xs in rules.items() if high == max(rules)[0])
        assert len(beside) == 3
        for (_, right), (left, _) in pairwise(beside):
            assert left - right >= 2.0 - 1e-6


def closed(plain: list[SheetLine | Ring | Text]) -> list[SheetLine]:
    return [one for one in plain if isinstance(one, SheetLine) and one.closed]


def marks_point_along_the_line_of_centres_and_the_crank(gear: Gear) -> None:
    """In the gear's own frame: the driving gear is met ahead, the driven one behind, where its crank points too."""
    sheet = sheets()[gear.value]
    (place,) = (item for item in sheet.items if isinstance(item, Text) and item.words.startswith("mesh"))
    assert place.words == ("mesh" if gear is Gear.DRIVING else "mesh, crank")
    arrows = [item.points for item in sheet.items if isinstance(item, SheetLine) and item.filled]
    ahead = 1.0 if gear is Gear.DRIVING else -1.0
    tip = min((points[0] for points in arrows), key=lambda point: hypot(*(point - np.array(place.place))))
    assert ahead * (tip - sheet.origin)[0] > 0.0
    assert tip[1] == pytest.approx(sheet.origin[1], abs=1e-9)


@pytest.mark.judges("files")
@at_once(
    "judge",
    [
        every_dimension_measures_what_it_says,
        dimensions_of_both_gears_are_those_of_the_design,
        *(partial(pins_lie_in_the_spaces_that_are_named, gear) for gear in Gear),
        *(partial(marks_point_along_the_line_of_centres_and_the_crank, gear) for gear in Gear),
        the_section_shows_the_widths_of_the_material,
        the_assembly_is_the_machine_at_its_first_pose,
        *(partial(texts_cover_neither_lines_nor_one_another, sheet) for sheet in ("driving", "driven", "pair")),
        tables_stand_beside_one_another,
    ],
)
def test_the_sheets_of_a_pump(judge: Callable[[], None]) -> None:
    judge()


@at_once("place", [(10.0, 20.0), (-15.0, 8.0), (12.0, -3.0)])
def test_a_leader_to_a_hole_comes_from_the_side_of_the_axis(place: tuple[float, float]) -> None:
    """An eighth of a turn beside the way to the axis, as first tried, from the edge through the centre."""
    board = Board((-100.0, -100.0, 100.0, 100.0))
    point_at_circle(board, PaperView(2.0, (5.0, 6.0)), [Circle(*place, 1.5)], "\u00d83", 0.0)
    (found,) = (item for item in board.items if isinstance(item, Dimension))
    center = np.array([5.0, 6.0]) + 2.0 * np.array(place)
    towards = -np.array(place) / hypot(*place)
    way = np.array([towards[0] - towards[1], towards[0] + towards[1]]) / np.sqrt(2.0)
    assert found.ends == pytest.approx(np.array([center + 3.0 * way, center - 3.0 * way]))
    assert found.lines[0].points[:2] == pytest.approx(np.array([center + 3.0 * way, center + 8.0 * way]))
    assert (found.value_mm, found.measured) == (pytest.approx(3.0), Measured.DIAMETER)


@at_once("hand", [1.0, -1.0])
def test_a_view_from_below_is_a_mirrored_one(hand: float) -> None:
    view = PaperView(2.0, (30.0, 40.0), 0.3, hand)
    points = np.array([[3.0, 1.0], [-2.0, 5.0], [0.0, 0.0]])
    seen = (points[:, 0] + 1j * hand * points[:, 1]) * 2.0 * np.exp(0.3j) + (30.0 + 40.0j)
    assert view.on_paper(points) == pytest.approx(np.column_stack([seen.real, seen.imag]))
    assert view.direction_rad(0.7) == pytest.approx(float(np.angle(np.exp(0.3j + 0.7j * hand))))


# --- tables ----------------------------------------------------------------------------------------------------------

LONG = "diameter of the hole for the crank pin", "H7 (0 to +0.015)", "unbreakableunbreakableunbreakable", "", "8"


@at_once("heads", [("what it is", "the size, mm"), ()])
@at_once("count", [1, 2, 7])
def test_the_cells_of_a_table_hold_their_texts(heads: tuple[str, ...], count: int) -> None:
    """Each between its own rules: words in their order and as many as have room, on lines of 4 mm."""
    rows = tuple((LONG[row % 5], LONG[(row + 3) % 5]) for row in range(count))
    table = PaperTable("A title", heads, rows, ColumnWidths((31.0, 17.0), (False, True)))
    items = list(table.drawn(20.0, 90.0))
    lines = [item.points for item in items if isinstance(item, SheetLine)]
    title, *cells = [item for item in items if isinstance(item, Text)]
    assert (title.words, title.place) == ("A title", pytest.approx((21.0, 86.8)))
    low = 90.0 - table.height_mm()
    upright = sorted({tuple(points[:, 0]) for points in lines if np.ptp(points[:, 0]) == 0.0})
    assert upright == [(20.0, 20.0), (51.0, 51.0), (68.0, 68.0)]
    assert {tuple(points[:, 1]) for points in lines if np.ptp(points[:, 0]) == 0.0} == {(86.0, low)}
    rules = sorted({float(y) for points in lines if len(points) > 2 for y in points[:, 1]}, reverse=True)
    written = [*([heads] if heads else []), *rows]
    assert len(rules) == len(written) + 1
    assert (rules[0], rules[-1]) == (86.0, pytest.approx(low))
    for (high, foot), texts in zip(pairwise(rules), written, strict=True):
        for (left, right), words in zip(((20.0, 51.0), (51.0, 68.0)), texts, strict=True):
            cell = shapely.box(left + 1.0, foot, right - 1.0, high)
            inside = [one for one in cells if cell.contains(Polygon(one.corners).centroid)]
            assert all(cell.buffer(1e-9).covers(Polygon(one.corners)) for one in inside)
            said = " ".join(one.words for one in inside)
            assert said == words or (said.endswith("...") and words.startswith(said[:-3]))
            # As few lines as there may be: the first word of the next has no room.
            for one, after in pairwise(inside):
                assert text_width_mm(f"{one.words} {after.words.split()[0]}") > right - left - 2.0
            assert [one.place[1] for one in inside] == pytest.approx([high - 3.2 - 4.0 * n for n in range(len(inside))])
            edges = {one.place[0] for one in inside}
            assert edges <= {right - 1.0 if left > 50.0 else left + 1.0}


@at_once(("count", "most"), [(3, 5), (5, 5), (6, 5), (24, 7), (100, 9)])
def test_rows_that_are_left_are_spread_evenly(count: int, most: int) -> None:
    kept = [int(row) for (row,) in evenly([(str(row),) for row in range(count)], most)]
    assert len(kept) == min(count, most)
    assert kept[0] == 0
    assert np.ptp(np.diff([*kept, count])) <= 1


@at_once("width_mm", [6.0, 14.0, 33.0, 90.0])
def test_as_much_of_a_text_as_has_room_is_left(width_mm: float) -> None:
    words = "Material-18CrNiMo7-6-and-more"
    cut = fitted(words, width_mm)
    assert text_width_mm(cut) <= width_mm
    assert cut == words or text_width_mm(f"{words[: len(cut) - 2]}...") > width_mm


@at_once("turned_deg", [0.0, 33.0, 90.0, 200.0])
def test_a_box_is_widened_to_all_sides_alike(turned_deg: float) -> None:
    box = shapely.affinity.rotate(shapely.box(3.0, 4.0, 20.0, 7.0), turned_deg)
    found = Polygon(_widened(np.array(box.exterior.coords[:4])))
    assert found.symmetric_difference(box.buffer(SLACK_MM, join_style="mitre")).area < 1e-9
