"""Inverse dynamics: the forces and the driving torque that a motion at constant driving speed needs.

Closed forms throughout: the law gives the crank's angle with its derivatives, Newton and Euler the forces in the
joints, the pitch curves the force between the teeth.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from ncgear.dynamics.joints import joint_forces
from ncgear.dynamics.mesh_force import MeshForce, MeshPlace, mesh_force
from ncgear.dynamics.pace import EvenPace
from ncgear.kinematics.bodies import bodies
from ncgear.kinematics.slider import Machine
from ncgear.kinematics.stretches import Stretch, angles_at
from ncgear.machine.masses import Masses
from ncgear.numerics.arrays import Array, Mask
from ncgear.numerics.jet import Jet
from ncgear.numerics.vector import Vector


@dataclass(frozen=True, eq=False)
class Loads:
    """What a motion needs, as jets by the driving angle; forces in N, torques in N mm.

    ``driving_torque`` is asked of the driving shaft, ``driven_torque`` of the driven gear.  ``wrist`` acts on the
    slider, ``pin`` on the rod, ``crank_bearing`` on the crank shaft, ``guide`` on the slider across its line, the mesh
    force on the driven gear.  The driving shaft's bearings bear the mesh force as it is: ``mesh`` too is what they
    exert.  Without gears (``mesh`` None) the crank's bearing holds the linkage alone.
    """

    driving_torque: Jet
    driven_torque: Jet
    wrist: Vector
    pin: Vector
    crank_bearing: Vector
    guide: Jet
    mesh: MeshForce | None

    @property
    def gripped(self) -> MeshForce:
        """The mesh force of a machine that has gears."""
        assert self.mesh is not None
        return self.mesh


@dataclass(frozen=True, eq=False)
class RigidMachine:
    """A machine at constant driving speed with its moving masses, and how its gears lie; None where it has none."""

    machine: Machine
    masses: Masses
    place: MeshPlace | None = None

    def loads(self, driven_angle: Jet, resistance_n: Jet) -> Loads:
        """The loads where the crank's angle is a jet by the driving angle; of two orders less, as the resistance is."""
        at = bodies(self.machine.linkage, driven_angle)
        joints = joint_forces(at, self.masses, EvenPace(self.machine.speed_rad_s), resistance_n)
        slope, torque = driven_angle.differentiated(), joints.torque_n_mm
        mesh = None if self.place is None else mesh_force(self.place, slope, torque)
        return Loads(
            driving_torque=slope.truncated(torque.order) * torque,
            driven_torque=torque,
            wrist=joints.wrist,
            pin=joints.pin,
            crank_bearing=joints.crank_axis if mesh is None else joints.crank_axis - mesh.force,
            guide=joints.guide_n,
            mesh=mesh,
        )

    def at(self, phi1: Array) -> Loads:
        """The loads at driving angles in rad, shape (n,); right-hand limits at joints of the law."""
        driven = self.machine.transmission.driven_angle(phi1, 2)
        return self.loads(driven, self._resistance_n(driven.truncated(0), self.machine.working(driven.value)))

    def on(self, stretch: Stretch, phi1: Array) -> Loads:
        """The loads with their slopes at driving angles on a stretch, shape (n,); one-sided at its ends."""
        driven = stretch.driven_angle(phi1, 3)
        return self.loads(driven, self._resistance_n(driven.truncated(1), np.full(phi1.shape, stretch.working)))

    def breaks(self, stretch: Stretch) -> Array:
        """Driving angles of a stretch, both ends included, between which the loads are smooth, and the resistance
        monotone besides."""
        resistance, stroke = self.machine.resistance, self.machine.linkage.stroke_mm
        places = np.union1d(resistance.turns_mm(stroke), resistance.zeros_mm(stroke))
        passed = angles_at(stretch, places) if stretch.working else np.empty(0)
        return np.unique([stretch.start_rad, *stretch.knots_rad, *passed, stretch.end_rad])

    def _resistance_n(self, driven_angle: Jet, working: Mask) -> Jet:
        resistance = self.machine.resistance
        force = resistance.fitted_n(self.machine.linkage.displacement(driven_angle))
        pressing = working & (resistance.keep_negative | (force.value > 0.0))
        return Jet(np.where(pressing, force.coefficients, 0.0))
