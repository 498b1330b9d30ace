"""Pictures on a few numbers that are done by hand: places of bodies, room, palettes, charts, key frames."""

from __future__ import annotations

from math import pi, sqrt
from types import SimpleNamespace
from typing import Any

import matplotlib.colors
import numpy as np
import pytest
from PIL import Image
from shapely.geometry import Polygon

from ncgear.drawings import train_pictures
from ncgear.drawings.animation import packing
from ncgear.drawings.animation.artists import PURE, tinted
from ncgear.drawings.charts import drawer, teeth_charts
from ncgear.drawings.charts.chart import Chart, ChartLine, Role
from ncgear.drawings.notebook.pieces import _keyframes
from ncgear.drawings.page import page_charts
from ncgear.drawings.page.chart_figure import DIGITS, PageChart, shaft_of
from ncgear.drawings.page.motion_charts import SIDE_RAD, split_angles
from ncgear.drawings.scene.bodies import output_shape
from ncgear.drawings.scene.geared_pairs import mountings
from ncgear.drawings.scene.standing import SUPPORT, SUPPORT_HATCHES, support_hatches_mm
from ncgear.mechanisms.mechanism import LinkShape
from ncgear.pitch.shape import Gear, Mesh
from ncgear.project.tooth_form import driving_axes_rad
from ncgear.strength.holding import Damage
from ncgear.trains.train import MARGIN, Part, Poses, Train

Made: Any = SimpleNamespace

SQUARE = np.array([[-2.0, -1.0], [2.0, -1.0], [2.0, 1.0], [-2.0, 1.0]])


@pytest.mark.judges("drawings")
def test_pairs_in_series_stand_where_their_directions_lead_from_the_crank() -> None:
    """50 mm to the right of the crank at 30 deg, then 20 mm upwards; outer gears turn the sense round."""
    first, last = mountings([Mesh.INTERNAL, Mesh.EXTERNAL], [20.0, 50.0], [pi / 2.0, pi / 6.0])
    middle = 50.0 * np.array([sqrt(3.0) / 2.0, 0.5])
    assert last.driving_axis_mm == pytest.approx(middle)
    assert first.driving_axis_mm == pytest.approx(middle + np.array([0.0, 20.0]))
    assert (last.axis_mm(Gear.DRIVEN), first.axis_mm(Gear.DRIVEN)) == (
        pytest.approx((0.0, 0.0), abs=1e-9),
        pytest.approx(middle),
    )
    assert last.on_centres_mm(np.array([10.0])) == pytest.approx(np.array([0.8 * middle]))
    assert [one.turn_rad for one in (first, last)] == pytest.approx([-pi / 2.0, -5.0 * pi / 6.0])
    assert last.sense(Gear.DRIVEN) == -last.sense(Gear.DRIVING)
    assert first.sense(Gear.DRIVEN) == first.sense(Gear.DRIVING) == last.sense(Gear.DRIVING)


@pytest.mark.judges("drawings")
@pytest.mark.parametrize(("count", "hand"), [(3, 1.0), (2, -1.0)])
def test_a_row_of_an_even_number_of_pairs_is_seen_from_behind(count: int, hand: float) -> None:
    turned = [0.5, 0.2, 0.9][:count]
    gears: Any = Made(driving_axis_deg=180.0, idlers=Made(directions_rad=turned))
    assert driving_axes_rad(gears, count) == pytest.approx([pi + hand * (one - turned[-1]) for one in turned])
    gears.idlers = None
    assert driving_axes_rad(gears, count) == [pi] * count


