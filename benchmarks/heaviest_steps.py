"""Each room's heaviest step, its operations, and how far it is from bare numpy.  Writes benchmarks/heaviest-steps.md.

Run as ``make bench`` or ``python benchmarks/heaviest_steps.py``.  Commands run in this process under a profile, then
again with the operations of the steps counted.  What the processor does with bare numpy is measured in the same run.
"""

from __future__ import annotations

import os

# One core: the libraries read this as they are loaded.
os.environ |= {"OMP_NUM_THREADS": "1", "OPENBLAS_NUM_THREADS": "1"}

import cProfile
import io
import platform
from collections.abc import Callable, Iterable
from contextlib import redirect_stderr, redirect_stdout, suppress
from copy import deepcopy
from dataclasses import dataclass
from functools import partial
from importlib import import_module
from pathlib import Path
from pkgutil import walk_packages
from tempfile import TemporaryDirectory
from time import perf_counter

# With matplotlib loaded, builds draw in this process.
import matplotlib  # noqa: F401
import numpy as np

import ncgear
from counted_operations import CACHE_BYTES, Counts, counting
from ncgear.cli.app import app
from ncgear.memory import collect_rarely
from profiled_steps import SOURCE, Step, Taken, profiled

ROOT = Path(__file__).parents[1]
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
    "sweep": "sweep designs/baler.yaml --vary motion.v1_mm_s=1500:1700 --vary motion.theta1_pi=0.36:0.40 "
    "--samples 4096 --processes 1 --out {out}/swept",
}
"""Each is run in this process; those that read what others write stand after them."""

OUTSIDE = {"cli", "design", "figures", "formulas", "papers", "project", "studio"}
"""Rooms of text, of keys and of what others compute."""


def run(command: str, folder: Path) -> None:
    """A command, its output thrown away."""
    with redirect_stdout(io.StringIO()), redirect_stderr(io.StringIO()):
        app([word.format(out=folder) for word in command.split()], standalone_mode=False)


def profiled_call_s(repeats: int = 100_000) -> float:
    """Seconds that a profile adds to a call."""

    def nothing() -> None:
        pass

    def work() -> None:
        for _ in range(repeats):
            nothing()

    return (least(lambda: cProfile.Profile().runcall(work), 3) - least(work, 3)) / repeats


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
        steps = profiled(partial(run, command, folder))
        whole = sum(taken.seconds for taken in steps.values())
        for step, taken in steps.items():
            room = room_of(step)
            if room and room not in OUTSIDE and (room not in found or taken.seconds > found[room].taken.seconds):
                found[room] = Heaviest(name, step, taken, taken.seconds / whole)
    return {room: one for room, one in found.items() if one.taken.seconds > LEAST_S}


def counted(found: Iterable[Heaviest], folder: Path) -> dict[Step, Counts]:
    """The operations of steps, each in its own command, run once more in a folder without results of earlier runs."""
    found = list(found)
    kept: dict[Step, Counts] = {}
    for name, command in COMMANDS.items():
        counts = counting(one.step for one in found if one.name == name)
        run(command, folder)
        # Later commands go on counting.
        kept |= deepcopy(counts)
    return kept


def row(room: str, one: Heaviest, counts: Counts, bare: Bare) -> str:
    """A line of the table."""
    step, taken, terms = one.step, one.taken, bare.terms(counts)
    below = {
        name: max(taken.below.get(name, 0.0), counts.compiled.get(name, 0.0))
        for name in {*taken.below, *counts.compiled}
    }
    library, inside = max(below.items(), key=lambda item: item[1], default=("", 0.0))
    part = min(inside / taken.seconds, 1.0)
    bound, heaviest = max(terms.items(), key=lambda item: item[1])
    least_s = sum(terms.values())
    last = [f"{1e3 * least_s:.3g}", f"{taken.seconds / least_s:.1f}", f"{bound} {heaviest / least_s:.0%}"]
    if library != "numpy" and part > 0.5:
        last = ["not counted", "-", f"library {library}"]
    cells = [
        room,
        one.name,
        f"`{step.name}`, {step.path.removeprefix(SOURCE + room + os.sep)}",
        f"{taken.calls}",
        f"{1e3 * taken.seconds:.1f}",
        f"{one.share:.1%}",
        f"{library} {part:.0%}" if part > 0.05 else "-",
        *(f"{number}" for number in (counts.arrays, counts.near, counts.far, counts.others)),
        *last,
    ]
    return f"| {' | '.join(cells)} |"


