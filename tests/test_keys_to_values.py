"""From keys to values, each by hand: torques, inertias that swing, limits that are drawn in, units of unknowns."""

from __future__ import annotations

from contextlib import nullcontext
from math import pi
from types import SimpleNamespace
from typing import Any

import numpy as np
import pytest

from at_once import at_once
from drives import drive_of_text, loaded
from ncgear.design.keys.masses import DrivenShaftMasses
from ncgear.design.mechanisms import mechanism_of
from ncgear.design.wishes.gentle_stop import GentleStop
from ncgear.drivetrain.cycle import with_tooth_friction
from ncgear.errors import NoSuchMechanism, WrongInput
from ncgear.mechanisms.resistance import _Slope
from ncgear.numerics.jet import Jet
from ncgear.optimum.outline.conditions import CurveLimits
from ncgear.project.alternatives import (
    changed_drive,
    enough_teeth,
    fitted_root_radius,
    flatter_rack,
    rack_at,
    resized,
    steeper_rack,
)
from ncgear.project.bench import BenchStage, TimedStage, _motion, _pitch_curves, step_count
from ncgear.project.drive import Drive
from ncgear.project.forces import drive_line_of, mean_inertia, swinging_inertia
from ncgear.project.free_lengths import _given
from ncgear.project.law import load_of
from ncgear.project.law_task import _of_radius, _size_of
from ncgear.project.moving import TrainInertia, train_inertia
from ncgear.project.outline_trial import Made, between, drawn_in
from ncgear.tolerances.drawn import DeviationLimits as Deviations

pytestmark = pytest.mark.judges("project")

Fake: Any = SimpleNamespace

SHAFT = """\
name: shaft
operation: {speed_rpm: 60}
motion: {law: ellipse, eccentricity: 0.2}
"""


@at_once(
    "given",
    [
        "table: {angle_deg: [0, 90, 180, 270, 360], torque_n_m: [2, 5, 2, 1, 2]}",
        'expression_n_m: "2 + 3*sin(x)"',
        "polynomial_n_m: [2, 0]",
    ],
)
def test_torques_on_a_shaft_are_in_n_m_over_its_angle(given: str) -> None:
    load = load_of(drive_of_text(f"{SHAFT}resistance: {{{given}}}\n").design)
    told = load.working.force_n(np.radians([0.0, 90.0, 180.0]))
    assert told == pytest.approx([2000.0, 2000.0 if "polynomial" in given else 5000.0, 2000.0])


def test_what_swings_on_teeth_is_both_inertias_in_series() -> None:
    """1/J = 1/J2 + i^2/J1 by the mean slope; a shaft that turns evenly has no end of inertia."""
    slopes = np.linspace(1.0, 2.0, 720)
    meshing = Fake(law=Fake(at=lambda angle: (angle, slopes)))
    assert swinging_inertia(meshing, 6.0, 4.0) == pytest.approx(1.0 / (1.0 / 4.0 + 1.5**2 / 6.0), rel=1e-9)
    assert swinging_inertia(meshing, 0.0, 4.0) == 4.0
    load = Fake(table=Fake(at=lambda angle: (3.0 + np.cos(angle)[:, None] * [1.0, 9.0], None)))
    assert mean_inertia(load) == pytest.approx(3.0, rel=1e-12)


