"""The charts of a pair of gears on the page; teeth and their contact are loaded with this module.

The horizontal axis is the angle of the pair's own driving gear, which for the second of two stages is on the shaft
between the stages; the lines are sampled like the lines of the motion (``motion_charts``).
"""

from __future__ import annotations

from collections.abc import Iterable
from dataclasses import replace
from math import degrees

import numpy as np

from ncgear.contact.designed.extremes import ValueRange
from ncgear.contact.pair import PairContact
from ncgear.drawings.charts import teeth_charts
from ncgear.drawings.charts.chart import RATIO_NAME, Chart, ChartLine, Role, joints_up_to
from ncgear.drawings.page.chart_figure import PageChart, shaft_of
from ncgear.drawings.page.motion_charts import split_angles
from ncgear.numerics.arrays import distinct
from ncgear.project.drive import Drive
from ncgear.project.strengthening import Rating, known_rating
from ncgear.ratio.transmission import Transmission


def gear_charts(drive: Drive, contact: PairContact) -> list[PageChart]:
    """Pressure angle and transmission error of one pair, stresses where a load is known; of a stage its ratio, too."""
    return charts_of_pair(drive, [_transmission_error(contact)], contact.as_designed.placement.cycle_rad)


def charts_of_pair(drive: Drive, written: Iterable[Chart], cycle_rad: float) -> list[PageChart]:
    """Charts of one pair that need no file; the charts ``written`` follow the first.  Keys follow from names."""
    joints = np.degrees(joints_up_to(drive.pair.transmission, cycle_rad))
    found = (_pressure_angle(drive), *written, *_strength(drive))
    charts = {chart.name.replace(" ", "_"): replace(chart, joints_deg=joints) for chart in found}
    if drive.stage is None:
        return [PageChart(key, chart) for key, chart in charts.items()]
    shaft, of_stage = shaft_of(drive.stage), f", stage {drive.stage}"
    ratio = replace(ratio_chart(drive.pair.transmission, cycle_rad), joints_deg=joints)
    return [
        PageChart(f"{key}_{drive.stage}", replace(chart, name=f"{chart.name}{of_stage}"), shaft)
        for key, chart in {"ratio": ratio, **charts}.items()
    ]


def _strength(drive: Drive) -> list[Chart]:
    rating = known_rating(drive)
    if not isinstance(rating, Rating):
        return []
    charts = teeth_charts.strength_charts(rating.strength, rating.weakest)
    # The page names the values of the first line.
    return [
        replace(chart, lines=tuple(sorted(chart.lines, key=lambda line: line is not chart.own))) for chart in charts
    ]


def _pressure_angle(drive: Drive) -> Chart:
    """The pressure angle at the first contact as designed; for circular gears the rack's, of flanks that push."""
    chart = teeth_charts.pressure_angle(drive.designed_contact)
    backs, pushing = chart.lines
    extremes = drive.contact_extremes
    pushing = _with_extremes(pushing, extremes.pushing_pressure_angle_rad, degrees(1.0))
    backs = _with_extremes(backs, extremes.back_pressure_angle_rad, degrees(1.0))
    circular = np.full(2, degrees(drive.rack.pressure_angle_rad))
    lines = (
        _closed(pushing, chart.end, Role.OWN, "pushing flanks"),
        _closed(backs, chart.end, Role.OTHER, "backs"),
        ChartLine(Role.UNIFORM, "circular gears", np.array([0.0, chart.end]), circular),
    )
    return replace(chart, unit="\u00b0", lines=lines)


def _transmission_error(contact: PairContact) -> Chart:
    """The transmission errors of the worst written outlines, which gears are cut from, and of the design."""
    chart = teeth_charts.transmission_error(contact)
    designed, written = chart.lines
    worst = teeth_charts.worst_written(contact)
    written = _with_extremes(written, contact.extremes[contact.as_written.index(worst)].pushing_rad, 1e6)
    source = worst.source.upper()
    lines = (
        _closed(written, chart.end, Role.WRITTEN, f"as written ({source})"),
        _closed(designed, chart.end, Role.OWN, "as designed"),
    )
    return replace(chart, lines=lines)


def _with_extremes(line: ChartLine, found: ValueRange, factor: float) -> ChartLine:
    """The line with the least and the greatest value, searched between its places, as the page names them."""
    at = np.degrees([found.low.at, found.high.at])
    values = factor * np.array([found.low.value, found.high.value])
    new = ~np.isin(at, line.x)
    place = np.searchsorted(line.x, at[new])
    return replace(line, x=np.insert(line.x, place, at[new]), values=np.insert(line.values, place, values[new]))


def _closed(line: ChartLine, end_deg: float, role: Role, label: str) -> ChartLine:
    """The line with its first value again at the end of the cycle, unless it reaches the end already."""
    if line.x[-1] >= end_deg * (1.0 - 1e-12):
        return replace(line, role=role, label=label)
    return ChartLine(role, label, np.append(line.x, end_deg), np.append(line.values, line.values[0]))


def ratio_chart(law: Transmission, end_rad: float) -> Chart:
    """The ratio of a law from 0 to a driving angle, with its joints and its extremes."""
    joints = joints_up_to(law, end_rad)
    extremes = [end.at for end in law.ratio_range]
    angle = distinct(np.concatenate([split_angles(end_rad, joints.tolist()), extremes]))
    values = 1.0 / law.driven_angle(angle, 1).derivative(1)
    line = ChartLine(Role.OWN, "this design", np.degrees(angle), values)
    return Chart(RATIO_NAME, "", (line,), degrees(end_rad), joints_deg=np.degrees(joints))
