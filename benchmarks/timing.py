"""How long commands take: whole processes beside the import of their libraries, steps of a build, growth with teeth.

Run as ``make bench`` or ``python benchmarks/timing.py``; ``--runs`` says how often each process is run.  Writes
benchmarks/timing.md.  Processes run in turn, each round once all of them, and ratios are taken round by round, so that
a machine whose speed drifts counts for all alike.  Beside the seconds of the clock stand those of processors, user and
system, of a process and its children, which other work on the machine changes less.  Bytecode is written before.
"""

from __future__ import annotations

import argparse
import json
import os
import platform
import resource
import statistics
import subprocess
import sys
import tempfile
from dataclasses import dataclass
from pathlib import Path
from time import perf_counter

ROOT = Path(__file__).parents[1]
RUNS = 7

LIBRARIES = "import numpy, scipy, trimesh, shapely, matplotlib"
SOLVERS = "import numpy, scipy.optimize"

BALER = "designs/baler.yaml"
COMMANDS = {
    "ncgear --help": ["--help"],
    "ncgear explain gears.module_mm": ["explain", "gears.module_mm"],
    "ncgear new NAME": ["new"],
    "completion of ncgear explain": [],
    f"ncgear check {BALER}": ["check", BALER],
    f"ncgear build {BALER}": ["build", BALER],
    f"ncgear report {BALER}": ["report", BALER],
    f"ncgear animate {BALER}": ["animate", BALER],
}

YARDSTICKS = {
    f"ncgear build {BALER}": LIBRARIES,
    f"ncgear report {BALER}": LIBRARIES,
    f"ncgear animate {BALER}": LIBRARIES,
    f"ncgear check {BALER}": SOLVERS,
}
"""What a command's time is divided by."""

STEPS = {
    "design file to pitch curves": ("law", "pitch curves"),
    "both tooth outlines": ("teeth",),
    "contact analysis": ("contact", "written contact"),
    "peaks of power and acceleration": ("check",),
    "solids": ("solids",),
    "load of every tooth": ("load of every tooth",),
    "files for the workshop": ("workshop files",),
    "waiting for the pictures": ("plots",),
}

TEETH = (25, 100, 200, 400)
"""Numbers of teeth of each gear; the gears have the same size."""

GROWTH_RUNS = 3
"""Rounds of builds with several numbers of teeth, of which the least times count."""

GROWING = """\
name: teeth-{teeth}
motion: {{law: ratio_expression, driven_angle: phi - 0.08*sin(2*phi)}}
linkage: {{crank_mm: 40, rod_mm: 150}}
operation: {{speed_rpm: 60}}
resistance: {{polynomial_n: [100]}}
gears: {{teeth: {teeth}, module_mm: {module_mm}, face_width_mm: 20}}
"""
"""The design whose number of teeth grows."""


@dataclass(frozen=True)
class Seconds:
    """Of a whole process: by the clock, and of processors, user and system together, its children included."""

    wall: float
    processor: float


def run(arguments: list[str], folder: Path, **variables: str) -> Seconds:
    """One run of Python, its output thrown away."""
    inherited = {name: value for name, value in os.environ.items() if name != "PYTHONDONTWRITEBYTECODE"}
    environment = {**inherited, "PYTHONPATH": str(ROOT / "src"), **variables}
    before, start = resource.getrusage(resource.RUSAGE_CHILDREN), perf_counter()
    quiet = subprocess.DEVNULL
    subprocess.run([sys.executable, *arguments], cwd=folder, check=True, env=environment, stdout=quiet, stderr=quiet)
    wall, after = perf_counter() - start, resource.getrusage(resource.RUSAGE_CHILDREN)
    return Seconds(wall, after.ru_utime + after.ru_stime - before.ru_utime - before.ru_stime)


def command_seconds(arguments: list[str], folder: Path) -> Seconds:
    """One run of the program; without arguments, of what the shell asks it after ``ncgear explain gea``."""
    if not arguments:
        typed = {"COMP_WORDS": "ncgear explain gea", "COMP_CWORD": "2", "_NCGEAR_COMPLETE": "complete_bash"}
        return run(["-c", "import sys; sys.argv = ['ncgear']; from ncgear.cli import main; main()"], folder, **typed)
    if arguments == ["new"]:
        (folder / "mine.yaml").unlink(missing_ok=True)
        return run(["-m", "ncgear", "new", "mine"], folder)
    out = {"build": str(folder / "built"), "report": str(folder / "reported"), "animate": str(folder / "moving.gif")}
    more = ["--out", out[arguments[0]]] if arguments[0] in out else []
    return run(["-m", "ncgear", *arguments, *more], ROOT)


def step_seconds(folder: Path) -> dict[str, float]:
    """Steps of the last build, from its summary."""
    timing = json.loads((folder / "built" / "summary.json").read_text())["timing_s"]
    return {name: sum(timing[step] for step in steps) for name, steps in STEPS.items()}


