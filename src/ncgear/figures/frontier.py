"""A frontier as CSV, JSON and text, with the mechanisms to compare with at the same speed."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from pathlib import Path
from typing import Any

from ncgear.design.keys.machine import Published
from ncgear.figures.csv_text import rows_text
from ncgear.figures.numbers import json_text, shown
from ncgear.figures.optimized import ARGUMENT, figures_summary
from ncgear.figures.tables import aligned
from ncgear.figures.terminal import written_lines
from ncgear.optimum.frontier import FamilyPoint, LawPoint
from ncgear.project.frontier import Frontier
from ncgear.project.improvement import Improvement

COLUMNS = (
    "power_cap_w",
    "limit_acceleration_mm_s2",
    "law_power_w",
    "law_acceleration_mm_s2",
    "law_tangent_deg",
    "family_power_w",
    "family_acceleration_mm_s2",
)

HEADS = ("power cap, W", "limit, mm/s2", "best law, mm/s2", "gap, %", "family, mm/s2")
COLUMN_WIDTH = 16


@dataclass(frozen=True)
class Mechanism:
    """A single mechanism to compare with, at the operating speed."""

    name: str
    peak_power_w: float
    peak_acceleration_mm_s2: float


def mechanisms(improvement: Improvement) -> list[Mechanism]:
    """The design's own law, the uniform crank, and published mechanisms of which both figures are known."""
    found = []
    if improvement.given_figures is not None and improvement.design.motion.law != "uniform_crank":
        given = improvement.given_figures
        found.append(Mechanism("design as given", given.peak_power_w, given.peak_acceleration_mm_s2))
    uniform = improvement.uniform_figures
    found.append(Mechanism("uniform crank", uniform.peak_power_w, uniform.peak_acceleration_mm_s2))
    comparison = improvement.design.comparison
    speed = improvement.design.operation.speed_rpm
    for published in comparison.published if comparison else ():
        mechanism = _at_speed(published, speed)
        if mechanism is not None:
            found.append(mechanism)
    return found


def _at_speed(published: Published, speed_rpm: float) -> Mechanism | None:
    """Power goes with the speed, acceleration with its square."""
    power, acceleration = published.peak_power_w, published.peak_acceleration_mm_s2
    if power is None or acceleration is None:
        return None
    faster = speed_rpm / published.speed_rpm
    return Mechanism(published.name, power * faster, acceleration * faster**2)


def frontier_csv(found: Frontier) -> str:
    """One line for each cap on the power; empty cells where nothing was found."""
    families = {point.cap_w: point for point in found.families}
    return rows_text(COLUMNS, [_cells(point, families[point.cap_w]) for point in found.laws])


def _cells(point: LawPoint, family: FamilyPoint) -> list[float | None]:
    law = figures_summary(point.law)
    figures = law["peak_power_w"], law["peak_acceleration_mm_s2"], law["tangent_deg"]
    return [point.cap_w, point.bound.value, *figures, family.peak_power_w, family.peak_acceleration_mm_s2]


def frontier_json(found: Frontier, improvement: Improvement) -> str:
    """The same with all figures of the laws, and the other mechanisms."""
    families = {point.cap_w: point for point in found.families}
    content: dict[str, Any] = {
        "design": improvement.design.name,
        "speed_rpm": improvement.design.operation.speed_rpm,
        "argument_of_limit": ARGUMENT,
        "points": [
            {
                "power_cap_w": point.cap_w,
                "limit_acceleration_mm_s2": point.bound.value,
                "limit_attained_by_rough_motion_mm_s2": point.bound.attained,
                "law": figures_summary(point.law),
                "gap": point.law.peak_acceleration_mm_s2 / point.bound.value - 1.0,
                "family_power_w": families[point.cap_w].peak_power_w,
                "family_acceleration_mm_s2": families[point.cap_w].peak_acceleration_mm_s2,
                "family_motion": families[point.cap_w].motion,
            }
            for point in found.laws
        ],
        "mechanisms": [vars(mechanism) for mechanism in mechanisms(improvement)],
    }
    return json_text(content)


def frontier_text(found: Frontier, improvement: Improvement, paths: Sequence[Path]) -> str:
    """A table of the points, the mechanisms, and the files written."""
    families = {point.cap_w: point.peak_acceleration_mm_s2 for point in found.families}
    rows = []
    for point in found.laws:
        law, limit = point.law.peak_acceleration_mm_s2, point.bound.value
        gap = f"{100.0 * (law / limit - 1.0):.1f}"
        rows.append([shown(point.cap_w), shown(limit), shown(law), gap, shown(families[point.cap_w])])
    others = [
        (one.name, f"{shown(one.peak_power_w)} W", f"{shown(one.peak_acceleration_mm_s2)} mm/s2")
        for one in mechanisms(improvement)
    ]
    speed = improvement.design.operation.speed_rpm
    lines = [
        f"{improvement.design.name}: power against acceleration at {speed:g} r/min",
        *aligned([HEADS, *rows], least=COLUMN_WIDTH),
        "",
        "At the same speed",
        *aligned(others, left=1, least=(0, 11, 15)),
        "",
        *written_lines(paths),
    ]
    return "\n".join(lines)
