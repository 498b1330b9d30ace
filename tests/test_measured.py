"""Measured gears: files, distances from the exact outline, best fit, deviations, and the pair as measured.

Synthetic measurements are made from the formulas of the flanks, turned, moved, and moved along normals that are taken
from differences of points; what must come out is known beforehand, or follows from linear algebra written here.
"""

from __future__ import annotations

import json
from dataclasses import replace
from functools import cache
from pathlib import Path

import numpy as np
import pytest
import shapely
from shapely import Polygon, affinity

from commands import Run
from drives import DESIGNS, drive, drive_of_text
from ncgear.contact.placement import placed, placed_at
from ncgear.contact.written.as_written import Outlines, as_written, reach_mm
from ncgear.design.reading.measured_file import MeasuredFile, read_measured
from ncgear.errors import WrongInput
from ncgear.figures.answers.answer import COLUMNS, LINES
from ncgear.figures.compared import alone_points, compared_answer, gear_figures
from ncgear.metrology import best_fit as best_fit_module
from ncgear.metrology.best_fit import BestFit, Pose, _fitted, alone_mm, are_judged, best_fit, on_flanks
from ncgear.metrology.deviations import _in_order, deviations, outline_as_measured
from ncgear.metrology.exact_outline import FLANK_CURVE, TIP_LAND_CURVE, ExactOutline, exact_outline
from ncgear.numerics.plane import as_complex, as_points
from ncgear.pitch.shape import Gear
from ncgear.project.compared import ComparedPair, FittedQuantities, compared_gear, compared_pair
from ncgear.teeth.gear import ToothedGear

OF_FLANK = 12
SIGMA_MM = 0.002


@cache
def outline_of(name: str, gear: Gear = Gear.DRIVING) -> ExactOutline:
    return exact_outline(drive(name).teeth.of(gear))


def flank_points(gear: ToothedGear, count: int = OF_FLANK) -> tuple[np.ndarray, np.ndarray, np.ndarray]:
    """Points in the middle of every working flank, their flanks, and unit normals away from the tooth."""
    high, low = gear.sides.flank_range()
    low = np.maximum(low, -gear.tips.met_depth_mm)
    share = np.linspace(0.1, 0.9, count)
    flank = np.repeat(np.arange(2 * gear.teeth), count)
    height = low[flank] + (high - low)[flank] * np.tile(share, 2 * gear.teeth)
    before, at, after = (as_complex(gear.flanks.flank(flank, height + step)[0]) for step in (-1e-4, 0.0, 1e-4))
    # Along growing arc length a front flank faces forwards, a back flank backwards.
    tangent = as_complex(gear.flanks.curve.at_length(gear.flanks.crossing_mm[flank]).tangent)
    normal = 1j * (after - before) / np.abs(after - before)
    facing = gear.flanks.side[flank] * (normal.real * tangent.real + normal.imag * tangent.imag)
    return at, flank, np.where(facing > 0.0, normal, -normal)


def file_of(points: np.ndarray) -> MeasuredFile:
    return MeasuredFile("p.csv", as_points(points), tuple(range(1, points.size + 1)))


class TestFiles:
    @pytest.mark.parametrize(
        "text",
        [
            "x_mm,y_mm\n1.5,-2\n3,4e0\n",
            "# of the machine\n1.5 -2\n\n3 4\n",
            "1,5;-2\n3;4,0;\n",
            "Z\tY\tX\n9\t-2\t1,5\n9\t4\t3\n",
            "1.5,-2,9.01\n3,4,8.99\n",
        ],
        ids=["commas", "spaces", "decimal-commas", "named", "heights"],
    )
    def test_a_point_a_line(self, text: str, tmp_path: Path) -> None:
        path = tmp_path / "p.csv"
        path.write_text(text)
        assert read_measured(path).points_mm.tolist() == [[1.5, -2.0], [3.0, 4.0]]

    @pytest.mark.parametrize(
        ("text", "said"),
        [
            ("1,2\n3,abc\n", "p.csv:2:1: 'abc' is not a finite number"),
            ("1,2\n3\n", "p.csv:2:1: 1 value"),
            ("x_in,y_in\n1,2\n", "p.csv:1:1: the header names inches"),
            ("a,b\n1,2\n", "must name one column x"),
            ("1,5,2,5\n", "separated by semicolons"),
            ("1,10,0\n2,0,10\n3,-10,0\n4,0,-10\n", "the third is no height z"),
            ("x,y\n", "holds no point"),
        ],
    )
    def test_what_is_no_point_is_named_with_its_line(self, text: str, said: str, tmp_path: Path) -> None:
        path = tmp_path / "p.csv"
        path.write_text(text)
        with pytest.raises(WrongInput) as error:
            read_measured(path)
        assert said in str(error.value)


