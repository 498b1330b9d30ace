"""Edges of windows, files, pictures, advice and steps that no test had judged, on a few numbers by hand."""

from __future__ import annotations

from math import pi, sqrt
from types import SimpleNamespace
from typing import Any

import numpy as np
import pytest
from shapely import Polygon

import ncgear.contact.written.apart as apart
import ncgear.drawings.pictures as pictures
import ncgear.dynamics.quasi_static as quasi_static
import ncgear.formulas.laws as laws
import ncgear.studio.form as form
import ncgear.trains.tip_path as tip_path
from at_once import at_once
from ncgear.balance.waveform import Waveform
from ncgear.contact.designed.tangency import _touches
from ncgear.contact.written.as_written import _chords
from ncgear.design.reading.measured_file import _require_height
from ncgear.design.reading.yaml import read_yaml
from ncgear.drawings.scene.bodies import _bar
from ncgear.dynamics.train_knocks import PER_SWING, SWINGS, KnockingTrain
from ncgear.errors import WrongInput
from ncgear.figures.advice.teeth_advice import _parts
from ncgear.kinematics import crank_stretches
from ncgear.numerics.chebyshev import PiecewiseChebyshev
from ncgear.numerics.crossing import zoomed_crossings
from ncgear.pitch.pair import STRAIGHT, PitchPair
from ncgear.pitch.shape import Gear
from ncgear.project.finer import fewest
from ncgear.project.geared import Geared
from ncgear.solids.plan.areas import stl_resolution_mm
from ncgear.studio.editing import _counterparts

Made: Any = SimpleNamespace


@pytest.mark.judges("contact")
@at_once("low_mm", [0.0, 20.0, 150.0])
@at_once("wide_mm", [1.0, 12.0, 60.0])
def test_chords_over_a_stretch_of_a_circle_are_counted(low_mm: float, wide_mm: float) -> None:
    """A circle of 30 mm in 360 chords, each 0.5236 mm long: as many as the stretch covers, and a few more."""
    around = 30.0 * np.exp(2j * pi * np.arange(360) / 360.0)

    def position(at: Any) -> Any:
        return Made(position=30.0 * np.stack([np.cos(at / 30.0), np.sin(at / 30.0)], axis=-1))

    flanks: Any = Made(curve=Made(at_length=position))
    low = np.array([low_mm, low_mm])
    found = _chords(np.stack([around.real, around.imag], 1), flanks, low, low + np.array([wide_mm, 0.1]))
    assert wide_mm / (pi / 6.0) <= found[0] <= wide_mm / (pi / 6.0) + 4.0
    assert found[1] <= 4


@pytest.mark.judges("contact")
@at_once(
    ("own", "other", "within"),
    [
        # Leaving and entering turns, each up and down: whichever is nearer tells whether the nearest vertex is inside.
        ([[0.3, 0.4], [0.1, 0.2]], [[0.5, 0.6], [0.2, 0.9]], True),
        ([[0.3, 0.4], [0.5, 0.2]], [[0.5, 0.6], [0.2, 0.9]], True),
        ([[0.3, 0.4], [0.5, 0.6]], [[0.5, 0.6], [0.2, 0.9]], False),
        ([[0.3, 0.4], [0.1, 0.2]], [[0.5, 0.6], [0.7, 0.8]], False),
    ],
)
def test_outlines_that_do_not_cross_are_apart_where_the_nearest_vertex_is_outside(
    own: Any, other: Any, within: bool
) -> None:
    """Play is the least turn up and down; up for the driving gear is down for the driven gear's vertices."""
    parallel = Made(start=np.array([[0j]]), against=np.array([[1.0 + 0j]]), length_mm=np.array([[1.0]]))
    above = Made(start=np.array([[5j]]), against=np.array([[1.0 + 0j]]), length_mm=np.array([[1.0]]))
    turns = iter([np.array(own)[..., None], np.array(other)[..., None]])
    setting: Any = Made(placement=Made(pitch_mm=6.0), stretches=Made(position=np.array([[0]])))
    with pytest.MonkeyPatch.context() as patch:
        patch.setattr(apart, "_placed", lambda *_: (parallel, above))
        patch.setattr(apart, "_least_turns", lambda *_: next(turns))
        play, free = apart._block_play(setting, Made(row=np.array([0])), np.array([0]), 9.0)
    assert free.tolist() == [within]
    up, down = (min(*np.array(own)[:, way], *np.array(other)[:, 1 - way]) for way in (0, 1))
    assert play[:, 0] == pytest.approx([up, down])


