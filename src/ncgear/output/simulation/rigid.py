"""The rigid level's table, figures and pictures."""

from __future__ import annotations

from dataclasses import asdict
from math import atan2, degrees, hypot
from typing import Any

from ncgear.numerics.units import N_M_PER_N_MM
from ncgear.drive import Drive
from ncgear.dynamics.inverse import Loads
from ncgear.dynamics.level import Level
from ncgear.dynamics.rigid import Rigid
from ncgear.numerics.arrays import Array
from ncgear.numerics.extrema import Extremum
from ncgear.numerics.vector import Vector
from ncgear.output.simulation.rigid_pictures import rigid_pictures
from ncgear.output.simulation.simulated import Simulated

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
        **_components("wrist", loads.wrist),
        **_components("pin", loads.pin),
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
        **_peak("peak_wrist_force", "n", peaks.wrist_n),
        **_peak("peak_crank_pin_force", "n", peaks.pin_n),
        **_peak("peak_crank_bearing_force", "n", peaks.crank_bearing_n),
        **_peak("peak_guide_force", "n", peaks.guide_n),
    }


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