def growth_rows(folder: Path) -> list[str]:
    """Builds with several numbers of teeth in turn: least times, and what each further tooth of each gear adds."""
    files = {count: folder / f"teeth-{count}.yaml" for count in TEETH}
    for count, path in files.items():
        path.write_text(GROWING.format(teeth=count, module_mm=75 / count))
    whole: dict[int, list[Seconds]] = {count: [] for count in TEETH}
    steps: dict[int, list[dict[str, float]]] = {count: [] for count in TEETH}
    for _ in range(GROWTH_RUNS):
        for count, path in files.items():
            whole[count].append(run(["-m", "ncgear", "build", str(path), "--out", str(folder / "built")], ROOT))
            steps[count].append(step_seconds(folder))

    def least(name: str, count: int) -> float:
        if name in STEPS:
            return 1000.0 * min(one[name] for one in steps[count])
        return float(1000.0 * min(getattr(one, name) for one in whole[count]))

    _, first, *_, last = TEETH
    said = {"processor": "build, processors", "wall": "build, by the clock", **{name: name for name in STEPS}}
    rows = []
    for name, words in said.items():
        times = [least(name, count) for count in TEETH]
        each = (times[-1] - times[1]) / (last - first)
        rows.append(f"| {words} | {' | '.join(f'{time:.0f}' for time in times)} | {each:.2f} |")
    return rows


def row(name: str, seconds: list[Seconds], ratio: str = "") -> str:
    """One line of a table: medians in milliseconds, and the range of the clock's."""
    wall, processor = ([getattr(one, kind) for one in seconds] for kind in ("wall", "processor"))
    middle = f"{1000 * statistics.median(wall):.0f} | {1000 * min(wall):.0f} .. {1000 * max(wall):.0f}"
    return f"| {name} | {middle} | {1000 * statistics.median(processor):.0f} | {ratio} |"


def ratios(one: list[Seconds], other: list[Seconds]) -> str:
    """Medians of the ratios of rounds, by the clock and by processors."""
    pairs = list(zip(one, other, strict=True))
    kinds = ([getattr(a, kind) / getattr(b, kind) for a, b in pairs] for kind in ("wall", "processor"))
    return ", ".join(f"{statistics.median(kind):.2f}" for kind in kinds)


def report(folder: Path, runs: int) -> str:
    """The whole page."""
    found: dict[str, list[Seconds]] = {name: [] for name in (*COMMANDS, LIBRARIES, SOLVERS)}
    steps = []
    for round_number in range(runs + 1):
        # The first round writes bytecode and fills the caches of the disk.
        for name in found:
            code = name in (LIBRARIES, SOLVERS)
            taken = run(["-c", name], ROOT) if code else command_seconds(COMMANDS[name], folder)
            if round_number:
                found[name].append(taken)
            if name == f"ncgear build {BALER}" and round_number:
                steps.append(step_seconds(folder))
    lines = [
        "# How long commands take",
        "",
        f"Written by `python benchmarks/timing.py --runs {runs}`: {os.cpu_count()} cores, "
        f"Python {platform.python_version()}.",
        "",
        "Seconds of processors are those of a command and of the process that draws for it. A ratio is the median of",
        "those of the rounds, by the clock and by processors. On a machine busy with other work, the clock says more",
        "of that work than of ncgear.",
        "",
        "| whole process | median, ms | range, ms | processors, ms | over the import of its libraries |",
        "|---|---|---|---|---|",
    ]
    for name, seconds in found.items():
        yardstick = YARDSTICKS.get(name)
        lines.append(row(f"`{name}`", seconds, ratios(seconds, found[yardstick]) if yardstick else ""))
    lines += ["", "| step of a build of `baler` | median, ms | range, ms |", "|---|---|---|"]
    for step in STEPS:
        times = [1000 * one[step] for one in steps]
        lines.append(f"| {step} | {statistics.median(times):.0f} | {min(times):.0f} .. {max(times):.0f} |")
    lines += [
        "",
        "Growth with the number of teeth of each gear, on gears of the same size, phi2 = phi1 - 0.08 sin 2 phi1: least",
        f"times of {GROWTH_RUNS} runs in ms, and what each tooth beyond {TEETH[1]} adds.",
        "",
        f"| | {' | '.join(map(str, TEETH))} | for each tooth |",
        f"|---|{'---|' * len(TEETH)}---|",
        *growth_rows(folder),
    ]
    return "\n".join([*lines, ""])


if __name__ == "__main__":
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--runs", type=int, default=RUNS, help="rounds, besides the one that fills caches")
    with tempfile.TemporaryDirectory() as place:
        page = report(Path(place), parser.parse_args().runs)
    (ROOT / "benchmarks" / "timing.md").write_text(page, encoding="utf-8")
    print(page)
