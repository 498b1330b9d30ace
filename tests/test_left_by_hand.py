"""What other tests had left alone, on a few numbers by hand: ends, limits, arrows, thinned teeth, printed readings."""

from __future__ import annotations

import os
import stat
from dataclasses import dataclass
from math import cos, hypot, pi
from pathlib import Path
from types import SimpleNamespace
from typing import Any

import numpy as np
import pytest
from mpmath import mp

import ncgear.figures.balance.shaking as shaking
import ncgear.project.strengthening as strengthening
import ncgear.whole_machines.conflict as conflict
from at_once import at_once
from ncgear.balance import frame
from ncgear.contact.designed import edges
from ncgear.design.wishes.dwell import Dwell
from ncgear.errors import Unanswered, WrongInput
from ncgear.files.workshop.sheets import gear_tables
from ncgear.files.workshop.sheets.sheet import ARROW_MM, arrow
from ncgear.kinematics import crank_stretches
from ncgear.kinematics.motion import Stretch
from ncgear.metrology import deviations
from ncgear.metrology.exact_outline import FLANK_CURVE
from ncgear.numerics.extrema import Extremum
from ncgear.numerics.formula import composed
from ncgear.numerics.jet import Jet
from ncgear.papers.gear_baler import synthesis
from ncgear.papers.track_chassis import measurements
from ncgear.ratio.laws.curve_shapes import _are_noise, _means
from ncgear.solids.plan.body import Bore, Keyway
from ncgear.studio.on_disk import DesignOnDisk
from ncgear.teeth import backlash
from ncgear.whole_machines import limits
from ncgear.whole_machines.conflict import Easing

Made: Any = SimpleNamespace


@pytest.mark.judges("contact")
def test_a_corner_is_found_where_a_curve_passes_its_circle(monkeypatch: pytest.MonkeyPatch) -> None:
    """Lines along x at a height of 3 mm meet circles of 5 mm and 3.25 mm at x = 4 and 1.25."""
    curves = Made(curve=lambda run, parameter, position: (parameter + 3.0j, 1.0 + 0.0 * parameter))
    ends = np.zeros(2), np.full(2, 10.0)
    hits: Any = Made(curves=curves, run=None, position=None, corner=np.array([5.0j, 3.25 + 0.0j]), ends=ends, named=str)
    assert edges._bracketed(hits) == pytest.approx([4.0, 1.25])
    monkeypatch.setattr(edges, "zeros_between", lambda missing, low, high: np.array([4.0, 1.3]))
    with pytest.raises(Unanswered, match=r"^1: "):
        edges._bracketed(hits)


@pytest.mark.judges("design")
@at_once(
    ("dwells", "refused"),
    [
        ([("retracted", 3.0, True), ("extended", 3.2, True)], False),
        ([("retracted", 3.0, True), ("extended", 3.3, True)], True),
        ([("retracted", 1.0, True), ("retracted", 3.0, True), ("extended", 3.3, True)], True),
        ([("retracted", 1.0, True), ("retracted", 3.0, False), ("extended", 3.3, True)], False),
    ],
)
def test_the_longest_hard_dwells_of_both_ends_leave_time_for_the_ways(dwells: Any, refused: bool) -> None:
    own = [Made(at=at, for_angle_rad=angle, hard=hard, within_mm=1.0) for at, angle, hard in dwells]
    wishes: Any = Made(of=lambda cls: own)
    on: Any = Made(cycle_rad=2.0 * pi)
    try:
        Dwell.refuse_together(wishes, on)
        said = ""
    except WrongInput as error:
        said = error.problem
    except AttributeError:
        said = "gone on"
    assert ("together" in said) is refused


