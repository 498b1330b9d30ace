"""What is told of teeth that knock where the load changes flanks, beside the motion in time."""

from __future__ import annotations

import json
from types import SimpleNamespace
from typing import Any

import numpy as np
import pytest

from commands import ROOT, Run, on_text
from drives import drive_of_text
from ncgear.dynamics.history import CRANK_BEARING
from ncgear.figures.advice import strength_advice
from ncgear.figures.advice.drivetrain_advice import around
from ncgear.figures.advice.strength_advice import rough, strength
from ncgear.figures.advice.values import Advice, NotJudged
from ncgear.pitch.shape import Gear
from ncgear.project.drive import Drive
from ncgear.project.strengthening import Rating
from ncgear.strength.holding import Damage, Weakest
from test_stage_loads import DRIVEN, SHARED, SLIDER

Made: Any = SimpleNamespace

TEXT = """\
name: shaken
linkage: {crank_mm: 40, rod_mm: 150}
operation: {speed_rpm: 120}
motion: {law: uniform_crank}
gears: {teeth: 24, module_mm: 2, face_width_mm: 10, backlash_mm: PLAY, material: 42CrMo4}
masses:
  slider_kg: 4
  rod: {mass_kg: 0.2, center_mm: 60, inertia_kg_mm2: 400}
  crank: {mass_kg: 0.5, center_mm: 0, inertia_kg_mm2: 400}
"""


def shaken(play_mm: float, more: str = "") -> Drive:
    """Round gears that drive a heavy slider, whose torque turns round four times in a turn."""
    return drive_of_text(TEXT.replace("PLAY", f"{play_mm:g}") + more)


def peak_n(drive: Drive) -> float:
    """The largest force of a pair of teeth."""
    return float(drive.strength.contacts.force_n.max())


@pytest.mark.slow
def test_teeth_knock_harder_with_more_play_and_not_at_all_without() -> None:
    """Over a small play the flight ends at x = s t^3 / (6 J) and s t^2 / (2 J), so as the play to 2/3."""
    exact, near, far = (shaken(play) for play in (0.0, 0.05, 0.1))
    speeds = [
        max((one.speed_mm_s for one in of.loading_by("estimate").knocks or ()), default=0.0)
        for of in (exact, near, far)
    ]
    assert speeds[0] == pytest.approx(0.0, abs=0.02 * speeds[1])
    assert speeds[2] / speeds[1] == pytest.approx(2.0 ** (2.0 / 3.0), rel=0.25)
    assert 3.0 * peak_n(exact) < peak_n(near) < peak_n(far)


def test_a_machine_without_masses_is_not_judged_for_knocks() -> None:
    text = TEXT.partition("masses")[0].replace("PLAY", "0.1") + "resistance: {polynomial_n: [100]}"
    assert drive_of_text(text).loading_by("estimate").knocks is None


@pytest.mark.slow
def test_a_check_and_a_build_tell_of_teeth_that_only_knocks_break() -> None:
    holds, broken = (shaken(play, "strength: {bending_safety: 6}\n") for play in (0.0, 0.3))
    for judge in (rough, strength):
        assert judge(holds) is None
        assert isinstance(judge(broken), Advice)


@pytest.mark.slow
def test_knocks_are_told_by_every_form(run: Run) -> None:
    holding = "strength: {contact_safety: 0.1}\n"
    _, told, _ = on_text(run, "strength")(TEXT.replace("PLAY", "0.1") + holding)
    assert "in a turn of the driven gear, at up to" in " ".join(told.split())
    figures = json.loads(on_text(run, "strength", "--json")(TEXT.replace("PLAY", "0.1") + holding)[1])
    assert figures["load"]["knocks"] > 4
    assert 0.0 <= figures["load"]["knock_max_at_rad"] < 2.0 * np.pi
    still = json.loads(on_text(run, "strength", "--json")(TEXT.replace("PLAY", "0") + holding)[1])
    assert still["load"].get("knock_max_mm_s", 0.0) < 0.02 * figures["load"]["knock_max_mm_s"]


SHAFTS = "drivetrain: {driving_shaft: {bearing_a: {at_mm: -40}, bearing_b: {at_mm: 40}}}\n"