@pytest.mark.judges("metrology")
def test_distances_are_those_of_shapely() -> None:
    """From the chords of the outline, which stray from it by their tolerance at most; inside is negative."""
    outline = outline_of("ellipse")
    chords = Polygon(outline.gear.outline_mm)
    spread = np.random.default_rng(1).normal(scale=0.05, size=outline.gear.outline_mm.shape)
    points = outline.gear.outline_mm + spread
    places = shapely.points(points)
    expected = np.where(chords.contains(places), -1.0, 1.0) * chords.exterior.distance(places)
    assert outline.feet(as_complex(points)).distance_mm == pytest.approx(expected, abs=0.005)


def solved(levers: np.ndarray, errors: np.ndarray) -> np.ndarray:
    return np.linalg.lstsq(levers, errors, rcond=None)[0]


@pytest.mark.judges("metrology")
@pytest.mark.parametrize("rigid", [False, pytest.param(True, marks=pytest.mark.slow)])
def test_what_was_done_to_a_gear_is_found(rigid: bool) -> None:
    """Turning, shift and the error of every flank, within 4.5 standard deviations of the noise, sigma / sqrt(n).

    Errors of flanks turn the gear of best fit by what linear least squares say.
    """
    outline = outline_of("ellipse")
    at, flank, normal = flank_points(outline.gear)
    random = np.random.default_rng(2)
    given = random.normal(scale=0.01, size=2 * outline.gear.teeth)
    noise = random.normal(scale=SIGMA_MM, size=at.size)
    turned, shift = 0.7, (0.3 - 0.2j if rigid else 0j)
    points = (at + (given[flank] + noise) * normal) * np.exp(1j * turned) + shift
    fit = best_fit(outline, points, 0.0, rigid=rigid)
    # By small steps of the pose, points move along their normals.
    moves = np.stack([1j * at, np.exp(-1j * turned) * np.ones(at.size), 1j * np.exp(-1j * turned) * np.ones(at.size)])
    levers = np.real(moves * normal.conj()).T[:, : 3 if rigid else 1]
    expected = solved(levers, given[flank])
    spread = SIGMA_MM * np.sqrt(np.diag(np.linalg.inv(levers.T @ levers)))
    moved = fit.pose.shift_mm - shift
    found = np.array([fit.pose.angle_rad - turned, moved.real, moved.imag])[: expected.size]
    # The second order of a step of 1e-4 is 1e-8 of a tooth's place.
    assert np.all(np.abs(found - expected) < 4.5 * spread + 1e-6)
    left = np.bincount(flank, given[flank] - levers @ expected) / OF_FLANK
    told = deviations(outline, fit).flanks
    assert told.points.tolist() == [OF_FLANK] * left.size
    assert np.abs(told.mean_mm - left).max() < 4.5 * SIGMA_MM / np.sqrt(OF_FLANK) + 1e-6
    # Negative control: without what was given, the flanks would be told wrong.
    assert np.abs(told.mean_mm).max() > 0.01
    own = shapely.points(as_points((points - fit.pose.shift_mm) * np.exp(-1j * fit.pose.angle_rad)))
    measured = shapely.LinearRing(outline_as_measured(outline, fit))
    assert measured.distance(own).max() < 1e-5
    assert shapely.LinearRing(outline.gear.outline_mm).distance(own).max() > 0.01


SPIKES, SPIKE_MM = 9, 0.22