@pytest.mark.judges("figures")
def test_a_chassis_is_told_what_both_loads_need_together(monkeypatch: pytest.MonkeyPatch) -> None:
    found = Made(retracted_kg=30.0, extended_kg=20.0, worst_kg=Extremum(35.0, pi / 6.0))
    monkeypatch.setattr(frame, "dynamic_counterweights", lambda chassis, mechanism: found)
    monkeypatch.setattr(frame, "static_counterweight_kg", lambda *_: 12.0)
    asked = Made(mechanism="b", slider_kg=1.0, weight_kg=2.0, weight_lever_mm=3.0)
    asked = Made(**vars(asked), support_mm=4.0, counterweight_mm=5.0, tilt_deg=6.0)
    balance = Made(chassis=asked, mechanisms=[Made(name="a"), Made(name="b")])
    told = shaking.chassis_figures(Made(balance=balance, mounted=[Made(mechanism="a"), Made(mechanism="b")]))
    assert (told["total_retracted_kg"], told["total_worst_kg"], told["against_weight_kg"]) == (42.0, 47.0, 12.0)
    assert told["worst_at_deg"] == pytest.approx(30.0)


# --- sheets


@pytest.mark.judges("files")
def test_an_arrowhead_is_three_times_as_long_as_wide() -> None:
    tip, way = np.array([10.0, 20.0]), np.array([3.0, 4.0])
    head, left, right = arrow(tip, way).points
    assert head == pytest.approx(tip)
    assert (left + right) / 2.0 == pytest.approx(tip - ARROW_MM * way / 5.0)
    assert left - right == pytest.approx(ARROW_MM / 3.0 * np.array([-4.0, 3.0]) / 5.0)


@pytest.mark.judges("files")
@pytest.mark.parametrize("keyway", [None, Keyway(6.0, 2.8)])
def test_a_bore_and_its_keyway_are_in_the_middle_of_their_view(keyway: Any, monkeypatch: pytest.MonkeyPatch) -> None:
    """But for the millimetre that the dimension on the left needs; its lowest point is 10.5 mm over the box."""
    drawn: list[Any] = []
    monkeypatch.setattr(gear_tables, "drawn_shape", lambda shape, view, pen: drawn.append(view) or [])
    monkeypatch.setattr(gear_tables, "bore_text", lambda *_: "H7")
    monkeypatch.setattr(gear_tables, "point_at_circle", lambda *_: None)
    monkeypatch.setattr(gear_tables.paper, "length", lambda *_: Made())
    monkeypatch.setattr(gear_tables.Board, "add", lambda self, *_: None)
    bore = Bore(20.0, keyway)
    box: Any = Made(left=100.0, right=200.0, low=50.0, high=120.0, width=100.0, height=70.0)
    gear_tables._bore_view(Made(), bore, box)
    view = drawn[0]
    ends = view.on_paper(np.array([[-10.0, 0.0], [bore.reach_mm, 0.0], [0.0, -10.0]]))
    assert (ends[0, 0] + ends[1, 0]) / 2.0 == pytest.approx(149.0)
    assert ends[2, 1] == pytest.approx(60.5)


# --- motion


@pytest.mark.judges("kinematics")
def test_inner_knots_of_a_stretch_are_those_of_its_turn() -> None:
    piece = Made(knots_rad=(0.5, 1.0, 2.0), start_rad=0.0, end_rad=3.0)
    stretch: Any = Stretch(10.6, 12.5, True, Made(), piece, (10.0, 4.0))
    assert stretch.knots_rad == (11.0, 12.0)


@pytest.mark.judges("kinematics")
@pytest.mark.parametrize(
    ("level", "lowest", "highest", "limits"), [(1.8, 2.0, 4.4, (1.8, 4.4)), (5.0, 2.2, 4.6, (2.2, 5.0))]
)
def test_a_stretch_of_even_speed_ends_at_its_slowest_or_fastest_speed(
    level: float, lowest: float, highest: float, limits: tuple[float, float], monkeypatch: pytest.MonkeyPatch
) -> None:
    """Its speed at the end counts beside those of the samples; all are in mm per rad at 2 rad/s."""
    samples = Made(speed=np.ones(3), place_mm=np.array([0.0, 5.0, 9.0]), phi1_rad=np.array([0.1, 0.2, 0.3]))
    monkeypatch.setattr(crank_stretches, "stretches", lambda machine: [Made(working=True)])
    monkeypatch.setattr(crank_stretches, "_sampled", lambda parts, most: samples)
    reach = np.array([2, 2, 2]), np.full(3, highest), np.full(3, lowest)
    monkeypatch.setattr(crank_stretches, "_reach", lambda speed, most: reach)
    monkeypatch.setattr(crank_stretches, "_beyond", lambda *_: (np.zeros(3), np.full(3, level)))
    monkeypatch.setattr(crank_stretches, "_where", lambda machine, on, last, at: 0.3)
    machine: Any = Made(speed_rad_s=2.0, displacement=lambda phi1, order: Made(value=np.array([9.0])))
    found = crank_stretches.longest_even_stretch(machine, crank_stretches.Stroke.WORKING, 0.1)
    values = [getattr(found, name) for name in crank_stretches.EvenStretch.__dataclass_fields__]
    assert values == pytest.approx([0.1, 0.3, 0.0, 9.0, 2.0 * limits[0], 2.0 * limits[1]])