@pytest.mark.slow
def test_knocks_of_two_pairs_and_of_herringbone_teeth_are_followed_with_inertia() -> None:
    lasting = "strength: {bending_safety: 0.01, contact_safety: 0.01}\n"
    loose = SHARED.replace("gears: {", "gears: {backlash_mm: 0.1, ")
    turning = drive_of_text(loose + SLIDER + "  shaft_between_kg_mm2: 4000\n" + lasting)
    for pair in turning.by_stage:
        loading = pair.loading_by("estimate")
        assert loading.knocks
        assert loading.still is not None
        assert pair.strength.peak_pair_n > 1.05 * loading.still.contacts.of_pairs().force_n.max()
        assert not isinstance(strength(pair), NotJudged)
    bare = drive_of_text(SHARED + SLIDER + DRIVEN + lasting)
    found = strength(bare.by_stage[1])
    assert isinstance(found, NotJudged)
    assert "knock" in found.why
    helical = drive_of_text(
        TEXT.replace("PLAY", "0.1").replace(
            "gears: {", "gears: {helix: {angle_deg: 10, kind: herringbone, hand: right}, "
        )
        + SHAFTS
    )
    assert helical.knocks
    for one in (helical, shaken(0.1, SHAFTS)):
        assert not any(isinstance(found, NotJudged) for found in around(one))


@pytest.mark.slow
def test_a_knock_hurries_the_slider_as_newton_says() -> None:
    """Speed and acceleration of the slider by differences of its place, the crank's by the torque that is missed."""
    knocking = shaken(0.1).knocking
    assert knocking is not None
    phi1 = knocking.turns_rad
    loads, machine = knocking.at(phi1), knocking.rigid.machine
    assert loads.driven_torque.value == pytest.approx(knocking.borne[0].turning(phi1), rel=1e-9)
    # Round gears: the crank turns as the driving gear does, and its inertia follows from the law's own torque.
    speed, step = machine.speed_rad_s, 1e-4
    place = [-40.0 * np.cos(q) + np.sqrt(150.0**2 - (40.0 * np.sin(q)) ** 2) for q in (phi1 - step, phi1, phi1 + step)]
    slope, bend = (place[2] - place[0]) / (2.0 * step), (place[2] - 2.0 * place[1] + place[0]) / step**2
    whole = (
        knocking.rigid.at(phi1, np.ones_like(phi1)).driven_torque.value - knocking.rigid.at(phi1).driven_torque.value
    )
    hurry = (knocking.borne[0].turning(phi1) - knocking.borne[0].asked(phi1)) / whole * speed**2
    pulled = 4.0 * 1e-3 * np.abs(bend * speed**2 + slope * hurry)
    along = np.abs(loads.joints["wrist"].x.value)
    assert along == pytest.approx(pulled, rel=1e-4, abs=1e-4 * pulled.max())
    assert hurry.max() > 5.0 * speed**2


def test_flanks_of_round_gears_stand_as_they_are_made_however_hard_they_knock() -> None:
    """F = T / (r cos 20 deg) on a radius of 24 mm, along a line 20 deg off the tangent, whatever hurries the gear."""
    machine = shaken(0.1).rigid.machine
    phi1 = np.linspace(0.0, 2.0 * np.pi, 50)
    for beyond in (0.0, 3.0, -40.0):
        loads = machine.at(phi1, np.full(phi1.shape, beyond))
        force = np.abs(loads.driven_torque.value) / (24.0 * np.cos(np.radians(20.0)))
        assert loads.mesh_force.size_n.value == pytest.approx(force, rel=1e-12)
        assert np.degrees(loads.mesh_force.pressure_angle_rad.value) == pytest.approx(20.0, rel=1e-12)


@pytest.mark.slow
def test_bearings_bear_the_knocks_of_the_teeth() -> None:
    knocked, still = shaken(0.1, SHAFTS), shaken(0.0, SHAFTS)
    pair, others = (one.drivetrain.shafts[0].bearings[0] for one in (knocked, still))
    peaks, knocking = knocked.knocking_peaks, knocked.knocking
    assert pair.largest_n.value == pytest.approx(peaks.mesh.force_n.value / 2.0, rel=0.02)
    assert pair.largest_n.value > 3.0 * others.largest_n.value
    even = np.linspace(0.0, 2.0 * np.pi, 200_001)[1:]
    cubes = (knocking.at(even).mesh_force.size_n.value / 2.0) ** 3
    assert pair.equivalent_n == pytest.approx(float(cubes.mean()) ** (1.0 / 3.0), rel=0.02)


