"""What pictures show, read from the figures before they become pixels: places, colours and sizes of what is drawn."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import replace
from functools import cache
from itertools import pairwise
from math import pi
from types import SimpleNamespace
from typing import Any

import numpy as np
import pytest
from matplotlib.collections import PolyCollection
from matplotlib.colors import to_rgb
from matplotlib.container import BarContainer
from matplotlib.figure import Figure
from shapely import Point, Polygon

from at_once import at_once
from drives import drive, drive_of_text
from ncgear.drawings.assembled import Assembled, AssembledPosition
from ncgear.drawings.pictures import positions_at
from ncgear.drawings.plots import canvas
from ncgear.drawings.plots.assembled_pair import pitch_curves_png, teeth_png
from ncgear.figures.side_by_side import SideBySide
from ncgear.files import sweep
from ncgear.files.balance import campbell, loops
from ncgear.files.bench import stage_png
from ncgear.files.measured import _along_flanks, _round_factor, compared_pictures, deviations_png
from ncgear.files.searched import outline_picture
from ncgear.files.side_by_side import CHARTS, side_by_side_png
from ncgear.files.strength import HOLDING_SCALE, ColouredGear, coloured_teeth_png
from ncgear.files.sweep import Axis, _chosen, _effects_picture, pareto, scatter_matrix
from ncgear.files.tolerance import FigureSpread, sources, spreads
from ncgear.files.workshop.drawing import pitch_points
from ncgear.metrology.best_fit import BestFit, Pose, on_flanks
from ncgear.metrology.deviations import deviations
from ncgear.metrology.exact_outline import exact_outline
from ncgear.numerics.plane import as_complex
from ncgear.pitch.shape import Gear, Mesh
from ncgear.project.bench import BenchStage, TimedStage
from ncgear.project.drive import Drive

Made: Any = SimpleNamespace


@pytest.fixture
def shown(monkeypatch: pytest.MonkeyPatch) -> Callable[..., Figure]:
    """Draw by a function and return the figure, which is not rendered."""
    kept: list[Figure] = []
    monkeypatch.setattr(canvas, "png", lambda made: kept.append(made) or b"")

    def figure(draw: Callable[..., bytes], *given: Any) -> Figure:
        draw(*given)
        return kept.pop()

    return figure


def said(made: Figure) -> list[str]:
    return [text.get_text() for axes in made.axes for text in axes.texts]


# --- teeth in colours ------------------------------------------------------------------------------------------------


@cache
def press(mesh: Mesh) -> Drive:
    """Elliptic gears of 19 teeth, or a gear of 14 teeth in a ring."""
    law, ring = "{law: ellipse, eccentricity: 0.3}", ""
    if mesh is Mesh.INTERNAL:
        law, ring = "{law: ratio_expression, ratio: 2 + 0.3*cos(phi), scale_to_close: true}", "mesh: internal, "
    return drive_of_text(
        "name: press\nlinkage: {crank_mm: 38, rod_mm: 96}\noperation: {speed_rpm: 60}\n"
        f"motion: {law}\ngears: {{{ring}teeth: {14 if ring else 19}, module_mm: 1.5, face_width_mm: 10, "
        f"lobes: {{driven: {2 if ring else 1}}}}}\n"
    )


@pytest.mark.judges("files")
@pytest.mark.parametrize("mesh", [Mesh.EXTERNAL, pytest.param(Mesh.INTERNAL, marks=pytest.mark.thorough)])
def test_coloured_teeth_have_their_own_numbers_below_their_roots(
    mesh: Mesh, shown: Callable[..., Figure], monkeypatch: pytest.MonkeyPatch
) -> None:
    """Numbers lie in the body beside their tooth; those of a ring lie outside the curve of its teeth."""
    one = press(mesh)
    (position,) = positions_at(one, np.array([0.7]))
    shares = {gear: np.geomspace(0.05, 20.0, one.teeth.of(gear).teeth) for gear in Gear}
    gears = {gear: ColouredGear(shares[gear], 3) for gear in Gear}
    made = shown(coloured_teeth_png, one, gears, position, "title")
    axes, bar = made.axes
    areas_of = [item for item in axes.collections if isinstance(item, PolyCollection)]
    apart = {}
    for gear, areas in zip(Gear, areas_of, strict=True):
        teeth = one.teeth.of(gear)
        polygons = [Polygon(path.vertices[:-1]) for path in areas.get_paths()]
        assert len(polygons) == teeth.teeth
        outline = Polygon(turned(one, gear, teeth.outline_mm, position))
        texts = [text for text in axes.texts if min(map(Point(text.get_position()).distance, polygons)) < 3.0]
        texts = [text for text in texts if outline.contains(Point(text.get_position())) != (teeth.flanks.curve.is_ring)]
        numbers = [int(text.get_text()) for text in texts]
        assert numbers == list(range(1, teeth.teeth + 1))
        assert [text.get_text() for text in texts if text.get_fontweight() == "bold"] == ["3"]
        for text, polygon in zip(texts, polygons, strict=True):
            assert min(polygons, key=Point(text.get_position()).distance) is polygon
            assert not polygon.contains(Point(text.get_position()))
        # The two flanks of tooth n bound its area.
        middle = teeth.flanks.crossing_mm.reshape(-1, 2)[: teeth.teeth].mean(axis=1)
        places = turned(one, gear, teeth.flanks.offset(middle, np.zeros(middle.size))[0], position)
        assert all(area.buffer(0.05).contains(Point(at)) for area, at in zip(polygons, places, strict=True))
        # Colours go by the logarithm of the share, from a quarter to four times.
        level = (np.log(np.clip(shares[gear], 0.25, 4.0)) / np.log(4.0) + 1.0) / 2.0
        assert np.asarray(areas.get_facecolor())[:, :3] == pytest.approx(HOLDING_SCALE(level)[:, :3], abs=0.01)
        apart[gear] = teeth.flanks.curve.length_mm / teeth.teeth
    assert [label.get_text() for label in bar.get_xticklabels()] == ["0.25", "0.5", "1", "2", "4"]
    # The axes have the shape of what they show, below the heading and above the scale, and hold both gears.
    box, height_in = axes.get_position(), made.get_figheight()
    (left, right), (low, high) = axes.get_xlim(), axes.get_ylim()
    for turn in (0.0, 1.6, 3.1):
        (other,) = positions_at(one, np.array([turn]))
        x, y = np.vstack([turned(one, gear, one.teeth.of(gear).outline_mm, other) for gear in Gear]).T
        assert (left < x.min(), x.max() < right, low < y.min(), y.max() < high) == (True,) * 4
    assert 0.0 <= bar.get_position().y1 < box.y0 < box.y1 < 1.0
    mm_per_in = max((right - left) / (made.get_figwidth() * box.width), (high - low) / (height_in * box.height))
    assert height_in < 7.0 + 1e-9
    assert height_in == 7.0 or mm_per_in == pytest.approx((right - left) / made.get_figwidth())
    # Closer than a distance in inches, every fifth and the named one have numbers.
    for share, crowded in ((0.999, False), (1.001, True)):
        with monkeypatch.context() as patched:
            patched.setattr("ncgear.files.strength.ROOM_IN", share * apart[Gear.DRIVING] / mm_per_in)
            told = shown(coloured_teeth_png, one, gears, position, "title").axes[0].texts
        count = one.teeth.driving.teeth
        wanted = [n for n in range(1, count + 1) if not crowded or n == 3 or n % 5 == 0]
        assert [int(text.get_text()) for text in told[: len(wanted)]] == wanted


def turned(one: Drive, gear: Gear, points: Any, position: AssembledPosition) -> Any:
    """Points of a gear's own frame in the frame of the pair: the driven gear turns the other way, unless in a ring."""
    at = as_complex(points)
    if gear is Gear.DRIVING:
        at = at * np.exp(1j * position.phi1_rad)
    else:
        sense = one.pitch.mesh.sense
        at = at * np.exp(1j * sense * position.phi2_rad) + one.pitch.center_distance_mm
    return np.column_stack([at.real, at.imag])


