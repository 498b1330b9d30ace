"""The pictures of the levels of a simulation: PNG by file name."""

from __future__ import annotations

from collections.abc import Mapping, Sequence

import numpy as np

from ncgear.drawings.charts import simulation_charts
from ncgear.drawings.charts.chart import Chart
from ncgear.drawings.charts.drawer import LOAD_LOOK, SIMULATION_COLUMN, TIME_LOOK, Look, column_png
from ncgear.drawings.pictures import titled
from ncgear.dynamics.history import History
from ncgear.dynamics.loaded_machine import Loads
from ncgear.numerics.arrays import Array
from ncgear.project.drive import Drive


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
    apart, output = np.degrees(apart_rad), drive.linkage.OUTPUT
    charts = {
        f"{output.name.replace(' ', '_')}_motion.png": (
            simulation_charts.output_in_time(shown, output, apart),
            output.name,
        ),
        "tooth_force.png": (simulation_charts.teeth_in_time(shown, apart), "teeth and torque"),
        "bearing_forces.png": (simulation_charts.bearings_in_time(drive, shown, apart), "bearings"),
    }
    return _simulation_pictures(drive, TIME_LOOK, charts)


def _simulation_pictures(
    drive: Drive, look: Look, columns: Mapping[str, tuple[Sequence[Chart], str]]
) -> dict[str, bytes]:
    """A picture for each column of charts, by file name; a column is given with its title and may be empty."""
    return {
        file: column_png(charts, titled(drive, what), look, SIMULATION_COLUMN)
        for file, (charts, what) in columns.items()
        if charts
    }
