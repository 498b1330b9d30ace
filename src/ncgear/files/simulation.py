"""What a simulation of any level hands over.

The pictures of the rigid level.

The rigid level's table, figures and pictures.

The quasi-static level's table, figures and pictures.

The dynamic level's table, figures and pictures.

A simulation of any level: as files, and as text.
"""

from __future__ import annotations

from collections.abc import Callable, Mapping, Sequence
from dataclasses import asdict, dataclass
from math import atan2, degrees, hypot
from pathlib import Path
from typing import Any

import numpy as np

from ncgear.drawings.plots.canvas import joints_up_to
from ncgear.drawings.plots.curves import LoadRow, TimeRow, load_curves, time_rows
from ncgear.dynamics.history import History, history, parted_s
from ncgear.dynamics.level import Level
from ncgear.dynamics.rigid import Loads, Rigid
from ncgear.figures.numbers import json_text
from ncgear.figures.tables import csv_text
from ncgear.figures.terminal import MECHANISMS, beside_lines, summary_text
from ncgear.numerics.arrays import Array
from ncgear.numerics.extrema import Extremum
from ncgear.numerics.plane import Vector
from ncgear.numerics.units import N_M_PER_N_MM
from ncgear.project.drive import Drive


@dataclass(frozen=True, eq=False)
class Simulated:
    """``table`` holds columns of one length by name, ``figures`` sections of plain values, ``pictures`` PNGs by file.

    Names and keys end in their unit.
    """

    table: Mapping[str, Array]
    figures: Mapping[str, Any]
    pictures: Mapping[str, bytes]


def rigid_pictures(drive: Drive, own: Loads, uniform: Loads) -> dict[str, bytes]:
    """Driving torque, forces in the joints and between the teeth, as PNG by file name."""
    pictures = {
        "driving_torque.png": _picture(drive, [_torque(drive, own, uniform)], "driving torque"),
        "bearing_forces.png": _picture(drive, _forces(drive, own, uniform), "forces in the joints"),
    }
    if own.mesh is None or uniform.mesh is None:
        return pictures
    force = LoadRow("mesh force", "N", own.mesh.size_n.value, uniform.mesh.size_n.value)
    angles = [np.degrees(mesh.pressure_angle_rad.value) for mesh in (own.mesh, uniform.mesh)]
    rows = [force, LoadRow("pressure angle", "deg", angles[0], angles[1], extreme=False)]
    return {**pictures, "mesh_force.png": _picture(drive, rows, "force between the teeth")}


def _picture(drive: Drive, rows: list[LoadRow], what: str) -> bytes:
    phi1, speed = drive.motion.phi1_rad, drive.design.operation.speed_rpm
    title = f"{drive.design.name}: {what} at {speed:.4g} r/min"
    return load_curves(phi1, rows, title, joints_up_to(drive.transmission, float(phi1[-1])))


def _torque(drive: Drive, own: Loads, uniform: Loads) -> LoadRow:
    mean = N_M_PER_N_MM * drive.rigid.fluctuation.mean_torque_n_mm
    curves = [N_M_PER_N_MM * loads.driving_torque.value for loads in (own, uniform)]
    return LoadRow("driving torque", "N m", curves[0], curves[1], mean=mean)


def _forces(drive: Drive, own: Loads, uniform: Loads) -> list[LoadRow]:
    joints = reversed([*drive.linkage.JOINTS.items()])
    return [
        LoadRow("crank bearing", "N", _size(own.crank_bearing), _size(uniform.crank_bearing)),
        *(LoadRow(words, "N", _size(own.joints[name]), _size(uniform.joints[name])) for name, words in joints),
        LoadRow("guide", "N", own.guide.value, uniform.guide.value),
    ]


def _size(force: Vector) -> Array:
    size: Array = (force.x.value**2 + force.y.value**2) ** 0.5
    return size


KG_M2 = 1e-6
"""One kg mm2 in kg m2."""


def rigid_simulation(drive: Drive) -> Simulated:
    """Inverse dynamics of a drive, beside the uniform crank."""
    phi1 = drive.motion.phi1_rad
    own, uniform = drive.rigid.machine.at(phi1), drive.uniform_rigid.machine.at(phi1)
    return Simulated(_table(drive, own, uniform), _figures(drive), rigid_pictures(drive, own, uniform))


def _table(drive: Drive, own: Loads, uniform: Loads) -> dict[str, Array]:
    motion = drive.motion
    names = "phi1_rad", "phi2_rad", "displacement_mm", "velocity_mm_s", "acceleration_mm_s2", "force_n"
    return {
        **{name: getattr(motion, name) for name in names},
        **_columns(own),
        **{f"uniform_{name}": column for name, column in _columns(uniform).items()},
    }