@pytest.mark.judges("design")
@at_once(
    ("third", "refused"),
    [
        (["1.0", "1.3", "0.8"], False),
        (["1.0", "1.5", "0.9"], True),
        (["1.0", "9.0", "-9.0"], True),
        (["1.0", "9.0", "top"], False),
    ],
)
def test_heights_differ_by_a_tenth_of_the_smaller_extent_at_most(third: list[str], refused: bool) -> None:
    """Points over 100 mm in x and 5.9 mm in y; a column with words is no column of numbers."""
    points = np.array([[0.0, 0.0], [100.0, 5.9], [50.0, 2.0]])
    try:
        _require_height(third, points, "p.csv")
        said = ""
    except WrongInput as error:
        said = error.problem
    assert ("no height z" in said) is refused


@pytest.mark.judges("design")
@at_once(
    ("text", "place"),
    [
        ("name: a\nlaw: [1, 2\nsize: 3\n", "d.yaml:3:5"),
        ("name: a\n\n  law: b: c\n", "d.yaml:3:6"),
        ("name: 'open\nlaw: 1\n", "d.yaml:1:7"),
    ],
)
def test_a_fault_of_yaml_has_the_line_of_its_text(text: str, place: str) -> None:
    with pytest.raises(WrongInput) as error:
        read_yaml(text, "d.yaml")
    assert error.value.location == place


# --- pictures


@pytest.mark.judges("drawings")
@pytest.mark.parametrize("covered", [None, 2.0])
def test_positions_of_a_picture_are_thirds_of_a_turn_or_the_ends_of_a_range_and_its_middle(
    covered: float | None, monkeypatch: pytest.MonkeyPatch
) -> None:
    asked: list[Any] = []
    for name in ("assembled_pitch_curves", "assembled_teeth", "_name_of_pair"):
        monkeypatch.setattr(pictures, name, lambda drive: None)
    monkeypatch.setattr(pictures, "positions_at", lambda drive, angles: asked.append(angles))
    lobes = Made(range=covered and Made(driving_rad=covered))
    pictures.gear_pictures(Made(pair=Made(transmission=Made(lobes=lobes)), pitch=Made(size=Made(module_mm=2.0))))
    assert asked[0] == pytest.approx([0.0, 1.0, 2.0] if covered else [0.0, 2.0 * pi / 3.0, 4.0 * pi / 3.0])


@pytest.mark.judges("drawings")
def test_a_bar_is_as_wide_as_asked_along_its_line() -> None:
    """From (1, 2) to (4, 6), five long."""
    bar = _bar(np.array([1.0, 2.0]), np.array([4.0, 6.0]), 0.5)
    assert (bar.area, bar.length) == pytest.approx((5.0, 12.0))
    assert bar.symmetric_difference(Polygon([(0.6, 2.3), (1.4, 1.7), (4.4, 5.7), (3.6, 6.3)])).area < 1e-12


# --- words


@pytest.mark.judges("figures")
@at_once(("gap", "parts"), [(0.5, False), (0.61, True)])
def test_flanks_part_where_a_helix_does_not_bridge_their_gap(gap: float, parts: bool) -> None:
    drive: Any = Made(overlap_ratio=1.5, designed_contact=Made(placement=Made(per_tooth=0.4)))
    assert _parts(drive, Made(pairs=Made(longest_gap=gap))) is parts