# --- curves and teeth


@pytest.mark.judges("ratio")
def test_means_of_neighbours_go_once_round() -> None:
    """Five places of a curve and its first one again: pairs, and the last place alone."""
    angles, radii = np.array([0.0, 1.0, 2.0, 3.0, 4.0, 6.0]), np.array([10.0, 12.0, 20.0, 22.0, 30.0, 10.0])
    angle, radius = _means(angles, radii, 2, 6.0)
    assert angle.tolist() == [0.5, 2.5, 4.0, 6.5]
    assert radius.tolist() == [11.0, 21.0, 30.0, 11.0]


@pytest.mark.judges("ratio")
def test_deviations_are_noise_where_steps_are_as_large_as_they() -> None:
    random = np.random.default_rng(2)
    assert _are_noise(random.normal(size=400))
    assert not _are_noise(np.sin(np.linspace(0.0, 6.0, 400)) + 0.05 * random.normal(size=400))


@pytest.mark.judges("teeth")
@pytest.mark.parametrize("share", [0.2, 0.5])
def test_play_thins_teeth_by_its_largest_part(share: float) -> None:
    """Arms of 20 and 26 mm under 20 deg and a play of 0.3 mm: what is set back, or what is left of the largest arm."""
    pitch: Any = Made()
    rack: Any = Made(angles_rad=(0.3, pi / 9.0), pitch_mm=3.0 * pi)
    asked: Any = Made(thickness_mm=(0.0, 0.0), least_normal_mm=0.3, driven_rad=0.0, driving_share=share, thicker_mm=0.0)
    told: list[float] = []
    with pytest.MonkeyPatch.context() as patch:
        patch.setattr(backlash, "idle_arms_mm", lambda *_: (Extremum(20.0, 0.1), Extremum(26.0, 0.2)))
        patch.setattr(backlash, "require_teeth", lambda asked, thinner, rack: told.append(thinner) or 5.0)
        found = backlash.play_of.__wrapped__(pitch, rack, asked)
    setback = share * 0.3 / cos(pi / 9.0)
    assert found.setback_mm == pytest.approx(setback)
    assert found.driven_rad == pytest.approx(0.015)
    assert told == [pytest.approx(max(setback, 0.015 * 26.0 / cos(pi / 9.0) - setback))]
    assert found.largest_normal_mm.value == pytest.approx(0.39)


@pytest.mark.judges("metrology")
def test_ends_of_flanks_move_as_their_nearest_points() -> None:
    """Two flanks and a land between: the first moves by 0.1 and 0.3 mm outwards, the other, without points, by none."""
    outline: Any = Made(
        part=np.array([FLANK_CURVE, FLANK_CURVE + 1, FLANK_CURVE]),
        flank=np.array([0, 0, 1]),
        begin_mm=np.array([0.0, 5.0, 7.0]),
        length_mm=np.array([5.0, 2.0, 5.0]),
        material=1.0,
        at=lambda rows, share: (None, np.full(rows.size, 2.0 + 0.0j)),
    )
    ends, moved = deviations._flank_ends(
        outline, np.array([0, 0, 1]), np.array([1.0, 4.0, 6.0]), np.array([0.1, 0.3, 9.0])
    )
    assert ends.tolist() == [0.0, 5.0, 7.0, 12.0]
    assert moved == pytest.approx([-0.1j, -0.3j, 0.0, 0.0])


