"""Screening designs: time against error, one by one and in blocks.  Writes benchmarks/screening.md.

Run as ``make bench`` or ``python benchmarks/screening.py``.  Law, closure, pitch curves and all scalar checks of a
design, no teeth, values checked against the models' limits.  Processor time on one core, the smallest of several runs.
"""

from __future__ import annotations

import os

# One core: the libraries read this as they are loaded.
os.environ |= {"OMP_NUM_THREADS": "1", "OPENBLAS_NUM_THREADS": "1"}

import platform
from collections.abc import Callable, Iterator
from functools import cache, partial
from pathlib import Path
from resource import RUSAGE_SELF, getrusage
from time import perf_counter, process_time
from typing import Any

import numpy as np

from ncgear.design.reading.design_file import load
from ncgear.design.space import checked_design
from ncgear.errors import DesignError, WrongInput
from ncgear.memory import begin_worker
from ncgear.numerics.arrays import Array
from ncgear.screening import designs, rows
from ncgear.screening.designs import MADE, screened_block
from ncgear.screening.samples import Fineness
from ncgear.screening.single import single_figures
from ncgear.workers import finished

ROOT = Path(__file__).parents[1]

Box = dict[str, tuple[float, float]]

BORDER: Box = {"motion.theta1_pi": (0.36, 0.42), "motion.theta2_pi": (0.66, 0.74)}
WIDE: Box = {
    "motion.theta1_pi": (0.2, 0.6),
    "motion.theta2_pi": (0.4, 1.0),
    "motion.theta3_pi": (0.6, 1.2),
    "motion.theta4_pi": (0.9, 1.7),
    "motion.v1_mm_s": (600.0, 2200.0),
    "motion.v2_mm_s": (600.0, 1600.0),
    "motion.a1_mm_s2": (-6000.0, 0.0),
    "motion.return.e": (-3.0, 3.0),
}
CASES: dict[str, tuple[str, Box]] = {
    "baler, v1 by 2 % up and down": ("baler", {"motion.v1_mm_s": (1568.0, 1632.0)}),
    "baler, at the border of what can be made": ("baler", BORDER),
    "baler, eight keys far and wide": ("baler", WIDE),
    "baler-dynamics (stated masses), v1 by 2 % up and down": ("baler-dynamics", {"motion.v1_mm_s": (1568.0, 1632.0)}),
    "baler-dynamics (stated masses), at the border": ("baler-dynamics", BORDER),
    "baler-drivetrain (harmonics), two coefficients": (
        "baler-drivetrain",
        {"motion.cosine.0": (-0.5, 0.5), "motion.sine.0": (-0.3, 0.3)},
    ),
    "feeder-table (no batch knows its law), speed": ("feeder-table", {"operation.speed_rpm": (20.0, 60.0)}),
}
"""Designs of each: a file, and keys with the ranges of their values."""

COUNT, ALONE = 512, 8
COUNTS = (1, 10, 100, 1000)
RESIDUALS = ("closure.residual_rad", "closure.stroke_residual_mm")
TOGETHER = (1 << 14, 1 << 16, 1 << 18)
MANY, PART, MILLION = 4000, 1000, 1_000_000


@cache
def data_of(name: str) -> dict[str, Any]:
    """The plain values of a shipped design; without masses where they leave the gears to their bodies."""
    data = load(ROOT / "designs" / f"{name}.yaml").data
    left_out = () if "driven_gear_kg_mm2" in data.get("masses", {}) else ("masses", "drivetrain")
    return {key: value for key, value in data.items() if key not in left_out}


def in_box(box: Box, count: int, seed: int = 1) -> Array:
    """Random values of the keys, shape (count, keys)."""
    random = np.random.default_rng(seed)
    return np.column_stack([random.uniform(low, high, count) for low, high in box.values()])


def least_ms(work: Callable[[], object], runs: int) -> float:
    """Smallest processor time of several runs."""
    times = []
    for _ in range(runs):
        start = process_time()
        work()
        times.append(process_time() - start)
    return 1000.0 * min(times)


def alone(name: str, box: Box, values: list[float]) -> dict[str, float] | str:
    """The figures of one design computed by itself, or its refusal."""
    design = checked_design(data_of(name), list(box), values)
    try:
        return str(design) if isinstance(design, WrongInput) else single_figures(design)
    except DesignError as error:
        return str(error)


