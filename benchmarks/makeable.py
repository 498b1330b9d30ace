"""Makeable laws by harmonics and by splines of ln i12: what they reach, what they cost.  Writes benchmarks/makeable.md.

Run as ``make bench`` or ``python benchmarks/makeable.py``.  Both go through the same programme, on the baler's linkage
at 60 r/min with convex pitch curves; limits hold at the programme's places only, so that the forms are compared and not
what is between.
"""

from __future__ import annotations

import os
import platform
import subprocess
import sys
import tempfile
from dataclasses import replace
from math import degrees, pi
from pathlib import Path
from time import perf_counter

import numpy as np
from scipy.interpolate import BSpline

from ncgear.design.load import load
from ncgear.improvement import Improvement
from ncgear.machine.linkage import CrankSlider
from ncgear.machine.polynomial_resistance import PolynomialResistance
from ncgear.numerics.arrays import Array
from ncgear.optimum.judged import figures
from ncgear.optimum.makeable.equations import programme
from ncgear.optimum.makeable.law import makeable_law, scales, shared_law
from ncgear.optimum.makeable.levels import levels
from ncgear.optimum.makeable.reached import Grid, ratios, reached
from ncgear.optimum.makeable.series import Basis, basis
from ncgear.optimum.makeable.stations import stations
from ncgear.optimum.task import Limits, Task
from ncgear.optimum.wishes import TwoStages, Wishes
from ncgear.ratio.train import Train
from ncgear.ratio.transmission import Lobes

DESIGNS = Path(__file__).parents[1] / "designs"
PAGE = Path(__file__).parent / "makeable.md"
POWERS_W = (18_750.0, 9_375.0, 6_300.0)
COEFFICIENTS = (24, 48, 72)
"""The second is the default of design files: 24 harmonics."""
DEGREE = 5
"""Of the spline: its second derivative, which curvature needs, is smooth."""

BALER = Task(
    CrankSlider(380.0, 960.0),
    PolynomialResistance((-131.2779, 3.447, 1.846e-2, -1.575e-4, 2.498e-7)),
    2.0 * pi,
)


def spline(angle: Array, count: int) -> Basis:
    """Values and two derivatives of all but one of the periodic quintic B-splines with ``count`` + 1 even knots.

    They sum up to one, and the programme has a constant of its own.
    """
    count = count + 1
    step = 2.0 * pi / count
    knots = step * np.arange(-DEGREE, count + DEGREE + 1)
    rows = np.zeros((3, angle.size, count))
    for number in range(count + DEGREE):
        bump = BSpline.basis_element(knots[number : number + DEGREE + 2], extrapolate=False)
        for order in range(3):
            curve = bump.derivative(order) if order else bump
            rows[order, :, number % count] += np.nan_to_num(curve(angle))
    return Basis(*rows[:, :, :-1])


def reached_by(form: str, power_w: float, count: int) -> tuple[float, float]:
    """Peak acceleration in mm/s2 at the programme's places, and seconds."""
    start = perf_counter()
    at = stations(BALER.linkage, BALER.resistance, 5 * count)
    there = basis(at.phi2_rad, count // 2) if form == "harmonics" else spline(at.phi2_rad, count)
    on, units = Grid(at, there), scales(BALER, at)
    wanted = levels(Wishes(Limits(0.2, 5.0, power_w)), units)
    caps = np.array([np.inf if level.limit is None else level.limit for level in wanted])
    weights = np.array([level.weight for level in wanted])
    found = programme(wanted, on, BALER.cycle_rad, None, 1).solved(caps, weights, np.zeros(count))
    assert found is not None
    level = reached(wanted, on, ratios(on, found.coefficients, BALER.cycle_rad))[0]
    return level * units.acceleration_mm_s2, perf_counter() - start


def finished(power_w: float, harmonics: int) -> tuple[float, float]:
    """The same of a finished law, all limits held between the places too."""
    start = perf_counter()
    law = makeable_law(BALER, Wishes(Limits(0.2, 5.0, power_w), harmonics=harmonics), [np.zeros(2 * harmonics)])
    unit = scales(BALER, stations(BALER.linkage, BALER.resistance, 1000)).acceleration_mm_s2
    return law.goal * unit, perf_counter() - start


def row(power_w: float, count: int) -> str:
    """One line of the table."""
    both = [figure for form in ("harmonics", "spline") for figure in reached_by(form, power_w, count)]
    cells = [f"{value:.0f}" if number % 2 == 0 else f"{value:.2f}" for number, value in enumerate(both)]
    acceleration, seconds = finished(power_w, count // 2)
    return f"| {power_w:.0f} | {count} | {' | '.join(cells)} | {acceleration:.0f} | {seconds:.2f} |"


def stages_row(name: str, improvement: Improvement, train: Train, seconds: float) -> str:
    """One line of the table of stages: peak acceleration, larger pressure angle, ranges of the ratios, time."""
    found = figures(improvement.task, train)
    angle = degrees(found.tangent_rad + improvement.wishes.rack_angle_rad)
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
    shared = shared_law(one.task, replace(one.wishes, two_stages=TwoStages()), one.law.cosine, one.law.sine)
    rows.append(stages_row("its law as it is, shared by two", one, shared.train(Lobes()), perf_counter() - start))
    for angle in (None, 50.0, 45.0):
        two = improvement_of("baler-66-two-stage", pressure_angle_deg=angle)
        start = perf_counter()
        train = two.train
        name = "two pairs, no angle asked" if angle is None else f"two pairs, {angle:.0f}° asked"
        rows.append(stages_row(name, two, train, perf_counter() - start))
    return rows


def improvement_of(name: str, **limits: float | None) -> Improvement:
    """A shipped design's best law, some of its limits changed."""
    design = load(DESIGNS / f"{name}.yaml").design
    asked = design.optimize
    assert asked is not None
    changed = asked.model_copy(update={"limits": asked.limits.model_copy(update=limits)})
    return Improvement(design.model_copy(update={"optimize": changed}))


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
    head = (
        "| peak power, at most, W | coefficients | harmonics, mm/s² | s | quintic spline, mm/s² | s "
        "| finished law, mm/s² | s |"
    )
    return "\n".join(
        [
            "# Makeable laws: harmonics and splines",
            "",
            f"Written by `python benchmarks/makeable.py`: {os.cpu_count()} cores, Python {platform.python_version()}.",
            "",
            "Least peak acceleration of the baler's linkage at 60 r/min under a cap on the power, pitch curves convex. "
            "Finished laws are by harmonics, with limits held between the places of the programme as well.",
            "",
            head,
            "|---" * (head.count("|") - 1) + "|",
            *(row(power, count) for power in POWERS_W for count in COEFFICIENTS),
            "",
            "## Two stages",
            "",
            f"The same machine at 6300 W; the limit of any law is {improvement_of('baler-66').bound.value:.0f} mm/s².",
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
