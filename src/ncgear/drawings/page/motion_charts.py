"""The charts of the output's motion on the page, and the angles at which their lines are sampled.

A cursor of the page runs along every line, straight from sample to sample, and shows the values.  The samples are
therefore close together, there is one on either side of every angle at which a curve may jump, and one wherever a curve
of this design is least or greatest, so that the page names the same extremes as a check.  The horizontal axis is the
driving angle.
"""

from __future__ import annotations

from collections.abc import Iterable, Sequence
from dataclasses import replace
from itertools import pairwise
from math import degrees

import numpy as np

from ncgear.drawings.charts.chart import LOAD, MOTION, Quantity, joints_up_to, motion_chart
from ncgear.drawings.page.chart_figure import PageChart
from ncgear.kinematics.check import SIDE_RAD
from ncgear.kinematics.motion import Machine
from ncgear.numerics.arrays import Array, distinct
from ncgear.project.drive import Drive

LEAST = 2001
"""Least number of samples over a cycle of the slider."""


def quantities_of(drive: Drive) -> tuple[Quantity, ...]:
    """Displacement to ratio; with force and power where the design has them."""
    return (*MOTION, *loads_of(drive), Quantity.RATIO)


def motion_charts(
    drive: Drive, end_rad: float, quantities: Sequence[Quantity] | None = None, phi1: Array | None = None
) -> list[PageChart]:
    """All charts or some, from 0 to a driving angle; masses are needed for the power alone.

    They are sampled at driving angles ``phi1`` of a cycle in rad, shape (n,), or else at ``cycle_angles_rad`` and where
    any curve of this design is least or greatest.
    """
    quantities = quantities_of(drive) if quantities is None else quantities
    if phi1 is None:
        phi1 = distinct(np.concatenate([cycle_angles_rad(drive), drive.extremes_rad]))
    machines = drive.machine, drive.uniform_machine
    moved = drive.motion_of if Quantity.POWER in quantities else Machine.motion
    own, uniform = (moved(machine, phi1) for machine in machines)
    joints = np.degrees(joints_up_to(drive.transmission, end_rad))
    charts = []
    for quantity in quantities:
        chart = motion_chart(quantity, drive.linkage, own, uniform, joints)
        this, other = chart.lines
        lines = this, replace(other, label=drive.linkage.UNIFORM)
        period = degrees(drive.transmission.cycle_rad)
        charts.append(
            PageChart(
                quantity.key_of(drive.linkage.OUTPUT), replace(chart, lines=lines, end=degrees(end_rad), period=period)
            )
        )
    return charts


def loads_of(drive: Drive) -> tuple[Quantity, ...]:
    """Force and power where the design has a resistance, power alone where it has masses and no resistance."""
    if drive.design.resistance is not None:
        return LOAD
    return () if drive.masses_left_out is not None else (Quantity.POWER,)


def cycle_angles_rad(drive: Drive) -> Array:
    """Rising driving angles over one cycle of the slider, both ends included, shape (n,) with n >= 2001."""
    cycle = drive.transmission.cycle_rad
    dead_centres = drive.machine.extended_rad, drive.uniform_machine.extended_rad
    return split_angles(cycle, (*joints_up_to(drive.transmission, cycle).tolist(), *dead_centres))


def split_angles(end_rad: float, jumps_rad: Iterable[float]) -> Array:
    """Rising angles in rad from 0 to the end, shape (n,), evenly spread between the jumps.

    There is an angle on either side of each jump, and one just before the end.
    """
    inner = sorted({jump for jump in jumps_rad if SIDE_RAD < jump < end_rad - SIDE_RAD})
    bounds = [0.0, *inner, end_rad]
    stretches = []
    for start, end in pairwise(bounds):
        count = 2 + int(np.ceil((LEAST - 1) * (end - start) / end_rad))
        # Two jumps may be closer together than the angles beside them.
        side = min(SIDE_RAD, (end - start) / 3.0)
        stretches.append(np.linspace(start + side, end - side, count))
    angles = np.concatenate([*stretches, [end_rad]])
    angles[0] = 0.0
    return angles
