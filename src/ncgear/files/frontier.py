"""The files of a frontier, and what its run says in the terminal."""

from __future__ import annotations

from collections.abc import Sequence
from pathlib import Path

from ncgear.drawings.plots.frontier_plot import frontier as frontier_plot
from ncgear.drawings.plots.frontier_plot import rows
from ncgear.figures.frontier import frontier_csv, frontier_json, mechanisms
from ncgear.figures.numbers import shown
from ncgear.project.frontier import Frontier
from ncgear.project.improvement import Improvement

LIMIT_PICTURE = "frontier.png"

HEADS = ("power cap, W", "limit, mm/s2", "best law, mm/s2", "gap, %", "family, mm/s2")


def frontier_files(found: Frontier, improvement: Improvement) -> dict[str, bytes]:
    """CSV, JSON and picture."""
    families = [point for point in found.families if point.peak_acceleration_mm_s2 is not None]
    speed = improvement.design.operation.speed_rpm
    picture = frontier_plot(
        rows([(point.cap_w, point.bound.value) for point in found.laws]),
        rows([(point.law.peak_power_w, point.law.peak_acceleration_mm_s2) for point in found.laws]),
        rows([(point.cap_w, point.peak_acceleration_mm_s2 or 0.0) for point in families]),
        [(one.name, one.peak_power_w, one.peak_acceleration_mm_s2) for one in mechanisms(improvement)],
        f"{improvement.design.name}: power against acceleration, all at {speed:.4g} r/min",
    )
    return {
        "frontier.csv": frontier_csv(found).encode(),
        "frontier.json": frontier_json(found, improvement).encode(),
        "frontier.png": picture,
    }


def limit_picture(improvement: Improvement) -> bytes:
    """PNG of the limit's curve with one makeable law, and the mechanisms to compare with."""
    law, speed = improvement.figures, improvement.design.operation.speed_rpm
    return frontier_plot(
        rows(improvement.limit_points),
        rows([(law.peak_power_w, law.peak_acceleration_mm_s2)]),
        rows([]),
        [(one.name, one.peak_power_w, one.peak_acceleration_mm_s2) for one in mechanisms(improvement)],
        f"{improvement.design.name}: this law and the limit, all at {speed:.4g} r/min",
    )


def frontier_text(found: Frontier, improvement: Improvement, paths: Sequence[Path]) -> str:
    """A table of the points, the mechanisms, and the files written."""
    families = {point.cap_w: point.peak_acceleration_mm_s2 for point in found.families}
    lines = [
        f"{improvement.design.name}: power against acceleration at {improvement.design.operation.speed_rpm:g} r/min"
    ]
    lines.append("".join(f"{head:>18}" for head in HEADS))
    for point in found.laws:
        family, law = families[point.cap_w], point.law.peak_acceleration_mm_s2
        cells = [
            shown(point.cap_w),
            shown(point.bound.value),
            shown(law),
            f"{100.0 * (law / point.bound.value - 1.0):.1f}",
            shown(family),
        ]
        lines.append("".join(f"{cell:>18}" for cell in cells))
    others = mechanisms(improvement)
    width = max(len(one.name) for one in others)
    lines += ["", "At the same speed"]
    lines += [
        f"  {one.name:<{width}}  {shown(one.peak_power_w):>9} W  {shown(one.peak_acceleration_mm_s2):>9} mm/s2"
        for one in others
    ]
    return "\n".join([*lines, "", "Written", *(f"  {path}" for path in paths)])
