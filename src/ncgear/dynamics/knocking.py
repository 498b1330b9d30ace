"""The forces in a machine with knocking teeth: in joints, bearings and shafts, from the torque that the teeth bear.

Where the teeth turn the driven side by M instead of the law's torque T, the acceleration of that side, of inertia J
about its shaft, exceeds the law's by (M - T) / J.  All moving bodies follow it by the equations of Newton and Euler, so
that the forces are those of ``ncgear.dynamics.loaded_machine`` with another acceleration.  J is the crank's reduced
inertia (``ncgear.dynamics.crank_load``).  The slider's deviations of place and speed from the law, and the effect of a
knock on the guide's friction, are left out: both are small against M - T.
"""

from __future__ import annotations

from typing import TYPE_CHECKING

import numpy as np

from ncgear.dynamics.crank_load import reduced_inertia
from ncgear.dynamics.loaded_machine import Loads, RigidMachine
from ncgear.dynamics.rigid import LoadPeaks, MeshPeak
from ncgear.frozen import dataclass
from ncgear.numerics.arrays import Array
from ncgear.numerics.extrema import Extremum
from ncgear.numerics.highest import largest_of_each
from ncgear.numerics.jet import Jet
from ncgear.numerics.plane import Vector
from ncgear.numerics.units import N_PER_KG_MM_S2

if TYPE_CHECKING:
    from ncgear.dynamics.flank_changes import BorneTorque


def hurried_loads(rigid: RigidMachine, phi1_rad: Array, beyond_n_mm: Array) -> Loads:
    """The loads at driving angles in rad where teeth bear a torque M - T beyond the law's, shape (n,) each.

    Without inertia no torque accelerates anything, and the loads are those of the law.
    """
    machine, masses = rigid.machine, rigid.masses
    angle = Jet.variable(machine.transmission.driven_angle(phi1_rad, 0).value, 2)
    inertia = N_PER_KG_MM_S2 * reduced_inertia(machine.linkage.moving_masses(angle, masses), masses)[0]
    hurried = np.zeros_like(beyond_n_mm)
    np.divide(beyond_n_mm, inertia * machine.speed_rad_s**2, out=hurried, where=inertia > 0.0)
    return rigid.at(phi1_rad, hurried)


@dataclass(frozen=True, eq=False)
class KnockingMachine:
    """A machine at constant driving speed whose teeth bear ``borne`` instead of the law's torque."""

    rigid: RigidMachine
    borne: BorneTorque

    def at(self, phi1_rad: Array) -> Loads:
        """The loads at driving angles in rad, shape (n,)."""
        return hurried_loads(self.rigid, phi1_rad, self.borne.turning(phi1_rad) - self.borne.asked(phi1_rad))

    @property
    def turns_rad(self) -> Array:
        """Driving angles of a cycle at which a swing of the teeth's torque reverses, shape (n,), rising."""
        found = []
        for borne in (self.borne, *self.borne.others):
            torque = borne.turning_n_mm
            rising = np.sign(np.diff(torque))
            turns = np.flatnonzero(rising[1:] != rising[:-1]) + 1
            found.append(borne.phi1_rad[turns[np.isfinite(torque[turns])]] % borne.cycle_rad)
        return np.unique(np.concatenate(found))

    def peaks(self, places_rad: Array) -> LoadPeaks:
        """The largest forces of a cycle, searched between ``places_rad`` (shape (n,)) and the reversals of swings."""
        linkage = self.rigid.machine.linkage

        def sizes(phi1: Array) -> Array:
            loads = self.at(phi1)
            vectors = [*(loads.joints[name] for name in linkage.JOINTS), loads.crank_bearing, loads.mesh_force.force]
            return np.stack([*(_size_n(vector) for vector in vectors), np.abs(loads.guide.value)])

        *joints, bearing, mesh, guide = largest_of_each(sizes, np.union1d(places_rad, self.turns_rad))
        steep = self.at(np.array([mesh.at])).mesh_force.pressure_angle_rad.value
        return LoadPeaks(
            dict[str, Extremum](zip(linkage.JOINTS, joints, strict=True)),
            bearing,
            guide,
            MeshPeak(mesh, float(steep[0])),
        )


def _size_n(force: Vector) -> Array:
    return np.asarray(np.hypot(force.x.value, force.y.value))
