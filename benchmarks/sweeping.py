"""Sweeps on one and two processes, what moves, and a plan for a thousand workers.  Writes benchmarks/sweeping.md.

Run as ``make bench`` or ``python benchmarks/sweeping.py``.  Times on one and on two processes are of one run, one after
the other, so that their ratio is that of one state of the computer.  A million designs are swept once, by the command.
"""

from __future__ import annotations

import os

# One core: the libraries read this as they are loaded.
os.environ |= {"OMP_NUM_THREADS": "1", "OPENBLAS_NUM_THREADS": "1"}

import pickle
import resource
import subprocess
import sys
from collections.abc import Callable, Iterator, Sequence
from dataclasses import dataclass
from functools import partial
from pathlib import Path
from tempfile import TemporaryDirectory
from time import perf_counter, process_time, sleep
from typing import Any
from unittest.mock import patch

import numpy as np
import psutil

from ncgear.design.reading.design_file import load
from ncgear.design.space import Ranged, Space
from ncgear.files.parts import Parts, table_bytes
from ncgear.files.sweep_run import ROWS, Order, _deeper_bytes, _screened_bytes, plan_of, screening_of, swept
from ncgear.numerics.arrays import Array
from ncgear.screening import designs as designs_module
from ncgear.screening.deeper import deepened
from ncgear.screening.designs import Block, Screening, screened_part
from ncgear.screening.overview import no_overview
from ncgear.screening.rows import figure_names
from ncgear.screening.wanted import Objective, Wanted
from ncgear.workers import finished

ROOT = Path(__file__).parents[1]
BALER = load(ROOT / "designs" / "baler.yaml")
RANGES = Ranged("motion.v1_mm_s", 1500.0, 1700.0), Ranged("motion.theta1_pi", 0.36, 0.40)
LEAST = Objective("check.peak_acceleration_cycle_mm_s2"), Objective("check.peak_power_w")
DESIGNS, FOLLOWED = 2 * ROWS, 16
MANY = 1_000_000
EMPTY_TASKS = 500
NETWORK_MB_S = 100.0
"""A usual network of one gigabit a second."""

WORKERS = (1, 2, 10, 100, 1000)


def asked(count: int, stage: str = "pitch", keep: int = FOLLOWED) -> tuple[Order, Screening]:
    """A sweep of so many balers."""
    order = Order(Space(RANGES, count), stage, keep)
    return order, screening_of(BALER.design, BALER.data, order)


def run_once(folder: Path, order: Order, screening: Screening, processes: int) -> float:
    """Seconds of a sweep."""
    start = perf_counter()
    swept(BALER, order, screening, Wanted((), LEAST), folder, lambda *_: None, processes=processes)
    return perf_counter() - start


def scaling(stage: str, count: int) -> tuple[str, bool]:
    """A row of the times on one and two processes; whether all parts are the same to the byte."""
    order, screening = asked(count, stage)
    times, tables = [], []
    for processes in (1, 2):
        with TemporaryDirectory() as folder:
            if stage != "pitch":
                run_once(Path(folder), *asked(count), 2)
            times.append(run_once(Path(folder), order, screening, processes))
            tables.append({path.name: path.read_bytes() for path in Path(folder).glob("*.parquet/*")})
    done = count if stage == "pitch" else FOLLOWED
    what = f"{done} designs, {stage}"
    row = f"| {what} | {times[0]:.1f} | {times[1]:.1f} | {times[0] / times[1]:.2f} | {1000.0 * times[0] / done:.3g} |"
    return row, tables[0] == tables[1]


def best_ms(work: Callable[[], object], runs: int = 5) -> float:
    """Least processor time of several runs, in ms."""
    times = []
    for _ in range(runs):
        start = process_time()
        work()
        times.append(process_time() - start)
    return 1000.0 * min(times)