def test_bodies_stand_for_inertias_that_a_file_leaves_out() -> None:
    """Of the first pair and of the last; on the shaft between is one gear of each."""
    bodies = [Fake(driving_kg_mm2=1.0, driven_kg_mm2=20.0), Fake(driving_kg_mm2=300.0, driven_kg_mm2=4000.0)]

    def given(driving: float | None, between_kg_mm2: float | None, driven: float | None) -> Any:
        keys = "driving_gear_kg_mm2", "shaft_between_kg_mm2", "driven_gear_kg_mm2"
        return DrivenShaftMasses(shaft_kg_mm2=0.0, **dict(zip(keys, (driving, between_kg_mm2, driven), strict=True)))

    assert train_inertia(given(None, None, None), 2, bodies.__getitem__) == TrainInertia(1.0, (320.0,), 4000.0)
    assert train_inertia(given(None, None, 7.0), 1, bodies.__getitem__) == TrainInertia(1.0, (), 7.0)
    assert train_inertia(given(5.0, None, 7.0), 1, None) == TrainInertia(5.0, (), 7.0)
    assert train_inertia(given(5.0, 6.0, 7.0), 2, bodies.__getitem__) == TrainInertia(5.0, (6.0,), 7.0)
    assert train_inertia(given(5.0, None, 7.0), 2, bodies.__getitem__) == TrainInertia(5.0, (320.0,), 7.0)
    third = Fake(driving_kg_mm2=300.0, driven_kg_mm2=5.0)
    of_three = train_inertia(given(None, None, 7.0), 3, [*bodies, third].__getitem__)
    assert of_three == TrainInertia(1.0, (320.0, 4300.0), 7.0)
    shared = train_inertia(given(None, None, 7.0), 3, [*bodies, third].__getitem__, shares_gears=True)
    assert shared == TrainInertia(1.0, (20.0, 4000.0), 7.0)


@at_once(("name", "key", "factor"), [("rocker-drive", "stroke_deg", 180.0 / pi), ("pump-1-2", "stroke_mm", 1.0)])
def test_a_free_stroke_is_in_the_unit_of_its_key(name: str, key: str, factor: float) -> None:
    design = loaded(name).design
    linkage = mechanism_of(design.linkage)
    way = linkage.displacement(Jet.variable(np.linspace(0.0, 2.0 * pi, 20_001), 0)).value
    assert _given(design, key) == pytest.approx(factor * np.ptp(way), rel=1e-6)


@at_once(
    ("name", "limits", "said"),
    [
        ("internal-1-2", {"tooth_force_n": 900.0}, "external pairs only"),
        ("baler-66-two-stage", {"flank_load_n_mm": 9.0}, "one pair only"),
        ("uniform-crank", {}, ""),
        ("ellipse", {"tooth_force_n": 900.0}, ""),
    ],
)
def test_the_force_between_teeth_is_limited_where_it_is_known(name: str, limits: dict[str, float], said: str) -> None:
    design = loaded(name).design
    names = dict.fromkeys(("tooth_force_n", "flank_load_n_mm", "center_distance_mm", "teeth_hold"))
    given = Fake(**{**names, **limits}, stages=design.stages)
    with pytest.raises(WrongInput, match=said) if said else nullcontext():
        assert _size_of(design, given) is not None


# --- limits of the next pair near an outline -------------------------------------------------------------------------


def made(refusal: NoSuchMechanism | None, lacking: list[tuple[float, float]], arc: float = 1.4) -> Made:
    """A closed curve of 100 mm with 20 teeth, looked at every 5 mm, flanks meeting every 2.5 mm."""
    arc_mm = np.arange(0.0, 100.0, 5.0)

    def apart(places: np.ndarray) -> np.ndarray:
        off = np.abs(arc_mm[:, None] - places)
        return np.minimum(off, 100.0 - off)

    curve = Fake(arc_mm=arc_mm, length_mm=100.0, teeth=20, apart_mm=apart)
    meetings = np.arange(0.0, 100.0, 2.5)
    arcs, rows = np.full(meetings.size, arc), np.array(lacking).reshape(-1, 2)
    return Made(curve, CurveLimits(share=1.0), Fake(), {}, refusal, meetings, arcs, rows)


SHORT = NoSuchMechanism("too short", key="gears.least_contact_ratio")
CLASH = NoSuchMechanism("clash", key="gears")


