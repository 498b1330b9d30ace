"""`ncgear simulate` as a user meets it: files, figures, exit status, and what is said about wrong masses."""

from __future__ import annotations

import re
from math import pi
from pathlib import Path

import numpy as np
import pytest
import trimesh
from ruamel.yaml import YAML

from at_once import at_once
from commands import ROOT, Run, modules_after, on_text, simulated, simulated_table
from drives import drive_of_text
from ncgear.design.reading.design_file import load
from ncgear.design.template import template
from ncgear.project.drive import Drive

DESIGN = ROOT / "designs" / "baler-dynamics.yaml"

HEAD = """\
name: press
linkage: {crank_mm: 38, rod_mm: 96}
operation: {speed_rpm: 600}
motion: {law: ellipse, eccentricity: 0.3}
resistance: {polynomial_n: [400]}
"""
GEARS = "gears: {teeth: 19, module_mm: 1.5, face_width_mm: 10, driven: {bore_mm: 8}}\n"
BODIES = "slider_kg: 1, rod: {mass_kg: 0.3, center_mm: 40, inertia_kg_mm2: 300}"
CRANK = "crank: {mass_kg: 0.4, center_mm: 10, inertia_kg_mm2: 200}"
MASSES = f"masses: {{{BODIES}, {CRANK}}}\n"


@pytest.fixture
def run(run: Run) -> Run:
    """Simulate d.yaml, which holds the text."""
    return on_text(run, "simulate", "--verbose")


@pytest.mark.slow
def test_the_published_baler_with_masses(run: Run) -> None:
    """Pinned: peaks of torque and mesh force beside the uniform crank's; the mean torque is the work's over 2 pi."""
    status, out, err = run(DESIGN.read_text(encoding="utf-8"))
    assert (status, err) == (0, "")
    found, rows = (read("export/baler-dynamics-rigid") for read in (simulated, simulated_table))
    own, uniform = found["this_design"], found["uniform_crank"]
    assert own["peak_driving_torque_n_m"] == pytest.approx(2922.4, abs=0.05)
    assert own["least_driving_torque_n_m"] == pytest.approx(-809.9, abs=0.05)
    assert uniform["peak_driving_torque_n_m"] == pytest.approx(3978.4, abs=0.05)
    assert own["peak_mesh_force_n"] == pytest.approx(94295.0, abs=0.5)
    assert own["inertia_for_speed_fluctuation_kg_m2"] == pytest.approx(9056.0, abs=0.5)
    work_j = 1e-3 * np.sum(np.diff(rows["displacement_mm"]) * (rows["force_n"][1:] + rows["force_n"][:-1]) / 2.0)
    assert 2.0 * pi * own["mean_driving_torque_n_m"] == pytest.approx(work_j, rel=1e-5)
    assert own["mean_driving_torque_n_m"] == pytest.approx(uniform["mean_driving_torque_n_m"], rel=1e-12)
    line = next(line for line in out.splitlines() if line.startswith("  peak mesh force") and "phi1" in line)
    cells = [cell.strip() for cell in line.split("  ") if cell]
    assert cells == ["peak mesh force, all pairs together", "94295 N at phi1 = 201 deg", "113071 N at phi1 = 153.3 deg"]


@pytest.mark.slow
def test_the_optimised_baler_with_the_same_masses() -> None:
    """At 60 r/min, with its own gears' inertia, its peak torque is half the uniform crank's, and is in the return."""
    drive = Drive(load(DESIGN.with_name("baler-half-dynamics.yaml")).design)
    own, uniform = (shaft.torque_range_n_mm[1] for shaft in (drive.rigid.driving, drive.uniform_rigid.driving))
    assert own.value == pytest.approx(1723.9e3, abs=50.0)
    assert uniform.value == pytest.approx(3396.5e3, abs=50.0)
    assert own.at > drive.machine.extended_rad


def test_the_baler_with_masses_has_the_gears_of_the_one_that_is_built() -> None:
    """Which is built with all checks; baler-half-dynamics is built with them itself, in tests/test_designs.py."""
    ours, built = (YAML(typ="safe").load(DESIGN.with_name(name)) for name in ("baler-dynamics.yaml", "baler.yaml"))
    for key in ("linkage", "operation", "motion", "gears", "resistance"):
        assert ours[key] == built[key], key


