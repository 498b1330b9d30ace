"""Runs killed at any moment leave the last good build whole, or the new one whole, never a mixture."""

from __future__ import annotations

import json
from itertools import count, cycle
from pathlib import Path
from time import perf_counter
from typing import Any

import numpy as np
import pytest

from disk import leftovers
from killed_runs import Files, build, killed_after, killed_at_step, seen, together
from ncgear.files.manifest import MANIFEST, publish_run

ONE = {"driving.csv": b"one, driving", "driven.csv": b"one, driven", "extra.png": b"one", "summary.json": b"one"}
OTHER = {"driving.csv": b"other, driving", "driven.csv": b"other, driven", "fresh.csv": b"o", "summary.json": b"other"}
STAGES = {f"stage-{stage}/{name}": b"%d of two " % stage + text for stage in (1, 2) for name, text in ONE.items()}
OTHER_STAGES = {name: b"other " + text for name, text in STAGES.items()}
KEPT = {"mine.txt": b"not of ncgear", "below/notes.txt": b"nor this"}


def filled(folder: Path, files: Files) -> Path:
    """A folder in which a person keeps files of their own, with ``files`` built into it."""
    for name, content in KEPT.items():
        (folder / name).parent.mkdir(parents=True, exist_ok=True)
        (folder / name).write_bytes(content)
    publish_run(folder, files, "build")
    return folder


def found(folder: Path) -> dict[str, bytes]:
    """What a reader finds, but for the manifest."""
    return {name: content for name, content in seen(folder).items() if name != MANIFEST}


@pytest.mark.long
@pytest.mark.slow
@pytest.mark.attack
@pytest.mark.parametrize(
    ("before", "after"), [pytest.param(ONE, OTHER, marks=pytest.mark.long), (STAGES, OTHER_STAGES)]
)
def test_killed_at_each_step_the_folder_is_whole_and_the_next_run_clears_up(
    tmp_path: Path, before: Files, after: Files
) -> None:
    for step in count(1):
        folder = filled(tmp_path / str(step), before)
        killed = killed_at_step(step, publish_run, folder, after, "build")
        assert found(folder) in ({**KEPT, **before}, {**KEPT, **after}), f"killed before step {step}"
        publish_run(folder, after, "build")
        assert found(folder) == {**KEPT, **after}
        assert leftovers(folder) == []
        if not killed:
            break
    assert step > 4 * len(after)


@pytest.mark.slow
@pytest.mark.long
@pytest.mark.attack
def test_a_run_killed_over_and_over_at_any_step_never_leaves_a_mixture(tmp_path: Path) -> None:
    """Nobody clears up between the kills: each run meets what the others have left, and may die while it mends it."""
    folder, whole = filled(tmp_path, ONE), {**KEPT, **ONE}
    for step in (*range(1, 160, 3), *range(158, 1, -3)):
        for files in (STAGES, ONE):
            killed_at_step(step, publish_run, folder, files, "build")
            there, wanted = found(folder), {**KEPT, **files}
            assert there in (whole, wanted), f"killed before step {step}"
            whole = there
    publish_run(folder, OTHER, "build")
    assert found(folder) == {**KEPT, **OTHER}
    assert leftovers(folder) == []


def test_names_of_an_earlier_build_go_with_it(tmp_path: Path) -> None:
    folder = filled(tmp_path, STAGES)
    publish_run(folder, ONE, "build")
    assert found(folder) == {**KEPT, **ONE}
    assert not (folder / "stage-1").exists()


DESIGN = """
name: NAME
linkage: {crank_mm: 40, rod_mm: 150}
operation: {speed_rpm: 90}
motion: MOTION
gears: {teeth: 13, module_mm: 3, face_width_mm: 12}
output: {chord_tolerance_mm: 0.02}
"""
MOTIONS = {
    "one-pair": "{law: ellipse, eccentricity: 0.2}",
    "other-pair": "{law: uniform_crank}",
    "two-pairs": "{law: harmonic_ratio, cosine: [0.3], second_stage: {cosine: [0.15]}}",
}
KILLS = 200


def built(folder: Path) -> dict[str, Any]:
    """What a reader finds of a build; of summaries what they say but for how long it took."""
    return {
        name: {**json.loads(content), "timing_s": None} if name.endswith("summary.json") else content
        for name, content in found(folder).items()
    }


@pytest.fixture
def designs(tmp_path: Path) -> dict[Path, tuple[float, dict[str, Any]]]:
    """Design files, the seconds that a build of each takes, and what it leaves."""
    killed_after(60.0, seen, tmp_path)  # the first one loads the program
    made = {}
    for name, motion in MOTIONS.items():
        path, start = tmp_path / f"{name}.yaml", perf_counter()
        path.write_text(DESIGN.replace("NAME", name).replace("MOTION", motion))
        assert not killed_after(60.0, build, path, tmp_path / name)
        made[path] = perf_counter() - start, built(tmp_path / name)
    return made


@pytest.mark.slow
@pytest.mark.long
@pytest.mark.attack
def test_builds_killed_at_random_moments_leave_one_build_whole(
    tmp_path: Path, designs: dict[Path, tuple[float, dict[str, Any]]]
) -> None:
    """Spread over the whole run and a little beyond its end; nobody clears up in between."""
    random, kills, folder = np.random.default_rng(2), 0, tmp_path / "out"
    whole: dict[str, Any] = {}
    for path in cycle(designs):
        seconds, wanted = designs[path]
        kills += killed_after(random.uniform(0.0, 1.1 * seconds), build, path, folder)
        there = built(folder)
        assert there in (whole, wanted), f"{path.name} after {kills} kills"
        whole = there
        if kills == KILLS:
            break
    assert whole


@pytest.mark.slow
@pytest.mark.long
@pytest.mark.attack
def test_runs_killed_while_they_publish_leave_one_build_whole(
    tmp_path: Path, designs: dict[Path, tuple[float, dict[str, Any]]]
) -> None:
    random, folder, whole = np.random.default_rng(3), tmp_path / "out", dict[str, bytes]()
    builds = [found(tmp_path / path.stem) for path in designs]
    start = perf_counter()
    publish_run(tmp_path / "once", builds[0], "build")
    seconds = 3.0 * (perf_counter() - start)
    for moment in range(KILLS):
        files = builds[moment % len(builds)]
        killed_after(random.uniform(0.0, seconds), publish_run, folder, files, "build")
        there = found(folder)
        assert there in (whole, files), f"after {moment} runs"
        whole = there


@pytest.mark.slow
@pytest.mark.attack
def test_runs_that_publish_at_the_same_time_wait_for_each_other(tmp_path: Path) -> None:
    together(*[(publish_run, tmp_path, files, "build") for files in (ONE, STAGES, OTHER, STAGES, ONE)])
    assert found(tmp_path) in (ONE, STAGES, OTHER)
    assert leftovers(tmp_path) == []