# --- the pair --------------------------------------------------------------------------------------------------------


@pytest.mark.judges("drawings")
@at_once("ring_mm", [None, 30.0])
def test_pictures_of_the_pair_show_its_curves_in_place(ring_mm: float | None, shown: Callable[..., Figure]) -> None:
    around = np.exp(1j * np.linspace(0.0, 2.0 * np.pi, 90, endpoint=False))
    egg = np.column_stack([(8.0 * around + 1.0).real, (8.0 * around).imag])
    disc = np.column_stack([(18.0 * around).real, (18.0 * around).imag])
    distance = 26.0 if ring_mm is None else -10.0
    pair = Assembled(egg, disc, distance, ring_mm)
    concave = np.arange(90) < 5, np.zeros(90, dtype=bool)
    made = shown(pitch_curves_png, pair, concave, "curves")
    (axes,) = made.axes
    (marked,) = (line for line in axes.lines if line.get_label() == "concave")
    assert np.array(marked.get_xydata())[:5] == pytest.approx(egg[:5])
    assert np.isnan(np.array(marked.get_xydata())[5:]).all()
    centers = [np.array(line.get_xydata()) for line in axes.lines if line.get_marker() == "+"]
    assert centers == [pytest.approx(np.array([[0.0, 0.0], [distance, 0.0]]))]
    assert [(text.get_text(), text.xy) for text in axes.texts] == [
        ("driving axis", (0.0, 0.0)),
        ("driven axis", (distance, 0.0)),
    ]
    # In a position: turned against each other, a ring alike; the mesh about the pitch point.
    position = AssembledPosition(0.5, 0.3, 9.0)
    made = shown(teeth_png, pair, 2.0, [position, AssembledPosition(2.0, 1.2, 8.5)], "teeth")
    whole, second, mesh, _ = made.axes
    sense = 1.0 if ring_mm else -1.0
    driving = (egg[:, 0] + 1j * egg[:, 1]) * np.exp(0.5j)
    driven = (disc[:, 0] + 1j * disc[:, 1]) * np.exp(0.3j * sense) + distance
    for axes in (whole, mesh):
        paths = [patch.get_path().vertices for patch in axes.artists + axes.patches]
        assert paths[0][:90] == pytest.approx(np.column_stack([driving.real, driving.imag]))
        points = np.column_stack([driven.real, driven.imag])
        assert np.hypot(*(paths[1][:, None] - points[None]).transpose(2, 0, 1)).min(axis=0).max() < 1e-9
    assert whole.get_title() == "phi1 = 28.6\u00b0, phi2 = 17.2\u00b0"
    assert mesh.get_xlim() == pytest.approx((0.0, 18.0))
    assert mesh.get_ylim() == pytest.approx((-9.0, 9.0))
    assert whole.get_xlim() == second.get_xlim()
    left, right = whole.get_xlim()
    reach = ring_mm or 18.0
    assert left <= min(-9.0, distance - reach)
    assert right >= max(9.0, distance + reach)
    assert whole.get_ylim()[1] >= max(9.0, reach)
    assert whole.get_ylim()[1] < 1.1 * max(9.0, reach)


