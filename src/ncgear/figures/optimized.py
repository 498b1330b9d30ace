"""An optimised law: as a design file that builds, as the certificate of how close to the limit it is, and as text."""

from __future__ import annotations

import platform
from collections.abc import Sequence
from dataclasses import asdict
from io import StringIO
from math import degrees
from pathlib import Path
from typing import Any

from ruamel.yaml import YAML
from ruamel.yaml.comments import CommentedMap, CommentedSeq

from ncgear import __version__
from ncgear.design.keys.design import Design
from ncgear.design.naming import LONGEST_NAME
from ncgear.figures.numbers import shown
from ncgear.figures.tables import aligned
from ncgear.figures.terminal import written_lines
from ncgear.numerics.arrays import Array
from ncgear.optimum.makeable.wishes import Goal
from ncgear.optimum.task import Figures
from ncgear.project.improvement import Improvement

UNITS = {Goal.ACCELERATION: "mm/s2", Goal.POWER: "W", Goal.WEIGHTED: "1"}

ARGUMENT = (
    "Acceleration, power and ratio limits bind the speed of the slider and its rate at each place only, so there is a "
    "fastest motion under them, and its time is bounded from below on the grid; no law, smooth or not, has less than "
    "the limit. That pitch curves are convex, and limits on jerk, curvature and driven speed, are not part of it."
)

LINE_WIDTH = 118

SUFFIX = "-optimized"


def optimized_design(text: str, improvement: Improvement) -> str:
    """The text of the design file with the optimised law in place of its motion; comments elsewhere are kept.

    Points of the resistance that stand in a file of their own come along: that file's path counts from the design.
    """
    yaml = YAML(typ="rt")
    yaml.width = LINE_WIDTH
    document = yaml.load(text)
    document["name"] = optimized_name(improvement)
    motion = CommentedMap({"law": "harmonic_ratio"})
    law = improvement.law
    motion.update({"cosine": _row(law.cosine), "sine": _row(law.sine)})
    if law.second is not None:
        second = {"cosine": _row(law.second.cosine), "sine": _row(law.second.sine)}
        motion["second_stage"] = CommentedMap(second)
    document["motion"] = motion
    _bring_points(document, improvement.design)
    written = StringIO()
    yaml.dump(document, written)
    return written.getvalue()


def optimized_name(improvement: Improvement) -> str:
    """Name of the optimised design."""
    name = improvement.design.name
    return name if name.endswith(SUFFIX) else f"{name[: LONGEST_NAME - len(SUFFIX)]}{SUFFIX}"


def certificate(improvement: Improvement) -> dict[str, Any]:
    """The limit, the law beside it, and the mechanisms to compare with, all at one speed."""
    bound = improvement.bound
    given = improvement.given_figures
    return {
        "design": improvement.design.name,
        "speed_rpm": improvement.design.operation.speed_rpm,
        "goal": {
            "least": improvement.wishes.goal.value,
            "unit": UNITS[improvement.wishes.goal],
            "limit": bound.value,
            "attained_by_rough_motion": bound.attained,
            "grid_cells": bound.cells,
            "law": improvement.goal,
            "gap": improvement.goal / bound.value - 1.0 if bound.value > 0.0 else None,
            "argument": ARGUMENT,
        },
        "wishes": improvement.design.optimize.model_dump(mode="json") if improvement.design.optimize else {},
        "frontier": [
            {"power_cap_w": power, "limit_acceleration_mm_s2": acceleration}
            for power, acceleration in improvement.limit_points
        ],
        "law": figures_summary(improvement.figures),
        "design_as_given": None if given is None else figures_summary(given),
        "uniform_crank": figures_summary(improvement.uniform_figures),
        "made_by": {"ncgear": __version__, "python": platform.python_version()},
    }


def figures_summary(found: Figures) -> dict[str, Any]:
    """Figures as plain values, angles in degrees beside radians."""
    return {**asdict(found), "working_deg": degrees(found.working_rad), "tangent_deg": degrees(found.tangent_rad)}


def _bring_points(document: CommentedMap, design: Design) -> None:
    table = design.resistance.table if design.resistance else None
    if table is None or table.file is None:
        return
    columns = CommentedMap()
    columns["displacement_mm"], columns["force_n"] = _row(table.displacement_mm or ()), _row(table.force_n or ())
    document["resistance"]["table"] = columns


def _row(values: Array | Sequence[float]) -> CommentedSeq:
    row = CommentedSeq([float(value) for value in values])
    row.fa.set_flow_style()
    return row


COLUMN_WIDTH = 18
COLUMNS = ("peak power, W", "peak accel., mm/s2", "ratio", "tangent, deg", "convex")


def optimized_text(improvement: Improvement, paths: Sequence[Path]) -> str:
    """The law beside its limit and the other mechanisms at equal speed, and the files written."""
    return "\n".join([*_limit(improvement), "", *_table(improvement), "", *written_lines(paths)])


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
    cells = [[name, *_cells(found)] for name, found in rows.items()]
    least = [0, *[COLUMN_WIDTH] * len(COLUMNS)]
    return ["At equal driving speed, whole cycle", *aligned([["", *COLUMNS], *cells], left=1, least=least)]


def _cells(found: Figures) -> list[str]:
    return [
        shown(found.peak_power_w),
        shown(found.peak_acceleration_mm_s2),
        f"{found.ratio_min:.3f} to {found.ratio_max:.3f}",
        f"{degrees(found.tangent_rad):.2f}",
        "yes" if found.convex else "no",
    ]
