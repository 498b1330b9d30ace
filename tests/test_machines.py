"""Every machine of ``ncgear new --machine`` is checked and built, by the size it says."""

from __future__ import annotations

from pathlib import Path

import pytest

from commands import Run
from ncgear.design.machines import MachineName, machine_template
from ncgear.project.drive import Drive, loads

pytestmark = pytest.mark.judges("design")

STROKES_MM = {"pump": 60.0, "pusher": 250.0, "press-feeder": 150.0, "baler": 760.0, "desk-toy": 30.0}
"""Twice the crank of a crank-slider without offset."""


@pytest.mark.parametrize("machine", MachineName)
def test_machine_has_the_work_of_both_strokes(machine: MachineName) -> None:
    drive = Drive(loads(machine_template("mine", machine)).design)
    assert drive.linkage.stroke_mm == pytest.approx(STROKES_MM[machine.value], rel=1e-12)
    # The cubics of a ramp h wide that end level add h^2/12 times the slope at its start, 62/60 of the chord's
    # (one-sided three-point rule of Fritsch and Butland's programs with h = 2 and 58 mm)
    ramps = 2.0**2 / 12.0 * 62.0 / 60.0 * (200.0 + 30.0)
    by_hand = {"pump": (400 * 59 + 60 * 59 + 30 * 60 + ramps) / 1e3, "press-feeder": 185 * 0.15, "desk-toy": 0.03}
    if machine.value in by_hand:
        cycle_s = 60.0 / drive.design.operation.speed_rpm
        assert drive.check.mean_power_w * cycle_s == pytest.approx(by_hand[machine.value], rel=1e-9)


@pytest.mark.slow
@pytest.mark.parametrize("machine", MachineName)
def test_every_machine_builds(run: Run, tmp_path: Path, machine: MachineName) -> None:
    assert run("new", "mine", "--machine", machine.value) == (0, "mine.yaml\n", "")
    assert run("check", "mine.yaml")[0] == 0
    assert run("build", "mine.yaml")[0] == 0


def test_a_machine_has_its_own_law_and_sizes(run: Run) -> None:
    status, _, err = run("new", "mine", "--machine", "pump", "--law", "ellipse")
    assert (status, err.startswith("--machine: ")) == (2, True)
