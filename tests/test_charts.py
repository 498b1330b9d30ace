"""One value for a chart: whoever draws it draws the same values."""

from __future__ import annotations

import re

import numpy as np
import pytest
from matplotlib.backends.backend_agg import FigureCanvasAgg
from matplotlib.figure import Figure
from matplotlib.font_manager import findfont
from matplotlib.path import Path
from matplotlib.transforms import Bbox
from PIL import ImageFont

import drives
import ncgear.plots
import reports
from at_once import at_once
from ncgear.drawings.animation.moving_picture import CHART_LOOK
from ncgear.drawings.charts.chart import Chart, ChartLine, Quantity, Role, over_displacement
from ncgear.drawings.charts.drawer import MOTION_LOOK, Look, draw
from ncgear.drawings.page.chart_figure import PageChart
from ncgear.drawings.page.chart_svg import OF_REPORT, PAGE_LOOK, TEXT_SIZE, Size, drawn
from ncgear.drawings.page.motion_charts import motion_charts
from ncgear.drawings.pictures import slider_chart
from ncgear.drawings.plots.canvas import JOINT
from ncgear.figures.simulated import rigid_figures
from ncgear.files.balance import spread
from ncgear.files.simulation import drawn_angles_rad, driving_torque, joint_forces, mesh_forces
from ncgear.studio.told import CHART

JOINTS = np.array([90.0, 180.0])


def ramp(period: float | None = None, joints: np.ndarray = JOINTS) -> Chart:
    x = np.array([0.0, 90.0, 180.0])
    lines = (ChartLine(Role.OWN, "own", x, np.array([0.0, 1500.0, -2000.0])),)
    return Chart("force", "N", lines, 360.0, period, joints, names_extreme=True)


@pytest.mark.parametrize("look", [MOTION_LOOK, PAGE_LOOK, CHART_LOOK], ids=["picture", "page", "moving picture"])
def test_every_look_draws_the_values_of_the_chart(look: Look) -> None:
    axes = Figure().subplots()
    draw(axes, ramp(), look)
    assert axes.lines[0].get_xdata() == pytest.approx([0.0, 90.0, 180.0])
    assert axes.lines[0].get_ydata() == pytest.approx([0.0, 1500.0, -2000.0])
    marked = [text.get_text() for text in axes.texts]
    assert marked == (["\u22122000 N at 180\u00b0"] if look.marks_extremes else [])


def test_a_line_is_repeated_over_a_longer_chart() -> None:
    axes = Figure().subplots()
    draw(axes, ramp(period=180.0), MOTION_LOOK)
    assert axes.lines[0].get_xdata() == pytest.approx([0.0, 90.0, 180.0, 180.0, 270.0, 360.0])
    assert axes.lines[0].get_ydata() == pytest.approx([0.0, 1500.0, -2000.0, 0.0, 1500.0, -2000.0])


@pytest.mark.parametrize(("count", "drawn"), [(12, 12), (13, 0)])
def test_more_joints_than_can_be_told_apart_are_not_marked(count: int, drawn: int) -> None:
    axes = Figure().subplots()
    draw(axes, ramp(joints=np.linspace(10.0, 350.0, count)), MOTION_LOOK)
    assert sum(line.get_color() == JOINT for line in axes.lines) == drawn


def test_the_notebook_and_the_page_draw_the_same_power() -> None:
    """At the table's angles the page's own, closer samples give the notebook's values."""
    drive = drives.drive("baler")
    notebook = ncgear.plots.power(drive, Figure().subplots()).lines[0]
    (page,) = (one.chart for one in reports.motion("baler") if one.key == "power_w")
    between = np.interp(notebook.get_xdata(), page.own.x, page.own.values)
    assert np.abs(between - notebook.get_ydata()).max() < 1e-3 * np.abs(page.own.values).max()


def test_over_the_displacement_the_values_stay() -> None:
    drive = drives.drive("baler")
    chart, motions = slider_chart(drive, Quantity.POWER), drive.drawn_motions
    across = over_displacement(chart, drive.linkage.OUTPUT, motions)
    assert (across.across, across.names_extreme, across.joints_deg.size) == ("displacement in mm", False, 0)
    for line, before, motion in zip(across.lines, chart.lines, motions, strict=True):
        np.testing.assert_array_equal(line.values, before.values)
        np.testing.assert_array_equal(line.x, motion.displacement)


@pytest.mark.thorough
def test_an_extreme_that_rounds_to_zero_has_no_sign() -> None:
    x = np.array([0.0, 120.0, 240.0, 360.0])
    chart = Chart("ratio", "", (ChartLine(Role.OWN, "own", x, np.array([-2e-4, 1.5, 0.7, -3e-5])),), 360.0)
    assert drawn(PageChart("k", chart)).extremes == "0.000 at 0\u00b0 to 1.500 at 120\u00b0"
    below = Chart("ratio", "", (ChartLine(Role.OWN, "own", x, np.array([-0.04, 1.5, 0.7, 0.2])),), 360.0)
    assert drawn(PageChart("k", below)).extremes.startswith("\u22120.040 at")