def _columns(loads: Loads) -> dict[str, Array]:
    columns = {
        "driving_torque_n_m": N_M_PER_N_MM * loads.driving_torque.value,
        "driven_torque_n_m": N_M_PER_N_MM * loads.driven_torque.value,
        **{key: column for name, force in loads.joints.items() for key, column in _components(name, force).items()},
        **_components("crank_bearing", loads.crank_bearing),
        "guide_n": loads.guide.value,
    }
    if loads.mesh is None:
        return columns
    mesh = {"mesh_n": loads.mesh.size_n.value, "pressure_angle_rad": loads.mesh.pressure_angle_rad.value}
    return {**columns, **_components("mesh", loads.mesh.force), **mesh}


def _components(name: str, force: Vector) -> dict[str, Array]:
    return {f"{name}_x_n": force.x.value, f"{name}_y_n": force.y.value}


def _figures(drive: Drive) -> dict[str, Any]:
    design = drive.design
    assert design.masses is not None
    return {
        "design": {"name": design.name, "description": design.description, "level": Level.RIGID.value},
        "drive": {"speed_rpm": design.operation.speed_rpm},
        "masses": _masses(drive),
        "this_design": _loads(drive.rigid, design.masses.flywheel.speed_fluctuation),
        "uniform_crank": _loads(drive.uniform_rigid, design.masses.flywheel.speed_fluctuation),
    }


def _masses(drive: Drive) -> dict[str, Any]:
    found = asdict(drive.masses)
    along, across = found.pop("gravity_m_s2")
    gravity = {"gravity_m_s2": hypot(along, across), "gravity_direction_deg": degrees(atan2(across, along))}
    return {**found, **gravity} if gravity["gravity_m_s2"] else found


def _loads(rigid: Rigid, coefficient: float) -> dict[str, Any]:
    peaks, swing, speed = rigid.peaks, rigid.fluctuation, rigid.machine.machine.speed_rad_s
    return {
        **_peak("peak_driving_torque", "n_m", peaks.most_torque_n_mm, N_M_PER_N_MM),
        **_peak("least_driving_torque", "n_m", peaks.least_torque_n_mm, N_M_PER_N_MM),
        "mean_driving_torque_n_m": N_M_PER_N_MM * swing.mean_torque_n_mm,
        "mean_power_w": N_M_PER_N_MM * swing.mean_torque_n_mm * speed,
        "peak_driving_power_w": N_M_PER_N_MM * peaks.most_torque_n_mm.value * speed,
        "energy_swing_j": N_M_PER_N_MM * swing.swing_n_mm,
        "flank_changes_deg": [degrees(angle) for angle in swing.flank_changes_rad],
        "speed_fluctuation": coefficient,
        "inertia_for_speed_fluctuation_kg_m2": KG_M2 * swing.flywheel_kg_mm2(coefficient),
        **_mesh(rigid),
        **_joint_peaks(rigid),
        **_peak("peak_crank_bearing_force", "n", peaks.crank_bearing_n),
        **_peak("peak_guide_force", "n", peaks.guide_n),
    }


def _joint_peaks(rigid: Rigid) -> dict[str, float]:
    """Of each joint of the mechanism, by its words."""
    words, found = rigid.machine.machine.linkage.JOINTS, {}
    for name, peak in rigid.peaks.joints_n.items():
        found.update(_peak(f"peak_{words[name].replace(' ', '_')}_force", "n", peak))
    return found


def _mesh(rigid: Rigid) -> dict[str, Any]:
    """Of a machine with gears; the driving shaft's bearings bear the mesh force as it is."""
    mesh = rigid.peaks.mesh
    if mesh is None:
        return {}
    return {
        **_peak("peak_mesh_force", "n", mesh.force_n),
        "pressure_angle_at_peak_mesh_force_deg": degrees(mesh.pressure_angle_rad),
        **_peak("peak_driving_bearing_force", "n", mesh.force_n),
    }


def _peak(name: str, unit: str, found: Extremum, factor: float = 1.0) -> dict[str, float]:
    return {f"{name}_{unit}": factor * found.value, f"{name}_at_rad": found.at}


NOWHERE = np.empty((0, 2))


def quasi_static_simulation(drive: Drive) -> Simulated:
    """Loaded contact of a drive's teeth, beside the torque of the rigid level."""
    rigid = N_M_PER_N_MM * drive.rigid.machine.at(drive.motion.phi1_rad).driving_torque.value
    return Simulated(
        _table_of_quasi_static(drive, rigid),
        _figures_of_quasi_static(drive),
        {"loaded_contact.png": _picture_of_quasi_static(drive, rigid)},
    )