def costs(folder: Path) -> dict[str, float]:
    """What one part of a sweep of a million costs, in ms and in bytes."""
    screening = asked(MANY)[1]
    parts = Parts(folder / "p.parquet", plan_of(BALER, screening, "pitch"), screening.space.keys)
    parts.begun([])
    values = screening.values(100)
    designs = screened_part(screening, 100, values)
    content = table_bytes(designs, parts.digest, 0)
    parts.add(0, content)
    wanted = Wanted((), LEAST)
    overview = no_overview(screening.space, wanted).with_part(designs)
    followed = designs.at(slice(4))
    deeper = table_bytes(deepened(BALER.data, 1, "teeth", followed), parts.digest, 0)
    return {
        "task": len(pickle.dumps((partial(_screened_bytes, screening, parts.digest), (100, values)))),
        "result": len(content),
        "deep_task": len(pickle.dumps((partial(_deeper_bytes, BALER.data, 1, "teeth", parts.digest), (7, followed)))),
        "deep_result": len(deeper),
        "values": best_ms(partial(screening.values, 100)),
        "figures": best_ms(partial(screened_part, screening, 100, values), 2),
        "bytes": best_ms(partial(table_bytes, designs, parts.digest, 0)),
        "write": best_ms(partial(parts.add, 0, content)),
        "gather": best_ms(lambda: overview.with_part(parts.designs(0))),
        "deep": best_ms(partial(deepened, BALER.data, 1, "teeth", followed), 2),
    }


def free_block(data: dict[str, Any], keys: Sequence[str], values: Array) -> Block:
    """Figures that cost nothing and differ from design to design; every tenth design is refused."""
    names = figure_names(BALER.design)
    made = np.arange(len(values)) % 10 != 0
    wave = np.where(made, np.cos(7.0 * values[:, 0]) + values[:, 1], np.nan)
    figures = {name: wave * values[:, place % 2] for place, name in enumerate(names)}
    return Block(figures, made, tuple("made" if one else f"motion: reaches {n} deg" for n, one in enumerate(made)))


def everything_else() -> None:
    """A million designs but for their figures, in this process: processor time in s and the most memory in MB."""
    with patch.object(designs_module, "screened_block", free_block), TemporaryDirectory() as folder:
        start = process_time()
        run_once(Path(folder), *asked(MANY), 1)
        seconds = process_time() - start
        size = sum(path.stat().st_size for path in Path(folder).glob("*.parquet/*"))
        count = len(list(Path(folder).glob("*.parquet/part*")))
    print(seconds, most_memory_mb(), size / 1e6, count)


def most_memory_mb() -> float:
    """The most memory that this process has had, without what the one that began it had."""
    lines = Path("/proc/self/status").read_text(encoding="utf-8").splitlines()
    return next(float(line.split()[1]) / 1000.0 for line in lines if line.startswith("VmHWM"))


def screening_memory_mb() -> float:
    """The most memory of a process that screens parts."""
    values = "sweeping.np.random.random((sweeping.ROWS, 2)) * [200.0, 0.04] + [1500.0, 0.36]"
    parts = f"[sweeping.screened_part(s, n, {values}) for n in (5, 6)]"
    code = f"import sweeping; s = sweeping.asked(10**6)[1]; {parts};"
    return float(_said(f"{code} print(sweeping.most_memory_mb())")[0])


def _said(code: str) -> list[str]:
    environment = {**os.environ, "PYTHONPATH": os.pathsep.join([str(ROOT / "benchmarks"), *sys.path])}
    run = subprocess.run([sys.executable, "-c", code], check=True, capture_output=True, text=True, env=environment)
    return run.stdout.split()


BORDER = "motion.theta1_pi=0.36:0.42", "motion.theta2_pi=0.66:0.74"
"""Where one design in eight is refused."""

LOOK_S = 0.5


@dataclass(frozen=True)
class Million:
    """A million designs by the command: seconds by the clock and of processors, and the most memory of all processes.

    Memory is counted twice: each process by itself, and with what several of them share counted once.
    """

    seconds: float
    processors_s: float
    resident_mb: float
    proportional_mb: float
    made: str


