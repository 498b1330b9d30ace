"""Contours of DXF files as programs write them: ends of lines, code pages, rounded numbers, blocks, layers, splines."""

from __future__ import annotations

from collections.abc import Callable
from functools import cache
from math import cos, dist, pi, sin
from pathlib import Path
from tempfile import TemporaryDirectory
from typing import Any

import ezdxf
import numpy as np
import pytest
from ezdxf.document import Drawing

from ncgear.design.reading.contour_file import contour_of
from ncgear.errors import WrongInput
from ncgear.figures.advice.machine_advice import drawing
from ncgear.ratio.laws.pitch_curve import closing_distance_mm
from test_pitch_curves import from_folder

HEAD = "holds no LINE, ARC, CIRCLE, ELLIPSE, SPLINE, LWPOLYLINE or POLYLINE"
PEG = [(30, 2), (22, 22), (0, 27), (-20, 20), (-27, 0), (-19, -21), (2, -26), (23, -19)]
HALVES = [(-8, -20, 1e-12), (12, -20, 1), (12, 20, -1e-12), (-8, 20, 1)]
OVAL_DEG = 54.3147


def made(add: Callable[[Any], object], version: str = "R2010") -> Drawing:
    document = ezdxf.new(version)
    add(document.modelspace())
    return document


def distance_mm(folder: Path, document: Drawing | None = None, layer: str = "") -> float:
    """The centre distance at which the contour's mate closes; no law is made for it."""
    if document is not None:
        document.saveas(folder / "contour.dxf")
    motion: Any = from_folder(folder, layer=layer).design.motion
    curve_of, _, _ = motion._curves("curve", 1)
    return closing_distance_mm(curve_of(1.0), 1, 1, "curve")


def circle(space: Any) -> None:
    space.add_circle((3.0, 0.0), 30.0, dxfattribs={"layer": "Straße"})


@cache
def drawn_mm(add: Callable[[Any], object]) -> float:
    """The centre distance of a shape alone in a file of this system."""
    with TemporaryDirectory() as folder:
        return distance_mm(Path(folder), made(add))


def ellipse(space: Any) -> None:
    space.add_ellipse((0, 0), (30, 0), 0.8)


def oval(space: Any, digits: int) -> None:
    """Arcs of radius 16 and 40 that touch, their numbers rounded."""
    for x, about in ((14.0, 0.0), (-14.0, 180.0)):
        space.add_arc((x, 0.0), 16.0, *(round((about + turn) % 360.0, digits) for turn in (-OVAL_DEG, OVAL_DEG)))
    for y, about in ((-19.4936, 90.0), (19.4936, 270.0)):
        half = 90.0 - OVAL_DEG
        space.add_arc((0.0, round(y, digits)), 40.0, round(about - half, digits), round(about + half, digits))


@pytest.mark.parametrize(
    ("add", "expected_mm"),
    [
        (lambda space: space.add_spline().set_closed([(x, y, 0) for x, y in PEG]), 51.334759),
        (lambda space: oval(space, 9), 50.090154),
        (lambda space: oval(space, 3), 50.0898),
        (lambda space: space.add_ellipse((3, 1), (30, 0), 0.8, 0.0, 6.28318), 54.047662),
        (lambda space: space.add_lwpolyline(HALVES, format="xyb", close=True), 51.732811),
        (lambda space: space.add_lwpolyline([HALVES[0], *HALVES], format="xyb", close=True), 51.732811),
    ],
    ids=["spline", "arcs", "arcs of three decimals", "ellipse to 6.28318", "bulges of nothing", "doubled vertex"],
)
def test_contours_of_other_programs_have_the_distances_that_were_found_elsewhere(
    tmp_path: Path, add: Callable[[Any], object], expected_mm: float
) -> None:
    """By a program of another hand, which integrated the polar curves; rounded numbers move them by their rounding."""
    assert distance_mm(tmp_path, made(add)) == pytest.approx(expected_mm, abs=2e-5 if expected_mm != 50.0898 else 1e-4)