# --- tolerances ------------------------------------------------------------------------------------------------------


@pytest.mark.judges("files")
@at_once("below", [True, False])
def test_bars_of_a_spread_are_shares_and_those_beyond_the_limit_stand_out(
    below: bool, shown: Callable[..., Figure]
) -> None:
    values = np.random.default_rng(4).normal(size=4000)
    far = FigureSpread("play", values, 0.2, -9.0, below, "jams")
    one = FigureSpread("play", values, 0.2, -0.5, below, "jams")
    made = shown(spreads, [one, far, FigureSpread("flat", np.full(5, 3.0), 3.0)], "title")
    first, second, flat = made.axes
    bars = [patch for patch in first.patches if patch.get_height() > 0.0]
    assert sum(bar.get_height() for bar in bars) == pytest.approx(100.0)
    bad = [bar for bar in bars if bar.get_facecolor()[:3] == pytest.approx(to_rgb(canvas.HIGHLIGHT))]
    share = 100.0 * np.mean(values < -0.5 if below else values > -0.5)
    # One bin of 60 may lie on both sides of the limit.
    assert sum(bar.get_height() for bar in bad) == pytest.approx(share, abs=max(bar.get_height() for bar in bars))
    for bar in bars:
        left, right = bar.get_x(), bar.get_x() + bar.get_width()
        assert bar.get_height() == pytest.approx(100.0 * np.mean((values >= left - 1e-12) & (values < right)), abs=0.1)
    assert [line.get_xdata()[0] for line in first.lines] == [0.2, -0.5]
    assert "jams" in " ".join(text.get_text() for text in first.texts)
    assert [line.get_xdata()[0] for line in second.lines] == [0.2]
    assert max(bar.get_height() for bar in flat.patches) == 100.0
    assert [axes.get_xlabel() for axes in made.axes] == ["play", "play", "flat"]


