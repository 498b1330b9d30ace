"""The forces in a machine with knocking teeth: in joints, bearings and shafts, from the torque that the teeth bear.

Where the teeth turn the driven side by M instead of the law's torque T, the acceleration of that side, of inertia J
about its shaft, exceeds the law's by (M - T) / J.  All moving bodies follow it by the equations of Newton and Euler, so
that the forces are those of ``ncgear.dynamics.loaded_machine`` with another acceleration.  J is the crank's reduced
inertia (``ncgear.dynamics.crank_load``).  The slider's deviations of place and speed from the law, and the effect of a
knock on the guide's friction, are left out: both are small against M - T.
"""

from __future__ import annotations

from collections.abc import Sequence
from typing import TYPE_CHECKING

import numpy as np

from ncgear.dynamics.crank_load import reduced_inertia
from ncgear.dynamics.loaded_machine import Loads, RigidMachine
from ncgear.dynamics.rigid import LoadPeaks, searched_peaks
from ncgear.frozen import dataclass
from ncgear.numerics.arrays import Array
from ncgear.numerics.jet import Jet
from ncgear.numerics.units import N_PER_KG_MM_S2
from ncgear.ratio.transmission import Pair

if TYPE_CHECKING:
    from ncgear.dynamics.flank_changes import BorneTorque


def hurried_loads(rigid: RigidMachine, phi1_rad: Array, beyond_n_mm: Array, borne_n_mm: Sequence[Array] = ()) -> Loads:
    """The loads at driving angles in rad where teeth bear a torque M - T beyond the law's, shape (n,) each.

    Of pairs in series, M is the torque of the last, and ``borne_n_mm`` are those on the driven gears before it.

    Without inertia no torque accelerates anything, and the loads are those of the law.
    """
    machine, masses = rigid.machine, rigid.masses
    angle = Jet.variable(machine.transmission.driven_angle(phi1_rad, 0).value, 2)
    inertia = N_PER_KG_MM_S2 * reduced_inertia(machine.linkage.moving_masses(angle, masses), masses)[0]
    hurried = np.zeros_like(beyond_n_mm)
    np.divide(beyond_n_mm, inertia * machine.speed_rad_s**2, out=hurried, where=inertia > 0.0)
    return rigid.at(phi1_rad, hurried, borne_n_mm)


@dataclass(frozen=True, eq=False)
class KnockingMachine:
    """A machine at constant driving speed whose teeth bear torques other than the law's.

    ``pairs`` are the laws of its pairs, from the driving shaft on, with the torques ``borne`` at their own angles.
    """

    rigid: RigidMachine
    pairs: tuple[Pair, ...]
    borne: tuple[BorneTorque, ...]

    def at(self, phi1_rad: Array) -> Loads:
        """The loads at driving angles in rad, shape (n,)."""
        *before, last = zip(self.borne, self.rigid.angles(phi1_rad, 0), strict=False)
        beyond = last[0].beyond(last[1].value)
        return hurried_loads(self.rigid, phi1_rad, beyond, [pair.turning(turned.value) for pair, turned in before])

    @property
    def turns_rad(self) -> Array:
        """Driving angles of a cycle at which a swing of the teeth's torque reverses, shape (n,), rising."""
        found = []
        for pair, whole in zip(self.pairs, self.borne, strict=True):
            for borne in (whole, *whole.others):
                torque = borne.turning_n_mm
                rising = np.sign(np.diff(torque))
                turns = np.flatnonzero(rising[1:] != rising[:-1]) + 1
                own_rad = borne.phi1_rad[turns[np.isfinite(torque[turns])]] % borne.cycle_rad
                found.append(pair.shaft_rad(own_rad))
        return np.unique(np.concatenate(found))

    def peaks(self, places_rad: Array) -> LoadPeaks:
        """The largest forces of a cycle, searched between ``places_rad`` (shape (n,)) and the reversals of swings."""
        return searched_peaks(self.at, self.rigid.machine.linkage, np.union1d(places_rad, self.turns_rad))