@pytest.mark.parametrize("way", ["windows", "code page", "binary", "by number"])
def test_a_file_of_any_system_is_read(tmp_path: Path, way: str) -> None:
    expected, file = drawn_mm(circle), tmp_path / "contour.dxf"
    old = made(circle, "R2000")
    if way == "windows":
        made(circle).saveas(file)
        file.write_bytes(file.read_bytes().replace(b"\n", b"\r\n"))
    elif way == "binary":
        old.saveas(file, fmt="bin")
    else:
        old.saveas(file)
        assert b"Stra\xdfe" in file.read_bytes()
    if way == "by number":
        file.write_bytes(file.read_bytes().replace(b"Stra\xdfe", b"Stra\\U+00DFe"))
    assert distance_mm(tmp_path) == expected
    assert distance_mm(tmp_path, layer="STRASSE") == expected


def splined(space: Any) -> None:
    """A polyline of R12 that is smoothed, with its control points among its vertices."""
    line = space.add_polyline2d([ellipse_at(number / 90.0)[:2] for number in range(90)], close=True)
    line.append_vertices([(99.0, 99.0), (98.0, 98.0)])
    for vertex in line.vertices[-2:]:
        vertex.dxf.flags = 16


def ellipse_at(turn: float) -> tuple[float, float, float]:
    return 30.0 * cos(2.0 * pi * turn), 24.0 * sin(2.0 * pi * turn), 0.0


def through(space: Any) -> None:
    """A closed spline that has its fit points alone."""
    spline = space.add_spline([ellipse_at(number / 64.0) for number in range(64)])
    spline.closed = True


def weightless(space: Any) -> None:
    spline = space.add_spline()
    spline.set_closed([(x, y, 0) for x, y in PEG])
    spline.weights = [-1.0] * len(spline.control_points)


def in_a_block(space: Any) -> None:
    inner = space.doc.blocks.new("inner")
    inner.add_circle((0.0, 0.0), 30.0)
    space.doc.blocks.new("outer").add_blockref("inner", (0.0, 0.0))
    space.add_blockref("outer", (3.0, 1.0), dxfattribs={"yscale": 0.8})


def beside_what_is_off(space: Any) -> None:
    circle(space)
    for name, hide in (("off", lambda layer: layer.off()), ("frozen", lambda layer: layer.freeze())):
        hide(space.doc.layers.add(name))
        space.add_line((0, 0), (5, 5), dxfattribs={"layer": name})
    space.add_solid([(0, 0), (1, 0), (0, 1)])


def beside_what_is_not_plotted(space: Any) -> None:
    circle(space)
    space.doc.layers.add("construction").dxf.plot = 0
    for name in ("construction", "DEFPOINTS"):
        space.add_line((0, 0), (5, 5), dxfattribs={"layer": name})


def twice(space: Any) -> None:
    """The sides and ends of a slot, each drawn twice, the sides in both senses."""
    for x, y in ((-8.0, -20.0), (12.0, 20.0)):
        for end in ((-x + 4.0, y), (x, y)):
            space.add_line(end, (4.0 - end[0], y))
        space.add_arc((4.0 - x, 0.0), 20.0, *((270.0, 90.0) if x < 0.0 else (90.0, 270.0)))
        space.add_arc((4.0 - x, 0.0), 20.0, *((270.0, 90.0) if x < 0.0 else (90.0, 270.0)))


@pytest.mark.parametrize(
    ("add", "version", "expected_mm", "within"),
    [
        (splined, "R12", None, 5e-2),
        (through, "R2010", None, 1e-5),
        (weightless, "R2010", 51.334759, 1e-6),
        (in_a_block, "R2010", 54.047662, 1e-6),
        (beside_what_is_off, "R2010", 60.149534, 1e-6),
        (beside_what_is_not_plotted, "R2010", 60.149534, 1e-6),
        (twice, "R2010", 51.732811, 1e-6),
    ],
    ids=[
        "R12",
        "fit points",
        "weights of -1",
        "blocks",
        "layers that are off",
        "layers that are not plotted",
        "drawn twice",
    ],
)
def test_what_programs_do_with_curves_is_undone(
    tmp_path: Path, add: Callable[[Any], object], version: str, expected_mm: float | None, within: float
) -> None:
    if expected_mm is None:
        expected_mm = drawn_mm(ellipse)
    assert distance_mm(tmp_path, made(add, version)) == pytest.approx(expected_mm, abs=within)