@pytest.mark.judges("numerics")
@pytest.mark.parametrize("exponent", [1.0, 1.2, 0.0, 2.0, -1.0, 0.5, 3.0])
def test_powers_are_those_of_many_digits(exponent: float) -> None:
    places = np.array([0.3, 1.0, 2.7])
    found = composed(f"x**{exponent}", "key", "x").values(places)
    assert found == pytest.approx([float(mp.mpf(place) ** mp.mpf(exponent)) for place in places], rel=1e-15)


# --- papers


@pytest.mark.judges("papers")
def test_frequencies_within_half_a_line_are_near() -> None:
    """Points 1 and 6 have 87.89, 87.89, 335.94 and 76.17, 80.08, 80.08 Hz; half a line is 0.977 Hz."""
    half = measurements.LINE_HZ / 2.0
    for wanted, count in ((87.89, 2), (87.89 + 0.9 * half, 2), (87.89 + 1.1 * half, 0), (80.08 - 0.9 * half, 2)):
        assert measurements.near((wanted, 1.0), ("1", "6")).values == (count,)


@pytest.mark.judges("papers")
def test_sums_of_readings_may_be_off_by_halves_of_their_last_digits() -> None:
    readings = measurements.Readings(("4.9", "1.85"), ("-3.86", "-2.8"))
    found = readings.combined(2.0, -3.0)
    assert found.values == pytest.approx((2.0 * 4.9 + 3.0 * 3.86, 2.0 * 1.85 + 3.0 * 2.8))
    assert found.input_rounding == pytest.approx((2.0 * 0.05 + 3.0 * 0.005, 2.0 * 0.005 + 3.0 * 0.05))
    assert readings.peaks == pytest.approx((8.76, 4.65))
    assert readings.largest.values == (4.9,)


@pytest.mark.judges("papers")
def test_jumps_of_a_ratio_are_those_of_the_inverse_of_slopes(monkeypatch: pytest.MonkeyPatch) -> None:
    """Slopes 2 - phi, 3 + phi and 4 at their ends: ratios with their derivatives 1/s and -s'/s^2."""

    def slope(value: float, rate: float) -> Any:
        return Made(
            slope=lambda at, order: Jet(np.array([value + rate * at, rate + 0.0 * at])), start_rad=1.0, end_rad=1.0
        )

    pieces = [slope(4.0, 0.0), Made(), slope(2.0, -1.0), slope(3.0, 1.0)]
    monkeypatch.setattr(synthesis, "law", lambda: Made(transmission=Made(pieces=pieces)))
    first = (1.0 - 1.0 / 4.0, 1.0 + 1.0 / 16.0)
    end = 3.0 + 2.0 * pi
    second = (1.0 / end - 1.0 / 4.0, -1.0 / end**2)
    assert synthesis.joint_residual().values == pytest.approx((*first, *second))


# --- project, studio, machines


@pytest.mark.judges("project")
@pytest.mark.parametrize(("peak_n", "loaded"), [(0.9, False), (1.1, True)])
def test_teeth_that_bear_next_to_nothing_are_not_rated(
    peak_n: float, loaded: bool, monkeypatch: pytest.MonkeyPatch
) -> None:
    """20 mm of 3 mm teeth: sixty square millimetres."""
    monkeypatch.setattr(strengthening, "unknown", lambda _: None)
    monkeypatch.setattr(strengthening, "weakest_under", lambda *_: ())
    strength = Made(peak_pair_n=peak_n * 60.0 * strengthening.NOTHING_MPA, of=lambda _: Made(material=None))
    usual = Made(wanted_bending_safety=lambda _: 1.4, wanted_contact_safety=lambda _: 1.0)
    drive: Any = Made(
        design=Made(strength=Made(method="estimate")),
        conditions=usual,
        strength_by=lambda _: strength,
        loading_by=lambda _: "loading",
        gears=Made(face_width_mm=20.0),
        pitch=Made(size=Made(module_mm=3.0)),
    )
    if loaded:
        assert strengthening.rating_of(drive).strength is strength
    else:
        with pytest.raises(WrongInput, match="no load"):
            strengthening.rating_of(drive)