@pytest.mark.judges("files")
def test_sources_stand_by_their_largest_share(shown: Callable[..., Figure]) -> None:
    of = {
        "least play": {"pitch": (0.02, 0.03), "bore": (0.7, 0.1), "profile": (0.3, 0.05)},
        "motion error": {"pitch": (0.9, 0.02), "bore": (0.1, 0.01)},
    }
    (axes,) = shown(sources, of, "title").axes
    names = [label.get_text() for label in axes.get_yticklabels()]
    assert names == ["profile", "bore", "pitch"]
    drawn = [one for one in axes.containers if isinstance(one, BarContainer)]
    for figure, bars in zip(of, drawn, strict=True):
        for name, bar in zip(names, bars.patches, strict=True):
            assert bar.get_width() == pytest.approx(100.0 * of[figure].get(name, (0.0, 0.0))[0])
            assert abs(bar.get_y() + bar.get_height() / 2.0 - names.index(name)) < 0.4
    lows = [segment[0, 0] for container in axes.collections for segment in container.get_segments()]
    assert min(lows) == 0.0
    (first,) = (segment for segment in axes.collections[0].get_segments() if abs(segment[:, 0].mean() - 70.0) < 1e-6)
    assert first[:, 0] == pytest.approx([60.0, 80.0])


# --- balance ---------------------------------------------------------------------------------------------------------


@pytest.mark.judges("files")
def test_closed_curves_are_at_most_eight_and_grow_thinner(shown: Callable[..., Figure]) -> None:
    curves = {f"{number} kg": np.array([[0.0, number], [1.0, 0.0], [0.0, number]]) for number in range(15)}
    (axes,) = shown(loops, curves, "N", "title").axes
    drawn = [float(line.get_ydata()[0]) for line in axes.lines]
    assert drawn == pytest.approx(np.linspace(0.0, 14.0, 8), abs=0.5)
    assert [line.get_label() for line in axes.lines] == [f"{number:g} kg" for number in drawn]
    widths = [line.get_linewidth() for line in axes.lines]
    assert widths == pytest.approx(np.linspace(2.6, 1.2, 8))
    assert len({(line.get_color(), line.get_linestyle()) for line in axes.lines}) == 8
    (few,) = shown(loops, {"one": curves["3 kg"]}, "N", "title").axes
    assert [line.get_linewidth() for line in few.lines] == [2.6]


@pytest.mark.judges("files")
def test_excitations_rise_with_the_speed_across_natural_frequencies(shown: Callable[..., Figure]) -> None:
    excitations: Any = [
        Made(kind="rotation", frequency_hz=2.0),
        Made(kind="harmonic 3", frequency_hz=30.0),
        Made(kind="combustion", frequency_hz=9.0),
        Made(kind="tooth mesh", frequency_hz=40.0),
    ]
    (axes,) = shown(campbell, excitations, [25.0, 80.0], 0.1, "title").axes
    rising = [line for line in axes.lines if len(line.get_xdata()) > 10]
    for line, one in zip(rising, excitations, strict=True):
        assert np.array(line.get_ydata()) == pytest.approx(np.array(line.get_xdata()) / 100.0 * one.frequency_hz)
        assert (line.get_xdata()[0], line.get_xdata()[-1]) == (20.0, pytest.approx(125.0))
        given = [dot for dot in axes.lines if dot.get_marker() == "o" and dot.get_ydata()[0] == one.frequency_hz]
        assert [dot.get_color() for dot in given] == [line.get_color()]
    across = [line for line in axes.lines if line.get_color() == canvas.INK and len(line.get_xdata()) == 2]
    assert [line.get_ydata()[0] for line in across[:2]] == [25.0, 80.0]
    bands = [patch.get_bbox() for patch in axes.patches]
    assert [(one.y0, one.y1) for one in bands] == [pytest.approx((22.5, 27.5)), pytest.approx((72.0, 88.0))]
    low, high = axes.get_ylim()
    # All frequencies of the given speed, and room above the highest natural one.
    assert low < 2.0
    assert 88.0 < high < 200.0
    assert axes.get_legend_handles_labels()[1] == ["rotation", "rollers and teeth", "engine", "slider"]


# --- sweeps ----------------------------------------------------------------------------------------------------------


@pytest.mark.judges("files")
def test_designs_that_are_written_lie_evenly_along_the_front() -> None:
    """By the first objective, both ends among them."""
    first = np.random.default_rng(5).permutation(50).astype(float)
    front: Any = Made(numbers=np.arange(50))
    chosen = _chosen(front, np.column_stack([first, -first]))
    assert first[chosen].tolist() == pytest.approx(np.linspace(0.0, 49.0, 8), abs=0.5)
    few = _chosen(Made(numbers=np.arange(3)), np.array([[2.0, 0.0], [0.0, 2.0], [1.0, 1.0]]))  # type: ignore[arg-type]
    assert few.tolist() == [1, 2, 0]