@pytest.mark.slow
def test_the_templates_masses_hold_what_they_say() -> None:
    text = template("mine").replace("\n# masses:", "\nmasses:")
    for mark in ("slider", "rod", "crank", "flywheel", "gravity"):
        text = text.replace(f"\n#   {mark}", f"\n  {mark}").replace(f"\n#   # {mark}", f"\n  {mark}")
    for gear in ("driving", "driven"):
        text = text.replace(f"\n#   # {gear}_gear_kg_mm2:", f"\n  {gear}_gear_kg_mm2: 1000")
    found = drive_of_text(text).masses
    assert (found.slider_kg, found.driven_inertia_kg_mm2, found.crank_center_mm) == (150.0, 1000.0, 120.0)
    assert found.gravity_m_s2 == pytest.approx((0.0, -9.80665), abs=1e-15)


@pytest.mark.tiers(slow=["gears"], rest="long")
@pytest.mark.parametrize("gears", [GEARS, ""], ids=["gears", "no gears"])
def test_what_is_written(run: Run, gears: str) -> None:
    status, out, _ = run(HEAD + gears + MASSES, "--out", "here", "--level", "rigid")
    assert status == 0
    pictures = {"driving_torque.png", "bearing_forces.png"} | ({"mesh_force.png"} if gears else set())
    assert {path.name for path in Path("here").iterdir()} == {
        "simulation.csv",
        "simulation.json",
        "manifest.json",
    } | pictures
    assert all(Path("here", name).read_bytes().startswith(b"\x89PNG") for name in pictures)
    assert str(Path("here/simulation.json")) in out
    rows, own = simulated_table("here"), simulated("here")["this_design"]
    assert ("mesh_n" in rows.dtype.names) == ("peak_mesh_force_n" in own) == bool(gears)
    assert rows["driving_torque_n_m"].max() == pytest.approx(own["peak_driving_torque_n_m"], rel=1e-4)
    bearing = np.hypot(rows["crank_bearing_x_n"], rows["crank_bearing_y_n"])
    assert bearing.max() == pytest.approx(own["peak_crank_bearing_force_n"], rel=1e-4)


def test_gears_that_say_nothing_of_their_inertia_have_that_of_their_bodies() -> None:
    """Against the moment of the written mesh about its axis."""
    drive = drive_of_text(HEAD + GEARS + MASSES)
    for solid, found in (
        (drive.solids.driving, drive.masses.driving_inertia_kg_mm2),
        (drive.solids.driven, drive.masses.driven_inertia_kg_mm2),
    ):
        mesh = trimesh.Trimesh(solid.mesh.vertices, solid.mesh.faces)
        mesh.density = 7850.0 * 1e-9
        x, y, _ = mesh.center_mass
        about_axis = mesh.moment_inertia[2, 2] + mesh.mass * (x**2 + y**2)
        assert found == pytest.approx(about_axis, rel=1e-12)


@pytest.mark.slow
def test_a_rings_inertia_is_that_of_its_body() -> None:
    motion = "motion: {law: ratio_expression, ratio: 2 + 0.4*cos(phi), scale_to_close: true}"
    gears = "gears: {mesh: internal, lobes: {driven: 2}, teeth: 24, module_mm: 1.5, face_width_mm: 5}\n"
    drive = drive_of_text(HEAD.replace("motion: {law: ellipse, eccentricity: 0.3}", motion) + gears + MASSES)
    mesh = trimesh.Trimesh(drive.solids.driven.mesh.vertices, drive.solids.driven.mesh.faces)
    mesh.density = 7850.0 * 1e-9
    # Its outer circle is written by chords within 0.005 mm, on the inside
    assert drive.masses.driven_inertia_kg_mm2 == pytest.approx(mesh.moment_inertia[2, 2], rel=1e-3)