def million_at_the_border() -> Million:
    """Sweep a million balers on two processes."""
    with TemporaryDirectory() as folder:
        varied = [f"--vary={one}" for one in BORDER]
        asked_for = ["sweep", str(ROOT / "designs" / "baler.yaml"), *varied, f"--samples={MANY}", "--processes=2"]
        command = [sys.executable, "-m", "ncgear", *asked_for, f"--out={folder}"]
        before, start, resident, proportional = _children_s(), perf_counter(), 0, 0
        run = subprocess.Popen(command, stdout=subprocess.PIPE, stderr=subprocess.DEVNULL, text=True)
        process = psutil.Process(run.pid)
        while run.poll() is None:
            try:
                held = [one.memory_full_info() for one in (process, *process.children(recursive=True))]
            except psutil.Error:
                # One of them ended while it was looked at.
                continue
            resident = max(resident, sum(one.rss for one in held))
            proportional = max(proportional, sum(one.pss for one in held))
            sleep(LOOK_S)
        seconds, said = perf_counter() - start, run.communicate()[0]
        if run.returncode:
            raise RuntimeError(said)
    used = _children_s() - before
    return Million(seconds, used, resident / 1e6, proportional / 1e6, said.splitlines()[0])


def _children_s() -> float:
    used = resource.getrusage(resource.RUSAGE_CHILDREN)
    return used.ru_utime + used.ru_stime


def tasks_per_s() -> float:
    """Empty tasks a second of processor time of this process, which is a Dask scheduler as well."""
    results = finished(abs, range(EMPTY_TASKS + 1), "local", 2)
    next(results)
    start = process_time()
    return sum(1 for _ in results) / (process_time() - start)


def start_s() -> float:
    """Seconds of processor time until a new process can compute a part."""
    before = _children_s()
    _said("import ncgear.files.sweep_run, pyarrow.parquet")
    return _children_s() - before