def test_limits_are_drawn_in_beside_what_lacks_and_eased_elsewhere_at_first() -> None:
    """Over 10 mm to both sides, in proportion: by 5 % and what lacks, 3 % more for each refusal, 30 % at most."""
    first = drawn_in(made(SHORT, [(50.0, 0.08)]), 0)
    share = np.asarray(first.share)
    assert share[10] == pytest.approx(1.0 - 0.13)
    assert share[[9, 11]] == pytest.approx(1.0 - 0.5 * 0.13)
    assert share[[8, 12, 0]] == pytest.approx(1.05)
    again = np.asarray(drawn_in(made(SHORT, [(50.0, 0.08)]), 2).share)
    assert (again[10], again[0]) == (pytest.approx(1.0 - 0.19), 1.0)
    assert np.asarray(drawn_in(made(SHORT, [(50.0, 0.9)]), 1).share)[10] == pytest.approx(0.7)
    # Flanks that touch over less than one and a quarter pitches are not eased.
    assert np.asarray(drawn_in(made(SHORT, [(50.0, 0.08)], arc=1.2), 0).share)[0] == 1.0
    assert drawn_in(made(CLASH, []), 0).share == pytest.approx(np.full(20, 0.9))


@at_once(
    ("refusal", "count", "refusals", "rounder"),
    [(SHORT, 3, 5, 0), (SHORT, 3, 6, 1), (SHORT, 9, 2, 0), (SHORT, 9, 3, 1), (CLASH, 1, 2, 0), (CLASH, 1, 3, 1)],
)
def test_slopes_are_drawn_in_after_some_refusals(refusal: Any, count: int, refusals: int, rounder: int) -> None:
    before = CurveLimits()
    after = drawn_in(made(refusal, [(10.0 * place, 0.05) for place in range(count)]), refusals)
    assert after.steepest_rad == pytest.approx(before.steepest_rad * 0.85**rounder)
    assert after.nearest == pytest.approx(min(before.nearest + 0.05 * rounder, 0.35))


def test_limits_between_a_pair_that_was_made_and_one_that_was_not() -> None:
    kept, refused = made(None, []), made(CLASH, [])
    wider = Made(refused.curve, CurveLimits(steepest_rad=1.0, nearest=0.3, share=1.2), Fake(), {}, CLASH)
    found = between(kept, wider)
    assert (found.share, found.steepest_rad, found.nearest) == (
        pytest.approx(1.1),
        pytest.approx((1.0 + kept.limits.steepest_rad) / 2.0),
        pytest.approx((0.3 + kept.limits.nearest) / 2.0),
    )
    assert between(kept, None).share == pytest.approx(1.05**2)
    eased = Made(kept.curve, CurveLimits(share=1.25), Fake(), {})
    assert between(eased, None).share == 1.3


# --- other racks and teeth, of circular gears ------------------------------------------------------------------------


def wheel(gears: str, motion: str = "{law: uniform_crank}") -> Drive:
    """Of as many teeth, without a linkage."""
    head = "name: wheel\noperation: {speed_rpm: 60}\n"
    return drive_of_text(f"{head}motion: {motion}\ngears: {{face_width_mm: 10, undercut: allow, {gears}}}\n")


@at_once("angle_deg", [20.0, 22.5])
def test_teeth_and_angles_without_undercut_are_those_of_circular_gears(angle_deg: float) -> None:
    """z = 2 h/sin^2(a), h the height of the tool's straight part: 1.25 less the rounding's 0.25 (1 - sin(a))."""
    one = wheel(f"teeth: 12, module_mm: 2, rack: {{profile: C, pressure_angle_deg: {angle_deg}}}")

    def limit(degrees: float) -> float:
        sine = np.sin(np.radians(degrees))
        return float(2.0 * (1.25 - 0.25 * (1.0 - sine)) / sine**2)

    assert enough_teeth(one) == np.ceil(limit(angle_deg))
    least = next(angle for angle in range(20, 40) if limit(angle) <= 12.0)
    assert steeper_rack(one, 60.0) == {"gears.rack.pressure_angle_deg": float(least)}
    assert steeper_rack(one, least - 0.5) == {}
    assert flatter_rack(one, 1.04) == {"gears.rack.pressure_angle_deg": float(f"{angle_deg - 1.1:.1f}")}
    assert flatter_rack(one, 60.0) == {}