def test_a_gap_that_no_rounding_explains_is_open(tmp_path: Path) -> None:
    """A hundredth of a millimetre between coordinates of four decimals."""

    def gaping(space: Any) -> None:
        oval(space, 4)
        next(iter(space)).dxf.center = (14.0123, 0.0)

    with pytest.raises(WrongInput, match="the contour is open: it ends at"):
        distance_mm(tmp_path, made(gaping))


def on_layers(space: Any) -> None:
    for name, radius in (("A", 30.0), ("B", 5.0)):
        space.add_circle((3.0, 0.0), radius, dxfattribs={"layer": name})
    space.add_line((0, 0), (1, 1), dxfattribs={"layer": "C"})


def hidden(space: Any) -> None:
    space.doc.layers.add("off").off()
    space.add_circle((0, 0), 30.0, dxfattribs={"layer": "off"})


@pytest.mark.parametrize(
    ("add", "said"),
    [
        (on_layers, "layers that hold one closed contour are A and B"),
        (hidden, f"{HEAD}; layers with such parts are off, frozen or not plotted: 'off'; switch them on"),
        (lambda space: space.doc.layout().add_circle((0, 0), 30.0), f"{HEAD}; such parts are in its paper space only"),
        (lambda space: space.add_solid([(0, 0), (1, 0), (0, 1)]), f"{HEAD}; it has SOLID only"),
    ],
    ids=["several layers", "layer off", "paper space", "solid"],
)
def test_a_drawing_without_a_contour_says_where_one_is(tmp_path: Path, add: Callable[[Any], object], said: str) -> None:
    with pytest.raises(WrongInput) as refused:
        distance_mm(tmp_path, made(add))
    assert said in str(refused.value)


@pytest.mark.parametrize(
    ("content", "said"),
    [
        (b"AC1032\x00\x00", "is a DWG file, which is not read; save it as DXF"),
        (b"<svg>" + b"x" * 7000, "it begins with '<svg>"),
        (None, "has no EOF at its end: it is cut off"),
    ],
    ids=["DWG", "SVG", "cut off"],
)
def test_a_file_that_is_something_else_says_what_it_is(tmp_path: Path, content: bytes | None, said: str) -> None:
    file = tmp_path / "contour.dxf"
    if content is None:
        made(circle).saveas(file)
        content = file.read_bytes()[: file.read_bytes().rindex(b"  0\nEOF")]
    file.write_bytes(content)
    with pytest.raises(WrongInput) as refused:
        from_folder(tmp_path)
    assert said in str(refused.value)
    assert len(str(refused.value)) < 400


@pytest.mark.parametrize("binary", [False, True], ids=["ASCII", "binary"])
def test_a_file_that_is_cut_off_anywhere_is_refused(tmp_path: Path, binary: bool) -> None:
    file = tmp_path / "contour.dxf"
    made(circle).saveas(file, fmt="bin" if binary else "asc")
    content = file.read_bytes()
    for share in np.linspace(0.01, 0.999, 40):
        file.write_bytes(content[: int(share * len(content))])
        with pytest.raises(WrongInput):
            contour_of(file, {})


def test_another_unit_and_a_gap_are_remarked_and_cost_no_clean_verdict(tmp_path: Path) -> None:
    document = made(lambda space: oval(space, 3))
    document.units = ezdxf.units.IN
    distance_mm(tmp_path, document)
    unit, gap = drawing(from_folder(tmp_path))
    assert not unit.matters
    assert not gap.matters
    assert "taken as about 60 by 41 mm; in inch it would be 1524 by 1042 mm" in unit.what
    assert "miss each other by up to 0.00035 mm" in gap.what
    document = made(circle)
    document.units = ezdxf.units.MM
    distance_mm(tmp_path, document)
    assert not list(drawing(from_folder(tmp_path)))


SIDES = 30
"""Chords of an ellipse that is drawn more than once."""


def corners() -> list[tuple[float, float]]:
    return [ellipse_at(number / SIDES)[:2] for number in range(SIDES)]


def there_and_back(space: Any) -> None:
    """A closed polyline, and over it the same one from another place in the other sense, and a part of it."""
    points = corners()
    space.add_lwpolyline(points, close=True)
    space.add_lwpolyline([*points[13::-1], *points[:13:-1]], close=True)
    space.add_lwpolyline(points[6:10])