def plan(cost: dict[str, float], tasks_s: float) -> Iterator[str]:
    """Rows of a plan: seconds of a million designs and of 10^8, and what is busy, for numbers of workers."""
    for designs, rows in ((10**6, 4096), (10**8, 16384)):
        count = designs / rows
        of_part, here = (cost["figures"] + cost["bytes"]) * rows / ROWS, rows / ROWS
        for workers in WORKERS:
            computing = -(-count // workers) * of_part / 1000.0
            writing = count * here * (cost["values"] + cost["write"] + cost["gather"]) / 1000.0
            network = count * here * cost["result"] / (1e6 * NETWORK_MB_S)
            tasks = count / tasks_s
            busiest = max((computing, "workers"), (writing, "this process"), (network, "network"), (tasks, "scheduler"))
            yield (
                f"| {designs:.0e} | {workers} | {count:.0f} | {computing:.3g} | {writing:.3g} | {network:.3g} | "
                f"{tasks:.2g} | {busiest[1]} |"
            )


def report() -> str:
    """The whole page."""
    rows, same = zip(*(scaling(stage, count) for stage, count in (("pitch", DESIGNS), ("teeth", 64))), strict=True)
    assert all(same)
    with TemporaryDirectory() as folder:
        cost = costs(Path(folder))
    seconds, parent_mb, table_mb, parts = map(float, _said("import sweeping; sweeping.everything_else()"))
    worker_mb, tasks_s, begins_s = screening_memory_mb(), tasks_per_s(), start_s()
    million = million_at_the_border()
    of_part = cost["figures"] + cost["bytes"]
    here = cost["values"] + cost["write"] + cost["gather"]
    lines = [
        "# Sweeps on many processes",
        "",
        f"Written by `python benchmarks/sweeping.py` on {os.cpu_count()} cores: `designs/baler.yaml`, Sobol points of",
        "`v1_mm_s` and `theta1_pi`. Times on one and on two processes are of one run; all parts were the same to the",
        "byte.",
        "",
        "| what | one process, s | two, s | times as fast | ms a design on one |",
        "|---|---|---|---|---|",
        *rows,
        "",
        "## A million at the border",
        "",
        f"`ncgear sweep designs/baler.yaml {' '.join(f'--vary {one}' for one in BORDER)} --samples {MANY} "
        f"--processes 2`: {million.made}.",
        f"{million.seconds:.0f} s by the clock, {1000.0 * million.processors_s / MANY:.3f} ms of processor time each, "
        "everything included. All processes together hold at most",
        f"{million.resident_mb:.0f} MB, or {million.proportional_mb:.0f} MB if what they share is counted once.",
        "",
        "## What a part costs, and what moves",
        "",
        f"A part of a sweep of a million has {ROWS} designs; processor time, the least of several runs.",
        "",
        "| where | what | |",
        "|---|---|---|",
        f"| this process | values of the keys (Sobol points from their numbers) | {cost['values']:.1f} ms |",
        f"| worker | figures | {cost['figures']:.0f} ms |",
        f"| worker | the part's file in memory | {cost['bytes']:.1f} ms |",
        f"| to the worker | a task, with the design, the space and the values | {cost['task'] / 1e3:.1f} kB |",
        f"| from the worker | the part's file | {cost['result'] / 1e3:.0f} kB |",
        f"| this process | writing it, down to the disk | {cost['write']:.1f} ms |",
        f"| this process | reading it again for the answer and the pictures | {cost['gather']:.1f} ms |",
        f"| worker | teeth of 4 designs | {cost['deep']:.0f} ms |",
        f"| to the worker | these 4 | {cost['deep_task'] / 1e3:.1f} kB |",
        f"| from the worker | these 4 | {cost['deep_result'] / 1e3:.1f} kB |",
        "",
        f"A million designs but for their figures: {seconds:.0f} s and at most {parent_mb:.0f} MB in this process, for",
        f"{parts:.0f} parts of {table_mb:.0f} MB together. A process that screens takes at most {worker_mb:.0f} MB.",
        "",
        "## A plan for a thousand workers",
        "",
        f"Computed from the figures above: workers as fast as this core, {NETWORK_MB_S:.0f} MB/s of network into this",
        f"process, and {tasks_s:.0f} tasks a second of processor time of scheduler and process together",
        f"({EMPTY_TASKS} empty tasks on a cluster of two processes).",
        "",
        "| designs | workers | tasks | workers busy, s | this process, s | network, s | scheduler, s | the longest |",
        "|---|---|---|---|---|---|---|---|",
        *plan(cost, tasks_s),
        "",
        "Where it stops:",
        "",
        f"- This process keeps up with {of_part / here:.0f} workers: each is busy {of_part / 1e3:.2f} s with a part",
        f"  that costs {here:.0f} ms here. More workers do not help, nor do larger parts, since both grow alike.",
        f"- The scheduler keeps up with {tasks_s * of_part / 1e3:.0f} workers at this length of a task.",
        f"- The network keeps up with {1e6 * NETWORK_MB_S / cost['result'] * of_part / 1e3:.0f} workers.",
        f"- A process needs {begins_s:.1f} s to begin: as long as {begins_s / of_part * 1e3:.1f} parts take.",
        "- A folder gets at most 6104 files of a sweep of 10^8 designs, 245 of one of 10^6.",
        f"- Teeth: a task of 4 designs takes {cost['deep'] / 1e3:.2f} s, so the scheduler keeps up with "
        f"{tasks_s * cost['deep'] / 1e3:.0f} workers.",
        "",
    ]
    return "\n".join(lines)


if __name__ == "__main__":
    page = report()
    (ROOT / "benchmarks" / "sweeping.md").write_text(page, encoding="utf-8")
    print(page)