@pytest.mark.judges("files")
def test_a_front_is_shown_with_what_is_near_it(shown: Callable[..., Figure]) -> None:
    drawn = np.concatenate([np.linspace(10.0, 14.0, 30), np.linspace(100.0, 900.0, 10)])
    front = np.array([12.0, 10.0, 11.0])
    along, up = Axis("power, W", drawn, front), Axis("mass, kg", 20.0 - drawn, 20.0 - front)
    named = [("7", 10.0, 10.0), ("8", 10.01, 9.99), ("9", 12.0, 8.0)]
    (axes,) = shown(pareto, along, up, named, "title").axes
    line = axes.lines[1]
    assert line.get_xdata().tolist() == [10.0, 11.0, 12.0]
    assert line.get_ydata().tolist() == [10.0, 9.0, 8.0]
    left, right = axes.get_xlim()
    assert left < 10.0
    assert 12.0 + 2.0 <= right < 100.0
    assert left > 10.0 - 2.0
    # Numbers that would cover each other are left out.
    assert [text for text in said(axes.figure) if text.isdigit()] == ["7", "9"]
    assert (axes.get_xlabel(), axes.get_ylabel()) == ("power, W", "mass, kg")


@pytest.mark.judges("files")
def test_every_pair_of_figures_is_shown_below_the_diagonal(shown: Callable[..., Figure]) -> None:
    rng = np.random.default_rng(6)
    axes = [Axis(f"{name}, mm", rng.uniform(size=40), rng.uniform(size=4)) for name in "abc"]
    axes.append(Axis("teeth", np.full(40, 20.0), np.full(4, 20.0)))
    made = shown(scatter_matrix, axes, "title")
    assert len(made.axes) == 10
    cells = iter(made.axes)
    for row, up in enumerate(axes):
        for column, along in enumerate(axes[: row + 1]):
            cell = next(cells)
            place = cell.get_position()
            assert place.x0 == pytest.approx(made.axes[-4 + column].get_position().x0)
            if row == column:
                count = sum(bar.get_height() for bar in cell.patches)
                assert count == 40
                assert sum(bar.get_height() > 0.0 for bar in cell.patches) == 1 or row < 3
                assert row < 3 or len(cell.patches) == 1
            else:
                by_lot, best = cell.lines
                assert (by_lot.get_xdata() == along.drawn).all()
                assert (by_lot.get_ydata() == up.drawn).all()
                assert (best.get_xdata() == along.front).all()
                assert (best.get_ydata() == up.front).all()
            assert cell.get_xlabel() == (
                {"teeth": "teeth"}.get(along.head, along.head.replace(", ", ",\n")) if row == 3 else ""
            )
            assert bool(cell.get_ylabel()) == (column == 0 and row > 0)


# --- measured gears --------------------------------------------------------------------------------------------------