def over_halves(space: Any) -> None:
    """A closed polyline, and two open ones over it that overlap each other and so make no contour."""
    points = corners()
    space.add_lwpolyline(points[:20])
    space.add_lwpolyline([*points[13:], *points[:3]])
    space.add_lwpolyline(points, close=True)


def ellipse_of_chords(space: Any) -> None:
    space.add_lwpolyline(corners(), close=True)


def edges_mm(*numbers: int) -> float:
    """Length of chords of the ellipse."""
    return sum(dist(ellipse_at(i / SIDES), ellipse_at((i + 1) / SIDES)) for i in numbers)


def a_circle_over_arcs(space: Any) -> None:
    for start in (0.0, 90.0, 180.0, 270.0):
        space.add_arc((3.0, 0.0), 30.0, start, start + 90.0)
    space.add_circle((3.0, 0.0), 30.0)


@pytest.mark.parametrize(
    ("add", "alone", "doubled_mm"),
    [
        (twice, None, 2 * 20.0 + 2 * 20.0 * pi),
        (there_and_back, ellipse_of_chords, edges_mm(*range(SIDES), *range(6, 9))),
        (over_halves, ellipse_of_chords, edges_mm(*range(19), *range(13, 32))),
        (a_circle_over_arcs, circle, 2.0 * pi * 30.0),
    ],
    ids=["entities", "polylines", "halves", "circle over arcs"],
)
def test_what_is_drawn_twice_counts_once_and_is_remarked(
    tmp_path: Path, add: Callable[[Any], object], alone: Callable[[Any], object] | None, doubled_mm: float
) -> None:
    """The remark has the length that lies over other parts, in closed form."""
    made(add).saveas(tmp_path / "contour.dxf")
    drive = from_folder(tmp_path)
    assert drive.law.facts["contour_doubled_mm"] == pytest.approx(doubled_mm, rel=1e-5)
    (remark,) = (one for one in drawing(drive) if "drawn twice" in one.what)
    assert not remark.matters
    wanted = 51.732811 if alone is None else drawn_mm(alone)
    assert drive.law.center_distance_mm == pytest.approx(wanted, abs=1e-6)


def test_a_line_close_beside_another_is_not_drawn_twice(tmp_path: Path) -> None:
    """A slot beside which a second one is drawn, a thousandth of its size away, is no single contour."""
    beside = [(x + 0.04, y, bulge) for x, y, bulge in HALVES]

    def both(space: Any) -> None:
        for points in (HALVES, beside):
            space.add_lwpolyline(points, format="xyb", close=True)

    with pytest.raises(WrongInput, match="further parts beside a closed contour"):
        distance_mm(tmp_path, made(both))


def chords(count: int) -> Callable[[Any], object]:
    points = [ellipse_at(number / count)[:2] for number in range(count)]
    return lambda space: space.add_lwpolyline(points, close=True)


@pytest.mark.slow
def test_many_chords_are_smoothed_within_the_tolerance_that_is_asked_for(tmp_path: Path) -> None:
    expected = drawn_mm(ellipse)
    with pytest.raises(WrongInput, match="has 2000 chords, and no teeth roll over their corners; give"):
        distance_mm(tmp_path, made(chords(2000)))
    drive = from_folder(tmp_path, more=", tolerance_mm: 0.005")
    assert drive.law.center_distance_mm == pytest.approx(expected, abs=0.005)
    assert 0.0 < drive.law.facts["points_missed_by_mm"] <= 0.005


def test_arcs_are_smoothed_with_their_neighbours(tmp_path: Path) -> None:
    """The oval's curvature jumps; a smooth curve near it has the same distance to the tolerance."""
    expected = distance_mm(tmp_path, made(lambda space: oval(space, 9)))
    assert from_folder(tmp_path, more=", tolerance_mm: 0.02").law.center_distance_mm == pytest.approx(
        expected, abs=0.02
    )


def stadium(space: Any) -> None:
    space.add_line((25, 25), (-25, 25))
    space.add_arc((-25, 0), 25, 90, 270)
    space.add_line((-25, -25), (25, -25))
    space.add_arc((25, 0), 25, 270, 90)


