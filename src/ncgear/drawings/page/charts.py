"""The charts of the page: of the output's motion, and of each pair of gears; and the angles at which they are sampled.

A cursor of the page runs along every line, straight from sample to sample, and shows the values.  The samples are
therefore close together, and there is one on either side of every angle at which a curve may jump.  The horizontal axis
is the driving angle; of a pair it is that of its own driving gear, which of the second of two stages is on the shaft
between the stages.
"""

from __future__ import annotations

from collections.abc import Iterable, Mapping, Sequence
from dataclasses import replace
from itertools import pairwise
from math import degrees

import numpy as np

from ncgear.contact.pair import PairContact
from ncgear.drawings.charts import teeth_charts
from ncgear.drawings.charts.chart import Chart, Line, Role, joints_up_to
from ncgear.drawings.charts.slider_charts import LOAD, MOTION, RATIO_NAME, Quantity, motion_chart
from ncgear.drawings.page.chart_figure import BETWEEN, DRIVING, PageChart
from ncgear.kinematics.motion import Machine
from ncgear.numerics.arrays import Array
from ncgear.project.drive import Drive
from ncgear.project.strengthening import Rating, known_rating
from ncgear.ratio.transmission import Transmission

LEAST = 2001
"""Least number of samples over a cycle of the slider."""

SIDE_RAD = 1e-9
"""Distance in rad between a jump and the samples before and after it.

It is far larger than the rounding of an angle, and too small to be seen or hit by the cursor.
"""


def quantities_of(drive: Drive) -> tuple[Quantity, ...]:
    """Displacement to ratio; with force and power where the design has them."""
    return (*MOTION, *loads_of(drive), Quantity.RATIO)


def motion_charts(drive: Drive, end_rad: float, quantities: Sequence[Quantity] | None = None) -> list[PageChart]:
    """Charts from 0 to a driving angle, all of them or some; masses are looked at for the power alone."""
    quantities = quantities_of(drive) if quantities is None else quantities
    phi1 = cycle_angles_rad(drive)
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


def gear_charts(drive: Drive, contact: PairContact) -> list[PageChart]:
    """Pressure angle and transmission error of one pair, stresses where a load is known; of a stage its ratio, too."""
    return charts_of_pair(
        drive, {"transmission_error": _transmission_error(contact)}, contact.as_designed.placement.cycle_rad
    )


def charts_of_pair(drive: Drive, written: Mapping[str, Chart], cycle_rad: float) -> list[PageChart]:
    """Charts of one pair that need no file, with those of what was written, by their keys, after the first."""
    charts = {"pressure_angle": _pressure_angle(drive), **written, **_strength(drive)}
    joints = np.degrees(joints_up_to(drive.pair.transmission, cycle_rad))
    if drive.stage is None:
        return [PageChart(key, replace(chart, joints_deg=joints)) for key, chart in charts.items()]
    shaft, stage = DRIVING if drive.stage == 1 else BETWEEN, drive.stage
    return [
        PageChart(f"{key}_{stage}", replace(chart, name=f"{chart.name}, stage {stage}", joints_deg=joints), shaft)
        for key, chart in {"ratio": ratio_chart(drive.pair.transmission, cycle_rad), **charts}.items()
    ]


def _strength(drive: Drive) -> dict[str, Chart]:
    """Loads and stresses of the teeth; empty where no strength is known."""
    rating = known_rating(drive)
    if not isinstance(rating, Rating):
        return {}
    charts = teeth_charts.strength_charts(rating.strength, rating.weakest)
    # The page names the values of the first line.
    return {
        chart.name.replace(" ", "_"): replace(
            chart, lines=(chart.own, *(one for one in chart.lines if one is not chart.own))
        )
        for chart in charts
    }


def _pressure_angle(drive: Drive) -> Chart:
    """The pressure angle at the first contact as designed; for circular gears the rack's, of flanks that push."""
    chart = teeth_charts.pressure_angle(drive.designed_contact)
    backs, pushing = chart.lines
    circular = np.full(2, degrees(drive.rack.pressure_angle_rad))
    lines = (
        _closed(pushing, chart.end, Role.OWN, "pushing flanks"),
        _closed(backs, chart.end, Role.OTHER, "backs"),
        Line(Role.UNIFORM, "circular gears", np.array([0.0, chart.end]), circular),
    )
    return replace(chart, unit="\u00b0", lines=lines)


def _transmission_error(contact: PairContact) -> Chart:
    """The transmission error of the worst written outlines, from which gears are cut, and of the design."""
    chart = teeth_charts.transmission_error(contact)
    designed, written = chart.lines
    source = teeth_charts.worst_written(contact).source.upper()
    lines = (
        _closed(written, chart.end, Role.WRITTEN, f"as written ({source})"),
        _closed(designed, chart.end, Role.OWN, "as designed"),
    )
    return replace(chart, lines=lines)


def _closed(line: Line, end_deg: float, role: Role, label: str) -> Line:
    """The line with its first value once more at the end of the cycle, unless it goes to the end by itself."""
    if line.x[-1] >= end_deg * (1.0 - 1e-12):
        return replace(line, role=role, label=label)
    return Line(role, label, np.append(line.x, end_deg), np.append(line.values, line.values[0]))


def ratio_chart(law: Transmission, end_rad: float) -> Chart:
    """The ratio of a law from 0 to a driving angle, with its joints."""
    joints = joints_up_to(law, end_rad)
    angle = split_angles(end_rad, joints.tolist())
    values = 1.0 / law.driven_angle(angle, 1).derivative(1)
    line = Line(Role.OWN, "this design", np.degrees(angle), values)
    return Chart(RATIO_NAME, "", (line,), degrees(end_rad), joints_deg=np.degrees(joints))
