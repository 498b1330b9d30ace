"""Makeable laws of one stage and of two, and a whole frontier: what they reach, what they cost.

Run as ``make bench`` or ``python benchmarks/makeable.py``; writes benchmarks/makeable.md.  On the baler's linkage at
60 r/min with convex pitch curves.  What knots cost is in docs/speed-against-error.md.
"""

from __future__ import annotations

import os
import platform
import subprocess
import sys
import tempfile
from dataclasses import replace
from math import degrees
from pathlib import Path
from time import perf_counter

from ncgear.design.reading.design_file import load
from ncgear.optimum.certified.limit import least_acceleration
from ncgear.optimum.makeable.demanded import demands_of
from ncgear.optimum.makeable.wishes import TwoStages
from ncgear.optimum.task import figures
from ncgear.project.best_law import BestLaw
from ncgear.ratio.transmission import Lobes, PairsInSeries
from shared_law import shared_law

DESIGNS = Path(__file__).parents[1] / "designs"
PAGE = Path(__file__).parent / "makeable.md"


def stages_row(name: str, best: BestLaw, train: PairsInSeries, seconds: float) -> str:
    """One line of the table of stages: peak acceleration, larger pressure angle, ranges of the ratios, time."""
    found = figures(best.task, train)
    angle = degrees(found.tangent_rad + best.wishes.limits.rack_angle_rad)
    ranges = ", ".join(
        f"{lowest.value:.2f} to {highest.value:.2f}"
        for lowest, highest in (one.transmission.ratio_range for one in train.pairs)
    )
    return f"| {name} | {found.peak_acceleration_mm_s2:.0f} | {angle:.1f} | {ranges} | {seconds:.2f} |"


def stages_rows() -> list[str]:
    """What two stages do to the baler at 6300 W: one pair, its law shared as it is, and laws for two pairs."""
    one = improvement_of("baler-66")
    start = perf_counter()
    rows = [stages_row("one pair, `designs/baler-66.yaml`", one, one.train, perf_counter() - start)]
    start = perf_counter()
    shared = shared_law(one.task, replace(one.wishes, two_stages=TwoStages()), one.law.ratio)
    rows.append(stages_row("its law as it is, shared by two", one, shared.train(Lobes()), perf_counter() - start))
    for angle in (None, 50.0, 45.0):
        two = improvement_of("baler-66-two-stage", pressure_angle_deg=angle)
        start = perf_counter()
        train = two.train
        name = "two pairs, no angle asked" if angle is None else f"two pairs, {angle:.0f}° asked"
        rows.append(stages_row(name, two, train, perf_counter() - start))
    return rows


def limit_mm_s2(name: str) -> float:
    """The certified limit of a shipped design's acceleration."""
    best = improvement_of(name)
    return least_acceleration(best.task, demands_of(best.task, best.wishes)).value


def improvement_of(name: str, **limits: float | None) -> BestLaw:
    """A shipped design's best law, some of its limits changed."""
    design = load(DESIGNS / f"{name}.yaml").design
    asked = design.optimize
    assert asked is not None
    changed = asked.model_copy(update={"limits": asked.limits.model_copy(update=limits)})
    return BestLaw(design.model_copy(update={"optimize": changed}))


def frontier_seconds() -> float:
    """A frontier of twenty points as a user has it: the whole process, on all cores."""
    design = DESIGNS / "baler-frontier.yaml"
    start = perf_counter()
    with tempfile.TemporaryDirectory() as folder:
        command = [sys.executable, "-m", "ncgear", "frontier", str(design), "--points", "20", "--out", folder]
        subprocess.run(command, check=True, stdout=subprocess.DEVNULL)
    return perf_counter() - start


def page() -> str:
    """The whole page."""
    return "\n".join(
        [
            "# Makeable laws: two stages, frontiers",
            "",
            f"Written by `python benchmarks/makeable.py`: {os.cpu_count()} cores, Python {platform.python_version()}.",
            "",
            "## Two stages",
            "",
            "The baler's linkage at 60 r/min and 6300 W. No law of one pair with convex curves is below "
            f"{limit_mm_s2('baler-66'):.0f} mm/s²; none at all is below {limit_mm_s2('baler-66-two-stage'):.0f} mm/s².",
            "",
            "| gears | peak acceleration, mm/s² | larger pressure angle, ° | ratios | s |",
            "|---|---|---|---|---|",
            *stages_rows(),
            "",
            "## Frontier",
            "",
            f"`ncgear frontier designs/baler-frontier.yaml --points 20`, whole process: {frontier_seconds():.0f} s.",
            "",
        ]
    )


if __name__ == "__main__":
    text = page()
    PAGE.write_text(text, encoding="utf-8")
    print(text)
