"""Every machine of ``ncgear new --machine``, optimised, checked and built as a user would, keeps what it wishes."""

from __future__ import annotations

import csv
import json
from collections.abc import Mapping
from pathlib import Path

import numpy as np
import pytest

from commands import Run
from ncgear.design.keys.design import Design
from ncgear.design.template import MachineName, machine_template
from ncgear.project.drive import Drive
from ncgear.project.opened import load, loads
from tiers import long_but

pytestmark = pytest.mark.judges("design")

STROKES_MM = {"pump": 60.0, "pusher": 250.0, "press-feeder": 150.0, "baler": 760.0, "desk-toy": 30.0}
"""Twice the crank of a crank-slider without offset."""

WORK_J = {
    # The cubics of a ramp h wide that end level add h^2/12 times the slope at its start, 62/60 of the chord's
    # (one-sided three-point rule of Fritsch and Butland's programs with h = 2 and 58 mm)
    "pump": (400 * 59 + 60 * 59 + 30 * 60 + 2.0**2 / 12.0 * 62.0 / 60.0 * (200.0 + 30.0)) / 1e3,
    "press-feeder": 185 * 0.15,
    "desk-toy": 0.03,
}
"""Work against force and friction in both strokes of a turn, by hand."""

PLAIN_CRANK_W = {"pump": 0.5, "pusher": 0.65, "press-feeder": 1.06, "baler": 0.53, "desk-toy": 1.2}
"""Peak power of the best law over that of a plain crank, rounded up: what the law is worth, or what a dwell costs."""

BEGINS_WITHOUT = {"press-feeder": ["dwell"]}
"""Wishes that the simple law of a new file does not keep, and `ncgear optimize` does."""

Columns = Mapping[str, np.ndarray]


@pytest.mark.slow
@pytest.mark.parametrize("machine", MachineName)
def test_machine_has_the_work_of_both_strokes(machine: MachineName) -> None:
    drive = Drive(loads(machine_template("mine", machine)).design)
    assert drive.linkage.stroke_mm == pytest.approx(STROKES_MM[machine.value], rel=1e-12)
    if machine.value in WORK_J:
        cycle_s = 60.0 / drive.design.operation.speed_rpm
        assert drive.check.mean_power_w * cycle_s == pytest.approx(WORK_J[machine.value], rel=1e-9)


@pytest.mark.tiers(slow=["press-feeder"], rest="long")
@pytest.mark.parametrize("machine", MachineName)
def test_every_machine_builds_with_the_law_it_begins_with(run: Run, tmp_path: Path, machine: MachineName) -> None:
    assert run("new", "mine", "--machine", machine.value) == (0, "mine.yaml\n", "")
    assert run("build", "mine.yaml")[0] == 0
    missed = _misses(load(Path("mine.yaml")).design, _table("export/mine/law.csv"))
    assert [one.split()[0] for one in missed] == BEGINS_WITHOUT.get(machine.value, [])


@pytest.mark.long
@pytest.mark.slow
def test_a_machine_of_other_sizes_and_wishes_keeps_them(run: Run, tmp_path: Path) -> None:
    """Half the stroke, twice the speed, and a quicker return: the wishes of the machine's own, in its sizes, stay."""
    flags = ["--stroke-mm", "120", "--speed-rpm", "60", "--wish", "time_ratio: {at_least: 1.7}"]
    assert run("new", "mine", "--machine", "pusher", *flags) == (0, "mine.yaml\n", "")
    assert run("optimize", "mine.yaml")[0] == 0
    assert run("build", "export/mine-optimized/mine-optimized.yaml")[0] == 0
    wished = load(Path("mine.yaml")).design
    assert wished.wishes is not None
    assert wished.wishes.constant_speed[0].to_mm == 96.0
    assert _misses(wished, _table("export/mine-optimized/law.csv")) == []