NARROW = """
name: narrow
linkage: {crank_mm: 40, rod_mm: 150}
operation: {speed_rpm: 60}
motion: {law: ratio_expression, ratio: "1 + 40*exp(-(phi - 3)**2/2e-5)", scale_to_close: true}
resistance: {expression_n: "20 + 500*exp(-(x - 41.237)**2/1e-3)"}
"""
"""A ratio and a force that are high over less than a step of 2000."""


@pytest.mark.slow
@pytest.mark.parametrize("name", ["baler-a1-at-law-speed", "narrow"])
def test_headings_tell_the_extremes_that_the_figures_tell(name: str) -> None:
    made = drives.drive_of_text(NARROW) if name == "narrow" else drives.drive(name)
    check, load = made.check, made.machine.load
    way = np.linspace(0.0, made.linkage.stroke_mm, 1_000_001)
    figures = {
        "velocity_mm_s": check.peak_speed.value,
        "acceleration_mm_s2": check.peak_acceleration_cycle.value,
        "force_n": load.against_n(way, np.zeros(way.size, dtype=bool)).max(),
        "power_w": check.peak_power_w.value,
        "ratio": made.transmission.ratio_range[1].value,
    }
    for one in motion_charts(made, made.transmission.cycle_rad)[1:]:
        told = [float(word) for word in drawn(one).extremes.replace("\u2212", "-").replace("\u00b0", "").split()[::4]]
        assert max(map(abs, told)) == pytest.approx(figures[one.key], abs=0.51 * 10.0**-one.decimals), one.key
    assert drawn(one).extremes.startswith(f"{made.transmission.ratio_range[0].value:.{one.decimals}f} at")


def test_the_note_of_a_picture_tells_the_peak_that_a_check_tells() -> None:
    made = drives.drive("baler-a1-at-law-speed")
    axes = Figure().subplots()
    draw(axes, slider_chart(made, Quantity.ACCELERATION), MOTION_LOOK)
    assert axes.texts[0].get_text() == f"{made.check.peak_acceleration_cycle.value:.0f} mm/s\u00b2 at 331\u00b0"


@pytest.mark.slow
def test_the_notes_of_loads_tell_the_peaks_that_a_simulation_tells() -> None:
    made = drives.drive("baler-real")
    loads = [rigid.machine.at(drawn_angles_rad(made)) for rigid in (made.rigid, made.uniform_rigid)]
    charts = [driving_torque(made, *loads), *joint_forces(made, *loads), *mesh_forces(made, *loads)]
    sizes = {one.name: float(np.abs(one.own.values).max()) for one in charts}
    peaks, figures = made.rigid.peaks, rigid_figures(made)["this_design"]
    assert sizes["driving torque"] == pytest.approx(figures["peak_driving_torque_n_m"], rel=1e-9)
    assert sizes["crank bearing"] == pytest.approx(peaks.crank_bearing_n.value, rel=1e-9)
    assert sizes["guide"] == pytest.approx(peaks.guide_n.value, rel=1e-7)
    assert sizes["mesh force"] == pytest.approx(peaks.mesh.force_n.value, rel=1e-9)
    # Negative control: the angles of the table miss the peaks.
    force = made.rigid.machine.at(made.motion.phi1_rad).crank_bearing
    assert np.hypot(force.x.value, force.y.value).max() < peaks.crank_bearing_n.value * (1.0 - 1e-6)


def test_a_level_extreme_is_named_where_it_begins() -> None:
    x = np.array([0.0, 90.0, 180.0, 270.0, 360.0])
    line = ChartLine(Role.OWN, "own", x, np.array([0.0, 80.0, 80.0 + 1e-13, 0.0, -1e-15]))
    assert drawn(PageChart("k", Chart("force", "N", (line,), 360.0))).extremes == "0.00 at 0\u00b0 to 80.00 at 90\u00b0"
    level = ChartLine(Role.OWN, "own", x, 1.0 + 1e-9 * x)
    assert drawn(PageChart("k", Chart("ratio", "", (level,), 360.0))).extremes == "1.000 throughout"


TEXT = re.compile(r'<text style="[^"]*text-anchor: (\w+);[^"]*" x="([\d.]+)" y="([\d.]+)"[^>]*>([^<]+)<')