def _table_of_quasi_static(drive: Drive, rigid_n_m: Array) -> dict[str, Array]:
    loaded, motion = drive.loaded_contact, drive.motion
    return {
        "phi1_rad": motion.phi1_rad,
        "phi2_rad": motion.phi2_rad + loaded.error_rad,
        "error_rad": loaded.error_rad,
        "pairs": loaded.pairs.astype(float),
        "tooth_force_n": loaded.tooth_force_n,
        "depth_mm": np.maximum(loaded.forces.depth_mm.max(axis=-1), 0.0),
        "driving_torque_n_m": N_M_PER_N_MM * loaded.driving_torque_n_mm,
        "rigid_driving_torque_n_m": rigid_n_m,
    }


def _figures_of_quasi_static(drive: Drive) -> dict[str, Any]:
    loaded, design = drive.loaded_contact, drive.design
    return {
        "design": {"name": design.name, "description": design.description, "level": Level.QUASI_STATIC.value},
        "drive": {"speed_rpm": design.operation.speed_rpm},
        "loaded_contact": {
            "contact_stiffness_n": drive.meshing.impact.stiffness,
            "transmission_error_rad": loaded.transmission_error_rad,
            **_peak_of_quasi_static(drive, "peak_tooth_force_n", loaded.tooth_force_n),
            **_peak_of_quasi_static(drive, "peak_depth_mm", loaded.forces.depth_mm.max(axis=-1)),
            **_peak_of_quasi_static(drive, "peak_driving_torque_n_m", N_M_PER_N_MM * loaded.driving_torque_n_mm),
            "most_pairs": int(loaded.pairs.max()),
        },
    }


def _peak_of_quasi_static(drive: Drive, key: str, values: Array) -> dict[str, float]:
    place = int(np.argmax(values))
    name = key.rsplit("_n_m", 1)[0] if key.endswith("_n_m") else key.rsplit("_", 1)[0]
    return {key: float(values[place]), f"{name}_at_rad": float(drive.motion.phi1_rad[place])}


def _picture_of_quasi_static(drive: Drive, rigid_n_m: Array) -> bytes:
    loaded, motion = drive.loaded_contact, drive.motion
    rows = [
        TimeRow("driving torque", "N m", N_M_PER_N_MM * loaded.driving_torque_n_mm, rigid_n_m),
        TimeRow("tooth force", "N", loaded.tooth_force_n),
        TimeRow("ahead of the law", "mrad", 1e3 * loaded.error_rad),
    ]
    title = f"{drive.design.name}: teeth under load at {drive.design.operation.speed_rpm:.4g} r/min"
    return time_rows(motion.phi1_rad, rows, title, NOWHERE, ("teeth give way", "rigid"))


def dynamic_simulation(drive: Drive) -> Simulated:
    """The motion of a drive in time, beside its law."""
    course, rigid = drive.course, drive.rigid.machine
    assert rigid.place is not None
    shown = history(course, rigid, rigid.place)
    apart = parted_s(course)
    return Simulated(_table_of_dynamic(shown), _figures_of_dynamic(drive, shown, apart), _pictures(drive, shown, apart))


def _table_of_dynamic(shown: History) -> dict[str, Array]:
    columns = {"time_s": shown.time_s, "phi1_rad": shown.phi1_rad, "phi2_rad": shown.phi2_rad}
    for prefix, slide in (("", shown.slide), ("law_", shown.law)):
        columns.update({f"{prefix}{name}": values for name, values in vars(slide).items()})
    return {
        **columns,
        "error_rad": shown.error_rad,
        "pushing_force_n": shown.pushing_n,
        "back_force_n": shown.back_n,
        "driving_torque_n_m": N_M_PER_N_MM * shown.torque_n_mm,
        **{f"{name}_{axis}_n": getattr(force, axis) for name, force in _joints(shown).items() for axis in ("x", "y")},
        "guide_n": np.asarray(shown.joints.guide_n),
    }


def _joints(shown: History) -> dict[str, Vector]:
    joints = shown.joints
    return {**joints.joints, "crank_bearing": shown.crank_bearing, "mesh": shown.mesh}