@pytest.mark.judges("drawings")
def test_strokes_under_a_support_and_along_a_guide_slant_out_of_the_frame() -> None:
    """A crank of 50 mm: a support has 6 strokes below its foot, a guide of 200 mm has 24, at its even steps."""
    linkage: Any = Made(crank_mm=50.0, pivots_mm={"crank": (10.0, 20.0)}, guides_mm=[((300.0, -5.0), (100.0, -5.0))])
    strokes = support_hatches_mm(linkage)
    size = SUPPORT * 50.0
    assert len(strokes) == SUPPORT_HATCHES + 4 * SUPPORT_HATCHES
    of_support, of_guide = strokes[:SUPPORT_HATCHES], strokes[SUPPORT_HATCHES:]
    assert of_support[:, 0, 1] == pytest.approx(np.full(6, 20.0 - size))
    assert of_support[:, 0, 0] == pytest.approx(10.0 + 1.4 * size * (1.0 - np.arange(1, 7) / 3.0))
    assert of_guide[:, 0, 0] == pytest.approx(300.0 - 200.0 * np.arange(1, 25) / 24.0)
    assert strokes[:, 1] - strokes[:, 0] == pytest.approx(np.tile([0.4 * size, -0.4 * size], (30, 1)))


@pytest.mark.judges("drawings")
def test_a_piston_is_as_high_as_its_chamber() -> None:
    linkage: Any = Made(shapes=dict, OUTPUT=Made(name="slider"))
    (piston,) = output_shape(linkage, Made(face_mm=30.0, height_mm=80.0))
    assert Polygon(piston).bounds == (-30.0, -40.0, 30.0, 40.0)
    linkage = Made(
        crank_mm=40.0,
        OUTPUT=Made(name="slider"),
        shapes=lambda: {"slider": LinkShape(bars=(((0.0, 0.0), (90.0, 0.0)),))},
    )
    (both,) = output_shape(linkage, Made(face_mm=30.0, height_mm=80.0))
    assert Polygon(both).bounds[:2] == pytest.approx((-30.0, -40.0))
    assert Polygon(both).bounds[2] > 90.0 - 1e-9


# --- pictures of trains


@pytest.mark.judges("drawings")
def test_a_picture_of_a_train_has_room_for_all_parts_over_a_cycle() -> None:
    """A bar of 4 mm by 2 mm on an axis that goes from 0 to 10 mm while it turns by a quarter."""
    share = np.linspace(0.0, 1.0, 61)
    poses = Poses(np.array([10.0 * share]), np.zeros((1, 61)), np.array([pi / 2.0 * share]))
    train: Any = Made(cycle_rad=2.0, parts=(Part("bar", SQUARE, 1.0),), poses_at=lambda _: poses)
    low, high = Train.room_mm(train)
    margin = MARGIN * (11.0 + 2.0)
    assert low == pytest.approx([-2.0 - margin, high[1] * -1.0], abs=0.1)
    assert high[0] - 11.0 == pytest.approx(margin, abs=0.4)
    assert high[1] > sqrt(5.0) - 0.1


@pytest.mark.judges("drawings")
def test_a_drawn_part_is_where_its_pose_has_it() -> None:
    areas, lines = list[Any](), list[Any]()
    axes: Any = Made(add_artist=areas.append, plot=lambda *given, **_: lines.append(given))
    poses = Poses(np.array([[5.0]]), np.array([[7.0]]), np.array([[pi / 2.0]]))
    part = Part("ring", SQUARE, 1.0, teeth=4, rim_mm=3.0)
    train_pictures._draw(axes, part, SQUARE, poses, 0, "red")
    outline, circle, mark = lines
    assert not areas
    assert (outline[0][:-1], outline[1][:-1]) == (
        pytest.approx([6.0, 6.0, 4.0, 4.0]),
        pytest.approx([5.0, 9.0, 9.0, 5.0]),
    )
    assert (outline[0][0], outline[0][-1], outline[0].size) == (6.0, 6.0, 5)
    assert np.hypot(circle[0] - 5.0, circle[1] - 7.0) == pytest.approx(np.full(181, sqrt(5.0) + 3.0))
    assert (circle[0][0], circle[1][45]) == pytest.approx((5.0 + sqrt(5.0) + 3.0, 7.0 + sqrt(5.0) + 3.0))
    assert (mark[0], mark[1]) == (5.0, 7.0)
    train_pictures._draw(axes, Part("sun", SQUARE, 1.0, teeth=4), SQUARE, poses, 0, "red")
    (area,) = areas
    assert area.get_xy()[:-1] == pytest.approx(np.column_stack([outline[0], outline[1]])[:-1])
    assert area.get_facecolor() == (1.0, 0.0, 0.0, 0.35)


