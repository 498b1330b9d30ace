"""`ncgear simulate` at the levels at which teeth give way: files, figures, and what is said about wrong parameters."""

from __future__ import annotations

import re
from math import sqrt
from pathlib import Path

import numpy as np
import pytest

from at_once import at_once
from commands import ROOT, Outcome, Run, on_text, simulated, simulated_table
from drives import drive, drive_of_text
from ncgear.contact.designed.as_designed import touch_at
from ncgear.contact.placement import placed_at
from ncgear.design.keys.masses import Simulation
from ncgear.dynamics.crank_load import reduced_inertia
from ncgear.dynamics.pair_places import KNOWN, pair_places
from ncgear.errors import WrongInput
from ncgear.numerics.jet import Jet
from ncgear.project.drive import Drive
from ncgear.project.forces import require_possible_stiffness

DESIGN = ROOT / "designs" / "baler-dynamics.yaml"

HEAD = """\
name: press
linkage: {crank_mm: 38, rod_mm: 96}
operation: {speed_rpm: 60}
motion: {law: ellipse, eccentricity: 0.3}
resistance: {polynomial_n: [400]}
gears: {teeth: 19, module_mm: 1.5, face_width_mm: 10}
masses: {slider_kg: 1, rod: {mass_kg: 0.3, center_mm: 40, inertia_kg_mm2: 300}, crank: {mass_kg: 0.4, center_mm: 10, \
inertia_kg_mm2: 200}, driving_gear_kg_mm2: 50, driven_gear_kg_mm2: 50}
"""

ROUND = HEAD.replace("{law: ellipse, eccentricity: 0.3}", "{law: uniform_crank}")


@pytest.fixture
def run(run: Run) -> Run:
    """Simulate d.yaml, which holds the text, into the folder here."""

    def run_once(text: str, level: str) -> Outcome:
        return on_text(run, "simulate", "--verbose")(text, "--level", level, "--out", "here")

    return run_once


