"""A simulation of any level: its table, figures and pictures, as files and as text."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from pathlib import Path
from typing import Any

import numpy as np

from ncgear.drawings.plots.canvas import joints_up_to
from ncgear.drawings.plots.curves import LoadRow, TimeRow, load_curves, time_rows
from ncgear.dynamics.history import History, history, parted_s
from ncgear.dynamics.level import Level
from ncgear.dynamics.rigid import Loads
from ncgear.figures.numbers import json_text
from ncgear.figures.simulated import (
    dynamic_figures,
    dynamic_table,
    force_size_n,
    joint_forces,
    quasi_static_figures,
    quasi_static_table,
    rigid_figures,
    rigid_table,
)
from ncgear.figures.tables import csv_text
from ncgear.figures.terminal import MECHANISMS, beside_lines, summary_text
from ncgear.numerics.arrays import Array
from ncgear.numerics.plane import Vector
from ncgear.numerics.units import N_M_PER_N_MM
from ncgear.project.drive import Drive

NOWHERE = np.empty((0, 2))


@dataclass(frozen=True, eq=False)
class Simulated:
    """``table`` holds columns of one length by name, ``figures`` sections of plain values, ``pictures`` PNGs by file.

    Names and keys end in their unit.
    """

    table: Mapping[str, Array]
    figures: Mapping[str, Any]
    pictures: Mapping[str, bytes]


def simulate(drive: Drive, level: Level) -> Simulated:
    """Simulate a machine at a level; raises WrongInput where the design lacks what the level needs."""
    match level:
        case Level.RIGID:
            return _rigid(drive)
        case Level.QUASI_STATIC:
            return _quasi_static(drive)
        case Level.DYNAMIC:
            return _dynamic(drive)


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


def _rigid(drive: Drive) -> Simulated:
    """Inverse dynamics of a drive, beside the uniform crank."""
    phi1 = drive.motion.phi1_rad
    own, uniform = drive.rigid.machine.at(phi1), drive.uniform_rigid.machine.at(phi1)
    return Simulated(rigid_table(drive, own, uniform), rigid_figures(drive), rigid_pictures(drive, own, uniform))


def _quasi_static(drive: Drive) -> Simulated:
    """Loaded contact of a drive's teeth, beside the torque of the rigid level."""
    rigid = N_M_PER_N_MM * drive.rigid.machine.at(drive.motion.phi1_rad).driving_torque.value
    return Simulated(quasi_static_table(drive, rigid), quasi_static_figures(drive), quasi_static_pictures(drive, rigid))


def _dynamic(drive: Drive) -> Simulated:
    """The motion of a drive in time, beside its law."""
    course, rigid = drive.course, drive.rigid.machine
    assert rigid.place is not None
    shown = history(course, rigid, rigid.place)
    apart_s = parted_s(course)
    apart_rad = np.stack([course.at(ends)[0] for ends in apart_s.T], axis=-1)
    pictures = dynamic_pictures(drive, shown, apart_rad)
    return Simulated(dynamic_table(shown), dynamic_figures(drive, shown, apart_s), pictures)


def rigid_pictures(drive: Drive, own: Loads, uniform: Loads) -> dict[str, bytes]:
    """Driving torque, forces in the joints and between the teeth, as PNG by file name."""
    pictures = {
        "driving_torque.png": _picture(drive, [_torque(drive, own, uniform)], "driving torque"),
        "bearing_forces.png": _picture(drive, _forces(own, uniform), "forces in the joints"),
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


def _forces(own: Loads, uniform: Loads) -> list[LoadRow]:
    return [
        LoadRow("crank bearing", "N", _size(own.crank_bearing), _size(uniform.crank_bearing)),
        LoadRow("crank pin", "N", _size(own.pin), _size(uniform.pin)),
        LoadRow("wrist", "N", _size(own.wrist), _size(uniform.wrist)),
        LoadRow("guide", "N", own.guide.value, uniform.guide.value),
    ]


def _size(force: Vector) -> Array:
    size: Array = (force.x.value**2 + force.y.value**2) ** 0.5
    return size


def quasi_static_pictures(drive: Drive, rigid_torque_n_m: Array) -> dict[str, bytes]:
    """Driving torque beside the rigid level's, tooth force and how far the driven gear is ahead of the law."""
    loaded, motion = drive.loaded_contact, drive.motion
    rows = [
        TimeRow("driving torque", "N m", N_M_PER_N_MM * loaded.driving_torque_n_mm, rigid_torque_n_m),
        TimeRow("tooth force", "N", loaded.tooth_force_n),
        TimeRow("ahead of the law", "mrad", 1e3 * loaded.error_rad),
    ]
    title = f"{drive.design.name}: teeth under load at {drive.design.operation.speed_rpm:.4g} r/min"
    return {"loaded_contact.png": time_rows(motion.phi1_rad, rows, title, NOWHERE, ("teeth give way", "rigid"))}


def dynamic_pictures(drive: Drive, shown: History, apart_rad: Array) -> dict[str, bytes]:
    """Motion, teeth and bearings; the driving angles between which the teeth are apart have shape (k, 2)."""
    speed = f"at {drive.design.operation.speed_rpm:.4g} r/min"
    name = drive.design.name
    own, law = shown.slide, shown.law
    motion = [
        TimeRow("displacement", "mm", own.displacement_mm, law.displacement_mm),
        TimeRow("velocity", "mm/s", own.velocity_mm_s, law.velocity_mm_s),
        TimeRow("acceleration", "mm/s\u00b2", own.acceleration_mm_s2, law.acceleration_mm_s2),
    ]
    teeth = [
        TimeRow("pushing force", "N", shown.pushing_n),
        TimeRow("back force", "N", shown.back_n),
        TimeRow("driving torque", "N m", N_M_PER_N_MM * shown.torque_n_mm),
    ]
    names = {"wrist": "wrist", "pin": "crank pin", "crank_bearing": "crank bearing", "mesh": "mesh force"}
    bearings = [TimeRow(names[key], "N", force_size_n(force)) for key, force in joint_forces(shown).items()]
    return {
        "slider_motion.png": time_rows(shown.phi1_rad, motion, f"{name}: slider {speed}", apart_rad),
        "tooth_force.png": time_rows(shown.phi1_rad, teeth, f"{name}: teeth and torque {speed}", apart_rad),
        "bearing_forces.png": time_rows(shown.phi1_rad, bearings, f"{name}: bearings {speed}", apart_rad),
    }
