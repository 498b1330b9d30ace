"""The quasi-static level's table, figures and pictures."""

from __future__ import annotations

from typing import Any

import numpy as np

from ncgear.numerics.units import N_M_PER_N_MM
from ncgear.drive import Drive
from ncgear.dynamics.level import Level
from ncgear.numerics.arrays import Array
from ncgear.output.plots.time_rows import TimeRow, time_rows
from ncgear.output.simulation.simulated import Simulated

NOWHERE = np.empty((0, 2))


def quasi_static_simulation(drive: Drive) -> Simulated:
    """Loaded contact of a drive's teeth, beside the torque of the rigid level."""
    rigid = N_M_PER_N_MM * drive.rigid.machine.at(drive.motion.phi1_rad).driving_torque.value
    return Simulated(_table(drive, rigid), _figures(drive), {"loaded_contact.png": _picture(drive, rigid)})


def _table(drive: Drive, rigid_n_m: Array) -> dict[str, Array]:
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


def _figures(drive: Drive) -> dict[str, Any]:
    loaded, design = drive.loaded_contact, drive.design
    return {
        "design": {"name": design.name, "description": design.description, "level": Level.QUASI_STATIC.value},
        "drive": {"speed_rpm": design.operation.speed_rpm},
        "loaded_contact": {
            "contact_stiffness_n": drive.meshing.impact.stiffness,
            "transmission_error_rad": loaded.transmission_error_rad,
            **_peak(drive, "peak_tooth_force_n", loaded.tooth_force_n),
            **_peak(drive, "peak_depth_mm", loaded.forces.depth_mm.max(axis=-1)),
            **_peak(drive, "peak_driving_torque_n_m", N_M_PER_N_MM * loaded.driving_torque_n_mm),
            "most_pairs": int(loaded.pairs.max()),
        },
    }


def _peak(drive: Drive, key: str, values: Array) -> dict[str, float]:
    place = int(np.argmax(values))
    name = key.rsplit("_n_m", 1)[0] if key.endswith("_n_m") else key.rsplit("_", 1)[0]
    return {key: float(values[place]), f"{name}_at_rad": float(drive.motion.phi1_rad[place])}


def _picture(drive: Drive, rigid_n_m: Array) -> bytes:
    loaded, motion = drive.loaded_contact, drive.motion
    rows = [
        TimeRow("driving torque", "N m", N_M_PER_N_MM * loaded.driving_torque_n_mm, rigid_n_m),
        TimeRow("tooth force", "N", loaded.tooth_force_n),
        TimeRow("ahead of the law", "mrad", 1e3 * loaded.error_rad),
    ]
    title = f"{drive.design.name}: teeth under load at {drive.design.operation.speed_rpm:.4g} r/min"
    return time_rows(motion.phi1_rad, rows, title, NOWHERE, ("teeth give way", "rigid"))