def _figures_of_dynamic(drive: Drive, shown: History, apart_s: Array) -> dict[str, Any]:
    design, course, work = drive.design, drive.course, drive.course.states[4:, -1]
    return {
        "design": {"name": design.name, "description": design.description, "level": Level.DYNAMIC.value},
        "drive": {"speed_rpm": design.operation.speed_rpm},
        "slider": {
            "largest_displacement_error_mm": _largest(shown.slide.displacement_mm - shown.law.displacement_mm),
            "largest_velocity_error_mm_s": _largest(shown.slide.velocity_mm_s - shown.law.velocity_mm_s),
            "peak_acceleration_mm_s2": _largest(shown.slide.acceleration_mm_s2),
            "peak_acceleration_of_law_mm_s2": _largest(shown.law.acceleration_mm_s2),
        },
        "bearings": {
            f"peak_{name}_force_n": _largest(_size_of_dynamic(force)) for name, force in _joints(shown).items()
        },
        "motion_in_time": {
            "contact_stiffness_n": drive.meshing.impact.stiffness,
            "peak_pushing_force_n": _largest(shown.pushing_n),
            "peak_back_force_n": _largest(shown.back_n),
            "peak_driving_torque_n_m": N_M_PER_N_MM * float(shown.torque_n_mm.max()),
            "least_driving_torque_n_m": N_M_PER_N_MM * float(shown.torque_n_mm.min()),
            "work_of_drive_j": N_M_PER_N_MM * float(work[0]),
            "loss_of_teeth_j": N_M_PER_N_MM * float(work[1]),
            "losses_of_contact": len(apart_s),
            "time_without_contact_s": float(np.sum(apart_s[:, 1] - apart_s[:, 0])),
            "energy_error": course.energy_error,
            "solver_steps": int(course.time_s.size - 1),
        },
    }


def _largest(values: Array) -> float:
    return float(np.abs(values).max())


def _size_of_dynamic(force: Vector) -> Array:
    size: Array = np.hypot(force.x, force.y)
    return size


def _pictures(drive: Drive, shown: History, apart_s: Array) -> dict[str, bytes]:
    apart = np.stack([drive.course.at(ends)[0] for ends in apart_s.T], axis=-1)
    speed = f"at {drive.design.operation.speed_rpm:.4g} r/min"
    name = drive.design.name
    return {
        "slider_motion.png": time_rows(shown.phi1_rad, _motion(shown), f"{name}: slider {speed}", apart),
        "tooth_force.png": time_rows(
            shown.phi1_rad, _forces_of_dynamic(shown), f"{name}: teeth and torque {speed}", apart
        ),
        "bearing_forces.png": time_rows(shown.phi1_rad, _bearings(drive, shown), f"{name}: bearings {speed}", apart),
    }


def _motion(shown: History) -> list[TimeRow]:
    own, law = shown.slide, shown.law
    return [
        TimeRow("displacement", "mm", own.displacement_mm, law.displacement_mm),
        TimeRow("velocity", "mm/s", own.velocity_mm_s, law.velocity_mm_s),
        TimeRow("acceleration", "mm/s\u00b2", own.acceleration_mm_s2, law.acceleration_mm_s2),
    ]


def _forces_of_dynamic(shown: History) -> list[TimeRow]:
    return [
        TimeRow("pushing force", "N", shown.pushing_n),
        TimeRow("back force", "N", shown.back_n),
        TimeRow("driving torque", "N m", N_M_PER_N_MM * shown.torque_n_mm),
    ]


def _bearings(drive: Drive, shown: History) -> list[TimeRow]:
    names = {**drive.linkage.JOINTS, "crank_bearing": "crank bearing", "mesh": "mesh force"}
    return [TimeRow(names[key], "N", _size_of_dynamic(force)) for key, force in _joints(shown).items()]


def simulate(drive: Drive, level: Level) -> Simulated:
    """Simulate a machine at a level; raises WrongInput where the design lacks what the level needs."""
    return LEVELS[level](drive)


def _rigid(drive: Drive) -> Simulated:

    return rigid_simulation(drive)


def _quasi_static(drive: Drive) -> Simulated:

    return quasi_static_simulation(drive)


def _dynamic(drive: Drive) -> Simulated:

    return dynamic_simulation(drive)


LEVELS: dict[Level, Callable[[Drive], Simulated]] = {
    Level.RIGID: _rigid,
    Level.QUASI_STATIC: _quasi_static,
    Level.DYNAMIC: _dynamic,
}
"""How each level is simulated; what one needs is imported when it is asked for."""


def simulation_files(found: Simulated) -> dict[str, bytes]:
    """Table, pictures and figures as files."""
    return {
        "simulation.csv": csv_text(list(found.table), list(found.table.values())).encode(),
        **found.pictures,
        "simulation.json": json_text(found.figures).encode(),
    }


def simulation_text(found: Simulated, paths: Sequence[Path]) -> str:
    """The figures for reading, those of both mechanisms side by side, and the files written."""
    compared = {key: found.figures[key] for key in MECHANISMS if key in found.figures}
    alone = {key: value for key, value in found.figures.items() if key not in compared}
    beside = [*beside_lines("Torques and forces", compared), ""] if compared else []
    return "\n".join([summary_text(alone), "", *beside, "Written", *(f"  {path}" for path in paths)])
