"""The files of a frontier."""

from __future__ import annotations

from collections.abc import Sequence
from itertools import accumulate

from ncgear.design.keys.design import Design
from ncgear.drawings.plots.frontier_plot import flywheels as flywheel_plot
from ncgear.drawings.plots.frontier_plot import frontier as frontier_plot
from ncgear.drawings.plots.frontier_plot import rows
from ncgear.figures.best_law import flywheel_csv, flywheel_figures, frontier_csv, frontier_figures, other_mechanisms
from ncgear.figures.numbers import json_text
from ncgear.numerics.units import KG_M2
from ncgear.optimum.flywheels import FlywheelPoint
from ncgear.optimum.frontier import limit_points
from ncgear.project.best_law import BestLaw
from ncgear.project.frontier_run import Frontier
from ncgear.project.sought_machine import SoughtMachine

Points = Sequence[tuple[float, float]]

PICTURE = "frontier.png"
"""Name of the picture of a frontier, and of that of a limit."""


def frontier_files(found: Frontier, beside: SoughtMachine) -> dict[str, bytes]:
    """CSV, JSON and picture."""
    caps = [(point.cap_w, point.limit_mm_s2) for point in found.laws]
    curve = limit_points(beside.task, beside.wishes, caps[-1][0])
    points = sorted([*caps, *(point for point in curve if caps[0][0] < point[0] < caps[-1][0])])
    # What needs so much acceleration at one power needs no less at a smaller one
    heights = [*accumulate((acceleration for _, acceleration in reversed(points)), max)][::-1]
    limit = [(power, height) for (power, _), height in zip(points, heights, strict=True)]
    laws = [(point.law.peak_power_w, point.law.peak_acceleration_mm_s2) for point in found.laws]
    family = [(one.cap_w, peak) for one in found.families if (peak := one.peak_acceleration_mm_s2) is not None]
    return {
        "frontier.csv": frontier_csv(found, beside).encode(),
        "frontier.json": json_text(frontier_figures(found, beside)).encode(),
        PICTURE: _picture(beside, limit, laws, family, "power against acceleration"),
    }


def flywheel_files(found: Sequence[FlywheelPoint], design: Design) -> dict[str, bytes]:
    """CSV, JSON and picture of power against the size of the flywheel on the driven shaft."""
    limit = rows([(KG_M2 * one.flywheel_kg_mm2, one.limit_w) for one in found])
    laws = rows([(KG_M2 * one.flywheel_kg_mm2, one.law.peak_power_w) for one in found])
    title = f"{design.name}: least power at {design.operation.speed_rpm:.4g} r/min"
    return {
        "flywheel.csv": flywheel_csv(found).encode(),
        "flywheel.json": json_text(flywheel_figures(found, design)).encode(),
        "flywheel.png": flywheel_plot(limit, laws, title),
    }


def limit_picture(best: BestLaw) -> bytes:
    """PNG of the limit's curve with one makeable law, and the mechanisms to compare with."""
    law = best.figures.peak_power_w, best.figures.peak_acceleration_mm_s2
    return _picture(best, best.limit_points, [law], [], "this law and the limit")


def _picture(beside: SoughtMachine, limit: Points, laws: Points, family: Points, what: str) -> bytes:
    """PNG of points of power in W and acceleration in mm/s2, with the mechanisms to compare with."""
    others = [(one.name, one.peak_power_w, one.peak_acceleration_mm_s2) for one in other_mechanisms(beside)]
    title = f"{beside.design.name}: {what}, all at {beside.design.operation.speed_rpm:.4g} r/min"
    unit = beside.task.linkage.OUTPUT.acceleration.text
    return frontier_plot(rows(limit), rows(laws), rows(family), others, title, unit)
