"""Sweeps on one and two processes, what moves, and a plan for a thousand workers.  Writes benchmarks/sweeping.md.

Run as ``make bench`` or ``python benchmarks/sweeping.py``; with ``sleeping`` it only prints how many sleeping processes
one client feeds.  Times on one and on two processes are of one run, one after
the other, so that their ratio is that of one state of the computer.  A million designs are swept once, by the command.
"""

from __future__ import annotations

import os

# One core: the libraries read this as they are loaded.
os.environ |= {"OMP_NUM_THREADS": "1", "OPENBLAS_NUM_THREADS": "1"}

import json
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
from distributed import Client

from ncgear import workers
from ncgear.design.reading.design_file import load
from ncgear.design.space import Ranged, Space
from ncgear.files.parts import Parts, table_bytes
from ncgear.files.sweep_run import ROWS, Order, _deeper_bytes, _screened_bytes, plan_of, screening_of, swept
from ncgear.numerics.arrays import Array
from ncgear.screening import designs as designs_module
from ncgear.screening.deeper import deepened, deeper_names
from ncgear.screening.designs import Block, Screening, screened_part
from ncgear.screening.overview import no_overview
from ncgear.screening.single import figure_names
from ncgear.screening.wanted import Objective, Wanted
from ncgear.workers import finished

