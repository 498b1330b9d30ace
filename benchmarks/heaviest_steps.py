"""Each room's heaviest step, its operations, and how far it is from bare numpy.  Writes benchmarks/heaviest-steps.md.

Run as ``make bench`` or ``python benchmarks/heaviest_steps.py``.  Commands run in this process under a profile, then
again with the operations of the steps counted.  What the processor does with bare numpy is measured in the same run.
"""

from __future__ import annotations

import os

# One core: the libraries read this as they are loaded.
os.environ |= {"OMP_NUM_THREADS": "1", "OPENBLAS_NUM_THREADS": "1"}

import builtins
import cProfile
import io
import platform
import pstats
import re
from collections import defaultdict
from collections.abc import Callable, Iterable
from contextlib import redirect_stderr, redirect_stdout, suppress
from dataclasses import dataclass, replace
from importlib import import_module
from pathlib import Path
from pkgutil import walk_packages
from tempfile import TemporaryDirectory
from time import perf_counter, process_time
from typing import Any

# With matplotlib loaded, builds draw in this process.
import matplotlib  # noqa: F401
import numpy as np
from counted_operations import Counts, Step, counting

import ncgear
from ncgear.cli.app import app

ROOT = Path(__file__).parents[1]
SOURCE = str(Path(ncgear.__file__).parent) + os.sep

COMMANDS = {
    "check": "check designs/baler-66.yaml",
    "build": "build designs/ellipse.yaml --out {out}/built",
    "measured": "measured designs/ellipse.yaml --driving {out}/built/driving.csv --out {out}/measured",
    "build, masses": "build designs/baler-drivetrain.yaml --out {out}/masses",
    "strength": "strength designs/pump-1-2.yaml --out {out}/strength",
    "simulate": "simulate designs/baler-dynamics.yaml --out {out}/simulated",
    "balance": "balance designs/balance/baler.yaml --out {out}/balance",
    "tolerance": "tolerance designs/pump-1-2.yaml --samples 256 --processes 1 --out {out}/tolerance",
    "optimize": "optimize designs/baler-66.yaml --processes 1 --out {out}/optimized",
    "sweep": "sweep designs/pusher.yaml --vary motion.theta1_pi=0.3:0.4 --vary motion.theta2_pi=0.5:0.7 --samples 4096 "
    "--processes 1 --out {out}/swept",
}
"""Each is run in this process; those that read what others write stand after them."""

OUTSIDE = {"cli", "design", "figures", "formulas", "papers", "project", "studio"}
"""Rooms of text, of keys and of what others compute."""

WITHIN = {"<listcomp>", "<genexpr>", "<dictcomp>", "<setcomp>"}
"""Parts of the function that they stand in."""

NOTHING_S = 1e-6
"""Less time of a library is lost on its way to who calls it."""


@dataclass(frozen=True)
class Taken:
    """Processor seconds of a step: of itself and in libraries below it, by library, in so many calls."""

    calls: int
    own: float
    below: dict[str, float]

    @property
    def seconds(self) -> float:
        return self.own + sum(self.below.values())


def run(command: str, folder: Path) -> None:
    """A command, its output thrown away."""
    with redirect_stdout(io.StringIO()), redirect_stderr(io.StringIO()):
        app([word.format(out=folder) for word in command.split()], standalone_mode=False)


def library_of(function: Any) -> str:
    """The library of a function of a profile; Python itself is one.  A library in Rust may name its class only."""
    path, _, name = function
    found = re.search(r"site-packages/_?(\w+)()", path) or re.search(r"(?:method |' of ')_?(\w+)\.(\w+)", name)
    if not found or (found[1] == "builtins" and hasattr(builtins, found[2])):
        return "Python"
    return found[2] if found[1] == "builtins" else found[1]


def profiled(command: str, folder: Path) -> dict[Step, Taken]:
    """The functions of ncgear that a command calls.  Time of libraries goes to those that call them, imports left out."""
    profile = cProfile.Profile()
    clock, start = perf_counter(), process_time()
    profile.runcall(run, command, folder)
    used = (process_time() - start) / (perf_counter() - clock)
    stats: dict[Any, Any] = pstats.Stats(profile).stats  # type: ignore[attr-defined]
    own = {one for one in stats if one[0].startswith(SOURCE) and one[2] not in WITHIN}
    below: dict[Any, dict[str, float]] = defaultdict(lambda: defaultdict(float))
    going = {(one, library_of(one)): row[2] for one, row in stats.items() if one not in own}
    while going:
        arriving: dict[Any, float] = defaultdict(float)
        for (one, library), seconds in going.items():
            if seconds < NOTHING_S:
                continue
            callers = stats[one][4]
            whole = sum(row[3] for row in callers.values())
            for caller, row in callers.items():
                share = seconds * row[3] / whole if whole else 0.0
                if caller in own:
                    below[caller][library] += share
                elif "importlib" not in caller[0]:
                    arriving[caller, library] += share
        going = arriving
    return {
        Step(*one): Taken(stats[one][1], used * stats[one][2], {name: used * s for name, s in below[one].items()})
        for one in own
        if one[2] != "<module>"
    }


