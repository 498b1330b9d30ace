"""The pictures of a build and of the levels of a simulation: PNG by file name."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import replace
from math import pi

import numpy as np

from ncgear.contact.pair import PairContact
from ncgear.drawings.charts import contact_charts, simulation_charts
from ncgear.drawings.charts.chart import EMPTY, Chart, Line, Role, joints_up_to
from ncgear.drawings.charts.drawer import (
    CONTACT_COLUMN,
    CONTACT_LOOK,
    LOAD_LOOK,
    MOTION_COLUMN,
    MOTION_LOOK,
    SIMULATION_COLUMN,
    TIME_LOOK,
    Look,
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
from ncgear.dynamics.history import History
from ncgear.dynamics.rigid import Loads
from ncgear.numerics.arrays import Array
from ncgear.project.drive import Drive

POSITIONS = 3
"""Positions of the pair in the picture of its teeth, evenly spread over a turn of the driving gear."""

NO_BACKLASH_RAD = 1e-9
"""Play in rad below which there is no chart of it: some nanometres at the flanks."""


def pictures(drive: Drive, contact: PairContact) -> dict[str, bytes]:
    """The pictures of a build."""
    name = drive.design.name
    pair = name if drive.stage is None else f"{name}, stage {drive.stage} by its own angles"
    positions = positions_at(drive, np.arange(POSITIONS) * 2.0 * pi / POSITIONS)
    module = drive.pitch.size.module_mm
    motion, load = ([slider_chart(drive, quantity) for quantity in quantities] for quantities in (MOTION, LOAD))
    motions = drive.motion, drive.uniform_motion
    load_pairs = [(chart, over_displacement(chart, motions)) for chart in load]
    return {
        "pitch_curves.png": pitch_curves_png(*assembled_pitch_curves(drive), f"{pair}: pitch curves at phi1 = 0"),
        "tooth_pair.png": teeth_png(assembled_teeth(drive), module, positions, f"{pair}: tooth outlines in mesh"),
        "motion.png": column_png(motion, _title(drive, "motion"), MOTION_LOOK, MOTION_COLUMN),
        "contact.png": _contact_picture(drive, contact, f"{pair}: contact of the teeth"),
        "power.png": beside_png(load_pairs, _title(drive, "force and power")),
    }


def _title(drive: Drive, what: str) -> str:
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


def rigid_pictures(drive: Drive, own: Loads, uniform: Loads) -> dict[str, bytes]:
    """The pictures of the rigid level; the loads are those at the angles of the drive's motion."""
    charts = {
        "driving_torque.png": ([simulation_charts.driving_torque(drive, own, uniform)], "driving torque"),
        "bearing_forces.png": (simulation_charts.joint_forces(drive, own, uniform), "forces in the joints"),
        "mesh_force.png": (simulation_charts.mesh_forces(drive, own, uniform), "force between the teeth"),
    }
    return _simulation_pictures(drive, LOAD_LOOK, charts)


def quasi_static_pictures(drive: Drive, rigid_n_m: Array) -> dict[str, bytes]:
    """The picture of the quasi-static level, beside the driving torque of rigid teeth in N m, shape (n,)."""
    charts = simulation_charts.teeth_under_load(drive, rigid_n_m)
    return _simulation_pictures(drive, TIME_LOOK, {"loaded_contact.png": (charts, "teeth under load")})


def dynamic_pictures(drive: Drive, shown: History, apart_rad: Array) -> dict[str, bytes]:
    """The pictures of the dynamic level; in the stretches ``apart_rad`` (shape (k, 2)) no pushing flanks touch."""
    apart = np.degrees(apart_rad)
    charts = {
        "slider_motion.png": (simulation_charts.slider_in_time(shown, apart), "slider"),
        "tooth_force.png": (simulation_charts.teeth_in_time(shown, apart), "teeth and torque"),
        "bearing_forces.png": (simulation_charts.bearings_in_time(drive, shown, apart), "bearings"),
    }
    return _simulation_pictures(drive, TIME_LOOK, charts)


def _simulation_pictures(
    drive: Drive, look: Look, columns: Mapping[str, tuple[Sequence[Chart], str]]
) -> dict[str, bytes]:
    """A picture for each column of charts, by file name; a column is given with its title and may be empty."""
    return {
        file: column_png(charts, _title(drive, what), look, SIMULATION_COLUMN)
        for file, (charts, what) in columns.items()
        if charts
    }
