"""The files of a frontier."""

from __future__ import annotations

from ncgear.drawings.plots.frontier_plot import frontier as frontier_plot
from ncgear.drawings.plots.frontier_plot import rows
from ncgear.figures.best_law import frontier_csv, frontier_json, other_mechanisms
from ncgear.project.best_law import BestLaw
from ncgear.project.frontier_run import Frontier

LIMIT_PICTURE = "frontier.png"


def frontier_files(found: Frontier, best: BestLaw) -> dict[str, bytes]:
    """CSV, JSON and picture."""
    families = [point for point in found.families if point.peak_acceleration_mm_s2 is not None]
    speed = best.design.operation.speed_rpm
    picture = frontier_plot(
        rows([(point.cap_w, point.bound.value) for point in found.laws]),
        rows([(point.law.peak_power_w, point.law.peak_acceleration_mm_s2) for point in found.laws]),
        rows([(point.cap_w, point.peak_acceleration_mm_s2 or 0.0) for point in families]),
        [(one.name, one.peak_power_w, one.peak_acceleration_mm_s2) for one in other_mechanisms(best)],
        f"{best.design.name}: power against acceleration, all at {speed:.4g} r/min",
    )
    return {
        "frontier.csv": frontier_csv(found).encode(),
        "frontier.json": frontier_json(found, best).encode(),
        "frontier.png": picture,
    }


def limit_picture(best: BestLaw) -> bytes:
    """PNG of the limit's curve with one makeable law, and the mechanisms to compare with."""
    law, speed = best.figures, best.design.operation.speed_rpm
    return frontier_plot(
        rows(best.limit_points),
        rows([(law.peak_power_w, law.peak_acceleration_mm_s2)]),
        rows([]),
        [(one.name, one.peak_power_w, one.peak_acceleration_mm_s2) for one in other_mechanisms(best)],
        f"{best.design.name}: this law and the limit, all at {speed:.4g} r/min",
    )