ROOT = Path(__file__).parents[1]
BALER = load(ROOT / "designs" / "baler.yaml")
RANGES = Ranged("motion.v1_mm_s", 1500.0, 1700.0), Ranged("motion.theta1_pi", 0.36, 0.40)
LEAST = Objective("check.peak_acceleration_cycle_mm_s2"), Objective("check.peak_power_w")
DESIGNS, FOLLOWED = 2 * ROWS, 16
MANY = 1_000_000
SLEEPING = (100, 0.05, 6000), (400, 0.3, 8000), (1000, 5.0, 4000)
"""Runs of sleeping parts: processes, seconds of a part, parts."""

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
    followed, names = designs.at(slice(4)), deeper_names(BALER.design, "teeth")
    deeper = table_bytes(deepened(BALER.data, names, "teeth", followed), parts.digest, 0)
    return {
        "task": len(pickle.dumps((partial(_screened_bytes, screening, parts.digest), (100, values)))),
        "result": len(content),
        "deep_task": len(
            pickle.dumps((partial(_deeper_bytes, BALER.data, names, "teeth", parts.digest), (7, followed)))
        ),
        "deep_result": len(deeper),
        "values": best_ms(partial(screening.values, 100)),
        "figures": best_ms(partial(screened_part, screening, 100, values), 2),
        "bytes": best_ms(partial(table_bytes, designs, parts.digest, 0)),
        "write": best_ms(partial(parts.add, 0, content)),
        "gather": best_ms(lambda: overview.with_part(parts.designs(0))),
        "deep": best_ms(partial(deepened, BALER.data, names, "teeth", followed), 2),
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


@dataclass(frozen=True)
class Fed:
    """A run of sleeping tasks on a cluster: how long it took and would take if nothing waited, and what a bundle cost.

    Milliseconds of processor time of this process and of the scheduler.
    """

    seconds: float
    least_s: float
    bundles: int
    here_ms: float
    scheduler_ms: float


def fed(processes: int, task_s: float, count: int) -> Fed:
    """So many sleeping tasks on a scheduler and a worker of so many threads, each in its own process."""
    arguments = {"scheduler": ["--host", "127.0.0.1", "--port", "0", "--no-dashboard", "--no-show"]}
    with TemporaryDirectory() as folder:
        file = Path(folder) / "scheduler.json"
        arguments["scheduler"] += ["--scheduler-file", str(file)]
        arguments["worker"] = [
            "--scheduler-file",
            str(file),
            "--nthreads",
            str(processes),
            "--no-nanny",
            "--no-dashboard",
        ]
        begun = {name: _dask(name, *given) for name, given in arguments.items()}
        try:
            with Client(scheduler_file=str(file), timeout="30s") as client:
                client.wait_for_workers(1, timeout="60s")
            address = json.loads(file.read_text(encoding="utf-8"))["address"]
            scheduler = psutil.Process(begun["scheduler"].pid)
            submitted, really = list[Any](), Client.submit

            def submit(*given: Any, **named: Any) -> Any:
                submitted.append(really(*given, **named))
                return submitted[-1]

            before, here, start = sum(scheduler.cpu_times()[:2]), process_time(), perf_counter()
            with patch.object(Client, "submit", submit):
                done = sum(1 for _ in finished(sleep, [task_s] * count, address))
            seconds, here = perf_counter() - start, process_time() - here
            there = sum(scheduler.cpu_times()[:2]) - before
        finally:
            for one in reversed(begun.values()):
                one.terminate()
                one.wait()
    assert done == count
    bundles = len(submitted)
    return Fed(seconds, task_s * count / processes, bundles, 1000.0 * here / bundles, 1000.0 * there / bundles)


def _dask(*arguments: str) -> subprocess.Popen[bytes]:
    quiet = subprocess.DEVNULL
    return subprocess.Popen([sys.executable, "-m", "dask", *arguments], stdout=quiet, stderr=quiet)


def start_s() -> float:
    """Seconds of processor time until a new process can compute a part."""
    before = _children_s()
    _said("import ncgear.files.sweep_run, pyarrow.parquet")
    return _children_s() - before


def bundles_of(count: int, task_s: float, processes: int) -> int:
    """Into how many bundles a cluster's client puts so many tasks."""
    left, bundles = count, 0
    while left > 0:
        left, bundles = left - workers.bundle_size(task_s, left, processes), bundles + 1
    return bundles


def plan(cost: dict[str, float], fed: Fed) -> Iterator[str]:
    """Rows of a plan: seconds of 10^6, 10^8 and 10^9 designs, and what is busy, for numbers of workers."""
    for designs, rows in ((10**6, 4096), (10**8, 16384), (10**9, 16384)):
        count = -(-designs // rows)
        of_part, share = (cost["figures"] + cost["bytes"]) * rows / ROWS / 1000.0, rows / ROWS
        for processes in WORKERS:
            bundles = bundles_of(count, of_part, processes)
            computing = -(-count // processes) * of_part
            feeding = count * share * (cost["values"] + cost["write"]) / 1000.0 + bundles * fed.here_ms / 1000.0
            gathering = count * share * cost["gather"] / 1000.0
            network = count * share * cost["result"] / (1e6 * NETWORK_MB_S)
            scheduling = bundles * fed.scheduler_ms / 1000.0
            busy = {"workers": computing, "this process": feeding, "network": network, "scheduler": scheduling}
            yield (
                f"| {designs:.0e} | {processes} | {count} | {bundles} | {computing:.3g} | {feeding:.3g} "
                f"| {network:.3g} | {scheduling:.2g} | {max(busy, key=busy.__getitem__)} | {gathering:.3g} |"
            )


def fed_lines(sleeping: Sequence[Fed]) -> list[str]:
    """How many sleeping processes one client feeds."""
    return [
        "A cluster gets parts in bundles: 10 ms of work for each of its processes, at most 5 s, and no more than a",
        "share of what is left. Sleeping parts, on a scheduler and a worker of so many threads on this computer:",
        "",
        "| processes | parts | each sleeps, s | bundles | took, s | if nothing waited, s | at work in the mean "
        "| this process, ms a bundle | scheduler, ms |",
        "|---|---|---|---|---|---|---|---|---|",
        *(
            f"| {processes} | {count} | {task_s:g} | {one.bundles} | {one.seconds:.1f} | {one.least_s:.1f} "
            f"| {processes * one.least_s / one.seconds:.0f} | {one.here_ms:.1f} | {one.scheduler_ms:.1f} |"
            for (processes, task_s, count), one in zip(SLEEPING, sleeping, strict=True)
        ),
    ]


def report() -> str:
    """The whole page."""
    rows, same = zip(*(scaling(stage, count) for stage, count in (("pitch", DESIGNS), ("teeth", 64))), strict=True)
    assert all(same)
    with TemporaryDirectory() as folder:
        cost = costs(Path(folder))
    seconds, parent_mb, table_mb, parts = map(float, _said("import sweeping; sweeping.everything_else()"))
    worker_mb, begins_s = screening_memory_mb(), start_s()
    sleeping = [fed(*run) for run in SLEEPING]
    million = million_at_the_border()
    of_part = cost["figures"] + cost["bytes"]
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
        *fed_lines(sleeping),
        "",
        f"Computed from these and the figures above: workers as fast as this core, {NETWORK_MB_S:.0f} MB/s of network",
        "into this process. What is gathered at the end comes after all else.",
        "",
        "| designs | workers | parts | bundles | workers busy, s | this process, s | network, s | scheduler, s "
        "| the longest | gathered in, s |",
        "|---|---|---|---|---|---|---|---|---|---|",
        *plan(cost, sleeping[-1]),
        "",
        "Where it stops:",
        "",
        f"- This process feeds and writes {of_part / (cost['values'] + cost['write']):.0f} workers: each is busy "
        f"{of_part / 1e3:.2f} s with a part, and its values",
        f"  and its file cost {cost['values'] + cost['write']:.1f} ms here; gathering costs {cost['gather']:.1f} ms.",
        f"- Part by part this process would feed {of_part / sleeping[-1].here_ms:.0f} workers and the scheduler "
        f"{of_part / sleeping[-1].scheduler_ms:.0f}; bundles of 5 s are enough",
        f"  for {5000.0 / sleeping[-1].here_ms:.0f} and {5000.0 / sleeping[-1].scheduler_ms:.0f}.",
        f"- The network keeps up with {1e6 * NETWORK_MB_S / cost['result'] * of_part / 1e3:.0f} workers.",
        f"- A process needs {begins_s:.1f} s to begin: as long as {begins_s / of_part * 1e3:.1f} parts take.",
        "- A folder gets at most 6104 files of a sweep of 10^8 designs, 245 of one of 10^6.",
        "",
    ]
    return "\n".join(lines)


if __name__ == "__main__":
    if sys.argv[1:] == ["sleeping"]:
        print("\n".join(fed_lines([fed(*run) for run in SLEEPING])))
        sys.exit()
    page = report()
    (ROOT / "benchmarks" / "sweeping.md").write_text(page, encoding="utf-8")
    print(page)
