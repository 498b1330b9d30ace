"""The certified limit: time and value against the grid.  Writes benchmarks/limit.md.

Run as ``make bench`` or ``python benchmarks/limit.py``.  The baler's linkage and resistance at 60 r/min, ratio within
0.2 to 5; medians of several runs after one that is not counted.
"""

from __future__ import annotations

import os
import platform
import statistics
from collections.abc import Callable
from dataclasses import replace
from functools import partial
from math import radians, tan
from pathlib import Path
from time import perf_counter

from ncgear.mechanisms.forces import RodMasses
from ncgear.optimum.certified.demands import Demands
from ncgear.optimum.certified.limit import Bound, least_acceleration, least_power
from ncgear.optimum.certified.sums import PeakWeights, least_weighted_sum
from speed_against_error.baler import TASK

ROOT = Path(__file__).parents[1]
RUNS = 3
GRIDS = (120, 240, 480, 960, 1920)
WEIGHTS = PeakWeights(1.0 / 20000.0, 1.0 / 9000.0)
FREE = Demands(0.2, 5.0)
MASSIVE = replace(TASK, masses=RodMasses(slider_kg=20.0))

SEARCHES: dict[str, Callable[[int], Bound]] = {
    "least acceleration at 6300 W, mm/s²": lambda places: least_acceleration(
        TASK, replace(FREE, power_w=6300.0), places
    ),
    "least power at 20 000 mm/s², W": lambda places: least_power(
        TASK, replace(FREE, acceleration_mm_s2=20000.0), places
    ),
    "least acceleration at 9000 W, pressure angle 40°, mm/s²": lambda places: least_acceleration(
        TASK, replace(FREE, power_w=9000.0, steepness=tan(radians(40.0))), places
    ),
    "least acceleration at 9000 W, moving 20 kg, mm/s²": lambda places: least_acceleration(
        MASSIVE, replace(FREE, power_w=9000.0), places
    ),
    "A/20 000 mm/s² + P/9000 W, to 0.5 %": lambda places: least_weighted_sum(TASK, FREE, WEIGHTS, places),
}
"""What is least on a grid of so many places."""

CONVEX = "least acceleration, convex pitch curves, mm/s²"
POWERS_W = (6300.0, 9375.0, 18750.0)


def timed(search: Callable[[], Bound]) -> tuple[Bound, str]:
    """A limit, and two cells of a table: median and range of its times in ms."""
    bound = search()
    seconds = []
    for _ in range(RUNS):
        start = perf_counter()
        search()
        seconds.append(perf_counter() - start)
    low, middle, high = min(seconds), statistics.median(seconds), max(seconds)
    return bound, f"{1000 * middle:.0f} | {1000 * low:.0f} .. {1000 * high:.0f} |"


def by_places(search: Callable[[int], Bound]) -> str:
    """A table: the limit on every grid, by how much it is below the finest one's, and the time."""
    found = [timed(partial(search, places)) for places in GRIDS]
    finest = found[-1][0].value
    rows = [
        f"| {places} | {bound.value:.6g} | {100 * (1.0 - bound.value / finest):.3g} | {times}"
        for places, (bound, times) in zip(GRIDS, found, strict=True)
    ]
    head = "| places | no law is below | below the finest, % | median, ms | range, ms |\n|---|---|---|---|---|"
    return "\n".join([head, *rows])


def of_convex_curves() -> str:
    """A table: the limit of convex curves as ncgear computes it, which chooses its places itself, and the time."""
    rows = []
    for power_w in POWERS_W:
        demands = replace(FREE, power_w=power_w, convex=True)
        bound, times = timed(partial(least_acceleration, TASK, demands))
        rows.append(f"| {power_w:.0f} | {bound.places} | {bound.value:.6g} | {times}")
    head = "| power, W | places | no law is below | median, ms | range, ms |\n|---|---|---|---|---|"
    return "\n".join([head, *rows])


def report() -> str:
    """The whole page."""
    tables = [f"## {name}\n\n{by_places(search)}" for name, search in SEARCHES.items()]
    where = f"{os.cpu_count()} cores, Python {platform.python_version()}, {platform.system()} {platform.machine()}"
    intro = (
        "# The certified limit: time and value against the grid\n\n"
        f"Written by `python benchmarks/limit.py` ({where}).\n"
        "No law is below any of these values, whatever the grid. ncgear takes 960 places where pitch curves need not\n"
        "be convex. Where they must be, it takes 240, and more where the driving curve matters. With masses the limit\n"
        "of power is relaxed: the values are lower than the grid alone makes them."
    )
    return "\n\n".join([intro, *tables, f"## {CONVEX}\n\n{of_convex_curves()}"]) + "\n"


if __name__ == "__main__":
    (ROOT / "benchmarks" / "limit.md").write_text(report(), encoding="utf-8")
