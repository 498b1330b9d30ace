"""How long builds take: whole processes, and the steps inside them.  Writes benchmarks/timing.md.

Run as ``make bench`` or ``python benchmarks/timing.py``.  Medians of several runs; the machine's noise is shown by the
range.  Whole processes include the interpreter's start and every import.
"""

from __future__ import annotations

import json
import os
import platform
import statistics
import subprocess
import sys
import tempfile
from pathlib import Path
from time import perf_counter

ROOT = Path(__file__).parents[1]
RUNS = 7

COMMANDS = {
    "ncgear --help": ["--help"],
    "ncgear check designs/baler.yaml": ["check", "designs/baler.yaml"],
    "ncgear build designs/baler.yaml": ["build", "designs/baler.yaml"],
    "ncgear build designs/baler-86.yaml": ["build", "designs/baler-86.yaml"],
}

STEPS = {
    "design file to pitch curves": ("law", "pitch curves"),
    "both tooth outlines": ("teeth",),
    "contact analysis": ("contact", "written contact"),
    "peaks of power and acceleration": ("check",),
    "solids": ("solids",),
    "plots": ("plots",),
}


def wall_seconds(arguments: list[str]) -> float:
    """One run of the program, its output thrown away."""
    start = perf_counter()
    subprocess.run([sys.executable, "-m", "ncgear", *arguments], cwd=ROOT, check=True, stdout=subprocess.DEVNULL)
    return perf_counter() - start


def step_seconds(design: str, folder: Path) -> dict[str, float]:
    """Steps of one build, from its summary."""
    wall_seconds(["build", f"designs/{design}.yaml", "--out", str(folder)])
    timing = json.loads((folder / "summary.json").read_text())["timing_s"]
    return {name: sum(timing[step] for step in steps) for name, steps in STEPS.items()}


def row(name: str, seconds: list[float]) -> str:
    """One line of a table: median, smallest and largest, in milliseconds."""
    low, middle, high = min(seconds), statistics.median(seconds), max(seconds)
    return f"| {name} | {1000 * middle:.0f} | {1000 * low:.0f} .. {1000 * high:.0f} |"


def report(folder: Path) -> str:
    """The whole page."""
    head = ["| median, ms | range, ms |", "|---|---|---|"]
    lines = [
        "# How long builds take",
        "",
        f"Written by `python benchmarks/timing.py`: {RUNS} runs each, {os.cpu_count()} cores, "
        f"Python {platform.python_version()}.",
        "",
        f"| whole process {head[0]}",
        head[1],
    ]
    for name, arguments in COMMANDS.items():
        extra = ["--out", str(folder)] if arguments[0] == "build" else []
        lines.append(row(f"`{name}`", [wall_seconds(arguments + extra) for _ in range(RUNS)]))
    for design in ("baler", "baler-86"):
        lines += ["", f"| step of `{design}` {head[0]}", head[1]]
        runs = [step_seconds(design, folder) for _ in range(RUNS)]
        lines += [row(step, [run[step] for run in runs]) for step in STEPS]
    return "\n".join([*lines, ""])


if __name__ == "__main__":
    with tempfile.TemporaryDirectory() as place:
        page = report(Path(place))
    (ROOT / "benchmarks" / "timing.md").write_text(page, encoding="utf-8")
    print(page)