def test_more_teeth_keep_the_centre_distance() -> None:
    """By the module where it is given with the teeth, and else by leaving it out."""
    one = wheel("teeth: 24, module_mm: 2")
    assert resized(one, 32) == {"gears.teeth": 32, "gears.module_mm": pytest.approx(1.5)}
    by_distance = wheel("teeth: 24, center_distance_mm: 48")
    assert resized(by_distance, 32) == {"gears.teeth": 32}
    all_three = wheel("teeth: 24, center_distance_mm: 48, module_mm: 2")
    assert resized(all_three, 32) == {"gears.teeth": 32, "gears.module_mm": None}
    assert changed_drive(one, resized(one, 32)).pitch.center_distance_mm == pytest.approx(48.0)


def test_racks_of_two_angles_both_become_as_steep() -> None:
    two = wheel("teeth: 30, module_mm: 2, rack: {pressure_angle_deg: 20, idle_pressure_angle_deg: 26}").gears
    changes = rack_at(two, 24.0)
    assert {key.rpartition(".")[2]: value for key, value in changes.items()} == {
        "pressure_angle_deg": 24.0,
        "idle_pressure_angle_deg": 26.0,
    }
    # A root radius of 0.38 modules fits at 20 deg below a dedendum of 1.25, and no more at 28: (pi/4 - 1.25 t) / ...
    given = wheel("teeth: 30, module_mm: 2, rack: {root_radius: 0.38}").gears
    assert fitted_root_radius(given, 20.0) == {}
    (fitting,) = fitted_root_radius(given, 28.0).values()
    angle = np.radians(28.0)
    assert 0.0 < fitting <= (pi / 4.0 - 1.25 * np.tan(angle)) * np.cos(angle) / (1.0 - np.sin(angle)) < fitting + 0.02


# --- stages of a bench -----------------------------------------------------------------------------------------------


def test_errors_of_samples_and_chords_fall_with_the_square_of_their_number() -> None:
    """Chords of a curve of curvature k miss its length by the integral of k^2 h^2/24."""
    one = wheel("teeth: 30, module_mm: 2", "{law: ellipse, eccentricity: 0.3}")
    motion, curves = _motion(one), _pitch_curves(one)
    assert [trial.setting for trial in motion.trials[:5]] == [125.0, 250.0, 500.0, 1000.0, 2000.0]
    assert all(trial.size == trial.setting + 1 for trial in motion.trials)
    assert curves.order == pytest.approx(2.0, abs=0.01)
    assert curves.recommended is not None
    length = one.pitch.driving.length_mm
    at = length * np.arange(2000) / 2000
    k = np.abs(one.pitch.driving.at_length(at).curvature)
    for trial in curves.trials[:3]:
        assert trial.error == pytest.approx(
            float(np.mean(k**2)) * length * (length / trial.setting) ** 2 / 24.0, rel=0.03
        )
        assert trial.size == trial.setting
    assert curves.asked_error == one.chord_tolerance_mm
    assert [curves.recommended.error <= curves.asked_error, curves.trials[0].error > curves.asked_error] == [True, True]
    trials = TimedStage(0.4, 0.0, 0.16, 1), TimedStage(0.1, 0.0, 0.01, 1)
    tried = BenchStage("", "", "", 0.02, 0.0, trials, "mm")
    assert tried.order == pytest.approx(2.0)
    assert step_count(one) == 5


