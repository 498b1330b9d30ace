"""Sheets of paper on plain values, by plane geometry: places of views, sections, senses of turning, lengths."""

from __future__ import annotations

from itertools import pairwise
from math import cos, degrees, hypot, pi, radians, sin, sqrt
from types import SimpleNamespace
from typing import Any

import numpy as np
import pytest
import shapely
from shapely import LineString, Polygon

import ncgear.files.workshop.sheets.gear_view as gear_view
import ncgear.files.workshop.sheets.sheets as sheets
from at_once import at_once
from ncgear.files.workshop.drawing import bore_shape
from ncgear.files.workshop.sheets import body, gear_tables
from ncgear.files.workshop.sheets.board import Board
from ncgear.files.workshop.sheets.body import HATCH_MM, BodySection, PaperView, section_of
from ncgear.files.workshop.sheets.frame import Box
from ncgear.files.workshop.sheets.sheet import A4_MM, SCALES, Dimension, Pen, SheetLine, Text
from ncgear.mechanisms.crank_slider import CrankSlider
from ncgear.pitch.shape import Gear
from ncgear.solids.plan.body import Bore, Keyway

Made: Any = SimpleNamespace

WIDE = 0.0, 0.0, 400.0, 300.0


def lines_of(items: Any, pen: Pen | None = None) -> list[Any]:
    """Points of all lines, or of those of a pen."""
    return [item.points for item in items if isinstance(item, SheetLine) and pen in (None, item.pen)]


# --- the assembly's sheet


@pytest.mark.judges("files")
def test_parts_of_an_assembly_share_the_paper_without_covering_each_other() -> None:
    """The frame is 20 mm from the left and 10 mm from other edges; the title block is 180 mm by 32 mm, down right."""
    upright, across = (sheets._layout(size, mechanism=True) for size in (A4_MM, A4_MM[::-1]))
    assert upright.parts.bounds == (20.0, 42.0, 200.0, 82.0)
    assert upright.mechanism is not None
    assert upright.mechanism.bounds == (22.0, 84.0, 198.0, 158.0)
    assert upright.gears.bounds == (22.0, 158.0, 198.0, 285.0)
    assert across.parts.bounds == (20.0, 10.0, 107.0, 44.0)
    assert across.mechanism is not None
    assert across.mechanism.bounds == (22.0, 46.0, 285.0, 120.0)
    assert across.gears.bounds == (22.0, 120.0, 285.0, 198.0)
    alone = sheets._layout(A4_MM, mechanism=False)
    assert (alone.mechanism, alone.gears.bounds) == (None, (22.0, 84.0, 198.0, 285.0))


@at_once("size_mm", [(30.0, 20.0), (100.0, 9.0), (9.0, 51.0), (740.0, 10.0), (7.4, 5.4)])
def test_gears_are_as_large_as_there_is_room(size_mm: tuple[float, float]) -> None:
    """A box of 200 mm by 140 mm leaves 148 mm by 108 mm: 26 mm left and right, 16 mm above and below."""
    found = sheets._scale_in(Box(10.0, 20.0, 210.0, 160.0), np.array(size_mm))
    larger = SCALES[SCALES.index(found) - 1]
    assert found * size_mm[0] <= 148.0
    assert found * size_mm[1] <= 108.0
    assert larger * size_mm[0] > 148.0 or larger * size_mm[1] > 108.0


@pytest.mark.judges("files")
def test_a_gears_name_points_at_its_edge_from_beside_the_other_gear() -> None:
    """From across the line of centres first, then round behind the gear, and at last between both."""
    asked: list[tuple[Any, float]] = []
    board: Any = Made(point=lambda target, angle, words, turns: asked.append((target, angle)))
    view, other = PaperView(2.0, (100.0, 50.0)), PaperView(2.0, (40.0, 50.0))
    square = Polygon([(-5.0, -4.0), (5.0, -4.0), (5.0, 4.0), (-5.0, 4.0)])
    sheets._name(board, Made(disc=square), view, "1 driving gear", [view, other])
    turns = [degrees(angle) for _, angle in asked]
    assert turns == pytest.approx([*range(90, 271, 15), *range(75, -76, -15)])
    for target, angle in asked:
        way = np.array([cos(angle), sin(angle)])
        corners = np.array([[x, y] for x in (90.0, 110.0) for y in (42.0, 58.0)])
        assert (target - [100.0, 50.0]) @ way == pytest.approx(((corners - [100.0, 50.0]) @ way).max())
    asked.clear()
    sheets._name(board, Made(disc=square), view, "1", [view])
    assert degrees(asked[0][1]) == pytest.approx(90.0)