@pytest.mark.slow
@at_once(
    ("largest", "size"),
    [(2e-7, CHART), (0.4, OF_REPORT), (8.0, CHART), (1.1e5, CHART), (1.1e5, OF_REPORT), (3e7, CHART), (2e12, CHART)],
)
def test_numbers_of_a_scale_are_whole_and_apart(largest: float, size: Size) -> None:
    """With the widths of DejaVu Sans, the font of browsers without another one."""
    font = ImageFont.truetype(findfont("DejaVu Sans"), 1000)
    x = np.array([0.0, 90.0, 180.0, 2880.0])
    line = ChartLine(Role.OWN, "own", x, largest * np.array([-1.0, 0.0, 1.0, 0.2]))
    svg = drawn(PageChart("k", Chart("acceleration", "mm/s\u00b2", (line,), 2880.0)), size).drawing
    boxes = []
    for anchor, across, down, text in TEXT.findall(svg):
        width = font.getlength(text) * TEXT_SIZE / 1000.0
        left = float(across) - {"start": 0.0, "middle": 0.5, "end": 1.0}[anchor] * width
        boxes.append(Bbox.from_bounds(left, float(down) - 0.75 * TEXT_SIZE, width, 0.75 * TEXT_SIZE))
    texts = [text for *_, text in TEXT.findall(svg)]
    # Numbers in full alone: no power of ten, and no unit, over the scale.
    assert len(texts) >= 10
    assert [
        text for text in texts if not re.fullmatch(r"\u2212?[\d.]+(e[+\u2212]\d+)?|driving angle in deg", text)
    ] == []
    assert all(box.x0 >= 0.0 and box.x1 <= size[0] and box.y0 >= 0.0 and box.y1 <= size[1] for box in boxes)
    assert not any(one.overlaps(other) for place, one in enumerate(boxes) for other in boxes[:place])


NOTED = np.linspace(0.0, 360.0, 721)


def note_and_curves(own: np.ndarray, other: np.ndarray) -> tuple[Bbox, Bbox, list[Path]]:
    """Box of the note of a peak, of the axes, and both curves as drawn, in pixels."""
    lines = ChartLine(Role.OWN, "own", NOTED, own), ChartLine(Role.UNIFORM, "other", NOTED, other)
    figure = Figure(figsize=(6.0, 3.0))
    FigureCanvasAgg(figure)
    axes = figure.subplots()
    draw(axes, Chart("force", "N", lines, 360.0, names_extreme=True), MOTION_LOOK)
    figure.draw_without_rendering()
    curves = [line.get_transform().transform_path(line.get_path()) for line in axes.lines[:2]]
    return axes.texts[0].get_window_extent(), axes.get_window_extent(), curves


@pytest.mark.tiers(quick=["120.0-75.0-1.0"], rest="slow")
@pytest.mark.parametrize("sign", [1.0, -1.0])
@pytest.mark.parametrize(
    ("peak", "higher"), [(120.0, 75.0), (120.0, 150.0), (203.0, 178.0), (203.0, 258.0), (15.0, 135.0), (345.0, 230.0)]
)
def test_the_note_of_a_peak_crosses_no_curve(peak: float, higher: float, sign: float) -> None:
    """Beside a higher peak of the other curve, on either side; at either end of the scale; and upside down."""
    own, other = (np.exp(-(((NOTED - at) / 20.0) ** 2)) for at in (peak, higher))
    note, frame, curves = note_and_curves(50.0 * sign * own, 90.0 * sign * other)
    assert not any(curve.intersects_bbox(note, filled=False) for curve in curves)
    assert frame.x0 <= note.x0 < note.x1 <= frame.x1
    assert frame.y0 <= note.y0 < note.y1 <= frame.y1


def test_a_note_over_a_crossing_curve_is_seen() -> None:
    """The same judge, of a note put right over a peak whose neighbour is higher."""
    own, other = (np.exp(-(((NOTED - at) / 20.0) ** 2)) for at in (203.0, 168.0))
    note, _, curves = note_and_curves(50.0 * own, 90.0 * other)
    peak = curves[0].vertices[:, 1].argmax()
    centred = Bbox.from_bounds(float(curves[0].vertices[peak, 0]) - note.width / 2.0, note.y0, note.width, note.height)
    assert curves[1].intersects_bbox(centred, filled=False)


def test_values_of_close_natural_frequencies_stand_apart() -> None:
    heights = np.array([0.1, 0.4, 0.405, 0.41, 0.8])
    apart = spread(heights, 0.03)
    assert np.diff(apart).min() >= 0.03 - 1e-12
    assert apart[[0, -1]].tolist() == [0.1, 0.8]
    assert np.abs(apart - heights).max() < 0.03


@pytest.mark.parametrize(("turns", "step"), [(1, 60.0), (3, 180.0)])
def test_angles_are_marked_every_sixth_of_a_turn_or_of_all_turns(turns: int, step: float) -> None:
    axes = Figure().subplots()
    lines = (ChartLine(Role.OWN, "own", np.array([0.0, 360.0 * turns]), np.array([0.0, 1.0])),)
    draw(axes, Chart("force", "N", lines, 360.0 * turns, None, JOINTS, names_extreme=True), PAGE_LOOK)
    ticks = np.array(axes.get_xticks())
    assert ticks[(ticks >= 0.0) & (ticks <= 360.0 * turns)] == pytest.approx(np.arange(7) * step)