@pytest.mark.slow
def test_no_pair_is_softer_or_stiffer_than_told() -> None:
    """100 positions to a pitch beside the table's: the table alone has a least stiffness that is 3 % too large."""
    one = drive("baler-dynamics")
    touch, even, own = touch_at(one.teeth), one.designed_contact.placement, one.section_stiffness[0]
    rolled = (np.arange(100 * even.meetings) + (sqrt(5.0) - 1.0) / 2.0) * even.pitch_mm / 100.0
    found = []
    for block in np.array_split(rolled, rolled.size // 1000):
        at = touch(placed_at(one.pitch, even, block))
        found += [own(pair_places(side.touching, at.placement)) for side in (at.pushing, at.back)]
    stiffness, told = np.concatenate(found), one.stiffness_range
    within = 2.0 * KNOWN * np.ptp(stiffness)
    assert -within <= stiffness.min() - told.low.value <= 0.01 * told.low.value
    assert -within <= told.high.value - stiffness.max() <= 1e-3 * told.high.value
    assert one.meshing.gaps.touching_stiffness.min() > 1.01 * told.low.value


@pytest.mark.long
@pytest.mark.slow
def test_loaded_contact_of_the_published_baler(run: Run) -> None:
    """Pinned: what its teeth give way and bear under the rigid level's torque, with chosen masses."""
    status, _, err = run(DESIGN.read_text(encoding="utf-8"), "quasi_static")
    assert (status, err) == (0, "")
    found, rows = simulated("here")["loaded_contact"], simulated_table("here")
    # 8 to 25 N/(mm um) for 20 mm of width: under this load the teeth's contacts are as wide as half a millimetre.
    assert found["least_pair_stiffness_n_per_mm"] == pytest.approx(157148.0, rel=1e-3)
    assert found["largest_pair_stiffness_n_per_mm"] == pytest.approx(507220.0, rel=1e-4)
    softer, stiffer = (simulated("here")["band_of_stiffness"][name] for name in ("softer", "stiffer"))
    assert softer["peak_depth_mm"] > found["peak_depth_mm"] > stiffer["peak_depth_mm"]
    assert softer["transmission_error_rad"] == pytest.approx(0.0092, rel=0.05)
    assert stiffer["transmission_error_rad"] == pytest.approx(0.0052, rel=0.05)
    assert found["peak_tooth_force_n"] == pytest.approx(67153.5, abs=0.5)
    assert found["peak_depth_mm"] == pytest.approx(0.2114, rel=1e-3)
    # Closed in on between the rows, which miss a little of both
    assert 66000.0 < rows["tooth_force_n"].max() < found["peak_tooth_force_n"]
    assert 0.99 < np.ptp(rows["error_rad"]) / found["transmission_error_rad"] < 1.0
    assert {path.name for path in Path("here").iterdir()} == {
        "manifest.json",
        "simulation.csv",
        "simulation.json",
        "loaded_contact.png",
    }
    # Friction apart, the teeth ask of the drive what the rigid machine does.
    assert rows["driving_torque_n_m"].mean() == pytest.approx(rows["rigid_driving_torque_n_m"].mean(), rel=0.03)


@pytest.mark.long
@pytest.mark.slow
def test_motion_in_time_of_the_published_baler(run: Run) -> None:
    """Pinned: the slider keeps to the law within 2 mm, its acceleration swings about it, and energy balances."""
    status, _, err = run(DESIGN.read_text(encoding="utf-8"), "dynamic")
    assert (status, err) == (0, "")
    found, rows = simulated("here"), simulated_table("here")
    assert found["motion_in_time"]["energy_error"] < 1e-5
    assert found["motion_in_time"]["work_of_drive_j"] == pytest.approx(3175.5, rel=1e-3)
    assert found["motion_in_time"]["peak_pushing_force_n"] == pytest.approx(71490.0, rel=1e-3)
    assert found["motion_in_time"]["time_with_pushing_flanks_apart_s"] == pytest.approx(0.4454, rel=1e-2)
    assert found["motion_in_time"]["losses_of_contact"] == found["motion_in_time"]["time_without_contact_s"] == 0
    assert found["slider"]["largest_displacement_error_mm"] == pytest.approx(1.571, rel=1e-2)
    assert rows["displacement_mm"].max() == pytest.approx(760.0, abs=1e-2)
    names = {"slider_motion.png", "tooth_force.png", "bearing_forces.png"}
    assert all(Path("here", name).read_bytes().startswith(b"\x89PNG") for name in names)


@pytest.mark.long
@pytest.mark.slow
def test_motion_in_time_with_a_motor_from_rest(run: Run) -> None:
    motor = "simulation: {start: rest, turns: 0.02, motor: {no_load_speed_rpm: 60, stall_torque_n_m: 200}}\n"
    status, out, err = run(HEAD + motor, "dynamic")
    assert (status, err) == (0, "")
    rows = simulated_table("here")
    assert rows["phi1_rad"][-1] == pytest.approx(0.04 * np.pi, rel=1e-6)
    assert rows["velocity_mm_s"][0] == 0.0
    assert "energy error" in out


@pytest.mark.slow
def test_an_impact_between_the_rows_is_told(run: Run) -> None:
    """A motor starts from rest, and the driven gear is struck between two rows; text, figures and rows tell which force
    is meant, of a pair or of all, and how long no flank touches."""
    text = ROUND.replace("face_width_mm: 10", "face_width_mm: 10, backlash_mm: 0.15") + (
        "simulation: {start: rest, turns: 0.02, motor: {no_load_speed_rpm: 60, stall_torque_n_m: 200}}\n"
    )
    status, out, err = run(text, "dynamic")
    assert (status, err) == (0, "")
    found, rows = simulated("here"), simulated_table("here")
    peak = found["motion_in_time"]["peak_pushing_force_n"]
    assert rows.size == 41
    assert peak > 2.0 * rows["pushing_force_n"].max()
    assert found["bearings"]["peak_mesh_force_n"] > 1.7 * peak
    assert re.search(rf"peak pushing force, one pair of teeth +{peak:.5g} N at phi1 = ", out)
    assert "peak mesh force, all pairs together" in out


@pytest.mark.long
@pytest.mark.slow
def test_a_motor_on_the_law_starts_at_the_operating_speed(run: Run) -> None:
    """Its speed without load is 90 r/min, the design's is 60; the slider keeps to the law at the motor's own speed."""
    motor = "simulation: {turns: 0.02, motor: {no_load_speed_rpm: 90, stall_torque_n_m: 300}}\n"
    status, out, err = run(HEAD + motor, "dynamic")
    assert (status, err) == (0, "")
    found, rows = simulated("here"), simulated_table("here")
    assert found["motion_in_time"]["start_speed_rpm"] == pytest.approx(60.0, rel=1e-12)
    assert found["motion_in_time"]["end_speed_rpm"] > 61.0
    assert "start speed" in out
    assert found["slider"]["largest_velocity_error_mm_s"] < 0.05 * rows["velocity_mm_s"].max()


@pytest.mark.slow
def test_a_stiffness_that_is_given_is_that_of_all_pairs() -> None:
    """With any exponent; where none is given, pairs differ, and a narrower gear is softer by its width."""
    wide, narrow, given = (
        drive_of_text(text)
        for text in (
            HEAD,
            HEAD.replace("face_width_mm: 10", "face_width_mm: 5"),
            HEAD + "simulation: {stiffness_n_mm: 7e4, exponent: 1.5}\n",
        )
    )
    assert set(given.meshing.gaps.touching_stiffness) == {7e4}
    assert given.meshing.impact.exponent == 1.5
    stiffness = wide.meshing.gaps.touching_stiffness
    assert 1.1 * stiffness.min() < stiffness.max()
    # Half as wide, each millimetre bears twice the load, under which contacts are flatter and a little stiffer.
    ratio = narrow.meshing.gaps.touching_stiffness / stiffness
    assert np.all((ratio > 0.5) & (ratio < 0.53))


@pytest.mark.slow
def test_damping_is_the_ratio_of_the_critical_one() -> None:
    """A pair between a shaft whose speed nothing changes and the crank's mean inertia at the base circle."""
    drive = drive_of_text(ROUND + "simulation: {turns: 0.001}\n")
    meshing = drive.course.machine.meshing
    angles = np.linspace(0.0, 2.0 * np.pi, 4001)[:-1]
    moving = drive.linkage.moving_masses(Jet.variable(angles, 2), drive.masses)
    inertia = 1e-3 * reduced_inertia(moving, drive.masses)[0].mean()
    base = 19 * 1.5 / 2.0 * np.cos(np.radians(20.0))
    stiffness = np.mean(meshing.gaps.touching_stiffness)
    critical = 2.0 * np.sqrt(stiffness * inertia) / base
    assert meshing.impact.damping_n_s_mm == pytest.approx(0.07 * critical, rel=1e-6)


WRONG: dict[str, tuple[str, str, str]] = {
    "negative stiffness": ("{stiffness_n_mm: -1}", "stiffness_n_mm", "over 0"),
    "exponent under 1": ("{exponent: 0.9}", "exponent", "1"),
    "negative damping": ("{damping_n_s_mm: -1}", "damping_n_s_mm", "0 or over"),
    "no depth of damping": ("{full_damping_depth_mm: 0}", "full_damping_depth_mm", "over 0"),
    "rest without a motor": ("{start: rest}", "start", "rest given without motor, but a drive at constant speed"),
    "exponent of no stiffness": ("{exponent: 1.5}", "exponent", "given without stiffness_n_mm"),
    "damping beyond critical": ("{damping_ratio: 1.5}", "damping_ratio", "1 or under"),
    "less friction at rest": ("{friction: {static: 0.01}}", "friction.static", "0.01 given, but dynamic is 0.05"),
    "speeds of friction": (
        "{friction: {dynamic_speed_mm_s: 1}}",
        "friction.dynamic_speed_mm_s",
        "over 1 mm/s is right",
    ),
    "motor without torque": (
        "{motor: {no_load_speed_rpm: 60, stall_torque_n_m: 0}}",
        "motor.stall_torque_n_m",
        "over 0",
    ),
    "no turns": ("{turns: 0}", "turns", "over 0"),
    "another start": ("{start: jump}", "start", "on_law"),
}


@at_once(("block", "key", "said"), WRONG.values())
def test_wrong_parameters_are_refused_by_key(run: Run, block: str, key: str, said: str) -> None:
    status, out, err = run(f"{HEAD}simulation: {block}\n", "dynamic")
    assert (status, out) == (2, "")
    assert f"simulation.{key}: " in err
    assert said in err
    assert not Path("here").exists()


@pytest.mark.thorough
@pytest.mark.parametrize("level", ["quasi_static", "dynamic"])
@pytest.mark.parametrize(
    ("text", "key"),
    [
        (HEAD[: HEAD.index("masses")], "masses"),
        ("\n".join(line for line in HEAD.splitlines() if not line.startswith("gears")) + "\n", "gears"),
    ],
    ids=["masses", "gears"],
)
def test_what_a_level_needs_is_asked_for(run: Run, level: str, text: str, key: str) -> None:
    status, out, err = run(text, level)
    assert (status, out) == (2, "")
    assert f": {key}: " in err


@pytest.mark.slow
def test_a_motor_whose_shaft_has_no_inertia_is_refused(run: Run) -> None:
    motor = "simulation: {motor: {no_load_speed_rpm: 60, stall_torque_n_m: 200}}\n"
    status, _, err = run(HEAD.replace("driving_gear_kg_mm2: 50", "driving_gear_kg_mm2: 0") + motor, "dynamic")
    assert status == 2
    assert "masses.driving_gear_kg_mm2: 0 given" in err


@pytest.mark.slow
def test_a_load_too_heavy_for_the_teeth_is_refused(run: Run) -> None:
    status, _, err = run(
        HEAD + "simulation: {stiffness_n_mm: 100, friction: {static: 0, dynamic: 0}}\n", "quasi_static"
    )
    assert status == 3
    assert ": simulation.stiffness_n_mm: " in err
    assert "deeper than their teeth can be followed" in err


IMPOSSIBLE = {"0.002": "so soft", "5e7": "so stiff", "5e13": "so stiff", "1e280": "so stiff"}
"""Stiffnesses in N of a pair 1 mm deep in each other that no teeth have: steel has some 1e5."""


@pytest.mark.tiers(quick=["dynamic-*", "quasi_static-0.002"], rest="slow")
@pytest.mark.parametrize("given", IMPOSSIBLE)
@pytest.mark.parametrize("level", ["quasi_static", "dynamic"])
def test_a_stiffness_that_no_teeth_have_is_refused_before_teeth_are_made(
    run: Run, level: str, given: str, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setattr(Drive, "teeth", property(lambda drive: pytest.fail("teeth are made")))
    status, _, err = run(f"{HEAD}simulation: {{stiffness_n_mm: {given}}}\n", level)
    assert status == 2
    assert f"d.yaml:8:14: simulation.stiffness_n_mm: {float(given):g} given" in err
    assert IMPOSSIBLE[given] in err
    right = re.search(r"; (\S+) or (more|less) is right", err)
    assert right is not None
    assert (float(right[1]) > float(given)) == (right[2] == "more")
    require_possible_stiffness(Simulation(stiffness_n_mm=float(right[1])), 10.0)


@pytest.mark.parametrize(("exponent", "most"), [(1.0, 20.0), (2.2, 20.0 * 1000.0**1.2)])
def test_a_stiffness_is_refused_that_is_too_great_even_at_a_micrometre(exponent: float, most: float) -> None:
    """By the stiffness of ISO 6336-1, 14 N/(mm um), of 8 mm; one per cent more is refused."""
    stiffness = most * 14e3 * 8.0
    require_possible_stiffness(Simulation(stiffness_n_mm=stiffness, exponent=exponent), 8.0)
    with pytest.raises(WrongInput, match="so stiff"):
        require_possible_stiffness(Simulation(stiffness_n_mm=1.01 * stiffness, exponent=exponent), 8.0)


@pytest.mark.slow
def test_teeth_of_diamond_and_of_rubber_are_possible() -> None:
    """Of 1050 GPa and of 2 MPa: they are to teeth of steel, where these are stiffest and softest, as their moduli."""
    steel = drive_of_text(HEAD).meshing.gaps.touching_stiffness
    for stiffness in (float(steel.max()) * 1050e3 / 206e3, float(steel.min()) * 2.0 / 206e3):
        require_possible_stiffness(Simulation(stiffness_n_mm=stiffness), 10.0)


@pytest.mark.slow
def test_a_stiffness_out_of_proportion_is_named(run: Run) -> None:
    """And not the friction, which is an ordinary one."""
    status, _, err = run(f"{HEAD}simulation: {{stiffness_n_mm: 3}}\n", "quasi_static")
    assert status == 3
    assert ": simulation.stiffness_n_mm: " in err
    assert "too soft" in err
    assert "friction" not in err


@pytest.mark.slow
@pytest.mark.parametrize(("stiffness", "share"), [(2.5e5, 0.01), (2.5e6, 0.02)])
def test_stiff_teeth_under_little_load_bear_as_rigid_ones_do(stiffness: float, share: float) -> None:
    light = HEAD.replace("[400]", "[4]").replace("slider_kg: 1", "slider_kg: 0.01")
    drive = drive_of_text(f"{light}simulation: {{stiffness_n_mm: {stiffness}}}\n")
    mesh = drive.rigid.peaks.mesh
    assert mesh is not None
    assert drive.loaded_peaks.tooth_force_n.value == pytest.approx(mesh.force_n.value, rel=share)


@pytest.mark.long
@pytest.mark.slow
def test_a_band_that_cannot_be_followed_says_so(run: Run) -> None:
    """At the edge of what teeth can be pressed into each other, teeth of 0.7 times the stiffness are beyond it."""
    load = HEAD.replace("[400]", "[40000]")
    status = 3
    stiffness = 6e4
    while status == 3 and stiffness < 3e6:
        stiffness *= 1.35
        status, out, _ = run(f"{load}simulation: {{stiffness_n_mm: {stiffness:g}}}\n", "quasi_static")
    assert status == 0
    softer = simulated("here")["band_of_stiffness"]["softer"]
    assert "not_followed" in softer
    assert "deeper than their teeth" in softer["not_followed"]
    assert "with 0.7 times their stiffness the teeth cannot be followed" in out or "not followed" in out
    assert not re.search(r"stiffness\s+-$", out, re.MULTILINE)
