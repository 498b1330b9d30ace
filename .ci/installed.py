"""Every command of an installed ncgear, from a foreign folder: .ci/installed.py PROGRAM --extras NAMES [--turn N ...].

Each has to end with the status that it should have: 0, or 2 where a design lacks what it needs or an extra is missing.
All commands on all designs take seven minutes of processor time, which no cell has. So quick commands get all five
designs, and the others one of those that fit them in each ``--turn``: the cells of .ci/run have all five turns between
them, and ``--turn 0 1 2 3 4``, for a person, gives a cell all.
Without ``--turn`` only the commands that need the given extras are run.

What is printed goes out in cp1252, the folder's name has letters that cp1252 has not, there is no HOME; and once the
folder is one in which nothing may be written.
"""

from __future__ import annotations

import argparse
import os
import re
import shlex
import shutil
import signal
import subprocess
import sys
import time
from collections.abc import Iterator
from dataclasses import dataclass
from pathlib import Path
from tempfile import TemporaryDirectory
from urllib.request import urlopen

DESIGNS = "pusher", "ellipse", "pump-1-2", "rocker-drive", "oval-flow-meter"
LOADED = "pusher", "pump-1-2", "rocker-drive"
HEAVY = "baler-dynamics", "rocker-drive"
STROKES = "pusher", "ellipse", "rocker-drive"
DRAWN = "traced-egg", "rounded-square"
OTHERS = "baler-dynamics", "uniform-crank", "balance/threshing-drum"

EACH = ("check {0}.yaml",)
"""Commands of every design."""

IN_TURN = {
    "formulas {0}.yaml": DESIGNS,
    "build {0}.yaml": DESIGNS,
    "build {0}.yaml --format dxf --format 3mf --format svg --out formats": DESIGNS[1:],
    "measured {0}.yaml --driving export/{0}/driving.csv": DESIGNS,
    "report {0}.yaml": DESIGNS,
    "animate {0}.yaml": DESIGNS,
    "compare {0}.yaml uniform-crank.yaml": DESIGNS,
    "tolerance {0}.yaml --samples 64": DESIGNS,
    "bench {0}.yaml": ("ellipse", "oval-flow-meter"),
    "simulate {0}.yaml": HEAVY,
    "strength {0}.yaml": LOADED,
    "size {0}.yaml": LOADED,
}
"""Commands that take longer, and the designs that give what each needs, of which one has its turn."""

ONCE = """
--version | examples | explain gears.module_mm | schema | reproduce | new mine --law ellipse
new heart --shape heart | check heart.yaml | freecad
balance balance/threshing-drum.yaml
"""

REFUSED = {"simulate ellipse.yaml": "masses: missing", "strength ellipse.yaml": "resistance: missing"}
"""Commands of a design that lacks what they need, and what is said."""

OF_EXTRAS: dict[str, tuple[str, tuple[str, ...] | str]] = {
    "optimize {0}.yaml": ("optimize", STROKES),
    "fit {0}.yaml": ("optimize", DRAWN),
    "frontier ellipse.yaml": ("optimize", "resistance: missing"),
    "design ellipse.yaml": ("optimize", "resistance: missing"),
    "measured ellipse.yaml --driving points.xlsx": ("tables", "points.xlsx: cannot be read"),
    "build {0}.yaml --format step --out step": ("step", DESIGNS),
    "animate {0}.yaml --out film.mp4": ("video", DESIGNS),
    "sweep {0}.yaml --vary gears.module_mm=1:2:2": ("sweep", DESIGNS),
    "tolerance {0}.yaml --samples 64 --scheduler local": ("cluster", DESIGNS),
    "studio {0}.yaml --no-browser": ("studio", DESIGNS),
}
"""Commands that need extras, and the designs, or what is said by a command that cannot succeed: a frontier would take
minutes, and there is no spreadsheet."""

READ_ONLY = {"check ellipse.yaml": 0, "build ellipse.yaml": 2, "new my": 2, "report ellipse.yaml --out ../open": 0}
"""Statuses in a folder in which nothing may be written."""

NO_RIGHTS = "setpriv", "--bounding-set=-dac_override,-dac_read_search", "--inh-caps=-dac_override,-dac_read_search"
"""What makes root a user who may write where the permissions say so."""


@dataclass(frozen=True)
class Run:
    """A command, the status that it has to end with, and words that it has to say then."""

    arguments: str
    status: int = 0
    said: str = ""


def runs_of(turns: list[int]) -> Iterator[Run]:
    """The commands that need no extra; the design of each turn."""
    yield from (Run(each.format(name)) for name in DESIGNS for each in EACH)
    for each, names in IN_TURN.items():
        yield from (Run(each.format(name)) for name in in_turn(names, turns))
    yield from (Run(one.strip()) for one in re.split(r"[|\n]", ONCE.strip()))
    yield from (Run(one, 2, said) for one, said in REFUSED.items())


