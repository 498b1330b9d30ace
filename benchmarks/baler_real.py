"""The baler with all its masses: what known laws need, and power and flywheel against acceleration.

Run as ``make bench`` or ``python benchmarks/baler_real.py``; writes benchmarks/baler-real.md and its picture in a
minute and a half.  Machine, limits and goal are those of designs/baler-real.yaml.  At each cap on the acceleration two
laws are looked for: the design's own goal, for a driving shaft that turns evenly by its motor alone, and the least
flywheel, for a shaft whose flywheel gives and takes what the load changes.  Then the least power of
designs/baler-flywheel.yaml is looked for, with flywheels of several sizes on the driven shaft.
"""

from __future__ import annotations

import os
import platform
from collections.abc import Callable, Sequence
from dataclasses import dataclass, replace
from math import degrees
from pathlib import Path
from time import perf_counter
from typing import Any

from ncgear.design.reading.design_file import load
from ncgear.drawings.plots.canvas import DRIVEN, DRIVING, HIGHLIGHT, REFERENCE, SMALL, dress, figure, png
from ncgear.optimum.task import Figures, Task, figures
from ncgear.project.best_law import BestLaw
from ncgear.project.law import law_of
from ncgear.ratio.laws.uniform import uniform_law
from ncgear.ratio.transmission import Lobes, PairsInSeries, single

DESIGNS = Path(__file__).parents[1] / "designs"
PAGE, PICTURE = Path(__file__).parent / "baler-real.md", Path(__file__).parent / "baler-real.png"

CAPS_MM_S2 = (15_000.0, 17_500.0, 20_000.0, 25_000.0, 30_000.0, 45_000.0)
"""From little over that of baler-smooth to the earlier mechanism's."""

COMPARED = ("baler-66", "baler-half", "baler-smooth", "baler-real")

MACHINE = """\
Masses, gears and limits of `designs/baler-real.yaml`, at 60 r/min: plunger of 150 kg, rod of 30 kg, crank of 40 kg,
gears of 5.5 kg m² each. Powers are those of the driving shaft, motor / brake in W, where it turns evenly."""

LAWS = """\
The same machine with other laws. `baler-real` is the law of this machine; the others were found for the resistance
alone. The flywheel is that of all masses."""

FLYWHEELS = """\
Without a flywheel the motor gives what the load asks at each moment. The first law has the least motor power and
braking power, each watt counting alike. With a flywheel on the driving shaft the motor gives the mean power,
{mean_w:.0f} W, whatever the law, and never brakes. The flywheel keeps the speed within 5 % (largest less smallest over
the mean), and the law decides how large it is: the second law needs the smallest. Flywheels are computed as if the
driving shaft turned evenly and the motor's torque were constant; the driving gear's 5.5 kg m² are part of them."""

ON_DRIVEN = """\
A flywheel beside the crank is another machine: its speed varies with the crank's, so it stores what the plunger gives
back and gives it where the plunger presses, and a law that varies the ratio little is enough. Limits of
`designs/baler-flywheel.yaml`: the acceleration stays under that of the uniform crank, {cap:.0f} mm/s². The limit is
certified for a flywheel of that size; whether another size needs less is not part of the proof. Braking is not
limited here. The uniform crank needs {uniform_w:.0f} W with each of them, since an even speed stores nothing. With a
motor of even torque its speed would vary as the last column says (largest less smallest over the mean, computed as if
it were small)."""

DRIVEN_KG_M2 = 0.0, 30.0, 60.0, 100.0, 150.0
"""Flywheels on the driven shaft."""

DESIGN = load(DESIGNS / "baler-real.yaml").design
FLYWHEEL = load(DESIGNS / "baler-flywheel.yaml").design

KG_M2 = 1e-6
"""One kg mm^2 in kg m^2."""


@dataclass(frozen=True)
class Found:
    """The two laws under a cap on the acceleration in mm/s2: of least power, and of the least flywheel."""

    cap_mm_s2: float
    least_power: Figures
    least_flywheel: Figures