LEAST_S = 1e-3
"""Steps that take less are not worth a row."""

COLUMNS = (
    *("room", "command", "step", "calls", "ms", "of the command", "in libraries", "array operations"),
    *("elements near", "elements far", "other operations", "bare ms", "times bare", "bound"),
)

PAGE = """\
# Each room's heaviest step

Written by `python benchmarks/heaviest_steps.py`: {cores} cores, one of them used, Python {python}, numpy {numpy}.

A step is a function of ncgear. Its time is its own and that of library functions below it, in all its calls of a
command, under a profile, which makes each call {profiled_us:.2f} µs longer. Of each room the step stands here that
takes most in any of these commands. Rooms of text and of keys are left out, and those whose steps take less than
1 ms.

{commands}

The operations are counted in the body of the function, in another run of the command:

- **Array operations** are operators, subscripts and calls of libraries that meet an array. Each takes
  {call_ns:.0f} ns before it comes to its elements.
- **Elements near** are those of arrays up to {cache_mb} MB, in the cache: {near_ns:.2f} ns each. **Elements far** are
  those of larger arrays, in memory: {far_ns:.2f} ns each. Views have none.
- **Other operations** are all other operators, subscripts and calls: of numbers, lists, objects. An element that
  becomes an object of Python is one too. Each takes {other_ns:.0f} ns.

These times are of the same run: of a multiply-add of bare numpy, `a * b + c`, for arrays of 1, of 4096 and of
8 million numbers, and of one for two numbers in Python. The **bare ms** are the time of the counted operations at
this rate. The **bound** says what takes most of it: calls of numpy, arithmetic in the cache, memory, or Python. A
step that takes about its bare time gets faster only by fewer operations, or by fewer calls.

What the count does not know: a sine or a root takes several times a multiply-add, an operation on truth values a
fraction of it. A call of numpy that sorts, multiplies matrices or interpolates is one operation on the largest
array that it meets; a function of Python for a whole list is one. Where a library other than numpy takes more than
half of the time, its operations are not counted.

| {columns} |
|{rule}
{rows}
"""


def as_typed(command: str) -> str:
    """A command without its output folder."""
    return command.split(" --out")[0].replace("{out}/", "")


def page() -> str:
    """The whole page."""
    # As the command line does.
    collect_rarely()
    load_all()
    os.chdir(ROOT)
    bare = measured_bare()
    with TemporaryDirectory() as first, TemporaryDirectory() as second:
        found = heaviest_steps(Path(first))
        counts = counted(found.values(), Path(second))
    return PAGE.format(
        cores=os.cpu_count(),
        python=platform.python_version(),
        numpy=np.__version__,
        profiled_us=1e6 * profiled_call_s(),
        commands="\n".join(f"- {name}: `ncgear {as_typed(text)}`" for name, text in COMMANDS.items()),
        call_ns=1e9 * bare.call,
        cache_mb=CACHE_BYTES >> 20,
        near_ns=1e9 * bare.near,
        far_ns=1e9 * bare.far,
        other_ns=1e9 * bare.other,
        columns=" | ".join(COLUMNS),
        rule="---|" * len(COLUMNS),
        rows="\n".join(row(room, one, counts[one.step], bare) for room, one in sorted(found.items())),
    )


if __name__ == "__main__":
    (ROOT / "benchmarks" / "heaviest-steps.md").write_text(page(), encoding="utf-8")
