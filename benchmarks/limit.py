"""The certified limit: time and width of its enclosure against the grid.  Writes benchmarks/limit.md.

Run as ``make bench`` or ``python benchmarks/limit.py``.  The baler's linkage and resistance at 60 r/min, ratio within
0.2 to 5; medians of several runs after one that is not counted.
"""

from __future__ import annotations

import os
import platform
import statistics
from collections.abc import Callable
from math import radians
from pathlib import Path
from time import perf_counter

from ncgear.optimum.certified.limit import Bound, Weights, least_acceleration, least_power, least_weighted_sum
from ncgear.optimum.task import Limits
from speed_against_error.baler import TASK

ROOT = Path(__file__).parents[1]
RUNS = 5
GRIDS = (200, 400, 800, 1600, 3200, 6400)
WEIGHTS = Weights(1.0 / 20000.0, 1.0 / 9000.0)

SEARCHES: dict[str, Callable[[int], Bound]] = {
    "least acceleration at 6300 W, mm/s²": lambda cells: least_acceleration(
        TASK, Limits(0.2, 5.0, peak_power_w=6300.0), cells
    ),
    "least power at 20 000 mm/s², W": lambda cells: least_power(
        TASK, Limits(0.2, 5.0, peak_acceleration_mm_s2=20000.0), cells
    ),
    "least acceleration at 9000 W, pressure angle 40°, mm/s²": lambda cells: least_acceleration(
        TASK, Limits(0.2, 5.0, peak_power_w=9000.0, pressure_angle_rad=radians(40.0)), cells
    ),
    "least acceleration at 9000 W, moving 20 kg, mm/s²": lambda cells: least_acceleration(
        TASK, Limits(0.2, 5.0, peak_power_w=9000.0, mass_kg=20.0), cells
    ),
    "A/20 000 mm/s² + P/9000 W, to 0.5 %": lambda cells: least_weighted_sum(TASK, Limits(0.2, 5.0), WEIGHTS, cells),
}


def row(search: Callable[[int], Bound], cells: int) -> str:
    """One line of a table: both sides of the bound, their distance, and the time."""
    bound = search(cells)
    seconds = []
    for _ in range(RUNS):
        start = perf_counter()
        search(cells)
        seconds.append(perf_counter() - start)
    low, middle, high = min(seconds), statistics.median(seconds), max(seconds)
    return (
        f"| {cells} | {bound.value:.6g} | {bound.attained:.6g} | {100 * bound.gap:.3g} | "
        f"{1000 * middle:.0f} | {1000 * low:.0f} .. {1000 * high:.0f} |"
    )


def report() -> str:
    """The whole page."""
    head = "| cells | no law is below | attained | gap, % | median, ms | range, ms |\n|---|---|---|---|---|---|"
    tables = [
        "\n".join([f"## {name}", "", head, *(row(search, cells) for cells in GRIDS)])
        for name, search in SEARCHES.items()
    ]
    where = f"{os.cpu_count()} cores, Python {platform.python_version()}, {platform.system()} {platform.machine()}"
    intro = (
        "# The certified limit: time and gap against the grid\n\n"
        f"Written by `python benchmarks/limit.py` ({where}).\n"
        "`attained` is a motion that keeps all limits, though not a smooth one. No law is below the one value, and no\n"
        "bound could be above the other."
    )
    return "\n\n".join([intro, *tables]) + "\n"


if __name__ == "__main__":
    (ROOT / "benchmarks" / "limit.md").write_text(report(), encoding="utf-8")