def compared() -> dict[str, PairsInSeries]:
    """The laws that are compared, by the names they have in the table."""
    laws = {"uniform crank": single(uniform_law(Lobes()))}
    return laws | {f"`{name}`": law_of(load(DESIGNS / f"{name}.yaml").design).train for name in COMPARED}


def moved(task: Task) -> dict[str, Task]:
    """The machine with no masses, with its slider's alone, and with all."""
    alone = replace(task.linkage.MASSES(), slider_kg=task.moving.slider_kg)
    return {
        "resistance alone": replace(task, masses=task.linkage.MASSES()),
        "plunger's mass too": replace(task, masses=alone),
        "all masses": task,
    }


def comparison(task: Task) -> list[str]:
    """A table: motor power and braking power of every law with ever more masses, acceleration and flywheel."""
    tasks = moved(task)
    rows = []
    for name, train in compared().items():
        each = [figures(one, train) for one in tasks.values()]
        powers = [f"{one.peak_power_w:.0f} / {braking_w(one):.0f}" for one in each]
        last = each[-1]
        rows.append([name, *powers, f"{last.peak_acceleration_mm_s2:.0f}", f"{flywheel_kg_m2(last):.0f}"])
    return table(["", *tasks, "acceleration, mm/s²", "flywheel, kg m²"], rows)


def flywheel_kg_m2(one: Figures) -> float:
    """The flywheel that keeps the wanted speed fluctuation."""
    assert one.flywheel_kg_mm2 is not None
    return KG_M2 * one.flywheel_kg_mm2


def braking_w(one: Figures) -> float:
    """The greatest power that flows back to the motor."""
    assert one.braking_power_w is not None
    return one.braking_power_w


def best_figures(cap_mm_s2: float, **goal: Any) -> Figures:
    """Figures of the best law under a cap, for the design's own goal or another."""
    asked = DESIGN.optimize
    assert asked is not None
    limits = asked.limits.model_copy(update={"peak_acceleration_mm_s2": cap_mm_s2})
    changed = asked.model_copy(update={"limits": limits, **goal})
    return BestLaw(DESIGN.model_copy(update={"optimize": changed})).figures


def found(cap_mm_s2: float) -> Found:
    """Both laws under a cap."""
    return Found(cap_mm_s2, best_figures(cap_mm_s2), best_figures(cap_mm_s2, goal="least_flywheel", weights=None))


def frontier(points: Sequence[Found], mean_w: float) -> list[str]:
    """A table of both laws under every cap."""
    heads = [
        "acceleration at most, mm/s²",
        "least power: motor / brake, W",
        "its flywheel, kg m²",
        "least flywheel, kg m²",
        "motor with either flywheel, W",
        "least flywheel's law without it: motor / brake, W",
    ]
    return table(heads, [row(point, mean_w) for point in points])


def row(point: Found, mean_w: float) -> list[str]:
    """Both laws under one cap."""
    own, other = point.least_power, point.least_flywheel
    powers = [f"{one.peak_power_w:.0f} / {braking_w(one):.0f}" for one in (own, other)]
    flywheels = [f"{flywheel_kg_m2(one):.0f}" for one in (own, other)]
    return [f"{point.cap_mm_s2:.0f}", powers[0], *flywheels, f"{mean_w:.0f}", powers[1]]