@pytest.mark.judges("files")
@pytest.mark.parametrize("angle", [0.0, 0.7, 2.5])
def test_a_cranks_direction_goes_six_millimetres_beyond_what_is_drawn(angle: float) -> None:
    """Points within a letter's height of the line count, and points ahead alone."""
    way = np.array([cos(angle), sin(angle)])
    aside, axis = np.array([-way[1], way[0]]), np.array([50.0, 60.0])
    drawn = axis + np.array([20.0 * way + 2.4 * aside, 40.0 * way + 2.6 * aside, -70.0 * way])
    board, texts = Board(WIDE), []
    board.put_text = lambda candidates: bool(texts.extend(candidates))  # type: ignore[method-assign]
    linkage = Made(crank_start_rad=angle, CRANK="crank")
    sheets._draw_crank(board, Made(linkage=linkage), axis, drawn)
    (line,) = lines_of(board.items, Pen.CHAIN)
    end = axis + 26.0 * way
    assert line == pytest.approx(np.array([axis, end]))
    assert len(texts) == 18
    assert [text.place for text in texts[::3]] == [
        pytest.approx(tuple(end + more * way + [0.0, lift])) for more in (1.0, 3.0, 6.0) for lift in (1.5, -4.0)
    ]


@pytest.mark.judges("files")
def test_the_centre_distance_stands_outside_both_gears_or_between_their_axes(monkeypatch: pytest.MonkeyPatch) -> None:
    """Squares 20 mm wide at half size, 40 mm apart: lines 7, 11 and 15 mm outside, then 6, 8 mm within."""
    box = Box(0.0, 0.0, 200.0, 100.0)
    square = Polygon([(-20.0, -20.0), (24.0, -20.0), (24.0, 20.0), (-20.0, 20.0)])
    views = {Gear.DRIVING: PaperView(0.5, (60.0, 50.0)), Gear.DRIVEN: PaperView(0.5, (100.0, 50.0))}
    asked: list[Any] = []
    for name in ("drawn_body", "drawn_holes"):
        monkeypatch.setattr(sheets, name, lambda *_: [])
    for module, name in ((gear_view, "number_teeth"), (sheets, "_name"), (sheets, "_draw_crank")):
        monkeypatch.setattr(module, name, lambda *_, **__: None)
    turned: list[tuple[float, float]] = []
    monkeypatch.setattr(gear_view, "draw_turning", lambda board, view, sense, free: turned.append((sense, free)))
    monkeypatch.setattr(gear_view, "free_radius_mm", lambda plan, view: 8.0)
    monkeypatch.setattr(sheets, "distance_text", lambda drive: "\u00b1 0.1")
    monkeypatch.setattr(
        gear_view, "mounting_of", lambda drive: Made(sense=lambda g: 1.0 if g is Gear.DRIVING else -1.0)
    )
    monkeypatch.setattr(Board, "put_dimension", lambda self, some: asked.extend(one for (one,) in some))
    linkage = Made(HAS_CRANK=False, CRANK="crank")
    plans: Any = {gear: Made(disc=square, index_hole=object()) for gear in Gear}
    for stage, said in ((None, 1), (0, 2)):
        asked.clear()
        pitch = Made(size=Made(module_mm=3.0), center_distance_mm=80.0)
        made: Any = Made(pitch=pitch, linkage=linkage, stage=stage, teeth=Made(of=lambda gear: gear), design=None)
        items = sheets._gears(made, plans, views, box)
        texts = [item for item in items if isinstance(item, Text)]
        assert [text.place for text in texts] == [(0.0, 96.5), (0.0, 92.0)][:said]
        assert said == 1 or "stage 1" in texts[1].words
    assert turned == 2 * [(1.0, 8.0), (-1.0, 8.0)]
    crosses = lines_of(items, Pen.CHAIN)[:4]
    assert [hypot(*np.ptp(line, axis=0)) for line in crosses] == pytest.approx([3.0] * 4)
    assert all(one.ends == pytest.approx(np.array([[60.0, 50.0], [100.0, 50.0]])) for one in asked)
    offsets = [one.base[1] - 50.0 for one in asked]
    assert offsets[:6] == pytest.approx([-17.0, 17.0, -21.0, 21.0, -25.0, 25.0])
    assert offsets[6:] == pytest.approx([-6.0, 6.0, -8.0, 8.0])
    assert {one.value_mm for one in asked} == {80.0}
    assert asked[0].text.words.endswith("\u00b1 0.1")