@pytest.mark.parametrize("tolerance_mm", [0.005, 0.2])
def test_a_smooth_curve_is_held_to_straight_parts_as_to_corners(tmp_path: Path, tolerance_mm: float) -> None:
    """75.45 and 76.23 where only their ends were held; the distance itself is that of the contour as it is drawn."""
    expected = distance_mm(tmp_path, made(stadium))
    smooth = from_folder(tmp_path, more=f", tolerance_mm: {tolerance_mm}").law.center_distance_mm
    assert smooth == pytest.approx(expected, abs=tolerance_mm)


def rows(space: Any) -> None:
    space.doc.blocks.new("A").add_circle((0.0, 0.0), 30.0)
    space.add_blockref("A", (3.0, 0.0)).grid((1, 2), (0.0, 100.0))


def bomb(space: Any) -> None:
    """Five blocks, each with ten of the one before: 100 000 circles."""
    space.doc.blocks.new("0").add_circle((0.0, 0.0), 30.0)
    for depth in range(1, 6):
        block = space.doc.blocks.new(str(depth))
        for place in range(10):
            block.add_blockref(str(depth - 1), (place * 10.0**depth, 0.0))
    space.add_blockref("5", (0.0, 0.0))


def test_a_block_that_holds_itself_is_named(tmp_path: Path) -> None:
    """At once, and by another block; blocks beside each other may be the same."""

    def ring(space: Any) -> None:
        space.doc.blocks.new("INNER").add_blockref("outer", (1.0, 0.0))
        space.doc.blocks.new("OUTER").add_blockref("inner", (0.0, 0.0))
        space.add_blockref("OUTER", (0.0, 0.0))

    with pytest.raises(WrongInput, match="block 'outer' holds itself; explode it in the drawing"):
        distance_mm(tmp_path, made(ring))


@pytest.mark.slow
@pytest.mark.parametrize(
    ("add", "said"), [(rows, "1 further part beside a closed contour"), (bomb, "holds 100000 lines.*at most 2000")]
)
def test_every_copy_of_a_block_counts_and_too_many_are_refused(
    tmp_path: Path, add: Callable[[Any], object], said: str
) -> None:
    with pytest.raises(WrongInput, match=said):
        distance_mm(tmp_path, made(add))


def test_layer_0_of_a_block_is_the_layer_on_which_it_is_put(tmp_path: Path) -> None:
    def put(space: Any) -> None:
        space.doc.blocks.new("A").add_circle((0.0, 0.0), 30.0)
        space.add_blockref("A", (3.0, 0.0), dxfattribs={"layer": "TEETH"})
        space.doc.layers.add("off").off()
        space.add_blockref("A", (3.0, 0.0), dxfattribs={"layer": "off"})

    distance_mm(tmp_path, made(put))
    assert from_folder(tmp_path, layer="TEETH").law.center_distance_mm == pytest.approx(60.1495338, abs=1e-6)


def test_parts_of_no_length_and_a_mark_of_utf_8_are_passed_over(tmp_path: Path) -> None:
    def beside(space: Any) -> None:
        circle(space)
        space.add_lwpolyline([(1, 1), (1, 1)])
        space.add_arc((1, 1), 1e-12, 0, 90)

    expected = distance_mm(tmp_path, made(beside))
    assert expected == pytest.approx(60.1495338, abs=1e-6)
    file = tmp_path / "contour.dxf"
    file.write_bytes(b"\xef\xbb\xbf" + file.read_bytes())
    assert distance_mm(tmp_path) == expected


@pytest.mark.parametrize(("heights", "flat"), [((5.0, 5.0), True), ((-5.0, -5.0), True), ((-1.0, 1.0), False)])
def test_a_flat_contour_may_lie_at_any_height(tmp_path: Path, heights: tuple[float, float], flat: bool) -> None:
    corners = [(30, 2), (22, 22), (0, 27), (-20, 20), (-27, 0), (-19, -21), (2, -26), (23, -19)]
    places = [(x, y, heights[number % 2]) for number, (x, y) in enumerate(corners)]
    add = made(lambda space: space.add_spline().set_closed(places))
    if flat:
        assert distance_mm(tmp_path, add) == pytest.approx(51.334759, abs=2e-5)
    else:
        with pytest.raises(WrongInput, match="leaves the plane"):
            distance_mm(tmp_path, add)