def runs_of_extras(turns: list[int], extras: set[str]) -> Iterator[Run]:
    """The commands that need an extra: done where it is there, and refused by its name where it is not."""
    for each, (extra, names) in OF_EXTRAS.items():
        if extra not in extras:
            yield Run(each.format(names[0]), 2, f"ncgear[{extra}]")
        elif isinstance(names, tuple):
            yield from (Run(each.format(name)) for name in in_turn(names, turns))
        else:
            yield Run(each, 2, names)


def in_turn(names: tuple[str, ...], turns: list[int]) -> list[str]:
    """The designs whose turn it is, each once."""
    return list(dict.fromkeys(names[turn % len(names)] for turn in turns))


class Installed:
    """An installed program in a folder; what has ended otherwise than it should is counted."""

    def __init__(self, program: list[str], folder: Path) -> None:
        self.program, self.folder, self.wrong = program, folder, 0
        self.environment = {"PATH": os.environ["PATH"], "PYTHONIOENCODING": "cp1252", "LANG": "C"}
        self.environment |= dict.fromkeys(("OMP_NUM_THREADS", "OPENBLAS_NUM_THREADS"), "1")

    def run(self, run: Run, folder: Path, before: tuple[str, ...] = ()) -> None:
        """Run a command and print how it ends."""
        begun, there = time.monotonic(), set(folder.rglob("*"))
        command = [*before, *self.program, *run.arguments.split()]
        if run.arguments.startswith("studio") and not run.status:
            status, err = self._served(command, folder)
        else:
            done = subprocess.run(command, cwd=folder, env=self.environment, capture_output=True)
            status, err = done.returncode, done.stderr.decode("cp1252")
            done.stdout.decode("cp1252")
        left = set(folder.rglob("*")) - there if run.status else set()
        right = status == run.status and run.said in err and not left and "Traceback" not in err
        self.wrong += not right
        took = time.monotonic() - begun
        print(f"{'' if right else 'WRONG: '}{run.arguments}: {status} in {took:.1f} s", flush=True)
        if not right:
            print(err, *left, sep="\n", flush=True)

    def _served(self, command: list[str], folder: Path) -> tuple[int, str]:
        """The status of a studio that Ctrl-C ends when its page has been fetched."""
        pipe = subprocess.PIPE
        with subprocess.Popen(command, cwd=folder, env=self.environment, stdout=pipe, stderr=pipe, text=True) as studio:
            assert studio.stdout is not None
            address = re.search(r"http://\S+", studio.stdout.readline())
            page = urlopen(address[0]).read().decode() if address else ""
            studio.send_signal(signal.SIGINT)
            _, err = studio.communicate()
            return (studio.returncode if "<title>ncgear" in page else 1), err

    def where_nothing_may_be_written(self) -> None:
        """Commands in a folder without the permission to write, with a home that is none."""
        root = getattr(os, "geteuid", lambda: 1)() == 0
        if root and shutil.which(NO_RIGHTS[0]) is None:
            print("NOT TESTED: a folder without the permission to write, because root may write everywhere", flush=True)
            return
        closed = self.folder / "closed"
        closed.mkdir()
        shutil.copy(self.folder / "ellipse.yaml", closed)
        closed.chmod(0o555)
        self.environment["HOME"] = "/dev/null"
        for arguments, status in READ_ONLY.items():
            self.run(Run(arguments, status), closed, NO_RIGHTS if root else ())
        closed.chmod(0o755)


def main() -> None:
    """Run all; a line for each that ends otherwise than it should."""
    parser = argparse.ArgumentParser()
    parser.add_argument("program")
    parser.add_argument("--extras", default="")
    parser.add_argument("--turn", type=int, nargs="*", default=[])
    given = parser.parse_args()
    program = shlex.split(given.program)
    program[0] = os.path.abspath(program[0])
    with TemporaryDirectory(suffix="-\u017elut\u00fd k\u016f\u0148") as place:
        folder = Path(place)
        installed = Installed(program, folder)
        extras = set(given.extras.split(","))
        alone = not given.turn
        for name in (*(STROKES if alone else (*DESIGNS, *OTHERS)), *DRAWN):
            installed.run(Run(f"new --example {name}"), folder)
        if alone:
            runs = [run for run in runs_of_extras([0], extras) if not run.said.startswith("ncgear[")]
        else:
            runs = [*runs_of(given.turn), *runs_of_extras(given.turn, extras)]
        for run in runs:
            installed.run(run, folder)
        if not alone:
            installed.where_nothing_may_be_written()
    sys.exit(bool(installed.wrong))


if __name__ == "__main__":
    main()
