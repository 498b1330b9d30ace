"""What tests of commands share: runs in this process and in one of their own, changed files, what was written."""

from __future__ import annotations

import json
import os
import re
import signal
import subprocess
import sys
from collections.abc import Callable, Iterator
from contextlib import ExitStack, contextmanager
from pathlib import Path
from tempfile import TemporaryDirectory
from typing import Any

import numpy as np

from ncgear.errors import NoSuchMechanism
from ncgear.interrupts import ENDING

Outcome = tuple[int, str, str]
"""Exit status, stdout and stderr."""

Run = Callable[..., Outcome]

ROOT = Path(__file__).parents[1]
Process = subprocess.CompletedProcess[str]


FOLDERS = ExitStack()
"""Folders that a file's tests share; closed when the last test of a process has run."""


def new_folder() -> Path:
    """A folder that stays until all tests have run."""
    return Path(FOLDERS.enter_context(TemporaryDirectory(prefix="ncgear-test-")))


def on_text(run: Run, command: str, *always: str) -> Run:
    """The command on d.yaml, which holds the text that is given first, with the arguments that it has ``always``."""

    def run_once(text: str, *arguments: str) -> Outcome:
        Path("d.yaml").write_text(text, encoding="utf-8")
        return run(command, "d.yaml", *always, *arguments)

    return run_once


@contextmanager
def signals_kept() -> Iterator[None]:
    """A context at whose end signals are handled as before: a run of the command line ignores them at its own end."""
    before = {number: signal.getsignal(number) for number in ENDING}
    try:
        yield
    finally:
        for number, handler in before.items():
            signal.signal(number, handler)


def environment(**more: str) -> dict[str, str]:
    """Variables of a process of its own, which imports the package of this checkout."""
    return {**os.environ, "PYTHONPATH": str(ROOT / "src"), **more}


def python(*arguments: str, folder: Path = ROOT, **more: str) -> Process:
    """Python in a process of its own, with more variables."""
    command = [sys.executable, *arguments]
    return subprocess.run(command, capture_output=True, text=True, cwd=folder, timeout=300, env=environment(**more))


def fresh(*arguments: str, folder: Path = ROOT) -> Process:
    """``python -m ncgear`` as a user runs it."""
    return python("-m", "ncgear", *arguments, folder=folder)


def modules_after(code: str, folder: Path = ROOT) -> set[str]:
    """Top-level modules loaded by a fresh interpreter that has run ``code``."""
    said = "print(json.dumps([name.partition('.')[0] for name in sys.modules]))"
    done = python("-c", f"import json, sys\n{code}\n{said}", folder=folder)
    assert done.returncode == 0, done.stderr
    return set(json.loads(done.stdout.splitlines()[-1]))


COMMAND = """
import ncgear.cli
sys.argv = {arguments}
try:
    ncgear.cli.main()
except SystemExit as exit_:
    assert exit_.code == 0, exit_
"""
"""A command as a user gives it, in an interpreter that has loaded nothing else."""


def loaded_by(*arguments: str, folder: Path = ROOT, before: str = "") -> set[str]:
    """Top-level modules that a command loads, after a text that is executed before it."""
    return modules_after(before + COMMAND.format(arguments=["ncgear", *arguments]), folder)


def changed(text: str, old: str, new: str) -> str:
    """``text`` with its only ``old`` replaced."""
    assert text.count(old) == 1, f"{old!r} stands {text.count(old)} times"
    return text.replace(old, new)


def stated_angle(fault: NoSuchMechanism) -> float:
    """The driving angle that a message names, in rad."""
    found = re.search(r"phi1 = ([-0-9.e]+) rad", fault.problem)
    assert found is not None, fault.problem
    return float(found.group(1))


def simulated(folder: str) -> dict[str, Any]:
    """The figures that ``ncgear simulate`` wrote."""
    return json.loads(Path(folder, "simulation.json").read_text())


def simulated_table(folder: str) -> np.ndarray:
    """The table that it wrote, its columns by name."""
    return np.genfromtxt(Path(folder, "simulation.csv"), delimiter=",", names=True)
