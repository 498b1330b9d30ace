"""The dynamic level's table, figures and pictures."""

from __future__ import annotations

from typing import Any

import numpy as np

from ncgear.numerics.units import N_M_PER_N_MM
from ncgear.drive import Drive
from ncgear.dynamics.history import History, history, parted_s
from ncgear.dynamics.level import Level
from ncgear.numerics.arrays import Array
from ncgear.numerics.vector import Vector
from ncgear.output.plots.time_rows import TimeRow, time_rows
from ncgear.output.simulation.simulated import Simulated


def dynamic_simulation(drive: Drive) -> Simulated:
    """The motion of a drive in time, beside its law."""
    course, rigid = drive.course, drive.rigid.machine
    assert rigid.place is not None
    shown = history(course, rigid, rigid.place)
    apart = parted_s(course)
    return Simulated(_table(shown), _figures(drive, shown, apart), _pictures(drive, shown, apart))


def _table(shown: History) -> dict[str, Array]:
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
    return {"wrist": joints.wrist, "pin": joints.pin, "crank_bearing": shown.crank_bearing, "mesh": shown.mesh}


def _figures(drive: Drive, shown: History, apart_s: Array) -> dict[str, Any]:
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
        "bearings": {f"peak_{name}_force_n": _largest(_size(force)) for name, force in _joints(shown).items()},
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


def _size(force: Vector) -> Array:
    size: Array = np.hypot(force.x, force.y)
    return size


def _pictures(drive: Drive, shown: History, apart_s: Array) -> dict[str, bytes]:
    apart = np.stack([drive.course.at(ends)[0] for ends in apart_s.T], axis=-1)
    speed = f"at {drive.design.operation.speed_rpm:.4g} r/min"
    name = drive.design.name
    return {
        "slider_motion.png": time_rows(shown.phi1_rad, _motion(shown), f"{name}: slider {speed}", apart),
        "tooth_force.png": time_rows(shown.phi1_rad, _forces(shown), f"{name}: teeth and torque {speed}", apart),
        "bearing_forces.png": time_rows(shown.phi1_rad, _bearings(shown), f"{name}: bearings {speed}", apart),
    }


def _motion(shown: History) -> list[TimeRow]:
    own, law = shown.slide, shown.law
    return [
        TimeRow("displacement", "mm", own.displacement_mm, law.displacement_mm),
        TimeRow("velocity", "mm/s", own.velocity_mm_s, law.velocity_mm_s),
        TimeRow("acceleration", "mm/s\u00b2", own.acceleration_mm_s2, law.acceleration_mm_s2),
    ]


def _forces(shown: History) -> list[TimeRow]:
    return [
        TimeRow("pushing force", "N", shown.pushing_n),
        TimeRow("back force", "N", shown.back_n),
        TimeRow("driving torque", "N m", N_M_PER_N_MM * shown.torque_n_mm),
    ]


def _bearings(shown: History) -> list[TimeRow]:
    names = {"wrist": "wrist", "pin": "crank pin", "crank_bearing": "crank bearing", "mesh": "mesh force"}
    return [TimeRow(names[key], "N", _size(force)) for key, force in _joints(shown).items()]