# --- animations


@pytest.mark.judges("drawings")
def test_a_palette_has_white_paper_and_the_pure_colours_of_lines() -> None:
    """Frames of two colours, of which one is nearly white."""
    frame = np.zeros((32, 32, 3), dtype=np.uint8)
    frame[:, :16], frame[:, 16:] = (250, 251, 252), (200, 30, 40)
    palette = np.array(packing.palette_found(lambda count: iter([frame] * count)).getpalette()).reshape(-1, 3)
    pure = np.round([[255.0 * part for part in matplotlib.colors.to_rgb(color)] for color in PURE])
    assert palette[-len(PURE) :].tolist() == pure.tolist()
    found = {tuple(color) for color in palette[: -len(PURE)].tolist()}
    assert (255, 255, 255) in found
    assert (200, 30, 40) in found
    assert (250, 251, 252) not in found


@pytest.mark.judges("drawings")
def test_a_tint_is_a_share_of_the_colour_on_white() -> None:
    assert tinted("#000000", 0.25) == pytest.approx((0.75, 0.75, 0.75))
    assert tinted("#ff0000", 0.25) == pytest.approx((1.0, 0.75, 0.75))


@pytest.mark.judges("drawings")
def test_frames_of_a_gif_are_shown_for_whole_ticks() -> None:
    loop = packing.Loop(frames=7, seconds=1.0, width_px=10)
    assert sum(loop.durations_ms) == 1000
    assert set(loop.durations_ms) == {140, 150}
    images = [Image.new("P", (2, 2), color=number) for number in range(3)]
    for image in images:
        image.putpalette([0, 0, 0, 255, 0, 0, 0, 255, 0])
    with Image.open(packing.BytesIO(packing.gif_bytes(images, packing.Loop(3, 0.6, 2)))) as found:
        assert (found.n_frames, found.info["duration"], found.info["loop"]) == (3, 200, 0)


@pytest.mark.judges("drawings")
def test_an_mp4_shows_its_frames_in_its_seconds(monkeypatch: pytest.MonkeyPatch) -> None:
    told: dict[str, Any] = {}

    def write(path: str, size: tuple[int, int], **form: Any) -> Any:
        told.update(form, size=size)
        with open(path, "wb") as file:
            while (data := (yield)) is not None:
                file.write(data)

    monkeypatch.setitem(__import__("sys").modules, "imageio_ffmpeg", Made(write_frames=write))
    images = [Image.new("RGB", (2, 2), color=(number, 0, 0)) for number in range(4)]
    found = packing.mp4_bytes(images, packing.Loop(4, 0.5, 2))
    assert (told["fps"], told["size"]) == (8.0, (2, 2))
    assert [found[12 * number] for number in range(4)] == [0, 1, 2, 3]


@pytest.mark.judges("drawings")
def test_key_frames_are_at_even_shares_of_the_loop() -> None:
    assert _keyframes("x", ["a", "b", "c"]) == "@keyframes x{0%{transform:a}50%{transform:b}100%{transform:c}}"
    assert _keyframes("x", ["a"] * 5) == "@keyframes x{0%{transform:a}100%{transform:a}}"


# --- charts


@pytest.mark.judges("drawings")
def test_stages_are_driven_by_the_first_shaft_and_those_between() -> None:
    assert [shaft_of(stage) for stage in (1, 2, 3, 4)] == ["driving", "between", "between-2", "between-3"]


@pytest.mark.judges("drawings")
def test_all_lines_have_the_decimals_of_the_largest_value() -> None:
    def decimals(*values: float) -> int:
        lines = [ChartLine(Role.OWN, "x", np.array([0.0, 1.0]), np.array([0.0, value])) for value in values]
        return PageChart("x", Chart("x", "mm", tuple(lines), 360.0)).decimals

    assert decimals(0.01, -123.4) == decimals(123.4) == max(DIGITS - 3, 0)
    assert decimals(0.01, 0.02) > decimals(123.4)