@pytest.mark.judges("formulas")
@pytest.mark.parametrize("variable", ["phi_1", "phi_2"])
def test_a_piece_over_the_driven_angle_says_what_it_is_without(variable: str) -> None:
    """The reason stands at the angle that is not written."""
    told: list[Any] = []
    write = Made(
        variable=laws.symbol(variable),
        steps={laws.symbol("i_12"): 1, laws.symbol("x"): 1},
        number=lambda name, value: laws.symbol(name),
        step=lambda name, value: None,
        written=lambda name, ends, without: told.append(without),
    )
    laws._whole(Made(write=write, without="no inverse", name="piece", ends=(0.0, 1.0)), Made(), None)
    assert told == [{"phi_2": "no inverse"} if variable == "phi_1" else {"phi_1": "no inverse"}]


# --- numbers


@pytest.mark.judges("pitch")
@at_once(("share", "convex"), [(1.0, True), (0.0, True), (-0.5, True), (-2.0, False)])
def test_a_curve_is_convex_but_for_rounding_of_its_size(share: float, convex: bool) -> None:
    """Curvatures of gears 50 mm apart, in the rounding that counts, at a distance of 1."""
    pair: Any = Made(center_distance_mm=50.0, _bend_range=lambda gear: (share * STRAIGHT / 50.0, 1.0))
    assert PitchPair.convex(pair, Gear.DRIVING) is convex


@pytest.mark.judges("balance")
@pytest.mark.parametrize("count", [3, 60])
def test_waves_of_a_parabola_on_one_panel_are_its_fourier_series(count: int) -> None:
    """x^2 on 0 to 1, as (3 + 4 T1 + T2) / 8 of 2 x - 1: 1/3, and 1 / (2 pi^2 k^2) + i / (2 pi k)."""
    form = PiecewiseChebyshev(np.array([0.0, 1.0]), np.array([[3.0], [4.0], [1.0]]) / 8.0)
    found = Waveform(form).harmonics(count)
    k = np.arange(1, count + 1)
    assert found == pytest.approx([1.0 / 3.0, *(1.0 / (2.0 * pi**2 * k**2) + 0.5j / (pi * k))], abs=1e-12)


@pytest.mark.judges("numerics")
@pytest.mark.parametrize(("at1", "at2"), [(0.31, -0.22), (-0.4, 0.05), (0.0, 0.0)])
def test_a_flat_crossing_is_closed_in_on_from_both_sides(at1: float, at2: float) -> None:
    """Lines that lean by a thousandth against each other, and a curve that is missed."""

    def first(t: Any) -> Any:
        return np.stack([t, 0.001 * (t - at1)], axis=-1), None

    def second(u: Any) -> Any:
        return np.stack([u - at2 + at1, -0.001 * (u - at2)], axis=-1), None

    one, other, there = zoomed_crossings(first, second, np.zeros(1), np.zeros(1), np.ones(1), np.ones(1))
    assert there.all()
    assert (one[0], other[0]) == pytest.approx((at1, at2), abs=1e-9)
    assert not zoomed_crossings(
        first, lambda u: (second(u)[0] + [0.0, 1.0], None), np.zeros(1), np.zeros(1), np.ones(1), np.ones(1)
    )[2].any()


@pytest.mark.judges("dynamics")
def test_a_step_is_a_part_of_the_fastest_swing_of_two_meshes() -> None:
    """Swings of both bodies on stiffnesses that grow along the way; the fastest of the swings ahead counts."""
    between, driven, slope, speed = 2.0, 5.0, 1.5, 3.0

    def at(phi: Any) -> Any:
        first = 1000.0 * (1.0 + np.asarray(phi))
        ones = np.ones_like(first)
        inertia = np.stack([between * ones, driven * ones])
        return Made(stiffness=np.stack([first, 2.0 * first]), slope=np.stack([ones, slope * ones]), inertia=inertia)

    def fastest(phi: float) -> float:
        stiff = 1000.0 * (1.0 + phi)
        return sqrt((stiff + slope**2 * 2.0 * stiff) / between + 2.0 * stiff / driven)

    train: Any = Made(speed_rad_s=speed, _at=at)
    ahead = 0.4 + 2.0 * pi * speed * SWINGS / fastest(0.4)
    assert KnockingTrain._step_s(train, 0.4) == pytest.approx(2.0 * pi / (PER_SWING * fastest(ahead)))


# --- searches and sizes