@pytest.mark.judges("studio")
def test_a_file_that_nobody_may_write_is_read_only(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(os, "access", lambda path, mode: True)
    path = tmp_path / "d.yaml"
    path.write_text("x")
    file = DesignOnDisk(path, b"x")
    for mode, read_only in ((0o444, True), (0o555, True), (0o644, False), (0o464, False), (0o446, False)):
        path.chmod(stat.S_IFREG | mode)
        assert ("read-only" in file._protected()) is read_only
    monkeypatch.setattr(os, "access", lambda path, mode: False)
    assert file._protected() == "is read-only"
    os.link(path, tmp_path / "other.yaml")
    assert "hard link" in file._protected()


@pytest.mark.judges("whole_machines")
def test_what_makes_a_machine_by_giving_way_is_offered(monkeypatch: pytest.MonkeyPatch) -> None:
    """Each demand by itself where one helps, all together where only that does."""
    asked = [Easing("choices.diameter_mm", ()), Easing("choices.center_distance_mm", ()), Easing("all", ())]
    figures = Made(
        center_distance_mm=hypot(30.0, 40.0),
        diameter_mm=80.0,
        module_mm=2.0,
        peak_power_w=90.0,
        peak_torque_n_m=3.0,
        face_width_mm=20.0,
    )
    monkeypatch.setattr(conflict, "easings", lambda *_: asked)
    for helps, key, said, unsaid in (
        ({"choices.diameter_mm", "all"}, "choices.diameter_mm", "each of these: a diameter of 80 mm", "centre"),
        ({"all"}, "choices.diameter_mm", "all of these together: a diameter of 80 mm (choices.diameter_mm), a", "all)"),
        (set(), "choices", "none of the choices", "mm"),
    ):
        found = [(one, Made(figures=figures, material="C45") if one.key in helps else None) for one in asked]
        monkeypatch.setattr(conflict, "finished", lambda *_, found=found: found)
        refusal = conflict.refusal_of_gears("", Made(), "C45", [], [Made(why=("too weak",))], None, None)
        assert refusal.key == key
        assert said in refusal.problem
        assert unsaid not in refusal.problem


@pytest.mark.judges("whole_machines")
@pytest.mark.parametrize(("limit", "cap"), [(None, 1.0), (0.5, 0.5), (2.0, 1.0)])
def test_a_machine_without_a_wish_needs_no_more_power_than_it_has(
    limit: float | None, cap: float, monkeypatch: pytest.MonkeyPatch
) -> None:
    """The least flank load of two laws under the power of the machine as it is, or under a tighter limit."""

    @dataclass
    class Wishes:
        goal: Any
        limits: Any
        motion: tuple[Any, ...] = ()

    @dataclass
    class Limits:
        peak_power_w: float | None

    asked: list[Any] = []
    laws = iter([Made(name="power", motion="m"), None, Made(name="flank", motion="n")])

    def kept_law(task: Any, wishes: Any, start: Any) -> Any:
        asked.append((wishes.goal, wishes.limits.peak_power_w, start))
        law = next(laws)
        return law and Made(motion=law.motion, train=lambda lobes: law.name)

    told = {
        "power": Made(peak_power_w=40.0, flank_load_n_mm=9.0),
        "flank": Made(peak_power_w=70.0, flank_load_n_mm=5.0),
    }
    for name, value in {
        "parsed": lambda text, path: Made(design=None),
        "law_design": lambda design: None,
        "inertia_as_given": lambda made: None,
        "task_of": lambda made, inertia: Made(lobes=None),
        "law_wishes": lambda made, _: Wishes("flanks", Limits(None if limit is None else limit * 80.0)),
        "Drive": lambda design: Made(check=Made(peak_power_w=Made(value=80.0 / limits.CLOSE))),
        "start_motion": lambda task, wishes: "start",
        "figures": lambda task, train: told[train],
    }.items():
        monkeypatch.setattr(limits, name, value)
    monkeypatch.setattr("ncgear.optimum.makeable.law.kept_law", kept_law)
    found = limits.needed_without("", "")
    assert [one[1:] for one in asked[1:]] == [(cap * 80.0, "start"), (cap * 80.0, "m")]
    assert asked[0][0] is limits.Goal.POWER
    assert [getattr(found, name) for name in type(found).__dataclass_fields__] == [40.0, 5.0]
