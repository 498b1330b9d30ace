"""Gears by themselves: no linkage, the driven shaft is the output and bears a torque over its angle.

Judged by closed forms of phi2 = phi - e sin(n phi), by Lagrange's equation of a shaft, and by the energy of a turn.
"""

from __future__ import annotations

import csv
import json
import pickle
from pathlib import Path

import numpy as np
import pytest
import trimesh

from at_once import at_once
from commands import Run
from drives import drive_of_text
from ncgear.errors import WrongInput
from ncgear.numerics.arrays import Array
from ncgear.project.drive import Drive

SHARE, RPM = 0.1, 90.0
OMEGA = RPM * np.pi / 30.0
GEARS = """
gears: {lobes: {driving: 2, driven: 2}, teeth: 40, module_mm: 2, face_width_mm: 15, driving: {bore_mm: 20},
  driven: {bore_mm: 20}}"""
MASSES = "masses: {shaft_kg_mm2: 20000, driving_gear_kg_mm2: 300, driven_gear_kg_mm2: 500}"
TORQUES = {
    "formula": '{expression_n_m: "12 + 3*sin(2*x)"}',
    "generator": '{expression_n_m: "-4 + 3*sin(2*x)"}',
    "constant": "{polynomial_n_m: [12]}",
    "table": "{table: {angle_deg: [0, 90, 180, 270, 360], torque_n_m: [10, 15, 10, 15, 10]}}",
}


def text(torque: str = TORQUES["formula"], *others: str) -> str:
    motion = f'{{law: ratio_expression, driven_angle: "phi - {SHARE}*sin(2*phi)"}}'
    head = f"name: alone\noperation: {{speed_rpm: {RPM}}}\nmotion: {motion}\n"
    return "\n".join([head, f"resistance: {torque}" if torque else "", *others])


def alone(torque: str = TORQUES["formula"], *others: str) -> Drive:
    return drive_of_text(text(torque, *others))


def shaft(phi1: Array) -> tuple[Array, Array, Array]:
    """The driven angle, its speed and its acceleration in closed form."""
    speed = OMEGA * (1.0 - 2.0 * SHARE * np.cos(2.0 * phi1))
    return phi1 - SHARE * np.sin(2.0 * phi1), speed, 4.0 * SHARE * OMEGA**2 * np.sin(2.0 * phi1)


@pytest.mark.judges("project")
def test_the_driven_shaft_moves_as_the_law_says() -> None:
    made = alone()
    phi1 = made.motion.phi1_rad
    angle, speed, acceleration = shaft(phi1)
    assert made.motion.displacement == pytest.approx(angle, abs=1e-12)
    assert made.motion.velocity == pytest.approx(speed, rel=1e-12)
    assert made.motion.acceleration == pytest.approx(acceleration, abs=1e-9)
    torque = 12.0 + 3.0 * np.sin(2.0 * angle)
    assert made.motion.load == pytest.approx(1000.0 * torque, rel=1e-12)
    assert made.motion.power_w == pytest.approx(torque * speed, rel=1e-12)
    check = made.check
    fine = np.linspace(0.0, np.pi, 400_001)
    power = (12.0 + 3.0 * np.sin(2.0 * shaft(fine)[0])) * shaft(fine)[1]
    assert check.peak_power_w.value == pytest.approx(power.max(), rel=1e-9)
    assert check.peak_speed.value == pytest.approx(OMEGA * (1.0 + 2.0 * SHARE), rel=1e-12)
    assert check.peak_acceleration_cycle.value == pytest.approx(4.0 * SHARE * OMEGA**2, rel=1e-12)
    # A turn of the driven shaft takes 12 N m times 2 pi, and as long as a turn of the driving one.
    assert check.mean_power_w == pytest.approx(12.0 * OMEGA, rel=1e-12)


def test_the_load_begins_again_with_every_turn_of_the_shaft() -> None:
    """Also where the driven shaft makes two turns in one of the driving gear."""
    doubled = text(TORQUES["table"]).replace('"phi - 0.1*sin(2*phi)"', '"2*phi - 0.1*sin(2*phi)"')
    made = drive_of_text(doubled + GEARS.replace("driven: 2}", "driven: 1}"))
    phi1 = np.array([0.4, 0.4 + np.pi])
    motion = made.machine.motion(phi1)
    assert motion.displacement[1] - motion.displacement[0] == pytest.approx(2.0 * np.pi, abs=1e-12)
    assert motion.load[0] == pytest.approx(motion.load[1], rel=1e-12)
    assert made.machine.motion(np.array([np.pi])).load[0] == pytest.approx(10_000.0, rel=1e-9)