@pytest.mark.long
@pytest.mark.slow
@pytest.mark.parametrize("machine", long_but([MachineName.PUMP, MachineName.PRESS_FEEDER], MachineName))
def test_every_machine_is_optimised_and_built_with_all_its_wishes_kept(
    run: Run, tmp_path: Path, machine: MachineName
) -> None:
    """Wishes and limits are judged by the table of the motion that the build writes, masses by their energy."""
    assert run("new", "mine", "--machine", machine.value) == (0, "mine.yaml\n", "")
    assert run("optimize", "mine.yaml")[0] == 0
    best = "export/mine-optimized/mine-optimized.yaml"
    checked, built = run("check", best, "--verbose"), run("build", best, "--verbose")
    assert (checked[0], built[0]) == (0, 0)
    assert "warning" not in "".join([*checked[1:], *built[1:]])
    assert "missed" not in checked[1]

    design = load(Path(best)).design
    table = _table("export/mine-optimized/law.csv")
    assert _misses(design, table) == []
    assert design.optimize is not None
    limits = design.optimize.limits
    found = json.loads(Path("export/mine-optimized/certificate.json").read_text())
    power_w = _power_w(design, table, found["masses"]["driven_inertia_kg_mm2"])
    assert np.max(power_w) < PLAIN_CRANK_W[machine.value] * found["uniform_crank"]["peak_power_w"]
    assert np.max(power_w) < 1.002 * (limits.peak_power_w or np.inf)
    slider_s2 = np.gradient(np.gradient(table["displacement_mm"], _times_s(design, table)), _times_s(design, table))
    assert np.max(np.abs(slider_s2[2:-2])) < 1.002 * (limits.peak_acceleration_mm_s2 or np.inf)
    assert limits.ratio_min * 0.999 < np.min(table["ratio"])
    assert np.max(table["ratio"]) < limits.ratio_max * 1.001


def _table(path: str) -> Columns:
    with open(path, newline="") as file:
        rows = list(csv.DictReader(file))
    return {key: np.array([float(row[key]) for row in rows]) for key in rows[0]}


def _times_s(design: Design, table: Columns) -> np.ndarray:
    return table["phi1_rad"] / (design.operation.speed_rpm * np.pi / 30.0)


def _misses(design: Design, table: Columns) -> list[str]:
    """The hard wishes that the table of a motion does not show."""
    phi, place = table["phi1_rad"], table["displacement_mm"]
    speed = np.gradient(place, _times_s(design, table))
    out = phi[np.argmax(place)]
    missed = []
    if design.wishes is None:
        return []
    for even in design.wishes.constant_speed:
        there = speed[(phi < out) & (place >= even.from_mm) & (place <= even.to_mm)]
        if not np.max(there) <= np.min(there) * (1.0 + even.tolerance) / (1.0 - even.tolerance) + 1e-3:
            missed.append(f"constant speed {np.min(there)} to {np.max(there)}")
    ratio = design.wishes.time_ratio
    if ratio is not None and not out / (2.0 * np.pi - out) >= ratio.at_least * 0.99:
        missed.append(f"time ratio {out / (2.0 * np.pi - out)}")
    for dwell in design.wishes.dwell:
        near = phi[place >= np.max(place) - dwell.within_mm]
        # By the rows of the table, up to one row less at either end.
        if not near[-1] - near[0] >= dwell.for_angle_rad - 2.0 * (phi[1] - phi[0]):
            missed.append(f"dwell of {near[-1] - near[0]} rad")
    return missed


def _power_w(design: Design, table: Columns, driven_kg_mm2: float) -> np.ndarray:
    """Driving power: the table's own, of the forces, and the change of the masses' energy of motion."""
    masses, crank_mm, rod_mm = design.masses, design.linkage.crank_mm, design.linkage.rod_mm
    assert masses is not None
    assert crank_mm is not None
    turned, time_s = table["phi2_rad"], _times_s(design, table)
    # The crank begins retracted, its pin on the far side of its axis; the slider moves along x.
    pin = np.stack([-crank_mm * np.cos(turned), crank_mm * np.sin(turned)])
    slider = np.stack([pin[0] + np.sqrt(rod_mm**2 - pin[1] ** 2), np.zeros_like(turned)])
    np.testing.assert_allclose(slider[0] - slider[0, 0], table["displacement_mm"], atol=1e-6)
    center = pin + (slider - pin) * masses.rod.center_mm / rod_mm
    tilt = np.arcsin(pin[1] / rod_mm)

    def squared(path: np.ndarray) -> np.ndarray:
        return np.sum(np.atleast_2d(np.gradient(path, time_s, axis=-1)) ** 2, axis=0)

    crank_kg_mm2 = masses.crank.inertia_kg_mm2 + driven_kg_mm2
    energy = masses.slider_kg * squared(slider) + masses.rod.mass_kg * squared(center)
    energy += masses.rod.inertia_kg_mm2 * squared(tilt) + crank_kg_mm2 * squared(turned)
    return (table["power_w"] + np.gradient(0.5e-6 * energy, time_s))[2:-2]


def test_a_machine_has_its_own_law_and_sizes(run: Run) -> None:
    status, _, err = run("new", "mine", "--machine", "pump", "--law", "ellipse")
    assert (status, err.startswith("--machine: ")) == (2, True)