def case_rows() -> Iterator[str]:
    """Milliseconds a design by itself and in a block, the share refused, and the largest difference of any figure."""
    for title, (name, box) in CASES.items():
        count = ALONE if name == "feeder-table" else COUNT
        values = in_box(box, count)
        screened_block(data_of(name), list(box), values[:64])
        each = least_ms(partial(screened_block, data_of(name), list(box), values), 2) / count
        found = screened_block(data_of(name), list(box), values)
        single, worst, texts = 0.0, 0.0, 0
        for row in range(0, count, count // ALONE):
            start = process_time()
            one = alone(name, box, values[row].tolist())
            single += (process_time() - start) / len(range(0, count, count // ALONE))
            texts += found.verdicts[row] != (MADE if isinstance(one, dict) else one)
            if isinstance(one, dict):
                worst = max(worst, *(differs(key, found.figures[key][row], value) for key, value in one.items()))
        refused = 100.0 * float(np.mean(~found.made))
        yield (
            f"| {title} | {refused:.0f} | {1000.0 * single:.1f} | {each:.3f} | {1000.0 * single / each:.0f} "
            f"| {worst:.0e} | {texts} |"
        )


def differs(key: str, value: float, exact: float) -> float:
    """The relative difference of a figure, of residuals the absolute one."""
    return abs(value - exact) / (1.0 if key in RESIDUALS or exact == 0.0 else abs(exact))


def count_rows() -> Iterator[str]:
    """Milliseconds a design against the number of designs of a block."""
    for count in COUNTS:
        values = in_box(BORDER, count)
        each = least_ms(partial(screened_block, data_of("baler"), list(BORDER), values), 3)
        yield f"| {count} | {each / count:.3f} |"


def together_rows() -> Iterator[str]:
    """Milliseconds a design against the samples computed at once."""
    values, usual = in_box(BORDER, 1024), designs.TOGETHER
    for together in TOGETHER:
        designs.TOGETHER = together
        each = least_ms(partial(screened_block, data_of("baler"), list(BORDER), values), 2) / len(values)
        yield f"| {together} | {each:.3f} |"
    designs.TOGETHER = usual


def error_rows() -> Iterator[str]:
    """Time and error against the points of a piece, where the first fineness is believed unseen."""
    name, box = CASES["baler, v1 by 2 % up and down"]
    values = in_box(box, 256)
    exact = screened_block(data_of(name), list(box), values).figures
    usual = designs.computed_together.__defaults__
    for count in (9, 17, 33, 49, 65):
        designs.computed_together.__defaults__ = ((Fineness(count),),)
        demands = {name: vars(rows)[name] for name in ("RESOLVED", "CLOSED")}
        vars(rows).update(dict.fromkeys(demands, np.inf))
        found = screened_block(data_of(name), list(box), values).figures
        each = least_ms(partial(screened_block, data_of(name), list(box), values), 2) / 256
        vars(rows).update(demands)
        worst = max(float(np.max(np.abs(found[key] / exact[key] - 1.0))) for key in exact if "peak" in key)
        yield f"| {count} | {each:.3f} | {worst:.0e} |"
    designs.computed_together.__defaults__ = usual


def part(seed: int) -> tuple[int, float, float]:
    """A part of a long sweep: how many are made, the processor time in s, the process's largest memory so far in MB."""
    start = process_time()
    found = screened_block(data_of("baler"), list(BORDER), in_box(BORDER, PART, seed))
    return int(found.made.sum()), process_time() - start, getrusage(RUSAGE_SELF).ru_maxrss / 1024.0


def long_rows() -> list[str]:
    """Many designs on two processes: processor time, time by the clock, memory."""
    start = perf_counter()
    parts = [one for _, one in finished(part, range(MANY // PART), None, 2)]
    took, busy = perf_counter() - start, sum(seconds for _, seconds, _ in parts)
    single = 1000.0 * least_ms(lambda: alone("baler", BORDER, [0.4, 0.7]), 5) / 1e6
    return [
        f"{MANY} designs at the border on two processes: {1000.0 * busy / MANY:.3f} ms of processor time each, "
        f"{busy / MANY / single:.4f} of what one design takes by itself in the same run; {took:.0f} s by the clock "
        f"(they had {100.0 * busy / 2.0 / took:.0f} % of two cores, their start included). "
        f"Two cores of their own take {busy / 2.0 / MANY * MILLION:.0f} s for a million. "
        f"Memory: {max(memory for _, _, memory in parts):.0f} MB for each process, whatever the number; "
        f"{sum(made for made, _, _ in parts)} can be made."
    ]


def report() -> str:
    """The whole page."""
    lines = [
        "# Screening designs",
        "",
        "Written by `python benchmarks/screening.py`: law, closure, pitch curves and all scalar checks of a design, no",
        f"teeth, with the check of its values, on one of {os.cpu_count()} cores, Python {platform.python_version()};",
        "processor time, the smallest of several runs.  Other work on the computer makes all times longer, not their",
        "ratios.",
        "",
        "| designs | refused, % | by itself, ms | in a block, ms | times as fast | largest error | other verdicts |",
        "|---|---|---|---|---|---|---|",
        *case_rows(),
        "",
        "## A million",
        "",
        *long_rows(),
        "",
        "## Designs of a block",
        "",
        "At the border of what can be made:",
        "",
        "| designs | ms each |",
        "|---|---|",
        *count_rows(),
        "",
        "## Designs computed at once",
        "",
        "| samples at once | ms each |",
        "|---|---|",
        *together_rows(),
        "",
        "## Points of a piece",
        "",
        "Time and largest error of a peak, if too few points were believed, which blocks do not.",
        "",
        "| points | ms each | error |",
        "|---|---|---|",
        *error_rows(),
        "",
    ]
    return "\n".join(lines)


if __name__ == "__main__":
    # As the processes of a sweep begin.
    begin_worker()
    page = report()
    (ROOT / "benchmarks" / "screening.md").write_text(page, encoding="utf-8")
    print(page)