def test_a_motors_shaft_has_its_inertia_in_newtons() -> None:
    """5 kg m2 are 5e6 kg mm2, and 5000 N mm turn them by 1 rad/s2."""
    motor = Fake(no_load_speed_rpm=60.0, stall_torque_n_m=2.0)
    made: Any = drive_line_of(Fake(motor=motor), Fake(driving_shaft_kg_mm2=5e6), 1.0)
    assert (made.speed_rad_s, made.stall_torque_n_mm) == pytest.approx((2.0 * pi, 2000.0))
    assert made.inertia_n_mm_s2 == pytest.approx(5000.0)


def test_a_least_radius_is_a_curvature_over_the_rolled_length() -> None:
    """A driven gear of 20 teeth of module 2 has 20 mm of radius and turns once; a radius of 10 mm turns it twice."""
    gears = Fake(teeth=40, module_mm=2.0, lobes=Fake(driving=2))
    (found,) = _of_radius(Fake(least_radius_mm=10.0), gears)
    assert found.turns == pytest.approx(4.0 * pi)
    with pytest.raises(WrongInput, match=r"20 mm given; under 20 mm is right"):
        list(_of_radius(Fake(least_radius_mm=20.0), gears))


def test_a_flywheel_on_the_driven_shaft_turns_with_the_crank() -> None:
    masses = (
        "{slider_kg: 2, rod: {mass_kg: 1, center_mm: 40, inertia_kg_mm2: 9}, driving_gear_kg_mm2: 0, "
        "driven_gear_kg_mm2: 0, crank: {mass_kg: 1, center_mm: 8, inertia_kg_mm2: 300}, driven_flywheel_kg_mm2: 1000}"
    )
    machine = "linkage: {crank_mm: 40, rod_mm: 90}\noperation: {speed_rpm: 30}\nmotion: {law: uniform_crank}"
    assert drive_of_text(f"name: d\n{machine}\nmasses: {masses}\n").masses.crank_inertia_kg_mm2 == 1300.0


@pytest.mark.judges("drivetrain")
def test_friction_between_teeth_resists_in_both_senses() -> None:
    assert with_tooth_friction(np.array([100.0, -100.0]), 0.1) == pytest.approx([110.0, -90.0])


@pytest.mark.judges("tolerances")
def test_flanks_are_displaced_by_all_that_deviates() -> None:
    """Twice 0.03 mm of teeth, 0.03 between axes, 0.09 of bores, and 100 mm that are 10 K warmer: 0.012 mm."""
    limits = Fake(
        expansions=(12e-6, 11e-6, 10e-6),
        temperature_c=(20.0, 30.0),
        warmer_k=0.0,
        pitch_mm=np.array([0.0, 0.01]),
        profile_mm=np.array([0.02, 0.0]),
        center_distance_mm=0.03,
        eccentricity_mm=(0.04, 0.05),
    )
    assert Deviations.displaced_mm(limits, 100.0) == pytest.approx(0.06 + 0.03 + 0.09 + 0.012)


@pytest.mark.judges("mechanisms")
def test_places_near_an_end_are_squares_of_the_forms_variable() -> None:
    told = _Slope.at_mm(Fake(width_mm=4.0, end_mm=1.0), np.array([0.0, 0.5, 1.0]))
    assert told == pytest.approx([1.0, 2.0, 5.0])


@pytest.mark.judges("design")
def test_until_a_law_is_known_an_even_crank_stands_for_a_driving_range() -> None:
    """Over two turns of the driving gear the crank turns once: from pi to 2 pi it goes from pi/2 to pi."""
    keys = Fake(ends=lambda stroke: (0.0, 10.0), bound=("speed", 5.0), driving_rad=(pi, 2.0 * pi), stroke="both")
    wish: Any = GentleStop.value(keys, Fake(mm=float, stroke=None, cycle_rad=4.0 * pi))
    assert (wish.most_mm_s, wish.to_mm) == (5.0, 10.0)
    assert (wish.driving.crank.start_rad, wish.driving.crank.end_rad) == pytest.approx((pi / 2.0, pi))