@pytest.mark.slow
def test_forces_with_knocks_are_told_with_the_teeth(run: Run) -> None:
    holding = "strength: {contact_safety: 0.1}\n"
    figures = json.loads(on_text(run, "strength", "--json")(TEXT.replace("PLAY", "0.1") + holding)[1])["load"]
    drive = shaken(0.1)
    assert figures["with_knocks"]["peak_crank_pin_force_n"] == drive.knocking_peaks.joints_n["pin"].value
    assert figures["with_knocks"]["peak_crank_pin_force_n"] > 1.2 * drive.rigid.peaks.joints_n["pin"].value


@pytest.mark.slow
@pytest.mark.parametrize("play_mm", [0.07, 0.15])
def test_the_motion_in_time_presses_teeth_as_hard(play_mm: float) -> None:
    text = (ROOT / "designs" / "baler-holds.yaml").read_text(encoding="utf-8")
    one = drive_of_text(text.replace("backlash_mm: 0.07", f"backlash_mm: {play_mm}"))
    states = one.course.at(one.course.fine_s)
    in_time = float(one.course.machine.answer(states).teeth[-1].normal_n.max())
    assert 0.95 * in_time < peak_n(one) < 1.15 * in_time
    bearing = one.peaks_of(one.course).forces_n[CRANK_BEARING].value
    assert 0.95 * bearing < one.knocking_peaks.crank_bearing_n.value < 1.25 * bearing


@pytest.mark.slow
@pytest.mark.judges("project")
def test_teeth_are_rated_with_the_damping_of_the_file() -> None:
    """Hardly damped, teeth that knock are pressed harder; a stiffness of another law of contact changes nothing."""
    text = (ROOT / "designs" / "baler-holds.yaml").read_text(encoding="utf-8").partition("\nsimulation:")[0]
    keys = "", "{damping_ratio: 0.01}", "{stiffness_n_mm: 1e6, exponent: 2.2, damping_n_s_mm: 100}"
    usual, hardly, other = (
        drive_of_text(text + (f"\nsimulation: {one}\n" if one else "")).strength.peak_pair_n for one in keys
    )
    assert usual == pytest.approx(21102.0, rel=1e-3)
    assert hardly > 1.2 * usual
    assert other == usual


@pytest.mark.judges("figures")
@pytest.mark.parametrize(
    ("force_n", "safety"), [(30.0, "1.3"), (61.8, "0.65"), (20.5, None), (24.0, None), (28.0, None), (29.0, "1.38")]
)
def test_a_force_beyond_the_rating_is_told_where_teeth_would_not_hold_it(
    force_n: float, safety: str | None, monkeypatch: pytest.MonkeyPatch
) -> None:
    """Rated are 20 N with K_A and K_V; safeties of 2 against breakage go as 1/F, of 1.2 against pitting as its root."""
    life = {"gear": Gear.DRIVING, "tooth": 1, "phi1_rad": 0.0, "stress_mpa": 1.0, "life_h": np.inf, "too_weak": ()}
    weakest = (
        Weakest(**life, damage=Damage.BENDING, safety=2.0, wanted=1.4),
        Weakest(**life, damage=Damage.CONTACT, safety=1.3, wanted=1.0),
    )
    rating = Rating(Made(), Made(still=None), weakest)
    monkeypatch.setattr(strength_advice, "known_rating", lambda _: rating)
    vibrating = Made(peak_tooth_force_vibrating_n=16.0)
    monkeypatch.setattr(strength_advice, "vibration_of_rating", lambda _, rated: vibrating if rated is rating else None)
    drive: Any = Made(conditions=Made(application_factor=1.25))
    found = strength_advice.pressed_in_time(drive, force_n)
    assert (found is None) == (safety is None)
    if found is not None:
        assert f"{force_n / 20.0:.3g} times what is rated: safety {safety} against breakage, 1.4 wanted" in found.what
        assert found.meaning.endswith("as if the teeth bore it as often as the rated load")
    # Far less than is rated is no motion that repeats, where knocks are rated.
    assert strength_advice.pressed_in_time(drive, 13.2) is None
    knocking = Rating(Made(), Made(still=Made()), weakest)
    monkeypatch.setattr(strength_advice, "known_rating", lambda _: knocking)
    monkeypatch.setattr(strength_advice, "vibration_of_rating", lambda *_: vibrating)
    assert strength_advice.pressed_in_time(drive, 13.4) is None
    few = strength_advice.pressed_in_time(drive, 13.2)
    assert few is not None
    assert "bears 13.2 N, and 20 N are rated with knocks: it may not repeat yet" in few.what
    assert not few.matters