@pytest.mark.judges("files")
def test_a_mechanism_stands_in_the_middle_of_its_box(monkeypatch: pytest.MonkeyPatch) -> None:
    """A crank of 30 mm and a rod of 90 mm beside two gears of 12 mm: all parts with 10 and 13 mm of room about them."""
    linkage = CrankSlider(crank_mm=30.0, rod_mm=90.0, offset_mm=10.0)
    axes = {Gear.DRIVING: (-24.0, 0.0), Gear.DRIVEN: (0.0, 0.0)}
    mounting = Made(axis_mm=axes.get, turn_rad=0.0, hand=1.0, driving_axis_mm=(-24.0, 0.0), driven_axis_mm=(0.0, 0.0))
    around = np.exp(1j * np.linspace(0.0, 2.0 * pi, 361))
    circle = 12.0 * np.column_stack([around.real, around.imag])
    curves = [Made(gear=gear, drawn=lambda count: Made(position=circle)) for gear in Gear]
    monkeypatch.setattr(gear_view, "mounting_of", lambda drive: mounting)
    monkeypatch.setattr(sheets, "shafts_below", lambda drive: [("gear", "shaft"), ("rod", "pin")])
    supports = [np.array([[-3.0, -9.0], [3.0, -9.0]])]
    monkeypatch.setattr(sheets, "supports_mm", lambda linkage: supports)
    asked: list[Any] = []
    monkeypatch.setattr(Board, "put_dimension", lambda self, some: asked.append([one for (one,) in some]))
    pointed: list[Any] = []
    monkeypatch.setattr(Board, "point", lambda self, *given: pointed.append(given) or len(pointed) == 3)
    made: Any = Made(linkage=linkage, pitch=Made(driving=curves[0], driven=curves[1], toothed=None))
    ring = np.array([[-6.0, -5.0], [36.0, -5.0], [36.0, 6.0], [-6.0, 6.0]])
    items = sheets._mechanism(made, {"crank": [ring]}, Box(20.0, 40.0, 220.0, 140.0))
    # From the left edge of the driving gear to the farther end of the slider; from -12 mm to 12 mm.
    nearest, farthest = (sqrt((90.0 + sense * 30.0) ** 2 - 100.0) for sense in (-1.0, 1.0))
    wide, scale = farthest + 36.0, 1.0
    assert scale * wide <= 180.0 < 2.0 * wide
    origin = np.array([120.0, 91.0]) - scale * np.array([farthest - 36.0, 0.0]) / 2.0
    thin = [item for item in items if isinstance(item, SheetLine)]
    crank = next(item for item in thin if item.name == "crank")
    assert crank.points == pytest.approx(origin + scale * ring)
    assert any(len(line.points) == 2 and np.allclose(line.points, origin + scale * supports[0]) for line in thin)
    curve = [item for item in thin if item.pen is Pen.CHAIN and item.closed]
    assert [line.points.mean(axis=0) for line in curve] == [
        pytest.approx(origin + scale * np.array(axis), abs=0.1) for axis in axes.values()
    ]
    (way,) = (item.points for item in thin if item.pen is Pen.CHAIN and not item.closed)
    ends = origin + scale * np.array([[nearest, 10.0], [farthest, 10.0]])
    assert way == pytest.approx(ends + np.array([[-6.0, 0.0], [6.0, 0.0]]))
    marks = [item.points for item in thin if len(item.points) == 2 and hypot(*np.ptp(item.points, axis=0)) < 5.5]
    assert [hypot(*np.ptp(mark, axis=0)) for mark in marks] == pytest.approx([5.0] * 4)
    texts = [item for item in items if isinstance(item, Text)]
    assert [text.place for text in texts] == [(22.0, 135.5), (22.0, 132.0), (22.0, 128.5)]
    assert texts[0].words.startswith("Mechanism at phi1 = 0, 1:1; lengths: crank 30, rod 90")
    stroke, *lengths = asked
    below = origin[1] - 12.0 - 5.0
    assert [one.base[1] for one in stroke] == pytest.approx([below, below - 2.0, below - 4.0])
    assert stroke[0].value_mm == pytest.approx(farthest - nearest)
    assert [one[0].value_mm for one in lengths] == pytest.approx([30.0, 90.0])
    for some in lengths:
        way = (some[0].ends[1] - some[0].ends[0]) / hypot(*(some[0].ends[1] - some[0].ends[0]))
        left = np.array([-way[1], way[0]])
        found = [(one.base - one.ends[0]) @ left for one in some]
        assert found == pytest.approx([7.0, -7.0, 10.0, -10.0, 13.0, -13.0, 5.0, -5.0, 16.0, -16.0])
    assert [degrees(given[1]) for given in pointed] == pytest.approx([70.0, 90.0, 110.0])
    assert [given[2] for given in pointed] == ["3 crank"] * 3
    assert pointed[0][0] == pytest.approx(origin + scale * ring[2])
    assert pointed[2][0] == pytest.approx(origin + scale * ring[3])


