"""Ctrl-C, ``kill`` and a closed terminal at any moment: a last line, a status, and earlier files as they were."""

from __future__ import annotations

import os
import signal
import subprocess
import sys
import time
from pathlib import Path

import numpy as np
import pytest

from commands import ROOT, environment, python, signals_kept
from killed_runs import seen
from ncgear.design.template import template
from ncgear.interrupts import ENDING, uninterrupted

PATIENCE_S = 120.0

BEGUN = "import sys; from ncgear.cli import main; print('begun', flush=True); main()"
"""A run that says when it begins: before that, the interpreter itself is interrupted."""


def interrupted(seconds: float, *arguments: str, whole_group: bool = False) -> tuple[int, str]:
    """Exit status and stderr of a run that hears Ctrl-C after a time, with its processes if the group does."""
    process = subprocess.Popen(
        [sys.executable, "-c", BEGUN, *arguments],
        stdout=subprocess.PIPE,
        stderr=subprocess.PIPE,
        text=True,
        env=environment(COLUMNS="100"),
        start_new_session=True,
    )
    assert process.stdout is not None
    assert process.stdout.readline() == "begun\n"
    time.sleep(seconds)
    (os.killpg if whole_group else os.kill)(process.pid, signal.SIGINT)
    _, err = process.communicate(timeout=PATIENCE_S)
    return process.returncode, err


def assert_interrupted(outcome: tuple[int, str]) -> None:
    """The solver of programmes may warn of it first, in a line of its own; then finished work is told."""
    status, err = outcome
    lines = [line for line in err.splitlines() if line and "casadi" not in line.lower() and " are kept in " not in line]
    assert (status, lines) == (130, ["interrupted; what earlier runs have written is untouched"])


@pytest.fixture
def design(tmp_path: Path) -> Path:
    path = tmp_path / "a.yaml"
    path.write_text(template("a"))
    return path


@pytest.mark.slow
@pytest.mark.parametrize("seconds", [0.01, 0.2, 0.5])
def test_an_interrupted_build_leaves_nothing(tmp_path: Path, design: Path, seconds: float) -> None:
    assert_interrupted(interrupted(seconds, "build", str(design), "--out", str(tmp_path / "out")))
    assert not (tmp_path / "out").exists() or not list((tmp_path / "out").iterdir())


def places(folder: Path) -> list[str]:
    return sorted(place.name for place in folder.iterdir())


@pytest.mark.slow
@pytest.mark.long
def test_builds_interrupted_at_random_moments_leave_the_last_good_one(tmp_path: Path, design: Path) -> None:
    random, folder = np.random.default_rng(8), tmp_path / "out"
    command = [sys.executable, "-m", "ncgear", "build", str(design), "--out", str(folder)]
    start = time.perf_counter()
    subprocess.run(command, check=True, capture_output=True, env=environment())
    seconds, before, names = time.perf_counter() - start, seen(folder), places(folder)
    for _ in range(8):
        status, err = interrupted(random.uniform(0.0, 0.8 * seconds), "build", str(design), "--out", str(folder))
        assert "Traceback" not in err
        if status == 130:
            assert_interrupted((status, err))
            assert seen(folder) == before
        else:  # it was faster than the first
            assert status == 0
            before = seen(folder)
        assert places(folder) == names


LONG: dict[str, tuple[float, list[str]]] = {
    "sweep": (1.0, ["sweep", "designs/baler.yaml", "--vary", "motion.v1_mm_s=1500:1700:20000"]),
    "simulate": (2.0, ["simulate", "designs/baler-dynamics.yaml", "--level", "dynamic"]),
    "size": (2.5, ["size", "designs/baler-half-dynamics.yaml"]),
    "reproduce": (0.3, ["reproduce"]),
    "optimize": (3.0, ["optimize", "designs/baler-66.yaml"]),
}


@pytest.mark.tiers(slow=["size"], rest="long")
@pytest.mark.parametrize("name", LONG)
def test_long_work_can_be_interrupted(tmp_path: Path, monkeypatch: pytest.MonkeyPatch, name: str) -> None:
    monkeypatch.chdir(ROOT)
    seconds, arguments = LONG[name]
    out = tmp_path / ("out.yaml" if name == "size" else "out")
    assert_interrupted(interrupted(seconds, *arguments, "--out", str(out)))
    # A sweep keeps its finished parts, from which it goes on.
    assert {path.name for path in out.glob("*")} <= ({"sweep.parquet"} if name == "sweep" else set())
    assert name == "sweep" or not out.exists()


@pytest.mark.tiers(slow=["told alone"], rest="long")
@pytest.mark.parametrize("whole_group", [False, True], ids=["told alone", "as a terminal does"])
def test_an_interrupted_frontier_ends_its_processes_at_once(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch, whole_group: bool
) -> None:
    pytest.importorskip("casadi")
    monkeypatch.chdir(ROOT)
    arguments = "frontier", "designs/baler-frontier.yaml", "--points", "4", "--out", str(tmp_path / "out")
    assert_interrupted(interrupted(5.0, *arguments, whole_group=whole_group))


AWAY = """
import signal, sys, time
from ncgear.cli import app, main

class Freed:
    def __del__(self):
        signal.raise_signal(signal.SIGINT)

def work():
    Freed()
    time.sleep(30)

app.app = work
main()
"""
"""Ctrl-C while an object is freed, where the interpreter can raise nothing."""


@pytest.mark.thorough
def test_ctrl_c_is_heard_also_where_it_cannot_be_raised() -> None:
    done = python("-c", AWAY)
    assert_interrupted((done.returncode, done.stderr))


IMPORT = """
import enum, signal, sys

made = enum.EnumType.__call__

def pressed(cls, *arguments, **options):
    if arguments[0] == "OpType":
        print("pressed", flush=True)
        signal.raise_signal(signal.SIGINT)
    return made(cls, *arguments, **options)

enum.EnumType.__call__ = pressed
from ncgear.cli import app, main

def work():
    import time
    import manifold3d
    time.sleep(5.0)

app.app = work
main()
"""
"""Ctrl-C while manifold3d makes an enumeration as it is imported: an exception there aborts the process."""


@pytest.mark.thorough
def test_ctrl_c_waits_for_the_import_of_a_compiled_library() -> None:
    done = python("-c", IMPORT)
    assert done.stdout == "pressed\n"
    assert_interrupted((done.returncode, done.stderr))


NOHUP = """
import signal
signal.signal(signal.SIGHUP, signal.SIG_IGN)
from ncgear.cli import app, main

def work():
    signal.raise_signal(signal.SIGHUP)
    print("it went on")
    signal.raise_signal(signal.SIGTERM)

app.app = work
main()
"""


@pytest.mark.thorough
@pytest.mark.skipif(os.name != "posix", reason="of Unix")
def test_what_nohup_has_begun_goes_on_where_its_terminal_is_closed() -> None:
    done = python("-c", NOHUP)
    assert done.stdout == "it went on\n"
    assert done.returncode == 128 + signal.SIGTERM
    assert done.stderr == "interrupted; what earlier runs have written is untouched\n"


@pytest.mark.parametrize("number", ENDING)
def test_signals_wait_for_what_must_not_be_left_half_done(number: signal.Signals) -> None:
    done = []

    def half_done() -> None:
        with uninterrupted():
            signal.raise_signal(number)
            done.append("the rest")

    with signals_kept():
        signal.signal(number, signal.default_int_handler)
        with pytest.raises(KeyboardInterrupt):
            half_done()
        assert done == ["the rest"]
        assert signal.getsignal(number) is signal.default_int_handler