def load_all() -> None:
    """Load all modules, so that no profile is of their loading."""
    for module in walk_packages(ncgear.__path__, "ncgear."):
        # Modules of extras that are not installed.
        with suppress(ImportError):
            import_module(module.name)


def room_of(step: Step) -> str:
    """The folder of ncgear that a step is in; "" for modules in no folder."""
    inner = step.path.removeprefix(SOURCE).split(os.sep)
    return inner[0] if len(inner) > 1 else ""


@dataclass(frozen=True)
class Bare:
    """What this processor does: seconds of an operation on a small array, of an element, of an operation of Python."""

    call: float
    near: float
    far: float
    other: float

    def terms(self, counts: Counts) -> dict[str, float]:
        """Seconds of these operations, by what they wait for."""
        return {
            "calls": self.call * counts.arrays,
            "arithmetic": self.near * counts.near,
            "memory": self.far * counts.far,
            "Python": self.other * counts.others,
        }


def least(work: Callable[[], object], runs: int = 15) -> float:
    """Least seconds of several runs."""
    times = []
    for _ in range(runs):
        start = perf_counter()
        work()
        times.append(perf_counter() - start)
    return min(times)


def multiply_add(size: int, repeats: int) -> float:
    """Seconds of an operation on arrays of this size: multiply-adds, each of two operations that give new arrays."""
    a, b, c = np.random.default_rng(1).random((3, size))

    def work() -> None:
        for _ in range(repeats):
            a * b + c

    return least(work) / (2 * repeats)


def python_operation(repeats: int = 100_000) -> float:
    """Seconds of an operation of Python on two floats."""

    def work() -> float:
        x = 0.5
        for _ in range(repeats):
            x = x * 0.5 + 0.25
        return x

    return least(work) / (2 * repeats)


def measured_bare() -> Bare:
    """What bare numpy and Python do here, now."""
    near = multiply_add(4096, 500)
    call = multiply_add(1, 20_000)
    return Bare(call, (near - call) / 4096, multiply_add(1 << 23, 1) / (1 << 23), python_operation())


@dataclass(frozen=True)
class Heaviest:
    """The heaviest step of a room: the command in which it was met, and what it took of all that this command took."""

    name: str
    step: Step
    taken: Taken
    share: float


def heaviest_steps(folder: Path) -> dict[str, Heaviest]:
    """Of each room that computes, by its name."""
    found: dict[str, Heaviest] = {}
    for name, command in COMMANDS.items():
        steps = profiled(command, folder)
        whole = sum(taken.seconds for taken in steps.values())
        for step, taken in steps.items():
            room = room_of(step)
            if room and room not in OUTSIDE and (room not in found or taken.seconds > found[room].taken.seconds):
                found[room] = Heaviest(name, step, taken, taken.seconds / whole)
    return found


def counted(found: Iterable[Heaviest], folder: Path) -> dict[Step, Counts]:
    """The operations of steps, each in its own command, run once more."""
    found = list(found)
    counts = counting(one.step for one in found)
    kept = {}
    for name in {one.name for one in found}:
        before = {step: replace(one) for step, one in counts.items()}
        run(COMMANDS[name], folder)
        kept.update({one.step: counts[one.step].since(before[one.step]) for one in found if one.name == name})
    return kept


def row(room: str, one: Heaviest, counts: Counts, bare: Bare) -> str:
    """A line of the table."""
    step, taken, terms = one.step, one.taken, bare.terms(counts)
    library, inside = max(taken.below.items(), key=lambda item: item[1], default=("", 0.0))
    within = f"{library} {inside / taken.seconds:.0%}" if inside > 0.1 * taken.seconds else "-"
    where = f"`{step.name}`, {step.path.removeprefix(SOURCE + room + os.sep)}:{step.line}"
    ms, least_ms = 1e3 * taken.seconds, 1e3 * sum(terms.values())
    held = library not in ("", "numpy") and inside > 0.5 * taken.seconds
    judged = (
        f"not counted | | | {library}"
        if held
        else (
            f"{least_ms:.3g} | {ms / least_ms:.1f} | {max(terms.values()) / sum(terms.values()):.0%} | {max(terms, key=terms.__getitem__)}"
        )
    )
    operations = f"{counts.arrays} | {counts.near} | {counts.far} | {counts.others}"
    return f"| {room} | {one.name} | {where} | {taken.calls} | {ms:.1f} | {one.share:.0%} | {within} | {operations} | {judged} |"


def page() -> str:
    """The whole page."""
    load_all()
    os.chdir(ROOT)
    with TemporaryDirectory() as place:
        folder = Path(place)
        found = heaviest_steps(folder)
        counts = counted(found.values(), folder)
    bare = measured_bare()
    rows = [row(room, one, counts[one.step], bare) for room, one in sorted(found.items())]
    return "\n".join(rows)


if __name__ == "__main__":
    text = page()
    (ROOT / "benchmarks" / "heaviest-steps.md").write_text(text, encoding="utf-8")
    print(text)