# --- one gear


@at_once("bounds", [(-20.0, -24.0, 22.0, 21.0), (-60.0, -9.0, 60.0, 9.0), (-3.0, -40.0, 5.0, 62.0)])
def test_a_gear_and_its_section_share_the_width(bounds: tuple[float, float, float, float]) -> None:
    """Room of 17 mm at both sides of the gear, 11 mm above and below, 24 mm beside the section; the rest is halved."""
    area, height = Box(22.0, 154.0, 198.0, 285.0), 12.0
    seen: dict[str, Any] = {}
    with pytest.MonkeyPatch.context() as patch:
        patch.setattr(body, "section_of", lambda plan: Made(height_mm=height))
        patch.setattr(gear_view, "_draw_gear", lambda board, *_: seen.update(board=board))
        patch.setattr(gear_view, "_draw_section", lambda *given: seen.update(cut=given[0], left=given[3]))
        view, items = gear_view.gear_views(Made(), Made(), Made(disc=Made(bounds=bounds)), area)
    left, low, right, high = bounds

    def has_room(scale: float) -> bool:
        wide = 34.0 + scale * (right - left) + 24.0 + scale * height
        return wide <= 176.0 and scale * (high - low) + 22.0 <= 131.0

    assert view.scale == next(scale for scale in SCALES if has_room(scale))
    spare = (176.0 - 58.0 - view.scale * (right - left + height)) / 2.0
    edges = view.on_paper(np.array([[left, low], [right, high]]))
    assert edges[0, 0] == pytest.approx(22.0 + spare + 17.0)
    assert edges[:, 1].mean() == pytest.approx(219.5)
    border = edges[1, 0] + 17.0 + spare
    assert seen["board"].box.bounds == pytest.approx((22.0, 154.0, border, 285.0))
    assert seen["cut"].box.bounds == pytest.approx((border, 154.0, 198.0, 285.0))
    assert seen["left"] == pytest.approx(border + 8.0)
    assert items[0].place == (22.0, 155.0)


@pytest.mark.judges("files")
def test_the_plane_of_a_section_is_marked_over_and_under_its_gear() -> None:
    """Strokes of 4.5 mm begin 1.5 mm from the edge; arrows of 5 mm point in the direction of view."""
    board, view = Board(WIDE), PaperView(2.0, (100.0, 80.0))
    gear_view._mark_plane(board, Made(disc=Made(bounds=(-9.0, -20.0, 9.0, 15.0))), view)
    strokes = lines_of(board.items, Pen.VISIBLE)
    assert strokes[0].tolist() == [[100.0, 38.5], [100.0, 34.0]]
    assert strokes[1].tolist() == [[100.0, 111.5], [100.0, 116.0]]
    thin = [item for item in board.items if isinstance(item, SheetLine) and item.pen is Pen.THIN]
    for stroke, shaft, head in zip(strokes, thin[::2], thin[1::2], strict=True):
        assert shaft.points == pytest.approx(np.array([stroke[1], stroke[1] + [5.0, 0.0]]))
        assert head.points[0] == pytest.approx(shaft.points[1])
        assert head.points[1:].mean(axis=0) == pytest.approx(head.points[0] - [2.5, 0.0])
    assert [text.place for text in board.items if isinstance(text, Text)] == [(96.5, 32.8), (96.5, 114.8)]


