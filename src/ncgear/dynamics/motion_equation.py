"""The toothed mechanism as a system of first order in time: two shafts that only their teeth join.

The state is (phi1, phi1', phi2, phi2', work of the drive, losses of the teeth); the last two are what an energy balance
needs, integrated along with the motion.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from ncgear.dynamics.crank_load import CrankLoad
from ncgear.dynamics.drive_line import DriveLine
from ncgear.dynamics.meshing import Meshing, ToothForces, TwoShafts
from ncgear.numerics.arrays import Array


@dataclass(frozen=True, eq=False)
class Answer:
    """Forces of the teeth, torque of the drive, and the accelerations of both shafts, in n states or in one."""

    teeth: ToothForces
    torque_n_mm: Array
    acceleration1_rad_s2: Array
    acceleration2_rad_s2: Array


@dataclass(frozen=True, eq=False)
class Mechanism:
    """What turns the driving gear, the teeth, and what the driven gear turns."""

    drive: DriveLine
    meshing: Meshing
    load: CrankLoad

    def change(self, _time_s: float, state: Array) -> Array:
        """Derivatives of a state by time, shape (6,)."""
        answer = self.answer(state)
        power, loss = answer.torque_n_mm * state[1], answer.teeth.loss_n_mm_s.sum(axis=-1)
        return np.array([state[1], answer.acceleration1_rad_s2, state[3], answer.acceleration2_rad_s2, power, loss])

    def answer(self, states: Array) -> Answer:
        """What moves and holds the shafts in states of shape (6,) or (6, n)."""
        teeth = self.meshing.forces(TwoShafts(*states[:4]))
        acceleration1, torque = self.drive.answer(states[1], teeth.driving_n_mm.sum(axis=-1))
        acceleration2 = self.load.acceleration_rad_s2(states[2], states[3], teeth.driven_n_mm.sum(axis=-1))
        return Answer(teeth, torque, acceleration1, acceleration2)

    def stored_n_mm(self, states: Array) -> Array:
        """Kinetic and elastic energy, and what resistance and weights have taken, in states of shape (6, n); (n,)."""
        depth = self.meshing.forces(TwoShafts(*states[:4])).depth_mm
        elastic = self.meshing.impact.energy_n_mm(depth).sum(axis=-1)
        driving = 0.5 * self.drive.inertia_n_mm_s2 * states[1] ** 2
        stored: Array = driving + self.load.energy_n_mm(states[2], states[3]) + elastic
        return stored
