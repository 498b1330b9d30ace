"""The fastest motion itself, as a law to start a search for a smooth one from."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from ncgear.numerics.arrays import Array
from ncgear.optimum.certified.limit import prepared, refuse
from ncgear.optimum.certified.passes import Ceilings
from ncgear.optimum.certified.road import Road
from ncgear.optimum.task import Limits, Task


@dataclass(frozen=True, eq=False)
class FastestMotion:
    """The fastest motion at places of the cycle, both dead centres among them; arrays of shape (n + 1,).

    ``slope`` is s = dphi2/dphi1 = 1/i12, and q(phi2) its square; without a limited pressure angle it may jump at the
    dead centres, and has there the value before them.  ``driving_rad`` is what the motion takes of the driving gear,
    the cycle at most, ``working_rad`` of it for the working stroke.
    """

    crank_angle_rad: Array
    way_mm: Array
    speed_mm_s: Array
    slope: Array
    driving_rad: float
    working_rad: float


def fastest_motion(task: Task, limits: Limits, cells: int | None = None) -> FastestMotion:
    """The fastest motion under the limits' peaks; raises NoSuchMechanism where it is too slow for the cycle."""
    problem = prepared(task, limits, cells)
    ceilings = problem.ceilings(problem.given_peaks)
    if ceilings is None or not problem.is_open(problem.given_peaks):
        raise refuse(problem, problem.given_peaks)
    out, back = problem.least_durations_s(problem.given_peaks, ceilings)
    return FastestMotion(
        crank_angle_rad=problem.road.crank_angle_rad,
        way_mm=problem.road.way_mm,
        speed_mm_s=np.sqrt(2.0 * ceilings.energy_mm2_s2),
        slope=_slope(problem.road, task, ceilings),
        driving_rad=(out + back) * task.speed_rad_s,
        working_rad=out * task.speed_rad_s,
    )


def _slope(road: Road, task: Task, ceilings: Ceilings) -> Array:
    """s = v / (omega x'); at a dead centre from the acceleration beside it, v^2 / x'^2 being a / x''."""
    moving = road.slope_mm_rad > 0.0
    slope = np.empty(moving.shape)
    energy, omega = ceilings.energy_mm2_s2, task.speed_rad_s
    np.divide(np.sqrt(2.0 * energy), omega * road.slope_mm_rad, out=slope, where=moving)
    for place, cell in ((0, 0), (road.extended, road.extended - 1), (-1, -1)):
        acceleration = abs(np.diff(energy)[cell]) / road.length_mm[cell]
        slope[place] = np.sqrt(acceleration / road.bend_mm_rad2[place]) / omega
    return slope
