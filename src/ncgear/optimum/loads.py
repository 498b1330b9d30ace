"""The loads of a machine with all its masses at places of the crank, for any motion of the crank.

Let phi2 be the crank's angle, s = dphi2/dphi1, q = s^2, primes by phi2 and w the driving shaft's constant speed.  The
crank turns with the speed w s, and its acceleration is w^2 s s' = w^2 q'/2.  The acceleration of every point of a
mechanism is linear in the square of the crank's speed and in its acceleration, and so is every force of Newton's and
Euler's equations (``ncgear.mechanisms.forces``):

    force = static + w^2 (by_q q + by_rate q'/2)

The static part holds resistance and weights.  The three columns follow from the mechanism's own equations, solved at
rest, at unit speed and at unit acceleration of the crank.  So every size or bound of such a force is convex in q.  The
kinetic energy of all that moves with the crank is J(phi2) w^2 q / 2, and the crank's torque is

    M2 = static + w^2 (J' q + J q') / 2

(Eksergian's equation, see ``ncgear.dynamics.crank_load``).  Units: N, N mm, kg mm^2, rad/s.
"""

from __future__ import annotations

from collections.abc import Callable, Mapping
from dataclasses import replace

import numpy as np

from ncgear.dynamics.crank_load import reduced_inertia
from ncgear.frozen import dataclass
from ncgear.mechanisms.forces import CrankPace, JointForces, Masses, shaking_force
from ncgear.mechanisms.mechanism import Mechanism
from ncgear.numerics.arrays import Array
from ncgear.numerics.jet import Jet
from ncgear.numerics.plane import Term, Vector


@dataclass(frozen=True, eq=False)
class Affine:
    """A force or torque at n places: static + w^2 (by_q q + by_rate q'/2).

    The three arrays have the same shape: (n,), or (n, 2) for the components along and across the slider's line.
    ``static`` is in N (or N mm), ``by_q`` and ``by_rate`` in N s^2 (or N mm s^2).
    """

    static: Array
    by_q: Array
    by_rate: Array

    @property
    def columns(self) -> tuple[Array, Array, Array]:
        """The three arrays."""
        return self.static, self.by_q, self.by_rate

    def component(self, axis: int) -> tuple[Array, Array, Array]:
        """The three arrays of a component, shape (n,): 0 along the slider's line, 1 across it."""
        return self.static[:, axis], self.by_q[:, axis], self.by_rate[:, axis]

    def at(self, q: Array, rate: Array, speed_rad_s: float) -> Array:
        """The values, of the arrays' shape, for q and its derivative ``rate`` = dq/dphi2, shape (n,) each."""
        shape = (-1,) + (1,) * (self.static.ndim - 1)
        moving = self.by_q * q.reshape(shape) + self.by_rate * (rate.reshape(shape) / 2.0)
        return self.static + speed_rad_s**2 * moving


@dataclass(frozen=True, eq=False)
class MachineLoads:
    """The loads of a machine at n crank angles.

    ``torque_n_mm`` is the torque on the driven gear in the sense of the crank's turning.  ``bearing_n`` is the force
    that the crank's bearings and the teeth together exert on the crank; without teeth, the force of the bearings alone.
    ``joints_n`` are the forces between the bodies by the mechanism's names, ``guide_n`` presses on the slider across
    its line.  ``shaking_n`` is the force of the moving masses on the frame, without weights and resistance.
    ``inertia_kg_mm2`` is J, with all that turns with the crank, and ``inertia_slope_kg_mm2`` is dJ/dphi2.
    """

    crank_angle_rad: Array
    torque_n_mm: Affine
    bearing_n: Affine
    joints_n: Mapping[str, Affine]
    guide_n: Affine
    shaking_n: Affine
    inertia_kg_mm2: Array
    inertia_slope_kg_mm2: Array


REST, UNIT_SPEED, UNIT_ACCELERATION = (0.0, 0.0), (1.0, 0.0), (0.0, 1.0)
"""Speeds in rad/s and accelerations in rad/s^2 of the crank for the three columns."""


def machine_loads(mechanism: Mechanism, masses: Masses, crank_angle_rad: Array, resistance_n: Array) -> MachineLoads:
    """The loads at crank angles in rad, where a resistance in N acts on the slider along -x; shape (n,) each.

    ``masses`` are of the mechanism's class ``MASSES``.  At a dead centre, where the resistance jumps, the given
    resistance decides the side.
    """
    angle = Jet.variable(crank_angle_rad, 2)
    weightless = replace(masses, gravity_m_s2=(0.0, 0.0))
    motions = (REST, UNIT_SPEED, UNIT_ACCELERATION)
    paces = [CrankPace(*(np.full(crank_angle_rad.size, component) for component in motion)) for motion in motions]
    forces = [
        mechanism.joint_forces(angle, masses, paces[0], resistance_n),
        *(mechanism.joint_forces(angle, weightless, pace, np.zeros_like(resistance_n)) for pace in paces[1:]),
    ]

    def affine(of: Callable[[JointForces], Term]) -> Affine:
        return Affine(*(_column(of(force), crank_angle_rad.size) for force in forces))

    moving = mechanism.moving_masses(angle, masses)
    crank = mechanism.crank_body(angle, masses.crank_center_mm)
    shaking = Affine(*(_column(shaking_force(moving, crank, masses, pace), crank_angle_rad.size) for pace in paces))
    inertia, slope = reduced_inertia(moving, masses)
    return MachineLoads(
        crank_angle_rad,
        torque_n_mm=affine(lambda load: load.torque_n_mm),
        bearing_n=affine(lambda load: load.crank_axis),
        joints_n={name: affine(_joint(name)) for name in mechanism.JOINTS},
        guide_n=affine(lambda load: load.guide_n),
        shaking_n=shaking,
        inertia_kg_mm2=inertia,
        inertia_slope_kg_mm2=slope,
    )


def _joint(name: str) -> Callable[[JointForces], Vector]:
    return lambda forces: forces.joints[name]


def _column(term: Term, count: int) -> Array:
    """Values of shape (count,), or (count, 2) for a vector, even where a mechanism gives a plain number."""
    if isinstance(term, Vector):
        return np.stack([np.broadcast_to(coordinate, count) for coordinate in (term.x, term.y)], axis=-1)
    return np.array(np.broadcast_to(term, count), dtype=float)
