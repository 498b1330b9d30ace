"""The pictures of a build: PNG by file name."""

from __future__ import annotations

from dataclasses import replace
from math import pi

import numpy as np

from ncgear.contact.pair import PairContact
from ncgear.drawings.charts import contact_charts
from ncgear.drawings.charts.chart import EMPTY, Line, Role, joints_up_to
from ncgear.drawings.charts.drawer import (
    CONTACT_COLUMN,
    CONTACT_LOOK,
    MOTION_COLUMN,
    MOTION_LOOK,
    beside_png,
    column_png,
)
from ncgear.drawings.charts.slider_charts import LOAD, MOTION, over_displacement, slider_chart
from ncgear.drawings.plots.assembled_pair import (
    assembled_pitch_curves,
    assembled_teeth,
    pitch_curves_png,
    positions_at,
    teeth_png,
)
from ncgear.project.drive import Drive

POSITIONS = 3
"""Positions of the pair in the picture of its teeth, evenly spread over a turn or from end to end."""

NO_BACKLASH_RAD = 1e-9
"""Play in rad below which there is no chart of it: some nanometres at the flanks."""


def pictures(drive: Drive, contact: PairContact) -> dict[str, bytes]:
    """The pictures of a build."""
    name = drive.design.name
    pair = name if drive.stage is None else f"{name}, stage {drive.stage} by its own angles"
    covered = drive.pair.transmission.lobes.range
    turn = np.arange(POSITIONS) * 2.0 * pi / POSITIONS
    positions = positions_at(drive, np.linspace(0.0, covered.driving_rad, POSITIONS) if covered else turn)
    module = drive.pitch.size.module_mm
    motion, load = ([slider_chart(drive, quantity) for quantity in quantities] for quantities in (MOTION, LOAD))
    motions = drive.motion, drive.uniform_motion
    load_pairs = [(chart, over_displacement(chart, drive.linkage.OUTPUT, motions)) for chart in load]
    return {
        "pitch_curves.png": pitch_curves_png(*assembled_pitch_curves(drive), f"{pair}: pitch curves at phi1 = 0"),
        "tooth_pair.png": teeth_png(assembled_teeth(drive), module, positions, f"{pair}: tooth outlines in mesh"),
        "motion.png": column_png(motion, titled(drive, "motion"), MOTION_LOOK, MOTION_COLUMN),
        "contact.png": _contact_picture(drive, contact, f"{pair}: contact of the teeth"),
        "power.png": beside_png(load_pairs, titled(drive, f"{drive.linkage.OUTPUT.load_name} and power")),
    }


def titled(drive: Drive, what: str) -> str:
    """The heading of a picture of the machine: design, content and speed."""
    return f"{drive.design.name}: {what} at {drive.design.operation.speed_rpm:.4g} r/min"


def _contact_picture(drive: Drive, contact: PairContact, title: str) -> bytes:
    """All charts of the contact, with the joints of the law; the chart of backlash only where there is any."""
    designed = contact.as_designed
    kinds = [contact_charts.flanks_in_contact, contact_charts.pressure_angle, contact_charts.sliding]
    if np.max(np.abs(designed.backlash_rad)) >= NO_BACKLASH_RAD:
        kinds.insert(0, contact_charts.backlash)
    errors = contact_charts.transmission_error(contact)
    # The legend is above the first row, which has no line of the backs: an empty line there names them.
    pushing, written = errors.lines
    errors = replace(errors, lines=(pushing, Line(Role.OTHER, contact_charts.BACKS, EMPTY, EMPTY), written))
    joints = np.degrees(joints_up_to(drive.pair.transmission, designed.placement.cycle_rad))
    charts = [replace(chart, joints_deg=joints) for chart in (errors, *(kind(designed) for kind in kinds))]
    return column_png(charts, title, CONTACT_LOOK, CONTACT_COLUMN)