@pytest.mark.parametrize("torque", ['{expression_n_m: "3*sin(x)"}', "{polynomial_n_m: [0, -6.283185307179586, 1]}"])
def test_a_torque_may_be_zero_at_the_ends_of_a_turn(torque: str) -> None:
    """Rounding leaves 7e-16 N m at 360 deg, which is no jump."""
    made = alone(torque)
    assert np.abs(made.motion.load).max() > 2000.0


@at_once("torque", TORQUES)
def test_driving_torque_is_lagranges(torque: str) -> None:
    """tau1 = (J q'' + T) q', J all that turns with the driven shaft, at even driving speed."""
    made = alone(TORQUES[torque], MASSES)
    phi1 = np.linspace(0.01, 6.27, 300)
    angle, speed, acceleration = shaft(phi1)
    load = np.interp(np.mod(angle, 2.0 * np.pi), made.motion.displacement, made.motion.load)
    if torque != "table":
        load = {
            "formula": 12_000.0 + 3000.0 * np.sin(2.0 * angle),
            "generator": -4000.0 + 3000.0 * np.sin(2.0 * angle),
            "constant": np.full_like(angle, 12_000.0),
        }[torque]
    expected = (20_500.0 * acceleration / 1000.0 + load) * speed / OMEGA
    found = made.rigid.machine.at(phi1)
    within = 1e-4 if torque == "table" else 1e-9
    assert found.driving_torque.value == pytest.approx(expected, abs=within * np.abs(expected).max())
    turn = made.rigid.fluctuation
    assert turn.work_n_mm / 1000.0 == pytest.approx(made.check.mean_power_w * 2.0 * np.pi / OMEGA, rel=1e-9)


@pytest.mark.long
@pytest.mark.slow
def test_the_table_of_the_motion_is_in_units_of_a_shaft(run: Run) -> None:
    Path("d.yaml").write_text(text(TORQUES["formula"], GEARS, MASSES), encoding="utf-8")
    assert run("build", "d.yaml", "--out", "b")[0] == 0
    with Path("b/law.csv").open(encoding="utf-8", newline="") as file:
        rows = list(csv.DictReader(file))
    expected = "phi1_rad phi2_rad ratio displacement_rad velocity_rad_s acceleration_rad_s2 torque_n_m power_w"
    assert list(rows[0]) == [*expected.split(), "driving_torque_with_masses_n_m", "power_with_masses_w"]
    row = rows[700]
    angle = float(row["displacement_rad"])
    assert float(row["torque_n_m"]) == pytest.approx(12.0 + 3.0 * np.sin(2.0 * angle), rel=1e-12)
    assert float(row["power_w"]) == pytest.approx(float(row["torque_n_m"]) * float(row["velocity_rad_s"]), rel=1e-12)
    summary = json.loads(Path("b/summary.json").read_text(encoding="utf-8"))
    assert summary["check"]["peak_speed_rad_s"] == pytest.approx(OMEGA * (1.0 + 2.0 * SHARE))
    assert "even_gears" in summary["check"]
    told = json.dumps(summary)
    for word in ("crank", "slider", "stroke", "_mm_s2", "uniform"):
        assert word not in told, word


@pytest.mark.tiers(slow=["quasi_static"], rest="long")
@pytest.mark.parametrize("level", ["rigid", "quasi_static", "dynamic"])
def test_simulations_name_no_crank(run: Run, level: str) -> None:
    Path("d.yaml").write_text(text(TORQUES["formula"], GEARS, MASSES, "simulation: {turns: 0.1}"), encoding="utf-8")
    status, out, err = run("simulate", "d.yaml", "--level", level, "--out", "s")
    assert (status, err) == (0, "")
    with Path("s/simulation.csv").open(encoding="utf-8", newline="") as file:
        columns = next(csv.reader(file))
    told = " ".join(columns) + Path("s/simulation.json").read_text(encoding="utf-8") + out
    for word in ("crank", "slider", "guide", "wrist"):
        assert word not in told, word


@pytest.mark.long
@pytest.mark.slow
def test_a_motion_in_time_keeps_its_energy() -> None:
    """What the drive puts in over half a turn is the work of the torque and the loss, as shafts turn then as before."""
    made = alone(TORQUES["formula"], GEARS, MASSES, "simulation: {turns: 0.5}")
    course = made.course_with(1.0, 1e-7)
    assert course.energy_error < 1e-6
    work, loss = (float(row) / 1000.0 for row in course.states[4:6, -1])
    # Impacts at the start leave the driven shaft a little off its speed.
    assert work - loss == pytest.approx(12.0 * np.pi, rel=0.02)