@pytest.mark.judges("drawings")
def test_angles_of_a_page_have_one_on_each_side_of_a_jump() -> None:
    end = 2.0
    for jump, counts in ((1.0, True), (0.5 * SIDE_RAD, False), (end - 0.5 * SIDE_RAD, False), (end + 1.0, False)):
        angles = split_angles(end, [jump, jump])
        assert (np.diff(angles) > 0.0).all()
        assert (angles[0], angles[-1]) == (0.0, end)
        beside = [np.isclose(angles, jump + side, rtol=0.0, atol=1e-12).any() for side in (-SIDE_RAD, SIDE_RAD)]
        assert all(beside) is counts
        assert not (angles > end).any()
    close = split_angles(end, [1.0, 1.0 + SIDE_RAD])
    assert (np.diff(close) > 0.0).all()


@pytest.mark.judges("drawings")
def test_the_chart_of_a_ratio_is_the_inverse_of_the_laws_slope(monkeypatch: pytest.MonkeyPatch) -> None:
    """A slope of 1 - sin(phi1) / 2 has its extremes 2/3 and 2 at 3 pi/2 and pi/2."""
    monkeypatch.setattr(page_charts, "joints_up_to", lambda law, end: np.array([1.0]))
    law: Any = Made(
        ratio_range=(Made(at=1.5 * pi), Made(at=0.5 * pi)),
        driven_angle=lambda angle, order: Made(derivative=lambda _: 1.0 - 0.5 * np.sin(angle)),
    )
    chart = page_charts.ratio_chart(law, 2.0 * pi)
    (line,) = chart.lines
    assert (line.values.min(), line.values.max()) == pytest.approx((2.0 / 3.0, 2.0), abs=1e-12)
    assert line.x[[line.values.argmin(), line.values.argmax()]] == pytest.approx([270.0, 90.0])
    assert (chart.end, chart.joints_deg) == (360.0, pytest.approx([180.0 / pi]))


@pytest.mark.judges("drawings")
def test_one_line_shows_the_stress_that_both_gears_endure() -> None:
    strength: Any = Made(end_rad=pi)

    def limits(driving: float, driven: float) -> Any:
        found = [
            Made(gear=gear, damage=damage, endured_mpa=value)
            for gear, value in ((Gear.DRIVING, driving), (Gear.DRIVEN, driven))
            for damage, value in ((Damage.CONTACT, value), (Damage.BENDING, 1.0))
        ]
        return teeth_charts._limits(strength, found, Damage.CONTACT)

    (line,) = limits(500.0, 500.0 * (1.0 + 0.9 * teeth_charts.SAME_LIMIT))
    assert (line.x, line.values) == (pytest.approx([0.0, 180.0]), pytest.approx([500.0, 500.0]))
    assert limits(500.0 * (1.0 + 0.9 * teeth_charts.SAME_LIMIT), 500.0)[0].values == pytest.approx([500.0, 500.0])
    assert [line.values[0] for line in limits(500.0, 600.0)] == [500.0, 600.0]


@pytest.mark.judges("drawings")
@pytest.mark.parametrize("across", [drawer.DRIVING_ANGLE, "speed in r/min"])
def test_a_column_of_charts_grows_by_a_row_for_each(across: str, monkeypatch: pytest.MonkeyPatch) -> None:
    told: list[Any] = []
    monkeypatch.setattr(drawer.canvas, "png", lambda made: told.append(tuple(made.get_size_inches())) or b"")
    monkeypatch.setattr(drawer, "draw", lambda axes, chart, look: told.append(chart))
    monkeypatch.setattr(drawer, "align", lambda *_: None)
    for name in ("angle_scale", "across_scale"):
        monkeypatch.setattr(drawer, name, lambda column, end, *_, name=name: told.append((name, len(column), end)))
    chart: Any = Made(across=across, end=360.0)
    sizes = drawer.ColumnSizes(row_in=1.5, rest_in=1.3, left_in=1.0, gap=0.1)
    drawer.column_png([chart] * 3, "x", Made(), sizes)
    scale = "angle_scale" if across == drawer.DRIVING_ANGLE else "across_scale"
    assert told == [chart] * 3 + [(scale, 3, 360.0), pytest.approx((drawer.COLUMN_IN, 5.8))]