@pytest.mark.judges("files")
@pytest.mark.parametrize("sense", [1.0, -1.0])
def test_an_arc_with_an_arrow_tells_the_sense_of_turning(sense: float) -> None:
    """A hundred degrees from 40 on, where nothing is in the way; else 20 degrees on, or a millimetre farther out."""
    view = PaperView(2.0, (50.0, 40.0))
    for blocked, radius, start in ((0, 6.0, 40.0), (1, 6.0, 60.0), (18, 7.0, 40.0)):
        board, answers = Board(WIDE), iter([*[False] * blocked, True])
        board.is_free = lambda lines, answers=answers: next(answers)  # type: ignore[method-assign, misc]
        gear_view.draw_turning(board, view, sense, 6.0)
        arc, head = lines_of(board.items)
        out = arc - [50.0, 40.0]
        turned = np.unwrap(np.arctan2(out[:, 1], out[:, 0]))
        assert np.hypot(*out.T) == pytest.approx(np.full(25, radius))
        assert degrees(turned[0]) == pytest.approx((start + 180.0) % 360.0 - 180.0)
        assert degrees(turned[-1] - turned[0]) == pytest.approx(sense * 100.0)
        # The arrowhead is a chord of the arc, as nearly as 2.5 mm of it allow.
        way, back = arc[-1] - head[1:].mean(axis=0), head[1:].mean(axis=0) - [50.0, 40.0]
        assert head[0] == pytest.approx(arc[-1])
        assert (out[-1, 0] * way[1] - out[-1, 1] * way[0]) * sense > 0.0
        assert hypot(*back) == pytest.approx(radius, abs=0.03 * radius)


@pytest.mark.judges("files")
def test_a_sense_of_turning_is_told_outside_bore_and_hub() -> None:
    view = PaperView(2.0, (0.0, 0.0))
    for bore, hub, radius in (
        (None, None, 5.0),
        (8.0, None, 18.5),
        (8.0, 30.0, 32.5),
        (8.0, 12.0, 18.5),
        (1.0, 2.0, 5),
    ):
        plan: Any = Made(bore=bore and Made(reach_mm=bore), hub=hub and Made(diameter_mm=hub))
        assert gear_view.free_radius_mm(plan, view) == radius


# --- sections


@pytest.mark.judges("files")
def test_a_section_is_hatched_under_half_a_right_angle() -> None:
    """A web of 4 mm between rims of 10 mm and a hub of 14 mm: strokes 2.5 mm apart fill the area and nothing else."""
    parts = [(0.0, -20.0, 10.0, -15.0), (0.0, -15.0, 4.0, 15.0), (0.0, 15.0, 10.0, 20.0), (0.0, -3.0, 14.0, 3.0)]
    section = BodySection(shapely.union_all([shapely.box(*part) for part in parts]), 10.0, 14.0)
    found = list(section.lines(2.0, 30.0, 50.0))
    upright = [line.points for line in found if line.pen is Pen.VISIBLE and not line.closed]
    assert sorted(line.tolist() for line in upright) == [[[x, 10.0], [x, 90.0]] for x in (30.0, 50.0)]
    area = shapely.transform(section.area, lambda points: np.array([30.0, 50.0]) + 2.0 * points)
    edges = [Polygon(line.points) for line in found if line.closed]
    assert shapely.union_all(edges).symmetric_difference(area).area == pytest.approx(0.0, abs=1e-9)
    strokes = [line.points for line in found if line.pen is Pen.THIN]
    assert all(np.diff(line, axis=0)[0] @ [1.0, -1.0] == pytest.approx(0.0, abs=1e-9) for line in strokes)
    rows = np.unique(np.round([(line[0] @ [-1.0, 1.0]) / np.sqrt(2.0) for line in strokes], 6))
    assert np.diff(rows) == pytest.approx(np.full(rows.size - 1, HATCH_MM), abs=1e-5)
    assert sum(LineString(line).length for line in strokes) * HATCH_MM == pytest.approx(area.area, rel=0.03)
    assert area.buffer(1e-6).covers(shapely.union_all([LineString(line) for line in strokes]))


@pytest.mark.judges("files")
def test_a_body_is_cut_through_its_axis() -> None:
    """A plate with a bore, and a hub over it, which is smaller than the plate's first hole."""
    plate = Polygon([(-30.0, -20.0), (30.0, -20.0), (30.0, 25.0), (-30.0, 25.0)]).difference(shapely.box(-4, -4, 4, 4))
    hub = shapely.box(-9.0, -9.0, 9.0, 9.0).difference(shapely.box(-4.0, -4.0, 4.0, 4.0))
    slabs = [Made(section=plate, low_mm=0.0, high_mm=8.0), Made(section=hub, low_mm=8.0, high_mm=13.0)]
    found = section_of(Made(disc=plate, slabs=slabs, face_width_mm=8.0, height_mm=13.0))
    wanted = [(0.0, -20.0, 8.0, -4.0), (0.0, 4.0, 8.0, 25.0), (8.0, -9.0, 13.0, -4.0), (8.0, 4.0, 13.0, 9.0)]
    assert found.area.symmetric_difference(shapely.union_all([shapely.box(*one) for one in wanted])).area == 0.0
    assert (found.width_mm, found.height_mm) == (8.0, 13.0)


