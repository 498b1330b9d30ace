"""What the shell offers, asked as the shell asks: by environment variables, in a process of its own."""

from __future__ import annotations

import subprocess
from pathlib import Path

import pytest

from commands import ROOT, python
from ncgear.cli.app import COMMANDS

# The shell calls it by the name under which it is installed.
PROGRAM = "import sys; sys.argv = ['ncgear']; from ncgear.cli import main; main()"


def offered(typed: str, folder: Path = ROOT) -> list[str]:
    """The words that bash is offered after ``typed``, a command line that is being written."""
    words = typed.split(" ")
    asked = {"_NCGEAR_COMPLETE": "complete_bash", "COMP_WORDS": " ".join(words), "COMP_CWORD": str(len(words) - 1)}
    done = python("-c", PROGRAM, folder=folder, **asked)
    assert done.stderr == ""
    return done.stdout.split()


@pytest.mark.slow
def test_all_commands() -> None:
    assert offered("ncgear ") == [command.__name__ for command in COMMANDS]


@pytest.mark.tiers(
    slow=[
        "ncgear explain gears.rack.prof-words1",
        "ncgear new x --law e-words4",
        "ncgear strength x --method el-words6",
    ],
    rest="long",
)
@pytest.mark.parametrize(
    ("typed", "words"),
    [
        ("ncgear expl", ["explain"]),
        ("ncgear explain gears.rack.prof", ["gears.rack.profile"]),
        ("ncgear explain thet", [f"theta{number}_{unit}" for number in (1, 2, 3, 4) for unit in ("rad", "deg", "pi")]),
        ("ncgear explain --of balance chain_drive.w", ["chain_drive.wrap_deg"]),
        ("ncgear new x --law e", ["ellipse"]),
        ("ncgear simulate x --level q", ["quasi_static"]),
        ("ncgear strength x --method el", ["elements"]),
        ("ncgear size x --material 18", ["18CrNiMo7-6"]),
        ("ncgear sweep x --js", ["--json"]),
    ],
)
def test_words(typed: str, words: list[str]) -> None:
    assert offered(typed) == words


@pytest.mark.slow
def test_files_are_designs_and_folders_that_may_hold_some(tmp_path: Path) -> None:
    for name in ("one.yaml", "other.yml", "points.csv", ".hidden.yaml", "below/deep.yaml"):
        (tmp_path / name).parent.mkdir(exist_ok=True)
        (tmp_path / name).touch()
    assert offered("ncgear check ", tmp_path) == ["below/", "one.yaml", "other.yml"]
    assert offered("ncgear build o", tmp_path) == ["one.yaml", "other.yml"]
    assert offered("ncgear balance below/", tmp_path) == ["below/deep.yaml"]
    assert offered("ncgear check .h", tmp_path) == [".hidden.yaml"]
    assert offered("ncgear check nowhere/x", tmp_path) == []


@pytest.mark.slow
def test_a_shell_gets_its_script() -> None:
    done = python("-c", PROGRAM, _NCGEAR_COMPLETE="source_bash")
    assert "complete" in done.stdout
    syntax = subprocess.run(["bash", "-n"], input=done.stdout, capture_output=True, text=True)
    assert (syntax.returncode, syntax.stderr) == (0, "")