@cache
def spiked() -> tuple[np.ndarray, np.ndarray, np.ndarray, np.ndarray]:
    """Points of the asymmetric ellipse turned by 0.4, their flanks, the errors given to flanks, and where spikes are.

    Of ten points of a flank, some of the first and last, or two beside each other, stand off to either side.
    """
    at, flank, normal = flank_points(outline_of("asymmetric-ellipse").gear, 10)
    random = np.random.default_rng(11)
    given = random.normal(scale=0.008, size=flank.max() + 1)
    off = given[flank] + random.normal(scale=SIGMA_MM, size=at.size)
    rows = np.concatenate([random.choice(at.size // 10, SPIKES - 4, replace=False) * 10 + 4, [0, 29, 55, 56]])
    off[rows] += SPIKE_MM * np.where(np.arange(rows.size) % 3, 1.0, -1.0)
    return (at + off * normal) * np.exp(0.4j), flank, given, np.sort(rows)


def astray(points: np.ndarray, flank: np.ndarray, given: np.ndarray) -> float:
    """How far the means of flanks after the best fit are from those given, in standard deviations of a mean."""
    outline = outline_of("asymmetric-ellipse")
    found = deviations(outline, best_fit(outline, points, 0.0, rigid=False)).flanks
    # The gear of best fit is turned by what the given errors say: by linear least squares.
    at, _, normal = flank_points(outline.gear, 10)
    lever = np.real(1j * at * normal.conj())
    left = given - np.bincount(flank, lever) / 10 * (lever @ given[flank]) / (lever @ lever)
    return float(np.abs(found.mean_mm - left).max() / (SIGMA_MM / np.sqrt(10)))


class TestPointsThatStandAlone:
    @pytest.mark.slow
    def test_they_are_named_and_the_gear_is_as_without_them(self) -> None:
        points, flank, given, rows = spiked()
        outlines = {gear: outline_of("asymmetric-ellipse", gear) for gear in Gear}
        one = compared_gear(outlines, Gear.DRIVING, file_of(points), FittedQuantities.ROTATION, 0.0)
        assert np.flatnonzero(one.fit.alone).tolist() == rows.tolist()
        named = alone_points(one)
        assert sorted(point.line - 1 for point in named) == rows.tolist()
        for point in named:
            number = flank[point.line - 1]
            assert (point.tooth, point.on) == (number // 2 + 1, ("back", "front")[number % 2])
            assert abs(point.off_mm) == pytest.approx(SPIKE_MM, abs=6.0 * SIGMA_MM)
            turned = points[point.line - 1] * np.exp(-0.4j)
            assert np.exp(1j * np.radians(point.angle_deg)) == pytest.approx(turned / abs(turned), abs=1e-4)
        assert astray(points, flank, given) < 5.0
        assert one.deviations.beside == {"root": 0, "tip": 0, "astray": 0}
        assert one.deviations.flanks.greatest_mm.max() < 0.05
        # The outline as measured has no spikes either.
        away = outline_of("asymmetric-ellipse").feet(as_complex(one.outline_mm)).distance_mm
        assert np.abs(away).max() < 0.05

    @pytest.mark.slow
    def test_without_that_the_figures_are_off(self, monkeypatch: pytest.MonkeyPatch) -> None:
        """Negative control."""
        points, flank, given, _ = spiked()
        monkeypatch.setattr(best_fit_module, "alone_mm", lambda outline, feet: np.zeros(feet.row.size))
        assert astray(points, flank, given) > 20.0

    @pytest.mark.slow
    @pytest.mark.parametrize(("depth_mm", "length"), [(0.15, 3), (-0.12, 4), (0.03, 6)])
    def test_a_burr_or_wear_goes_on_from_point_to_point_and_is_of_the_gear(self, depth_mm: float, length: int) -> None:
        outline = outline_of("asymmetric-ellipse")
        at, _, normal = flank_points(outline.gear, 14)
        off = np.random.default_rng(4).normal(scale=SIGMA_MM, size=at.size)
        # In the middle of one flank, and at the tips of three others: the tops of front flanks come last.
        for number, first in ((6, 5), (13, 14 - length), (15, 14 - length), (17, 14 - length)):
            off[number * 14 + first : number * 14 + first + length] += depth_mm
        fit = best_fit(outline, at + off * normal, 0.0, rigid=False)
        assert not fit.alone.any()
        found = deviations(outline, fit).flanks
        worst = found.greatest_mm if depth_mm > 0.0 else -found.least_mm
        assert set(np.argsort(worst)[-4:]) == {6, 13, 15, 17}
        assert worst[[6, 13, 15, 17]] == pytest.approx(abs(depth_mm), abs=6.0 * SIGMA_MM)

    @pytest.mark.slow
    def test_a_rough_gear_is_measured_as_it_is(self) -> None:
        """One point of seven stands off: no dust lies so thick, and none is left out."""
        outline = outline_of("asymmetric-ellipse")
        at, _, normal = flank_points(outline.gear, 14)
        off = np.where(np.arange(at.size) % 7 == 3, 0.1, 0.0)
        fit = best_fit(outline, at + off * normal, 0.0, rigid=False)
        assert not fit.alone.any()

    @pytest.mark.slow
    def test_flanks_that_lean_do_not_stand_alone_at_their_ends(self) -> None:
        outline = outline_of("asymmetric-ellipse")
        at, flank, normal = flank_points(outline.gear, 14)
        share = np.tile(np.linspace(-0.5, 0.5, 14), 2 * outline.gear.teeth)
        off = np.random.default_rng(8).normal(scale=0.5 * SIGMA_MM, size=at.size) + np.where(
            flank == 5, 0.4 * share, 0.0
        )
        assert not best_fit(outline, at + off * normal, 0.0, rigid=False).alone.any()

    def test_two_with_one_between_are_found_wherever_they_are(self) -> None:
        """On a flank of eight points each, at all places from its lower end to its upper one; and two at each end."""
        outline, count = small(), 8
        at, _, normal = flank_points(outline.gear, count)
        pairs = [(first, first + 2) for first in range(count - 2)]
        rows = [(4 * number + 1) * count + place for number, pair in enumerate(pairs) for place in pair]
        off = np.zeros(at.size)
        off[rows] = np.where(np.arange(len(rows)) % 4 < 2, 0.09, -0.13)
        found = alone_mm(outline, outline.feet(at + off * normal))
        assert np.flatnonzero(found).tolist() == rows
        assert found[rows] == pytest.approx(off[rows], abs=1e-6)
        # Moved by one place each, there are three beside each other: of the gear.
        off[np.array(rows[::2]) + 1] = off[rows[::2]]
        assert not alone_mm(outline, outline.feet(at + off * normal)).any()

    def test_noise_of_normal_distribution_does_not_stand_alone(self) -> None:
        """However few points a flank has, none is named below eight standard deviations."""
        outline = small()
        for count in (3, 4, 5):
            at, _, normal = flank_points(outline.gear, count)
            for seed in range(2):
                noise = np.random.default_rng(seed).normal(scale=2.0 * SIGMA_MM, size=at.size)
                assert not alone_mm(outline, outline.feet(at + noise * normal)).any()
                # Control: twelve of them are.
                noise[7] = 48.0 * SIGMA_MM
                assert np.flatnonzero(alone_mm(outline, outline.feet(at + noise * normal))).tolist() == [7]

    @pytest.mark.slow
    def test_a_point_that_is_written_often_is_one(self) -> None:
        outline, count = outline_of("asymmetric-ellipse"), 9
        at, _, normal = flank_points(outline.gear, count)
        off = np.random.default_rng(6).normal(scale=SIGMA_MM, size=at.size)
        off[4 * count + 3] = -0.11
        off[9 * count + 2 : 9 * count + 5] = 0.11
        points = (at + off * normal) * np.exp(0.7j)
        points = np.insert(points, 4 * count + 3, [points[4 * count + 3]] * 4)
        fit = best_fit(outline, points, 0.0, rigid=False)
        assert np.flatnonzero(fit.alone).tolist() == list(range(4 * count + 3, 4 * count + 8))

    def test_flanks_of_two_points_are_not_judged(self) -> None:
        """Nor are those of two places, however often they are written; three places are."""
        outline = outline_of("asymmetric-ellipse")
        at, flank, _ = flank_points(outline.gear, 3)
        few = (flank == 4) & (np.arange(flank.size) % 3 == 0)
        points = np.append(at[~few], at[(flank == 4) & ~few][:1])
        judged = are_judged(outline, outline.feet(points))
        assert judged.tolist() == [*(flank[~few] != 4), False]
        outlines = {gear: outline_of("asymmetric-ellipse", gear) for gear in Gear}
        one = compared_gear(outlines, Gear.DRIVING, file_of(points), FittedQuantities.ROTATION, 0.0)
        assert gear_figures(one)["points_not_judged"] == 3

    @pytest.mark.slow
    def test_a_spike_in_few_points_is_said_to_be_not_judged(self) -> None:
        own = drive("ellipse")
        for count, said in ((2, True), (3, False)):
            at, _, normal = flank_points(own.teeth.driving, count)
            at[7] += 0.12 * normal[7]
            pair = compared_pair(own, {Gear.DRIVING: file_of(at)}, FittedQuantities.ROTATION, 0.0)
            assert not_judged(pair) == (f"{FEW}: {at.size} of the driving gear" if said else "")
            assert pair.gears[0].fit.alone.any() != said

    @pytest.mark.slow
    def test_a_spike_on_a_tip_of_two_points_is_said_to_be_not_judged(self) -> None:
        """It jams the pair as metal would; with a third point beside them it is left out."""
        own = drive("ellipse")
        at, _, _ = flank_points(own.teeth.driving, 5)
        outline = exact_outline(own.teeth.driving)
        land = int(np.flatnonzero(outline.part == TIP_LAND_CURVE)[3])
        for count, said in ((2, True), (3, False)):
            share = np.linspace(0.4, 0.6, count)
            on, slope = outline.at(np.full(count, land), share)
            on[0] -= 0.12j * outline.material * slope[0] / abs(slope[0])
            pair = compared_pair(own, {Gear.DRIVING: file_of(np.append(at, on))}, FittedQuantities.ROTATION, 0.0)
            assert not_judged(pair) == (f"{FEW}: 2 of the driving gear" if said else "")
            assert pair.gears[0].fit.alone.any() != said

    @pytest.mark.slow
    def test_one_spike_of_few_points_is_found(self) -> None:
        """Of fifteen points a single one is more than one in twenty, and no roughness."""
        outline = outline_of("asymmetric-ellipse")
        at, flank, normal = flank_points(outline.gear, 3)
        at[4] += 0.12 * normal[4]
        points = at[flank < 5]
        assert points.size == 15
        assert np.flatnonzero(best_fit(outline, points, 0.0, rigid=False).alone).tolist() == [4]

    @pytest.mark.slow
    def test_how_many_points_are_rough_is_told(self) -> None:
        own = drive("ellipse")
        at, _, normal = flank_points(own.teeth.driving, 14)
        for every, said in ((7, True), (28, False)):
            rows = np.arange(at.size) % every == 3
            pair = compared_pair(own, {Gear.DRIVING: file_of(at + 0.1 * rows * normal)}, FittedQuantities.ROTATION, 0.0)
            told = f"where over 5 % stand off, which all count: {np.count_nonzero(rows)} of the driving gear"
            assert not_judged(pair) == (f"Not judged: whether points stand alone {told}" if said else "")
            assert pair.gears[0].fit.alone.any() != said


FEW = "Not judged: whether points stand alone on flanks, roots and tip lands with fewer than 3"


def not_judged(pair: ComparedPair) -> str:
    return compared_answer(pair, "ellipse", FittedQuantities.ROTATION, "").not_judged


@pytest.mark.slow
def test_an_eccentric_circular_gear_has_the_pitch_error_of_the_closed_form() -> None:
    """F_p = 2 e / cos(alpha) of circular gears about an axis that is e away (ISO 1328-1 states it of runout)."""
    outline, eccentricity = outline_of("uniform-crank"), 0.02
    at, _, _ = flank_points(outline.gear)
    found = deviations(outline, best_fit(outline, at + eccentricity, 0.0, rigid=False)).flanks
    expected = 2.0 * eccentricity / np.cos(np.radians(20.0))
    for front in (False, True):
        # Forty teeth meet both extremes within 1 - cos(pi / 40); along its height a flank turns.
        assert found.cumulative_mm(front) == pytest.approx(expected, rel=0.01)
    # The axis is found wherever the origin of the machine is.
    for shift in (eccentricity, 300.0 - 200.0j):
        assert best_fit(outline, at + shift, 0.0, rigid=True).pose.shift_mm == pytest.approx(shift, abs=1e-9)


@pytest.mark.slow
def test_a_nearly_round_gear_is_not_a_tooth_off() -> None:
    """The pusher's gear is nearly round about its middle: a tooth on, with its axis moved, it nearly fits too."""
    outline = outline_of("pusher")
    at, _, normal = flank_points(outline.gear)
    noise = 0.01 * np.random.default_rng(5).normal(size=at.size)
    pose = best_fit(outline, (at + noise * normal) * np.exp(0.3j) + 7.0, 0.0, rigid=True).pose
    assert pose.angle_rad == pytest.approx(0.3, abs=1e-4)
    assert pose.shift_mm == pytest.approx(7.0, abs=2e-3)


@pytest.mark.slow
def test_a_probe_of_a_ball_and_a_slope_are_found() -> None:
    outline, radius = outline_of("ellipse"), 0.5
    at, _, normal = flank_points(outline.gear)
    share = np.tile(np.linspace(0.1, 0.9, OF_FLANK), 2 * outline.gear.teeth)
    fit = best_fit(outline, at + (radius + 0.01 * (share - 0.5)) * normal, radius, rigid=False)
    found = deviations(outline, fit).flanks
    assert found.slope_mm == pytest.approx(np.full(found.slope_mm.size, 0.01), abs=1e-5)
    assert np.abs(found.form_mm).max() < 1e-5
    # Negative control: taken as points of the surface, the balls lie outside.
    assert np.nanmin(deviations(outline, best_fit(outline, at + 0.1 * normal, 0.0, rigid=False)).thickness_mm) > 0.2


@cache
def small() -> ExactOutline:
    """Of a gear of 19 teeth, which takes little time."""
    gears = "{teeth: 19, module_mm: 1.5, face_width_mm: 10}"
    text = f"name: small\noperation: {{speed_rpm: 60}}\nmotion: {{law: ellipse, eccentricity: 0.3}}\ngears: {gears}\n"
    return exact_outline(drive_of_text(text).teeth.driving)


def posed(points: np.ndarray, probe_mm: float = 0.0) -> BestFit:
    """Points of the small gear as they stand, with nothing fitted."""
    feet = small().feet(points).less(probe_mm)
    return BestFit(Pose(0.0), feet, on_flanks(small(), feet), 0.0, None, np.zeros(points.size))


@pytest.mark.judges("metrology")
def test_deviations_of_flanks_are_what_was_given() -> None:
    """Means, slopes and waves of every flank, and what ISO 1328-1 makes of the means, without any fit."""
    outline, count = small(), 9
    at, flank, normal = flank_points(outline.gear, count)
    share = np.tile(np.linspace(0.1, 0.9, count), 38)
    random = np.random.default_rng(7)
    given, slope, wave = (random.normal(scale=size, size=38) for size in (0.01, 0.01, 0.004))
    # Waves that a line of least squares leaves as they are: up, down, up.
    waves = np.tile(np.where(np.arange(count) == count // 2, -8.0, 1.0), 38)
    off = given[flank] + slope[flank] * (share - 0.5) + np.abs(wave)[flank] * waves
    found = deviations(outline, posed(at + (0.3 + off) * normal, 0.3))
    told = found.flanks
    assert told.mean_mm == pytest.approx(given, abs=1e-6)
    assert told.slope_mm == pytest.approx(slope, rel=2e-3, abs=1e-6)
    assert told.form_mm == pytest.approx(9.0 * np.abs(wave), rel=1e-3, abs=1e-6)
    every = off.reshape(38, count)
    assert (told.least_mm, told.greatest_mm) == (pytest.approx(every.min(axis=1)), pytest.approx(every.max(axis=1)))
    along = given / np.cos(np.radians(20.0))
    assert found.thickness_mm == pytest.approx(along[0::2] + along[1::2], abs=1e-6)
    # Metal on a front flank moves it forwards, on a back flank backwards.
    place = along * np.tile([-1.0, 1.0], 19)
    for front in (False, True):
        own = place[int(front) :: 2]
        assert told.side(told.single_pitch_mm, front) == pytest.approx(own - np.roll(own, 1), abs=1e-6)
        assert told.cumulative_mm(front) == pytest.approx(np.ptp(own), abs=1e-6)
    assert told.largest(told.single_pitch_mm) == told.single_pitch_mm[np.argmax(np.abs(told.single_pitch_mm))]
    assert (told.points.tolist(), found.missing_teeth, found.beside) == (
        [count] * 38,
        [],
        {"root": 0, "tip": 0, "astray": 0},
    )


def test_what_few_points_do_not_tell_is_left_open() -> None:
    """Three points of a flank, or four close together, have no slope; a flank without points has nothing."""
    outline = small()
    at, flank, _ = flank_points(outline.gear, 16)
    number = np.tile(np.arange(16), 38)
    left = (flank > 1) & ~((flank == 4) & (number % 5 > 0)) & ~((flank == 6) & (np.abs(number - 8) > 2))
    beside = [80.0 + 3.0j, 0.0j]
    found = deviations(outline, posed(np.append(at[left & ~((flank == 4) & (number == 15))], beside)))
    told = found.flanks
    assert np.flatnonzero(np.isnan(told.slope_mm)).tolist() == [0, 1, 4, 6]
    assert np.flatnonzero(np.isnan(told.mean_mm)).tolist() == [0, 1]
    assert found.missing_teeth == [1]
    assert np.isnan(found.thickness_mm).tolist() == [True, *[False] * 18]
    assert found.beside["astray"] == 2


@pytest.mark.judges("metrology")
def test_an_outline_as_measured_goes_through_its_points_and_keeps_the_rest() -> None:
    """Between the points of a flank it is between them; tooth 1 has none, and is as exact."""
    outline = small()
    at, flank, normal = flank_points(outline.gear, 4)
    given = 0.02 * np.random.default_rng(8).normal(size=at.size)
    given[flank == 5] = 0.03
    kept = flank > 1
    points = (at + given * normal)[kept]
    found = outline_as_measured(outline, posed(points))
    ring = shapely.LinearRing(found)
    assert ring.is_ccw
    assert ring.distance(shapely.points(as_points(points))).max() < 2e-4
    exact = shapely.LinearRing(outline.gear.outline_mm)
    assert ring.distance(shapely.points(as_points(at[~kept]))).max() < 0.003
    away = np.array([exact.distance(point) for point in shapely.points(found)])
    assert away.max() < np.abs(given[kept]).max() + 0.003
    # All of flank 5 stands out by as much, from end to end.
    whole, _, _ = flank_points(outline.gear, 25)
    (own,) = np.split(whole, 38)[5:6]
    assert ring.distance(shapely.points(as_points(own))) == pytest.approx(0.03, abs=0.003)


def test_points_at_one_place_count_as_their_mean() -> None:
    """Two that are a ten-thousandth of a micrometre apart along the flank: 16 um out and 8 um in are 4 um out."""
    outline = small()
    at, _, normal = flank_points(outline.gear, 3)
    points = np.append(at, at[7] + 1e-7j * normal[7]) + np.append(np.zeros(at.size), -0.008 * normal[7])
    points[7] += 0.016 * normal[7]
    ring = shapely.LinearRing(outline_as_measured(outline, posed(points)))
    wanted = at[7] + 0.004 * normal[7]
    assert ring.distance(shapely.Point(wanted.real, wanted.imag)) == pytest.approx(0.0, abs=1e-4)


def test_points_at_the_ends_of_a_flank_do_not_count() -> None:
    """Of its exact curve between root and tip, where an edge may be broken."""
    outline = small()
    flanks = np.flatnonzero(outline.part == FLANK_CURVE)
    for share, counts in ((0.0, False), (5e-5, False), (0.5, True), (1.0 - 5e-5, False), (1.0, False)):
        at, _ = outline.at(flanks, np.full(flanks.size, share))
        found = on_flanks(outline, outline.feet(at))
        assert found.all() if counts else not found.any(), share


def test_places_that_coincide_are_one_of_their_mean_shift() -> None:
    place, shift = _in_order(np.array([3.0, 1.0, 1.0 + 1e-9, 2.0]), np.array([3.0j, 1.0, 2.0, 5.0 + 1.0j]), 1e-6)
    assert place == pytest.approx([1.0, 2.0, 3.0])
    assert shift == pytest.approx(np.array([1.5, 5.0 + 1.0j, 3.0j]))


@pytest.mark.judges("metrology")
def test_a_gear_beside_its_axis_is_found_with_how_surely() -> None:
    """Turned by less than half a tooth, and moved: both within what the scatter allows, by hand from linear algebra."""
    outline = small()
    at, _, normal = flank_points(outline.gear, 3)
    noise = SIGMA_MM * np.random.default_rng(9).normal(size=at.size)
    found = _fitted(outline, (at + noise * normal) * np.exp(0.02j) + (0.05 - 0.03j), 0.0, Pose(0.0), True, 20)
    assert found is not None
    levers = np.stack(
        [(np.conj(normal) * way).real for way in (1j * at, np.ones(at.size), np.full(at.size, 1j))], axis=1
    )
    spread = SIGMA_MM * np.sqrt(np.diag(np.linalg.inv(levers.T @ levers)))
    assert abs(found.pose.angle_rad - 0.02) < 4.5 * spread[0]
    assert abs(found.pose.shift_mm - (0.05 - 0.03j)) < 4.5 * np.hypot(*spread[1:])
    assert found.angle_error_rad == pytest.approx(spread[0], rel=0.25)
    assert found.shift_error_mm == pytest.approx(spread[1:].max(), rel=0.25)
    assert found.rms_mm == pytest.approx(SIGMA_MM, rel=0.25)
    assert found.counted.all()


class TestForeignPoints:
    """Negative controls: points of something else are refused, and told what they are."""

    @staticmethod
    def said_of(points: np.ndarray, gear: Gear = Gear.DRIVING) -> str:
        outlines = {one: outline_of("asymmetric-ellipse", one) for one in Gear}
        with pytest.raises(WrongInput) as error:
            compared_gear(outlines, gear, file_of(points), FittedQuantities.ROTATION, 0.0)
        return str(error.value)

    @pytest.mark.long
    @pytest.mark.slow
    def test_of_the_other_gear_mirrored_or_in_inches(self) -> None:
        at, _, _ = flank_points(outline_of("asymmetric-ellipse").gear)
        assert "they fit the driving gear; give the file as --driving" in self.said_of(at, Gear.DRIVEN)
        mirrored = self.said_of(at.conj() * np.exp(0.4j))
        assert "p.csv: " in mirrored
        assert "mirror image" in mirrored
        assert "in inches" in self.said_of(at / 25.4)

    def test_too_few(self) -> None:
        at, _, _ = flank_points(outline_of("asymmetric-ellipse").gear)
        assert "fewer than 12 of 8 points" in self.said_of(at[:8])


def dense(gear: ToothedGear, given: np.ndarray) -> np.ndarray:
    """Sixty points of every flank, each flank moved along its normals by what is given."""
    at, flank, normal = flank_points(gear, 60)
    return (at + given[flank] * normal) * np.exp(0.3j)


@cache
def pair(thick: int) -> ComparedPair:
    """The ellipse as measured; a tooth of the driving gear (from 1; 0 for none) is 0.05 mm thicker on both sides."""
    own = drive("ellipse")
    given = {gear: np.zeros(2 * own.teeth.of(gear).teeth) for gear in Gear}
    if thick:
        given[Gear.DRIVING][2 * thick - 2 : 2 * thick] = 0.05
    files = {gear: file_of(dense(own.teeth.of(gear), given[gear])) for gear in Gear}
    return compared_pair(own, files, FittedQuantities.ROTATION, 0.0)


@pytest.mark.slow
def test_measured_as_designed_has_the_contact_of_the_design() -> None:
    """The play of the exact teeth is the same angle everywhere, and they follow the law without error."""
    found = pair(0)
    play = drive("ellipse").play.driven_rad
    # A tenth of a micrometre at the teeth.
    assert found.measured.backlash_rad == pytest.approx(np.full(found.placement.count, play), abs=4e-6)
    assert found.measured_extremes.transmission_error_rad < 5e-6
    assert found.jams == []


@pytest.mark.slow
def test_a_thick_tooth_jams_where_polygons_overlap() -> None:
    thick = 7
    found = pair(thick)
    assert {driving for driving, _ in found.jams} <= {thick - 1, thick, thick + 1}
    assert thick in {driving for driving, _ in found.jams}
    place, play = int(np.argmin(found.measured.backlash_rad)), float(found.measured.backlash_rad.min())
    free = int(np.argmax(found.measured.backlash_rad))
    outlines = {one.gear: one.outline_mm for one in found.gears}
    assert not turns(found, outlines, place, play)
    assert turns(found, outlines, free, play)
    # A tooth thicker by 0.05 mm on both sides takes 0.1 mm, over the arm of its normals, from the angle of play.
    play = drive("ellipse").play
    arms = play.least_normal_mm.value / play.largest_normal_mm.value
    least, most = (0.1 * share - play.least_normal_mm.value for share in (arms, 1.0))
    assert least < found.needed_backlash_mm < most


@pytest.mark.long
@pytest.mark.slow
def test_play_and_error_as_measured_at_shifted_positions_are_within_the_extremes() -> None:
    """At 200 shifted positions a pitch; at the 20 that keep step with the teeth exact outlines seem 3 % more even."""
    found = pair(7)
    shifted = placed(drive("ellipse").pitch, 200)
    shifted = placed_at(drive("ellipse").pitch, shifted, shifted.rolled_mm[1:] - 0.37 * shifted.step_mm)
    reach = reach_mm(drive("ellipse").pitch, found.teeth)
    exact = {gear: found.teeth.of(gear).outline_mm for gear in Gear}
    measured = exact | {one.gear: one.outline_mm for one in found.gears}
    for outlines, searched in ((measured, found.measured_extremes), (exact, found.exact_extremes)):
        both = Outlines("", outlines[Gear.DRIVING], outlines[Gear.DRIVEN])
        # From the middle of the play, where thick teeth overlap at the law's angle
        rolled, known = found.placement.rolled_mm, (found.measured if outlines is measured else found.exact)
        middle = np.interp(shifted.rolled_mm, rolled, (known.pushing_rad + known.back_rad) / 2.0)
        other = as_written(both, found.teeth, replace(shifted, phi2_rad=shifted.phi2_rad + middle), reach)
        for values, one in (
            (other.pushing_rad + middle, searched.pushing_rad),
            (other.back_rad + middle, searched.back_rad),
            (other.backlash_rad, searched.backlash_rad),
        ):
            assert one.low.value - 0.01 * one.width < values.min() < one.low.value + 0.03 * one.width
            assert one.high.value - 0.03 * one.width < values.max() < one.high.value + 0.01 * one.width
    assert np.ptp(found.exact.backlash_rad) < 0.98 * found.exact_extremes.backlash_rad.width
    assert found.measured_extremes.tightest_teeth == found.jams[0]


def turns(found: ComparedPair, outlines: dict[Gear, np.ndarray], place: int, play_rad: float) -> bool:
    """Whether there is a driven angle near the law's at which the polygons are apart."""
    pose = found.placement
    first = affinity.rotate(Polygon(outlines[Gear.DRIVING]), pose.phi1_rad[place], origin=(0, 0), use_radians=True)
    for more in np.linspace(-3.0 * abs(play_rad), 3.0 * abs(play_rad), 61):
        angle = -(pose.phi2_rad[place] + more)
        second = affinity.rotate(Polygon(outlines[Gear.DRIVEN]), angle, origin=(0, 0), use_radians=True)
        if first.intersection(affinity.translate(second, pose.center_distance_mm)).area == 0.0:
            return True
    return False


@pytest.mark.long
@pytest.mark.slow
def test_the_command(run: Run) -> None:
    """A screen, the files, and a gear of which some teeth were not measured."""
    gear = drive("ellipse").teeth.driving
    points = as_points(dense(gear, np.zeros(2 * gear.teeth))[: 60 * 2 * (gear.teeth - 3)])
    # A point of tooth 2's front flank and one of tooth 3's back flank stand off.
    _, _, normal = flank_points(gear, 60)
    for row, off_mm in ((60 * 3 + 17, -0.17), (60 * 4 + 30, 0.25)):
        points[row] += off_mm * as_points(normal * np.exp(0.3j))[row]
    np.savetxt("points.csv", points, delimiter=";", header="x_mm;y_mm", comments="")
    arguments = "measured", str(DESIGNS / "ellipse.yaml"), "--driving", "points.csv"
    status, out, err = run(*arguments)
    assert (status, err) == (0, "")
    assert len(out.splitlines()) <= LINES
    assert max(map(len, out.splitlines())) <= COLUMNS
    assert "flanks without points at 3 teeth" in out
    assert "driving gear: 2 points stand alone, by up to 250 \u00b5m at teeth 3, 2; not counted" in out
    told = json.loads(Path("export/ellipse-measured/measured.json").read_text())
    assert told["driving"]["teeth_with_missing_points"] == [gear.teeth - 2, gear.teeth - 1, gear.teeth]
    assert [one["line"] for one in told["driving"]["alone"]] == [60 * 4 + 32, 60 * 3 + 19]
    assert told["driving"]["turned_rad"] == pytest.approx(0.3, abs=1e-9)
    rows = Path("export/ellipse-measured/measured.csv").read_text().splitlines()
    assert len(rows) == 1 + 2 * gear.teeth
    status, out, _ = run(*arguments, "--verbose")
    assert status == 0
    assert len([line for line in out.splitlines() if line.split()[1:2] in (["back"], ["front"])]) == 2 * gear.teeth
    status, _, err = run("measured", str(DESIGNS / "ellipse.yaml"))
    assert status == 2
    assert "points of one gear or both are needed" in err


@pytest.mark.long
@pytest.mark.slow
def test_a_gear_of_two_pairs_is_held_against_its_own_pair(run: Run) -> None:
    """Points of an exact gear deviate by rounding only; those of the other pair's gear are no points of this one."""
    design = DESIGNS / "baler-66-two-stage.yaml"
    for pair in drive("baler-66-two-stage").by_stage:
        np.savetxt(f"{pair.stage}.csv", pair.teeth.driven.outline_mm, delimiter=",")
    status, out, err = run("measured", str(design), "--driven", "2.csv", "--stage", "2")
    assert (status, err) == (0, "")
    assert out.startswith("baler-66-two-stage-stage-2")
    told = json.loads(Path("export/baler-66-two-stage-stage-2-measured/measured.json").read_text())
    assert abs(told["driven"]["turned_rad"]) < 1e-6
    status, _, err = run("measured", str(design), "--driven", "1.csv", "--stage", "2")
    assert status == 2
    assert "1.csv: the points are 0.569 mm" in err
    status, _, err = run("measured", str(design), "--driven", "1.csv")
    assert status == 2
    assert "motion.second_stage: given: two pairs of gears; --stage 1 or --stage 2 says which one" in err
    status, _, err = run("measured", str(DESIGNS / "ellipse.yaml"), "--driven", "1.csv", "--stage", "1")
    assert status == 2
    assert "motion: has one pair of gears; leave out --stage" in err
