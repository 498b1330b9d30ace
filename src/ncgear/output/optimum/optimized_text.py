"""What an optimisation says in the terminal."""

from __future__ import annotations

from collections.abc import Sequence
from math import degrees
from pathlib import Path

from ncgear.improvement import Improvement
from ncgear.optimum.judged import Figures
from ncgear.output.numbers import shown
from ncgear.output.optimum.optimized import UNITS

COLUMNS = ("peak power, W", "peak accel., mm/s2", "ratio", "tangent, deg", "convex")


def optimized_text(improvement: Improvement, paths: Sequence[Path]) -> str:
    """The law beside its limit and the other mechanisms at equal speed, and the files written."""
    return "\n".join([*_limit(improvement), "", *_table(improvement), "", "Written", *(f"  {path}" for path in paths)])


def _limit(improvement: Improvement) -> list[str]:
    goal, bound, unit = improvement.wishes.goal, improvement.bound, UNITS[improvement.wishes.goal]
    words = goal.value.replace("_", " ")
    speed = improvement.design.operation.speed_rpm
    lines = [f"{improvement.design.name}: {words} at {speed:g} r/min"]
    lines.append(f"  limit      {bound.value:,.6g} {unit}: no law has less (certified)")
    gap = f", {100.0 * (improvement.goal / bound.value - 1.0):.1f} % above the limit" if bound.value > 0.0 else ""
    lines.append(f"  this law   {improvement.goal:,.6g} {unit}{gap}")
    return lines


def _table(improvement: Improvement) -> list[str]:
    rows = {"this law": improvement.figures}
    if improvement.given_figures is not None:
        rows["design as given"] = improvement.given_figures
    rows["uniform crank"] = improvement.uniform_figures
    width = max(map(len, rows))
    head = "  ".join(f"{column:>18}" for column in COLUMNS)
    return [
        "At equal driving speed, whole cycle",
        f"  {'':<{width}}  {head}",
        *(f"  {name:<{width}}  {_row(found)}" for name, found in rows.items()),
    ]


def _row(found: Figures) -> str:
    cells = [
        shown(found.peak_power_w),
        shown(found.peak_acceleration_mm_s2),
        f"{found.ratio_min:.3f} to {found.ratio_max:.3f}",
        f"{degrees(found.tangent_rad):.2f}",
        "yes" if found.convex else "no",
    ]
    return "  ".join(f"{cell:>18}" for cell in cells)