@pytest.mark.judges("project")
@at_once("least", [11, 13, 19, 30, 57, 100])
@at_once("needed", [0.0, 12.0, 19.0, 60.0])
@at_once("about", [0.05, 0.5])
@at_once("each", [1, 3])
def test_the_fewest_are_found_from_any_estimate(least: int, needed: float, about: float, each: int) -> None:
    """The least multiple from 10 on that is not under a number; none where even the most is under it."""
    found = fewest(lambda count: count >= least, 10, 90 // each * each, each, needed, about)
    assert found == (0 if least > 90 else -(-least // each) * each)


@pytest.mark.judges("project")
@pytest.mark.parametrize("covered", [None, 2.5])
def test_open_gears_run_out_and_back_over_what_is_covered(covered: float | None) -> None:
    """60 mm of the pitch curves over 2.5 and 1.5 rad, at a module of 2 mm: as whole gears of 24 and 40 teeth."""
    toothed = covered and Made(covered_rad=covered, covered_mm=60.0)
    angle = Made(value=np.array([-1.5]))
    transmission = Made(lobes=Made(driving=2), driven_angle=lambda phi: angle)
    drive: Any = Made(
        pitch=Made(size=Made(module_mm=2.0, driving_teeth=20, driven_teeth=30), toothed=toothed),
        gears=Made(face_width_mm=12.0),
        machine=Made(speed_rad_s=3.0),
        transmission=transmission,
        pair=Made(transmission=Made(lobes=Made(driving=1))),
        design=Made(strength=Made(mates=4)),
        stage=2,
        overlap_ratio=0.5,
    )
    found = Geared.running.func(drive)  # type: ignore[attr-defined]
    assert (found.module_mm, found.teeth, found.face_width_mm, found.speed_rad_s) == (2.0, (20, 30), 12.0, 6.0)
    assert (found.overlap_ratio, found.mates) == (0.5, 1)
    drive.stage = 1
    assert Geared.running.func(drive).mates == 4  # type: ignore[attr-defined]
    if covered:
        assert found.stroke_rad == pytest.approx(5.0)
        assert found.around == pytest.approx((24.0, 40.0))


@pytest.mark.judges("solids")
def test_points_of_single_precision_are_apart_by_two_of_its_steps() -> None:
    """Numbers from 64 to 128 have steps of 2^(6 - 23)."""
    assert stl_resolution_mm([3.0, -100.0, 64.0]) == 2.0 * 2.0**-17


@pytest.mark.judges("contact")
@pytest.mark.parametrize("turn", [1e-7, -3e-7])
def test_the_angle_of_a_touch_is_corrected_by_the_gap_that_is_left_across_its_tangent(turn: float) -> None:
    """A point 30 mm from the axis that turns on by the rest of the angle, and slides along the tangent."""
    point, slope = 30.0 * np.exp(0.4j), 2.0 * np.exp(0.9j)
    state: Any = Made(
        driving_mm=None,
        driven_mm=None,
        turn_rad=np.array([0.2]),
        point=np.array([point]),
        slope=np.array([slope]),
        gap=np.array([point * (np.exp(1j * turn) - 1.0) + 0.001 * slope]),
    )
    assert _touches(state).turn_rad - 0.2 == pytest.approx([turn], rel=1e-6)


@pytest.mark.judges("trains")
def test_a_wished_path_is_missed_over_one_whole_turn(monkeypatch: pytest.MonkeyPatch) -> None:
    asked: list[Any] = []
    monkeypatch.setattr(tip_path, "distances_mm", lambda points, places: places)
    motion: Any = Made(tip=lambda angles: asked.append(angles))
    tip_path.missed_mm(motion, Made(points=None))
    assert asked[0] == pytest.approx(np.linspace(0.0, 2.0 * pi, tip_path.FINE + 1))


@pytest.mark.judges("studio")
def test_lines_keep_their_numbers_about_lines_that_were_put_in() -> None:
    """Two new lines: one before three that stay together, and one after them."""
    former, lines = ["x", "a", "b", "c", "p", "y"], ["x", "n", "a", "b", "c", "m", "p", "q", "y"]
    assert _counterparts(former, lines) == {0: 0, 2: 1, 3: 2, 4: 3, 6: 4, 8: 5}


@pytest.mark.judges("drawings")
def test_a_picture_of_positions_has_a_panel_for_each(monkeypatch: pytest.MonkeyPatch) -> None:
    """Three positions beside each other; the whole pair is half as high as wide, the mesh 0.95 of a panel."""
    from ncgear.drawings.plots import assembled_pair

    asked: list[tuple[float, float]] = []

    def figure(wide: float, high: float, title: str) -> Any:
        asked.append((wide, high))
        raise StopIteration

    monkeypatch.setattr(assembled_pair.canvas, "figure", figure)
    with pytest.raises(StopIteration):
        assembled_pair.teeth_png(Made(frame=(-10.0, 30.0, 10.0)), 2.0, [Made()] * 3, "title")
    panel = assembled_pair.PANEL_IN
    assert asked == [pytest.approx((3.0 * panel + 0.85, 1.45 * panel + 1.5))]


@pytest.mark.judges("studio")
@at_once(
    ("rules", "value", "kind"),
    [
        ([{"type": "number"}, {"type": "string"}], 3.0, "other"),
        ([{"type": "string"}], "a", "text"),
        ([{"type": "object"}], "a", "other"),
        ([{"type": "array"}], None, "numbers"),
        ([{"enum": ["a", "b"]}], "a", "choice"),
        ([{"type": "boolean"}], True, "truth"),
    ],
)
def test_a_field_is_of_the_kind_of_its_only_rule(rules: Any, value: Any, kind: str) -> None:
    key: Any = Made(rule=None, field=Made(is_required=lambda: False), is_law_name=False)
    with pytest.MonkeyPatch.context() as patch:
        for name, found in (("choices", rules), ("_head", {}), ("allowed", ""), ("default_words", "none, say")):
            patch.setattr(form, name, lambda *_, found=found: found)
        row: Any = form._plain(key, True, value, Made)
    assert (row["kind"], row["value"], row["needed"], row["hint"]) == (kind, value, False, "none")


@pytest.mark.judges("dynamics")
@pytest.mark.parametrize("torque", [5.0, -5.0])
def test_a_balance_is_between_the_first_touch_and_a_depth_that_bears_the_torque(torque: float) -> None:
    """Flanks touch 2 mrad ahead of the law, backs 1 mrad behind; each bears 1000 N mm for a rad of its depth."""
    first = 0.002 if torque > 0.0 else -0.001
    sense = np.sign(torque)

    def missing(ahead: Any) -> Any:
        return sense * 1000.0 * np.maximum(sense * (first - ahead), 0.0) - torque

    meshing: Any = Made(gaps=Made(play_rad=lambda phi: (np.array([0.002]), np.array([-0.001]))))
    low, high = quasi_static._bracket(missing, meshing, np.zeros(1), np.array([torque]))
    start, end = (high, low) if torque > 0.0 else (low, high)
    assert start == pytest.approx([first + sense * quasi_static.CLEAR_RAD], abs=1e-15)
    assert sense * missing(end) >= 0.0
    assert low < first - torque / 1000.0 < high


@pytest.mark.judges("kinematics")
@pytest.mark.parametrize(("last", "level", "at"), [(0, 2.25, 0.25), (1, 3.4, 1.4), (2, 4.0, 2.0), (1, 9.0, 2.0)])
def test_a_speed_is_passed_between_its_samples(last: int, level: float, at: float) -> None:
    """Speeds of 2 + phi at 0, 1 and 2 rad; a speed that is not passed is nearest at an end of its step."""
    angles = np.array([0.0, 1.0, 2.0])
    machine: Any = Made(displacement=lambda phi, order: Made(derivative=lambda number: -(2.0 + phi)))
    on: Any = Made(phi1_rad=angles, speed=2.0 + angles)
    assert crank_stretches._where(machine, on, last, level) == pytest.approx(at)
    still: Any = Made(phi1_rad=angles, speed=np.full(3, 2.0))
    assert crank_stretches._where(machine, still, 1, 2.0) == 1.0
