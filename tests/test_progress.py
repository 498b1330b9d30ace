"""How far work has come: what is told beforehand is what comes."""

from __future__ import annotations

from pathlib import Path

import pytest

from drives import loaded
from ncgear.cli import progress
from ncgear.files.build import WRITTEN_STEPS, build, contacts_as_written, step_count
from ncgear.project.drive import loads
from ncgear.screening.screen import screened

GEARS = """
name: small
linkage: {crank_mm: 40, rod_mm: 150}
operation: {speed_rpm: 90}
motion: MOTION
gears: {teeth: 15, module_mm: 3, face_width_mm: 12}
output: {chord_tolerance_mm: 0.05}
"""
MOTIONS = ["{law: uniform_crank}", "{law: harmonic_ratio, cosine: [0.2], second_stage: {cosine: [0.1]}}"]


@pytest.mark.tiers(slow=["two pairs"], rest="thorough")
@pytest.mark.parametrize("motion", MOTIONS, ids=["one pair", "two pairs"])
def test_a_build_tells_as_many_stages_as_it_says_it_has(tmp_path: Path, motion: str) -> None:
    drive, told = loads(GEARS.replace("MOTION", motion)), list[str]()
    build(drive, tmp_path, told.append)
    assert len(told) == len(set(told)) == step_count(drive, report=False)


def test_a_report_tells_as_many_as_it_says() -> None:
    told = list[str]()
    contacts_as_written(loads(GEARS.replace("MOTION", MOTIONS[0])), told.append)
    assert tuple(told) == WRITTEN_STEPS


def test_a_sweep_tells_every_design() -> None:
    design, told = loaded("baler").design, list[tuple[int, int]]()
    screened([design] * 3, on_done=lambda done, total: told.append((done, total)))
    assert told[-1] == (3, 3)
    assert [done for done, _ in told] == sorted(done for done, _ in told)


def test_the_bar_counts_the_steps_that_are_done(monkeypatch: pytest.MonkeyPatch) -> None:
    made = []
    original = progress._bar
    monkeypatch.setattr(progress, "_bar", lambda *arguments: made.append(original(*arguments)) or made[-1])
    with progress.steps_shown(3) as on_step:
        seen = []
        for step in ("teeth", "contact", "solids"):
            on_step(step)
            seen.append((made[0].tasks[0].description, made[0].tasks[0].completed, made[0].tasks[0].total))
    assert seen == [("teeth", 0, 3), ("contact", 1, 3), ("solids", 2, 3)]


def test_nothing_is_shown_where_stderr_is_no_terminal(capsys: pytest.CaptureFixture[str]) -> None:
    with progress.counted("designs") as on_done, progress.steps_shown(1) as on_step:
        on_done(1, 2)
        on_step("teeth")
    assert capsys.readouterr() == ("", "")