@pytest.mark.slow
def test_the_page_shows_gears_and_no_crank(run: Run) -> None:
    Path("d.yaml").write_text(text(TORQUES["formula"], GEARS), encoding="utf-8")
    assert run("report", "d.yaml", "--out", "page")[0] == 0
    page = Path("page/report.html").read_text(encoding="utf-8")
    assert "even gears" in page
    assert "uniform crank" not in page
    assert 'id="scene-slider"' not in page
    assert run("animate", "d.yaml", "--out", "page/a.gif", "--frames", "4", "--width", "320")[0] == 0


@pytest.mark.slow
def test_gears_by_themselves_are_balanced(run: Run) -> None:
    """The centre of mass is that of the solid as read back from its file by another library."""
    off = "{law: pitch_curve, ellipse: {semi_major_mm: 40, semi_minor_mm: 38, axis_x_mm: 4}}"
    gears = "gears: {teeth: 36, face_width_mm: 10, driving: {bore_mm: 10}, driven: {bore_mm: 10}}"
    Path("d.yaml").write_text(f"name: egg\noperation: {{speed_rpm: 60}}\nmotion: {off}\n{gears}\n", encoding="utf-8")
    Path("b.yaml").write_text("name: b\nspeed_rpm: 60\ngears: {design: d.yaml}\n", encoding="utf-8")
    assert run("build", "d.yaml", "--out", "built")[0] == 0
    status, _, err = run("balance", "b.yaml", "--out", "balance")
    assert (status, err) == (0, "")
    told = json.loads(Path("balance/balance.json").read_text(encoding="utf-8"))["gears"]
    for gear in ("driving", "driven"):
        center = trimesh.load_mesh(f"built/{gear}.stl").center_mass
        assert told[gear]["eccentricity_mm"] == pytest.approx(float(np.hypot(*center[:2])), rel=1e-4)


def test_a_design_of_gears_can_be_sent_to_another_process() -> None:
    made = alone(TORQUES["table"], GEARS, MASSES).design
    assert pickle.loads(pickle.dumps(made)) == made


REFUSED = [
    (
        "motion: {law: table, phi1_deg: [0, 90, 180, 270, 360], displacement_mm: [0, 300, 760, 350, 0]}",
        "linkage",
        "missing; motion.law table tells how a slider moves",
    ),
    ("motion: {law: uniform_crank}\nwishes: {time_ratio: {at_least: 2}}", "wishes", "nothing moves to and fro"),
    ("motion: {law: uniform_crank}\noptimize: {goal: least_power}", "optimize", "nothing moves to and fro"),
    ("motion: {law: uniform_crank}\nresistance: {polynomial_n: [400]}", "resistance.polynomial_n", "polynomial_n_m"),
    ("motion: {law: uniform_crank}\nmasses: {slider_kg: 3}", "masses.slider_kg", "unknown key"),
    ("motion: {law: uniform_crank}\nresistance: {polynomial_n_m: [4, 3]}", "resistance", "repeats every turn"),
    (
        "motion: {law: uniform_crank}\nresistance: {table: {angle_deg: [0, 90], torque_n_m: [1, 2, 3]}}",
        "resistance.table.torque_n_m",
        "3 values, but angle_deg has 2",
    ),
    ("motion: {law: uniform_crank}\nlinkage: {crank_mm: 10}", "linkage.rod_mm", "missing"),
]


@at_once(("rest", "key", "said"), REFUSED)
def test_what_needs_a_linkage_is_refused_at_its_place(run: Run, rest: str, key: str, said: str) -> None:
    Path("d.yaml").write_text(f"name: alone\noperation: {{speed_rpm: 60}}\n{rest}\n", encoding="utf-8")
    status, _, err = run("check", "d.yaml")
    assert status == 2
    assert key in err
    assert said in err


@pytest.mark.parametrize("command", ["optimize", "frontier"])
def test_the_best_law_of_gears_by_themselves_is_refused(run: Run, command: str) -> None:
    pytest.importorskip("casadi")
    bare = text().replace("sin(2*phi)", "sin(phi)").replace(f"{SHARE}*", "0.3*")
    Path("d.yaml").write_text(bare, encoding="utf-8")
    status, _, err = run(command, "d.yaml", "--out", "o")
    assert status == 2
    assert "moves nothing to and fro" in err


def test_a_torque_that_jumps_is_refused_in_its_own_units() -> None:
    with pytest.raises(WrongInput, match=r"from 2 to 17\.84\d* N m at x = 1 rad"):
        _ = alone('{expression_n_m: "2 if x < 1 else 2 + 3*(2*pi - x)"}').check