WRONG: dict[str, tuple[str, str, str]] = {
    "nothing": ("", "masses", "missing; forces need slider_kg, rod and crank"),
    "no slider": (f"masses: {{{CRANK}, rod: {{mass_kg: 0, center_mm: 0, inertia_kg_mm2: 0}}}}", "slider_kg", "missing"),
    "no rod": (f"masses: {{slider_kg: 1, {CRANK}}}", "rod", "missing; give it"),
    "no centre": (f"masses: {{slider_kg: 1, rod: {{mass_kg: 1}}, {CRANK}}}", "rod.center_mm", "missing"),
    "negative mass": (
        f"masses: {{{BODIES.replace(': 1,', ': -1,')}, {CRANK}}}",
        "slider_kg",
        "-1 given; a number of 0",
    ),
    "rod without mass": (f"masses: {{{BODIES.replace('0.3', '0')}, {CRANK}}}", "rod.mass_kg", "no moment of inertia"),
    "crank about its centre": (
        f"masses: {{{BODIES}, {CRANK.replace('200', '39')}}}",
        "crank.inertia_kg_mm2",
        "40 or over is right",
    ),
    "negative gear": (f"masses: {{{BODIES}, {CRANK}, driven_gear_kg_mm2: -2}}", "driven_gear_kg_mm2", "0 or over"),
    "no density": (f"masses: {{{BODIES}, {CRANK}, density_kg_m3: 0}}", "density_kg_m3", "a number over 0"),
    "flywheel of no use": (
        f"masses: {{{BODIES}, {CRANK}, flywheel: {{speed_fluctuation: 0}}}}",
        "flywheel.speed_fluctuation",
        "a number over 0",
    ),
    "gravity upside down": (
        f"masses: {{{BODIES}, {CRANK}, gravity: {{acceleration_m_s2: -9.81}}}}",
        "gravity.acceleration_m_s2",
        "a number of 0 or over",
    ),
}


@at_once(("block", "key", "said"), WRONG.values())
def test_wrong_masses_are_refused_at_their_line(run: Run, block: str, key: str, said: str) -> None:
    status, out, err = run(f"{HEAD}{block}\n")
    assert (status, out) == (2, "")
    assert err.startswith("d.yaml:6:" if block else "d.yaml:1:")
    assert f": masses{'.' if block else ''}{key if block else ''}" in err
    assert said in err.splitlines()[0]
    assert not Path("export").exists()


@pytest.mark.slow
def test_two_stages_at_rest_are_told_pair_by_pair(run: Run) -> None:
    motion = "motion: {law: harmonic_ratio, cosine: [0.1], sine: [0.0], second_stage: {cosine: [0.1], sine: [0.0]}}"
    text = HEAD.replace("motion: {law: ellipse, eccentricity: 0.3}", motion) + GEARS + MASSES
    status, out, err = run(text, "--level", "quasi_static")
    assert (status, err) == (0, "")
    assert re.search(r"peak tooth force, one pair of teeth +[\d.]+ N, [\d.]+ N\n", out)
    assert re.search(r"transmission error +[\d.]+ µrad\n", out)


def test_flanks_that_cannot_push_are_refused(run: Run) -> None:
    """Where an ellipse this long slows the crank against the resistance, its flanks stand at over 90 degrees."""
    slow = HEAD.replace("0.3}", "0.96, phase_deg: 180}").replace("600", "6")
    status, _, err = run(slow + GEARS.replace("19", "60").replace("bore_mm: 8", "bore_mm: 3") + MASSES)
    assert status == 3
    assert "d.yaml:4:1: motion: the teeth cannot push the driven gear at phi1 = 0.283794 rad" in err
    assert "under 90 deg is needed" in err


def test_an_unknown_level_is_a_usage_error(run: Run) -> None:
    status, _, err = run(HEAD + MASSES, "--level", "soft")
    assert status == 2
    assert "rigid" in err


def after_simulating(check: str) -> set[str]:
    """Top-level modules loaded by a fresh interpreter that has simulated the baler, once ``check`` holds."""
    code = f"""
from ncgear.design.reading.design_file import load
from pathlib import Path
from ncgear.project.drive import Drive
from ncgear.dynamics.level import Level
from ncgear.files.simulation import simulate
drive = Drive(load(Path({str(DESIGN)!r})).design)
simulate(drive, Level.RIGID)
{check}
"""
    return modules_after(code)


@pytest.mark.slow
def test_the_rigid_level_makes_no_tooth_and_loads_no_solver_and_no_mesh() -> None:
    unmade = "assert not {'teeth', 'designed_contact', 'solids'} & set(vars(drive)), vars(drive)"
    assert after_simulating(unmade) & {"trimesh", "casadi", "sympy"} == set()


@pytest.mark.slow
def test_a_tooth_that_was_made_would_be_seen() -> None:
    """Negative control: it is made where the inertia is left out."""
    drive = drive_of_text(HEAD + GEARS + MASSES)
    assert drive.rigid.peaks.mesh is not None
    assert "teeth" in vars(drive)
