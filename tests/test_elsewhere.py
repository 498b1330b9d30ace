"""ncgear where the system is Windows, as far as one can have that here: tests/elsewhere stands in for what differs."""

from __future__ import annotations

import json
import os
from pathlib import Path

import pytest

from commands import ROOT, Process, python

ELSEWHERE = os.pathsep.join(map(str, (ROOT / "tests" / "elsewhere", ROOT / "src", ROOT / "tests", ROOT / "benchmarks")))

SEEN = """
import json
from ncgear import interrupts, memory, workers
from ncgear.files import one_file
from ncgear.studio import drafts
print(json.dumps([
    one_file.os.name, drafts.HOLDS, memory.sys.platform, hasattr(workers.os, "sched_getaffinity"),
    hasattr(interrupts.signal, "setitimer"), hasattr(interrupts.signal, "pthread_sigmask"),
    [one.name for one in interrupts.ENDING],
]))
"""


def there(*arguments: str, folder: Path) -> Process:
    done = python(*arguments, folder=folder, PYTHONPATH=ELSEWHERE)
    assert (done.returncode, "Traceback" in done.stderr) == (0, False), done.stdout[-3000:] + done.stderr
    return done


def test_ncgear_sees_the_other_system(tmp_path: Path) -> None:
    """Without this the tests below would try nothing."""
    seen = json.loads(there("-c", SEEN, folder=tmp_path).stdout)
    assert seen == ["nt", False, "win32", False, False, False, ["SIGINT", "SIGTERM"]]


@pytest.mark.slow
@pytest.mark.parametrize(
    ("command", "written"),
    [
        ("build ellipse --format dxf --format svg", "driving.dxf"),
        ("animate ellipse --out film.gif", "film.gif"),
        ("optimize pusher", "certificate.json"),
        ("sweep pusher --vary linkage.rod_mm=200:240:4 --stage teeth --processes 2", "sweep.json"),
    ],
)
def test_commands_work(command: str, written: str, tmp_path: Path) -> None:
    """Twice, since files that are there have to be replaced."""
    name, design, *others = command.split()
    for _ in range(2):
        there("-m", "ncgear", name, str(ROOT / "designs" / f"{design}.yaml"), *others, folder=tmp_path)
        files = [path.name for path in tmp_path.rglob("*") if path.is_file()]
        assert written in files
        assert [file for file in files if file.startswith(".")] == []


@pytest.mark.slow
def test_tests_begin(tmp_path: Path) -> None:
    """Every file of tests can be imported, and skips with a reason what the system lacks."""
    there("-m", "pytest", "-q", "-n", "0", "-p", "no:cacheprovider", "--collect-only", str(ROOT / "tests"), folder=ROOT)
