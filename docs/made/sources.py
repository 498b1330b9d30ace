"""Where each figure of the loaded machine comes from: one function each, whichever command tells it.

``docs/figures.md`` is made from this list, and tests/test_one_machine.py holds what every command tells against it.
"""

from __future__ import annotations

from collections.abc import Callable, Mapping
from typing import Any

from ncgear.dynamics.driving_shaft import DrivingShaft, Fluctuation
from ncgear.dynamics.rigid import Rigid, load_peaks
from ncgear.frozen import dataclass
from ncgear.kinematics.check import KinematicCheck, kinematic_check
from ncgear.mechanisms.forces import Masses
from ncgear.numerics.units import KG_M2
from ncgear.project.drive import Drive
from ncgear.project.moving import train_inertia


@dataclass(frozen=True, eq=False)
class LoadedMachine:
    """The machine of a drive, or of its uniform crank with the same masses; values are computed when asked for."""

    drive: Drive
    uniform: bool = False

    @property
    def check(self) -> KinematicCheck:
        """Its peaks."""
        return self.drive.uniform_check if self.uniform else self.drive.check

    @property
    def driving(self) -> DrivingShaft:
        """What its driving shaft is asked for."""
        return self.drive.uniform_driving if self.uniform else self.drive.driving

    @property
    def rigid(self) -> Rigid:
        """The forces in it."""
        return self.drive.uniform_rigid if self.uniform else self.drive.rigid

    @property
    def masses(self) -> Masses:
        """Its masses."""
        return self.drive.masses

    @property
    def speed_fluctuation(self) -> float:
        """The coefficient for which a flywheel is told."""
        given = self.drive.design.masses
        assert given is not None
        return given.flywheel.speed_fluctuation

    @property
    def mesh_n(self) -> float:
        """The largest force between its teeth."""
        mesh = self.rigid.peaks.mesh
        assert mesh is not None
        return mesh.force_n.value


@dataclass(frozen=True, eq=False)
class Source:
    """The function or property that computes a figure, and the figure of a machine in the unit of its key."""

    function: Any
    of: Callable[[LoadedMachine], float]

    @property
    def name(self) -> str:
        """The function's name with its module, as in ``dynamics.driving_shaft.DrivingShaft.peak_power_w``."""
        made: Any = self.function.fget if isinstance(self.function, property) else self.function
        return f"{made.__module__.removeprefix('ncgear.')}.{made.__qualname__}"


SOURCES: Mapping[str, Source] = {
    "peak_power_w": Source(DrivingShaft.peak_power_w, lambda one: one.check.peak_power_w.value),
    "peak_power_resistance_w": Source(kinematic_check, lambda one: one.check.peak_power_resistance_w.value),
    "braking_power_w": Source(DrivingShaft.braking_power_w, lambda one: one.driving.braking_power_w.value),
    "mean_power_w": Source(DrivingShaft.mean_power_w, lambda one: one.check.mean_power_w),
    "rms_torque_n_m": Source(DrivingShaft.rms_torque_n_m, lambda one: one.driving.rms_torque_n_m),
    "energy_swing_j": Source(DrivingShaft.energy_swing_j, lambda one: one.driving.energy_swing_j),
    "inertia_for_speed_fluctuation_kg_m2": Source(
        Fluctuation.flywheel_kg_mm2,
        lambda one: KG_M2 * one.driving.fluctuation.flywheel_kg_mm2(one.speed_fluctuation),
    ),
    "peak_speed": Source(kinematic_check, lambda one: one.check.peak_speed.value),
    "peak_acceleration_working": Source(kinematic_check, lambda one: one.check.peak_acceleration_working.value),
    "peak_acceleration_cycle": Source(kinematic_check, lambda one: one.check.peak_acceleration_cycle.value),
    "peak_mesh_force_n": Source(load_peaks, lambda one: one.mesh_n),
    "peak_crank_bearing_force_n": Source(load_peaks, lambda one: one.rigid.peaks.crank_bearing_n.value),
    "driven_gear_kg_mm2": Source(train_inertia, lambda one: one.masses.driven_inertia_kg_mm2),
}
"""By key without the unit of the output, where that is mm/s or rad/s.

Without masses the powers are those of the resistance alone, from ``kinematic_check``.
"""