def on_driven_shaft() -> tuple[list[str], float]:
    """A table of the least power with flywheels on the driven shaft, and the power of the uniform crank in W."""
    heads = [
        "flywheel on the driven shaft, kg m²",
        "least power: motor / brake, W",
        "no law has less (certified), W",
        "acceleration, mm/s²",
        "ratio",
        "pressure angle, deg",
        "uniform crank with even torque: speed varies by, %",
    ]
    assert FLYWHEEL.masses is not None
    rows = []
    for inertia in DRIVEN_KG_M2:
        masses = FLYWHEEL.masses.model_copy(update={"driven_flywheel_kg_mm2": inertia / KG_M2})
        best = BestLaw(FLYWHEEL.model_copy(update={"masses": masses}))
        own, uniform, limit = best.figures, best.uniform_figures, best.limit
        assert limit is not None
        shaft_kg_m2 = inertia + KG_M2 * best.task.moving.driving_shaft_kg_mm2
        varies = best.task.speed_fluctuation * flywheel_kg_m2(uniform) / shaft_kg_m2
        rows.append(
            [
                f"{inertia:.0f}",
                f"{own.peak_power_w:.0f} / {braking_w(own):.0f}",
                f"{limit.value:.0f}",
                f"{own.peak_acceleration_mm_s2:.0f}",
                f"{own.ratio_min:.3f} to {own.ratio_max:.3f}",
                f"{degrees(own.tangent_rad + best.wishes.limits.rack_angle_rad):.1f}",
                f"{100.0 * varies:.0f}" if inertia else "-",
            ]
        )
    return table(heads, rows), uniform.peak_power_w


def table(heads: Sequence[str], rows: Sequence[Sequence[str]]) -> list[str]:
    """Lines of a table in Markdown."""
    return [f"| {' | '.join(line)} |" for line in [heads, ["---"] * len(heads), *rows]]


def picture(points: Sequence[Found], mean_w: float) -> bytes:
    """PNG: power against acceleration above, flywheels below."""
    made = figure(7.6, 6.4, "Baler with all masses at 60 r/min")
    above, below = made.subplots(2, 1, sharex=True)
    made.subplots_adjust(left=0.12, right=0.97, bottom=0.09, top=0.92, hspace=0.12)
    caps = [point.cap_mm_s2 for point in points]

    def line(axes: Any, of: Callable[[Found], float], label: str, color: str) -> None:
        axes.plot(caps, [of(point) for point in points], color=color, marker="o", markersize=4.0, label=label)

    line(above, lambda one: one.least_power.peak_power_w, "motor, without a flywheel", DRIVING)
    line(above, lambda one: braking_w(one.least_power), "brake, without a flywheel", DRIVEN)
    above.axhline(mean_w, color=REFERENCE, label="motor, with a flywheel")
    line(below, lambda one: flywheel_kg_m2(one.least_power), "for the law of least power", DRIVING)
    line(below, lambda one: flywheel_kg_m2(one.least_flywheel), "for the law of the least flywheel", HIGHLIGHT)
    dress(above, "", "power, W")
    dress(below, "peak acceleration, mm/s²", "flywheel for 5 %, kg m²")
    for axes in (above, below):
        axes.set_ylim(bottom=0.0)
        axes.legend(frameon=False, fontsize=SMALL)
    return png(made)


def page(start: float) -> str:
    """The whole page; writes the picture beside it.  ``start`` is the clock's time in s at the beginning."""
    task = BestLaw(DESIGN).task
    mean_w = task.work_n_mm / task.cycle_s / 1000.0
    points = [found(cap) for cap in CAPS_MM_S2]
    PICTURE.write_bytes(picture(points, mean_w))
    driven, uniform_w = on_driven_shaft()
    assert FLYWHEEL.optimize is not None
    cap = FLYWHEEL.optimize.limits.peak_acceleration_mm_s2
    lines = [
        "# The baler with all its masses",
        "",
        f"Written by `python benchmarks/baler_real.py`: {os.cpu_count()} cores, Python {platform.python_version()}, "
        f"{perf_counter() - start:.0f} s.",
        "",
        MACHINE,
        "",
        "## Known laws",
        "",
        LAWS,
        "",
        *comparison(task),
        "",
        "## Power against acceleration",
        "",
        FLYWHEELS.format(mean_w=mean_w),
        "",
        *frontier(points, mean_w),
        "",
        f"![Power and flywheel against acceleration]({PICTURE.name})",
        "",
        "## A flywheel on the driven shaft",
        "",
        ON_DRIVEN.format(cap=cap, uniform_w=uniform_w),
        "",
        *driven,
        "",
    ]
    return "\n".join(lines)


if __name__ == "__main__":
    text = page(perf_counter())
    PAGE.write_text(text, encoding="utf-8")
    print(text)