@cache
def measured() -> Any:
    """An elliptic gear whose points stand out by 10 um on front flanks, 4 um on back flanks; tooth 5 has none."""
    gear = press(Mesh.EXTERNAL).teeth.driving
    outline = exact_outline(gear)
    high, low = gear.sides.flank_range()
    low = np.maximum(low, -gear.tips.met_depth_mm)
    flank = np.repeat([row for row in range(2 * gear.teeth) if row // 2 != 4], 4)
    height = low[flank] + (high - low)[flank] * np.tile([0.2, 0.4, 0.6, 0.8], flank.size // 4)
    before, at, after = (as_complex(gear.flanks.flank(flank, height + step)[0]) for step in (-1e-4, 0.0, 1e-4))
    normal = 1j * (after - before) / np.abs(after - before)
    tangent = as_complex(gear.flanks.curve.at_length(gear.flanks.crossing_mm[flank]).tangent)
    facing = gear.flanks.side[flank] * np.real(normal * tangent.conj())
    normal = np.where(facing > 0.0, normal, -normal)
    points = at + np.where(flank % 2 == 1, 0.010, 0.004) * normal
    feet = outline.feet(points)
    fit = BestFit(Pose(0.0), feet, on_flanks(outline, feet), 0.0, None, np.zeros(points.size))
    found = deviations(outline, fit)
    return Made(gear=Gear.DRIVING, outline=outline, fit=fit, deviations=found)


def test_deviations_are_drawn_many_times_as_long_on_their_own_flanks(shown: Callable[..., Figure]) -> None:
    one = measured()
    gear, scale, bars = shown(deviations_png, one, "title").axes
    (spikes,) = (item for item in gear.collections if hasattr(item, "get_segments"))
    segments = np.array(spikes.get_segments())
    outline = Polygon(one.outline.gear.outline_mm)
    long = np.hypot(*(segments[:, 1] - segments[:, 0]).T)
    # The worst one is about a module of 1.5 mm long, by a factor of one digit.
    factor = np.median(long) / np.median(np.abs(one.fit.feet.distance_mm))
    assert factor == pytest.approx(100.0)
    worst = np.abs(one.fit.feet.distance_mm).max()
    assert factor * worst <= 1.5 < (factor + 100.0) * worst
    assert all(outline.exterior.distance(Point(foot)) < 0.01 for foot, _ in segments)
    numbers = {text.get_text(): text.get_position() for text in gear.texts}
    assert len(numbers) == 19
    for number, place in numbers.items():
        assert outline.contains(Point(place))
        flanks = one.outline.gear.flanks
        middle = flanks.crossing_mm.reshape(-1, 2).mean(axis=1)
        at = flanks.offset(middle, np.zeros(middle.size))[0]
        assert int(np.argmin(np.hypot(*(at - place).T))) == int(number) - 1
    left, right = gear.get_xlim()
    assert (left < outline.bounds[0], right > outline.bounds[2]) == (True, True)
    # A bar for each flank, back flanks left of front ones; none stands for tooth 5, which is marked.
    tops = [(bar.get_x() + bar.get_width() / 2.0, bar.get_height()) for bar in bars.patches]
    assert len(tops) == 2 * 19
    for at, height in tops:
        tooth, front = round(at), at > round(at)
        mean = 0.0 if tooth == 5 else 1e3 * one.deviations.flanks.side(one.deviations.flanks.mean_mm, front)[tooth - 1]
        assert height == pytest.approx(mean, abs=1e-9)
    (cross,) = (line for line in bars.lines if line.get_marker() == "x")
    assert cross.get_xdata() == [5]
    assert scale.get_xlabel().startswith("deviation in \u00b5m")


def test_lines_of_deviations_go_along_one_flank_each() -> None:
    one = measured()
    counted = one.fit.feet.kept(one.fit.counted)
    rows = np.arange(counted.row.size, dtype=float)
    lines = _along_flanks(one, np.column_stack([rows, rows]))
    assert len(lines) == 2 * 18
    for line in lines:
        of = line[:, 0].astype(int)
        assert len({*one.outline.flank[counted.row[of]].tolist()}) == 1
        assert (np.diff(counted.place_mm[of]) > 0.0).all()
    assert sum(map(len, lines)) == rows.size


@at_once(("factor", "rounded"), [(287.3, 200.0), (1.0, 1.0), (0.099, 0.09), (9999.0, 9000.0), (30.0, 30.0)])
def test_factors_are_rounded_down_to_one_digit(factor: float, rounded: float) -> None:
    assert _round_factor(factor) == pytest.approx(rounded)


# --- benches, designs side by side, play of measured pairs -----------------------------------------------------------


@pytest.mark.judges("files")
def test_trials_are_shown_by_time_and_error_and_the_one_that_is_recommended(shown: Callable[..., Figure]) -> None:
    """In ms; an error of nothing is shown as the least, and room is left around all and what is asked."""
    trials = tuple(TimedStage(setting, time, error, 9) for setting, time, error in
                   ((0.4, 0.002, 0.3), (0.2, 0.004, 0.01), (0.1, 0.009, 0.0)))  # fmt: skip
    stage = BenchStage("tolerance", "error", "exact", 0.02, 0.2, trials, "mm", name="teeth")
    (axes,) = shown(stage_png, stage, "name").axes
    tried, asked, best = axes.lines
    assert list(tried.get_xdata()) == pytest.approx([2.0, 4.0, 9.0])
    assert list(tried.get_ydata())[:2] == [0.3, 0.01]
    assert 0.0 < tried.get_ydata()[2] < 1e-6
    assert list(asked.get_ydata()) == [0.02, 0.02]
    assert (list(best.get_xdata()), list(best.get_ydata())) == ([pytest.approx(4.0)], [0.01])
    (left, right), (low, high) = axes.get_xlim(), axes.get_ylim()
    assert left < 2.0 < 9.0 < right
    assert low < tried.get_ydata()[2] < 0.3 < high
    assert [text.xy for text in axes.texts] == [pytest.approx(place) for place in tried.get_xydata()]
    coarse = replace(stage, asked_error=1e-9, trials=trials[:2])
    (axes,) = shown(stage_png, coarse, "name").axes
    assert len(axes.lines) == 2
    assert axes.get_ylim()[0] < 1e-9
    wide = replace(stage, asked_error=5.0)
    assert shown(stage_png, wide, "name").axes[0].get_ylim()[1] > 5.0


@pytest.mark.judges("files")
def test_designs_side_by_side_have_a_chart_below_another(shown: Callable[..., Figure]) -> None:
    """That of power only where a design has a load; curves are those of the motions, over one scale of angles."""
    with_load, without = drive("pump-1-2"), press(Mesh.EXTERNAL)
    for drives, count in (((with_load, without), len(CHARTS)), ((without, without), len(CHARTS) - 1)):
        made = shown(side_by_side_png, SideBySide(drives, ({}, {})))
        assert len(made.axes) == count
        boxes = [axes.get_position() for axes in made.axes]
        assert all(upper.y0 > lower.y1 for upper, lower in pairwise(boxes))
        assert max(box.y1 for box in boxes) < 1.0
        for axes in made.axes:
            assert sum(len(line.get_xdata()) > 50 for line in axes.lines) >= 2


@pytest.mark.judges("files")
def test_play_of_a_measured_pair_is_in_micrometres_at_the_flanks(monkeypatch: pytest.MonkeyPatch) -> None:
    kept: list[Any] = []
    monkeypatch.setattr("ncgear.files.measured.column_png", lambda charts, *_: kept.extend(charts) or b"")
    phi1 = np.array([0.0, pi, 2.0 * pi])
    measured = Made(backlash_rad=np.array([1e-3, 2e-3, 3e-3]), pushing_rad=np.array([1e-6, 2e-6, 3e-6]))
    pair: Any = Made(gears=(), placement=Made(phi1_rad=phi1, cycle_rad=2.0 * pi), lever_mm=30.0, measured=measured,
                     exact=Made(backlash_rad=np.full(3, 5e-3), pushing_rad=np.zeros(3)))  # fmt: skip
    assert list(compared_pictures(pair, "name")) == ["measured-contact.png"]
    play, error = kept
    assert (play.end, list(play.lines[1].x)) == (pytest.approx(360.0), pytest.approx([0.0, 180.0, 360.0]))
    assert [list(line.values) for line in play.lines] == [pytest.approx([150.0] * 3), pytest.approx([30.0, 60.0, 90.0])]
    assert [list(line.values) for line in error.lines] == [pytest.approx([0.0] * 3), pytest.approx([1.0, 2.0, 3.0])]


@pytest.mark.judges("files")
def test_points_of_a_pitch_curve_keep_the_tolerance_and_are_hardly_more_than_that_takes() -> None:
    """By the sagitta of chords: k s^2/8 with the largest curvature."""
    curve = press(Mesh.EXTERNAL).pitch.driving
    for tolerance in (0.05, 0.002):
        points = pitch_points(curve, tolerance)
        at = curve.length_mm * (np.arange(len(points)) + 0.5) / len(points)
        middle = curve.at_length(at).position
        off = np.hypot(*(middle - (points + np.roll(points, -1, axis=0)) / 2.0).T)
        assert 0.7 * tolerance < off.max() <= tolerance


@pytest.mark.judges("files")
def test_what_each_key_does_is_shown_on_one_scale_an_objective(
    shown: Callable[..., Figure], monkeypatch: pytest.MonkeyPatch
) -> None:
    """A bin without designs is not shown; of an objective, all keys have one scale; every mean is within it."""
    monkeypatch.setattr(sweep, "rank_correlations", lambda _: np.array([[0.5, -0.25], [0.125, 1.0]]))
    effects = Made(
        designs=np.array([[3, 0, 2], [1, 1, 5]]),
        places=np.array([[1.0, 2.0, 3.0], [10.5, 20.0, 30.0]]),
        refused_share=np.array([[0.0, 0.5, 0.25], [1.0, 0.125, 0.0]]),
        means=np.array([[[1.0, 7.0], [np.nan, np.nan], [3.0, 9.0]], [[np.nan, np.nan], [2.0, 5.0], [5.0, 6.0]]]),
        explained=np.array([[0.31, 0.47], [0.62, np.nan]]),
    )
    wanted = Made(objectives=[Made(name="figures.mass_kg"), Made(name="figures.peak_power_w")])
    overview = Made(effects=effects, space=Made(keys=["teeth", "rod_mm"]), wanted=wanted, count=11)
    made = shown(_effects_picture, "press", overview)
    cells = np.array(made.axes, dtype=object).reshape(2, 3)
    assert [line.get_xdata().tolist() for line in (cell.lines[0] for cell in cells[0])] == [[1.0, 3.0]] * 3
    ydata = [[cell.lines[0].get_ydata().tolist() for cell in row] for row in cells]
    assert ydata == [[[1.0, 3.0], [7.0, 9.0], [0.0, 25.0]], [[2.0, 5.0], [5.0, 6.0], [100.0, 12.5, 0.0]]]
    for column, (low, high) in enumerate([(1.0, 5.0), (5.0, 9.0), (0.0, 100.0)]):
        bottom, top = cells[0, column].get_ylim()
        assert cells[1, column].get_ylim() == (bottom, top)
        assert 0.02 < (low - bottom) / (high - low) < 0.15
        assert 0.02 < (top - high) / (high - low) < 0.15
    assert [cell.texts[0].get_text() for cell in cells[:, :2].ravel()] == [
        "explains 31 %, rank +0.50",
        "explains 47 %, rank -0.25",
        "explains 62 %, rank +0.12",
        "does not vary",
    ]
    assert not cells[0, 2].texts
    assert [bool(cell.get_title(loc="left")) for cell in cells.ravel()] == [True] * 3 + [False] * 3
    places = [cell.get_position() for cell in cells.ravel()]
    assert places[0].y0 > places[3].y1
    assert places[0].x1 < places[1].x0
    assert "11 designs" in str([text.get_text() for text in made.texts])


@pytest.mark.judges("files")
def test_the_outline_of_a_mate_is_shown_where_the_mate_stands(shown: Callable[..., Figure]) -> None:
    """Its first point faces the curve's: what the drawing has at an eighth turn is towards the other axis."""
    square = np.array([[1.0, 1.0], [-1.0, 1.0], [-1.0, -1.0], [1.0, -1.0]])
    own = Made(at_mm=[3.0, 1.0], toward_mm=[3.5, 1.0], greatest_mm=0.5)
    away = Made(at_mm=[6.0, 6.0], toward_mm=[5.0, 6.0], greatest_mm=2.0)
    curve = Made(axis_mm=np.array([3.0, 0.0]), center_distance_mm=10.0, mate_place=Made(turned_rad=pi / 4))
    follower = Made(scale=2.0, axis_mm=np.array([5.0, 5.0]), outline=Made(corners=square + 5.0), deviation=away)
    found = Made(
        deviation=own,
        curve=curve,
        mate=follower,
        outline=Made(corners=square + np.array([3.0, 0.0])),
        points_mm=square * 2.0 + np.array([3.0, 0.0]),
        mate_points_mm=square * 3.0,
    )
    (axes,) = shown(outline_picture, found, "press").axes
    drawn, mate = (patch.get_xy()[:4] for patch in axes.patches)
    assert drawn == pytest.approx(found.outline.corners)
    # Twice as large, and turned so that the corner (1, 1) is to the left of the mate's axis.
    diagonal = 2.0 * 2.0**0.5
    assert mate[:2] == pytest.approx(np.array([[13.0 - diagonal, 0.0], [13.0, -diagonal]]), abs=1e-12)
    ends = [line.get_xydata() for line in axes.lines]
    assert ends[0][:4] == pytest.approx(found.points_mm)
    assert ends[1] == pytest.approx(np.vstack([square, square[:1]]) * 3.0 + [13.0, 0.0])
    assert ends[2] == pytest.approx(np.array([[3.0, 1.0], [3.5, 1.0]]))
    assert ends[3] == pytest.approx(np.array([mate[0], (mate[0] + mate[1]) / 2.0]), abs=1e-12)
    assert ends[4] == pytest.approx(np.array([[3.0, 0.0], [13.0, 0.0]]))
    assert "2.00 mm" in str([text.get_text() for text in axes.figure.texts])
    assert "0.50 mm" in str(
        [text.get_text() for text in shown(outline_picture, Made(**{**vars(found), "mate": None}), "press").texts]
    )
