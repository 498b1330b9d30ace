"""The pictures of the rigid level."""

from __future__ import annotations

import numpy as np

from ncgear.numerics.units import N_M_PER_N_MM
from ncgear.drive import Drive
from ncgear.dynamics.inverse import Loads
from ncgear.numerics.arrays import Array
from ncgear.numerics.vector import Vector
from ncgear.output.joints import joints_up_to
from ncgear.output.plots.loads import LoadRow, load_curves


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