@pytest.mark.judges("files")
def test_a_sections_widths_stand_below_it() -> None:
    board, view = Board(WIDE), PaperView(2.0, (80.0, 90.0))
    section = BodySection(shapely.box(0.0, -20.0, 10.0, 15.0).union(shapely.box(0.0, -4.0, 14.0, 4.0)), 10.0, 14.0)
    gear_view._draw_section(board, section, view, 150.0)
    (axis,) = lines_of(board.items, Pen.CHAIN)
    assert axis.tolist() == [[148.0, 90.0], [180.0, 90.0]]
    (words,) = (item for item in board.items if isinstance(item, Text))
    assert words.place == (164.0, 124.0)
    sizes = [item for item in board.items if isinstance(item, Dimension)]
    assert [(one.value_mm, one.base.tolist()) for one in sizes] == [(10.0, [150.0, 44.0]), (14.0, [150.0, 37.5])]
    assert [one.ends[0].tolist() for one in sizes] == 2 * [[150.0, 50.0]]


@pytest.mark.judges("files")
def test_a_bore_with_a_keyway_is_two_arcs_and_three_sides() -> None:
    """Arcs bulge by the tangent of a quarter of their angle: all lie on the circle, and end at the keyway's sides."""
    shape: Any = bore_shape(Bore(20.0, Keyway(6.0, 2.8)))
    assert shape.points[:, 1].tolist() == [3.0, 0.0, -3.0, -3.0, 3.0]
    assert shape.points[3:, 0].tolist() == [12.8, 12.8]
    for (begin, end), bulge in zip(pairwise(shape.points[:3]), shape.bulges[:2], strict=True):
        assert np.hypot(*begin) == pytest.approx(10.0)
        chord = end - begin
        top = (begin + end) / 2.0 + bulge / 2.0 * np.array([chord[1], -chord[0]])
        assert np.hypot(*top) == pytest.approx(10.0)
        assert top[0] < 10.0 * cos(radians(60.0))
    assert shape.bulges[2:].tolist() == [0.0, 0.0, 0.0]
    assert bore_shape(Bore(20.0)).radius_mm == 10.0


@pytest.mark.judges("files")
@at_once("keyway", [None, Keyway(6.0, 2.8)])
def test_a_bores_sizes_are_beside_its_view(keyway: Any) -> None:
    """Room of 30 mm by 20 mm about it: 70 mm of 100 leave twice the size of 22.8 mm at a height of 70 mm."""
    with pytest.MonkeyPatch.context() as patch:
        patch.setattr(gear_tables, "bore_text", lambda drive, size: "H7")
        asked: list[Any] = []
        patch.setattr(gear_tables, "point_at_circle", lambda *given: asked.append(given))
        items = gear_tables._bore_view(Made(), Bore(20.0, keyway), Box(100.0, 50.0, 200.0, 120.0))
    ((_, view, (circle,), words, towards),) = asked
    reach = 12.8 if keyway else 10.0
    assert (view.scale, circle.radius_mm, words) == (2.0, 10.0, "\u00d820 H7")
    assert degrees(towards) == pytest.approx(80.0)
    assert next(item for item in items if isinstance(item, Text)).place == (101.0, 115.5)
    assert [hypot(*np.ptp(line, axis=0)) for line in lines_of(items, Pen.CHAIN)] == pytest.approx([48.0, 48.0])
    sizes = [item for item in items if isinstance(item, Dimension)]
    assert [one.value_mm for one in sizes] == pytest.approx([6.0, 10.0 + reach] if keyway else [])
    if keyway:
        wide, across = sizes
        assert wide.base == pytest.approx(view.on_paper(np.array([reach, -3.0])) + np.array([6.0, 0.0]))
        assert across.base == pytest.approx(view.on_paper(np.array([-10.0, 0.0])) - [0.0, 25.0])
        assert across.ends[0, 1] == across.ends[1, 1]
