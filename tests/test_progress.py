"""How far work has come: what is told beforehand is what comes."""

from __future__ import annotations

import itertools
import threading
from pathlib import Path

import pytest

from at_once import at_once
from ncgear.cli import progress
from ncgear.files.build import WRITTEN_STEPS, build, contacts_as_written, step_count
from ncgear.project.moving import left_words
from ncgear.project.opened import loads

GEARS = """
name: small
linkage: {crank_mm: 40, rod_mm: 150}
operation: {speed_rpm: 90}
motion: MOTION
gears: {teeth: 15, module_mm: 3, face_width_mm: 12}
output: {chord_tolerance_mm: 0.05}
"""
MOTIONS = ["{law: uniform_crank}", "{law: harmonic_ratio, cosine: [0.2], second_stage: {cosine: [0.1]}}"]


@pytest.mark.tiers(slow=["one pair"], rest="long")
@pytest.mark.parametrize("motion", MOTIONS, ids=["one pair", "two pairs"])
def test_a_build_tells_as_many_stages_as_it_says_it_has(tmp_path: Path, motion: str) -> None:
    drive, told = loads(GEARS.replace("MOTION", motion)), list[str]()
    build(drive, tmp_path, told.append)
    assert len(told) == len(set(told)) == step_count(drive, report=False)


@pytest.mark.slow
def test_a_report_tells_as_many_as_it_says() -> None:
    told = list[str]()
    contacts_as_written(loads(GEARS.replace("MOTION", MOTIONS[0])), told.append)
    assert tuple(told) == WRITTEN_STEPS


def test_the_bar_counts_the_steps_that_are_done(monkeypatch: pytest.MonkeyPatch) -> None:
    made = []
    original = progress._bar
    monkeypatch.setattr(progress, "_bar", lambda *arguments: made.append(original(*arguments)) or made[-1])
    monkeypatch.setattr("sys.stderr.isatty", lambda: True)
    with progress.steps_shown(3) as on_step:
        seen = []
        for step in ("teeth", "contact", "solids"):
            on_step(step)
            seen.append((made[0].tasks[0].description, made[0].tasks[0].completed, made[0].tasks[0].total))
    assert seen == [("teeth", 0, 3), ("contact", 1, 3), ("solids", 2, 3)]


def test_a_single_step_has_no_bar() -> None:
    """Nothing of it is told but its name and its time."""
    ends = [[type(column).__name__ for column in progress._bar("teeth", count).columns] for count in (3, 1)]
    assert ends == [
        ["SpinnerColumn", "TextColumn", "BarColumn", "MofNCompleteColumn", "TimeElapsedColumn"],
        ["SpinnerColumn", "TextColumn", "TimeElapsedColumn"],
    ]


def test_a_step_says_how_far_it_has_come(monkeypatch: pytest.MonkeyPatch) -> None:
    made = []
    original = progress._bar
    monkeypatch.setattr(progress, "_bar", lambda *arguments: made.append(original(*arguments)) or made[-1])
    monkeypatch.setattr("sys.stderr.isatty", lambda: True)
    with progress.steps_shown(2) as on_step:
        on_step("law")
        on_step("limit")
        on_step.within("7 of at most 9 programmes")
        task = made[0].tasks[0]
        assert (task.description, task.completed, task.total) == ("limit, 7 of at most 9 programmes", 1, 2)


def test_a_long_step_says_how_long_it_takes() -> None:
    """At an even pace: 30 s for a hundredth are 50 min, of which 49.5 are left."""
    assert left_words(30.0, 0.01) == ", about 50 min left"
    assert [left_words(*one) for one in ((30.0, 0.5), (5.0, 0.0), (600.0, 1.0))] == ["", "", ""]


def test_short_work_says_nothing_where_stderr_is_no_terminal(capsys: pytest.CaptureFixture[str]) -> None:
    with progress.counted("designs") as on_done, progress.steps_shown(1) as on_step:
        on_done(1, 2)
        on_step("teeth")
    assert capsys.readouterr() == ("", "")


class Clock:
    """A clock that a test moves, and by which it waits."""

    def __init__(self) -> None:
        self.seconds = 100.0

    def __call__(self) -> float:
        return self.seconds


def lines_of(work_s: float) -> list[tuple[float, str]]:
    """The lines of work that lasts so long and counts a design each second: when they come, and what they say."""
    clock = Clock()
    lines, said = progress.Lines("designs", clock=clock), []
    while (at := lines.seconds + lines.pause_s) < work_s:
        clock.seconds = 100.0 + at
        lines.update("designs", int(at), 3600)
        said.append((at, lines.line))
    return said


def test_a_line_comes_now_and_then() -> None:
    assert lines_of(4.9) == []
    assert lines_of(12.0) == [(5.0, "5 s: designs (5 of 3600 done)"), (10.0, "10 s: designs (10 of 3600 done)")]


def test_lines_are_never_less_than_five_seconds_apart_and_few_in_an_hour() -> None:
    times = [at for at, _ in lines_of(3600.0)]
    assert min(later - sooner for sooner, later in itertools.pairwise([0.0, *times])) >= 5.0
    assert 20 <= len(times) <= 40


def test_a_line_names_the_step_and_counts_only_several() -> None:
    clock = Clock()
    lines = progress.Lines("starting", 3, clock)
    clock.seconds += 7.4
    assert lines.line == "7 s: starting (0 of 3 done)"
    lines.update("teeth", 1, 3)
    assert lines.line == "7 s: teeth (1 of 3 done)"
    lines.update("changes tried", 4, None)
    assert lines.line == "7 s: changes tried"
    lines.update("kinematics", 0, 1)
    assert lines.line == "7 s: kinematics"


def test_lines_go_to_stderr_and_end_with_the_work(
    monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str]
) -> None:
    monkeypatch.setattr(progress, "LINE_SECONDS", 0.02)
    came = threading.Event()
    monkeypatch.setattr(progress.Lines, "line", property(lambda self: came.set() or "5 s: teeth"))
    with progress.steps_shown(2) as on_step:
        on_step("teeth")
        assert came.wait(5.0)
    out, err = capsys.readouterr()
    assert out == ""
    assert set(err.splitlines()) == {"5 s: teeth"}
    assert [one.name for one in threading.enumerate() if one.name == progress.TELLER] == []


def test_work_goes_on_where_nobody_reads(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(progress, "LINE_SECONDS", 0.01)
    tried = threading.Event()

    def broken(*_: object, **__: object) -> None:
        tried.set()
        raise BrokenPipeError

    monkeypatch.setattr(progress, "print", broken, raising=False)
    with progress.steps_shown(1) as on_step:
        on_step("teeth")
        assert tried.wait(5.0)


@at_once(
    ("folder", "done", "told"),
    [
        (Path("out"), 3, "3 of 9 points are kept in out: the same command goes on from there\n"),
        (Path("out"), 0, ""),
        (None, 3, ""),
    ],
)
def test_interrupted_work_says_what_is_kept_and_how_it_goes_on(
    capsys: pytest.CaptureFixture[str], folder: Path | None, done: int, told: str
) -> None:
    """Nothing is said where nothing is kept."""

    def interrupted() -> None:
        with progress.counted("points", folder) as count:
            count(done, 9)
            raise KeyboardInterrupt

    with pytest.raises(KeyboardInterrupt):
        interrupted()
    assert capsys.readouterr().err == told
