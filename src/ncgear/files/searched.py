"""The files of searches: a frontier and a limit, the outline that a pitch curve follows, whole machines."""

from __future__ import annotations

from collections.abc import Sequence
from itertools import accumulate
from math import cos, pi, sin
from typing import TYPE_CHECKING

import numpy as np

from ncgear.design.keys.design import Design
from ncgear.drawings.plots import canvas
from ncgear.drawings.plots.frontier_plot import flywheels as flywheel_plot
from ncgear.drawings.plots.frontier_plot import frontier as frontier_plot
from ncgear.drawings.plots.frontier_plot import rows
from ncgear.figures.best_law import flywheel_csv, flywheel_figures, frontier_csv, frontier_figures, other_mechanisms
from ncgear.figures.numbers import json_text
from ncgear.numerics.arrays import Array
from ncgear.numerics.units import KG_M2
from ncgear.optimum.flywheels import FlywheelPoint
from ncgear.optimum.frontier import limit_points
from ncgear.project.best_law import BestLaw
from ncgear.project.frontier_run import Frontier
from ncgear.project.law_task import SoughtMachine

if TYPE_CHECKING:
    from ncgear.project.outline_fit import OutlineFit
    from ncgear.whole_machines.search import WholeMachines

Points = Sequence[tuple[float, float]]

PICTURE = "frontier.png"
"""Name of the picture of a frontier and of the picture of a limit."""


def frontier_files(found: Frontier, beside: SoughtMachine) -> dict[str, bytes]:
    """CSV, JSON and picture."""
    caps = [(point.cap_w, point.limit_mm_s2) for point in found.laws]
    curve = limit_points(beside.task, beside.wishes, caps[-1][0])
    points = sorted([*caps, *(point for point in curve if caps[0][0] < point[0] < caps[-1][0])])
    # The acceleration needed at one power is needed at every smaller power, too
    heights = [*accumulate((acceleration for _, acceleration in reversed(points)), max)][::-1]
    limit = [(power, height) for (power, _), height in zip(points, heights, strict=True)]
    laws = [(point.law.peak_power_w, point.law.peak_acceleration_mm_s2) for point in found.laws]
    family = [(family.cap_w, peak) for family in found.families if (peak := family.peak_acceleration_mm_s2) is not None]
    return {
        "frontier.csv": frontier_csv(found, beside).encode(),
        "frontier.json": json_text(frontier_figures(found, beside)).encode(),
        PICTURE: _picture(beside, limit, laws, family, "power against acceleration"),
    }


def flywheel_files(found: Sequence[FlywheelPoint], design: Design) -> dict[str, bytes]:
    """CSV, JSON and picture of power against the size of the flywheel on the driven shaft."""
    limit = rows([(KG_M2 * point.flywheel_kg_mm2, point.limit_w) for point in found])
    laws = rows([(KG_M2 * point.flywheel_kg_mm2, point.law.peak_power_w) for point in found])
    title = f"{design.name}: least power at {design.operation.speed_rpm:.4g} r/min"
    return {
        "flywheel.csv": flywheel_csv(found).encode(),
        "flywheel.json": json_text(flywheel_figures(found, design)).encode(),
        "flywheel.png": flywheel_plot(limit, laws, title),
    }


def limit_picture(best: BestLaw) -> bytes:
    """PNG of the limit's curve with a makeable law and the mechanisms for comparison."""
    law = best.figures.peak_power_w, best.figures.peak_acceleration_mm_s2
    return _picture(best, best.limit_points, [law], [], "this law and the limit")


def _picture(beside: SoughtMachine, limit: Points, laws: Points, family: Points, what: str) -> bytes:
    """PNG of points of power in W and acceleration in mm/s2, with the mechanisms to compare with."""
    others = [
        (mechanism.name, mechanism.peak_power_w, mechanism.peak_acceleration_mm_s2)
        for mechanism in other_mechanisms(beside)
    ]
    title = f"{beside.design.name}: {what}, all at {beside.design.operation.speed_rpm:.4g} r/min"
    unit = beside.task.linkage.OUTPUT.acceleration.text
    return frontier_plot(rows(limit), rows(laws), rows(family), others, title, unit)


OUTLINE_PICTURE = "outline.png"
"""Name of the picture."""


def outline_picture(found: OutlineFit, name: str) -> bytes:
    """PNG of the outline, the fitted curve, its mate where they touch at the curve's first point, and the deviation.

    An outline of the mate lies where the mate stands.
    """
    away, curve, follower = found.deviation, found.curve, found.mate
    other = curve.axis_mm + np.array([curve.center_distance_mm, 0.0])
    outlines, greatest = [found.outline.corners], [np.array([away.at_mm, away.toward_mm])]
    farthest = away.greatest_mm
    if follower is not None and curve.mate_place is not None:
        # The mate is turned from its drawing so that its first point faces the curve's first point.
        turn = pi - curve.mate_place.turned_rad
        to_pair = follower.scale * np.array([[cos(turn), sin(turn)], [-sin(turn), cos(turn)]])

        def placed(points: Array) -> Array:
            return other + (points - follower.axis_mm) @ to_pair

        outlines.append(placed(follower.outline.corners))
        greatest.append(placed(np.array([follower.deviation.at_mm, follower.deviation.toward_mm])))
        farthest = max(farthest, follower.deviation.greatest_mm)
    title = f"{name}: outline and pitch curves, greatest deviation {farthest:.2f} mm"
    mate = other + found.mate_points_mm
    return outline_and_curve(outlines, found.points_mm, mate, (curve.axis_mm, other), greatest, title)


FIGURES = "machines.json"


def machine_files(found: WholeMachines) -> dict[str, bytes]:
    """The content of each file by its name."""
    from ncgear.whole_machines.told import machines_figures

    texts = {f"{machine.name}.yaml": machine.text.encode() for machine in found.machines}
    return {**texts, FIGURES: json_text(machines_figures(found)).encode()}


OUTLINE_WIDTH_IN, HEIGHT_IN = 8.2, 5.0


def outline_and_curve(
    outlines: list[Array], curve: Array, mate: Array, axes_mm: tuple[Array, Array], greatest: list[Array], title: str
) -> bytes:
    """PNG of the outlines of one gear or both, the curve and its mate, each as points of shape (n, 2) in the drawing.

    ``axes_mm`` are the axes of both gears, ``greatest`` the ends of the greatest deviation from each outline.
    """
    made = canvas.figure(OUTLINE_WIDTH_IN, HEIGHT_IN, title, canvas.Margins(left=0.6, right=0.2, top=0.75))
    axes = made.add_subplot()
    for place, outline in enumerate(outlines):
        label = "_" if place else "outline"
        axes.fill(*outline.T, color=canvas.REFERENCE, alpha=0.25, linewidth=0.0, label=label)
    for points, color, label in ((curve, canvas.DRIVING, "pitch curve"), (mate, canvas.DRIVEN, "its mate")):
        axes.plot(*np.concatenate([points, points[:1]]).T, color=color, linewidth=1.6, label=label)
    for place, ends in enumerate(greatest):
        label = "_" if place else "greatest deviation"
        axes.plot(*ends.T, color=canvas.HIGHLIGHT, linewidth=2.2, label=label)
    axes.plot(*np.array(axes_mm).T, "+", color=canvas.INK, markersize=10)
    axes.set_aspect("equal")
    canvas.dress(axes, "x in mm", "y in mm")
    canvas.legend_above(axes)
    return canvas.png(made)
