"""What a motion in time shows: the slider beside its ideal law, forces of the teeth, torque, and loss of contact."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from ncgear.dynamics.meshing import force_on_driven
from ncgear.dynamics.motion_in_time import Course, pressed_rad
from ncgear.dynamics.rigid import RigidMachine
from ncgear.mechanisms.forces import CrankPace, JointForces
from ncgear.numerics.arrays import Array
from ncgear.numerics.jet import Jet
from ncgear.numerics.plane import Vector

PER_TURN = 2000
"""Samples in a turn of the driving gear."""


@dataclass(frozen=True, eq=False)
class Slide:
    """The slider's displacement in mm, velocity in mm/s and acceleration in mm/s^2, shape (n,) each."""

    displacement_mm: Array
    velocity_mm_s: Array
    acceleration_mm_s2: Array


@dataclass(frozen=True, eq=False)
class History:
    """A motion at n even times, shape (n,) each.

    ``slide`` is the slider's motion, ``law`` the one it would have on the law at the machine's speed;
    ``error_rad`` is the driven angle beyond the law's.  ``pushing_n`` and ``back_n`` are the largest normal forces of
    any pair on either side of the teeth, ``torque_n_mm`` is the drive's.  ``joints`` are the forces in the mechanism,
    ``mesh`` is the force of all teeth on the driven gear; the driving shaft's bearings exert the same force.
    """

    time_s: Array
    phi1_rad: Array
    phi2_rad: Array
    error_rad: Array
    slide: Slide
    law: Slide
    pushing_n: Array
    back_n: Array
    torque_n_mm: Array
    joints: JointForces
    mesh: Vector

    @property
    def crank_bearing(self) -> Vector:
        """Force of its bearing on the crank shaft in N."""
        return self.joints.crank_axis - self.mesh


def history(course: Course, rigid: RigidMachine, per_turn: int = PER_TURN) -> History:
    """The motion at even times, ``per_turn`` in each turn; the course must be one of this machine, which has gears."""
    toothed = course.machine
    assert rigid.place is not None
    turns = float(course.states[0, -1] - course.states[0, 0]) / (2.0 * np.pi)
    time_s = np.linspace(0.0, float(course.time_s[-1]), max(2, round(per_turn * turns) + 1))
    states = course.at(time_s)
    answer = toothed.answer(states)
    phi1, _, phi2, speed2 = states[:4]
    ratio = toothed.meshing.law.at(phi1)[1]
    linkage, law = rigid.machine.linkage, rigid.machine.motion(phi1)
    urge, normal = answer.teeth.near.urge, answer.teeth.normal_n
    return History(
        time_s,
        phi1,
        phi2,
        phi2 - toothed.meshing.law.at(phi1)[0],
        _slide(linkage.displacement(Jet.variable(phi2, 2)), speed2, answer.acceleration2_rad_s2),
        Slide(law.displacement_mm, law.velocity_mm_s, law.acceleration_mm_s2),
        np.where(urge > 0.0, normal, 0.0).max(axis=-1),
        np.where(urge < 0.0, normal, 0.0).max(axis=-1),
        answer.torque_n_mm,
        rigid.joints(phi2, CrankPace(speed2, answer.acceleration2_rad_s2)),
        force_on_driven(answer.teeth, ratio, rigid.place),
    )


def parted_s(course: Course) -> Array:
    """Starts and ends of the times at which no pushing flanks touch, shape (k, 2)."""
    edges = np.unique(np.concatenate([[0.0], course.pushing_s, course.time_s[-1:]]))
    states = course.at((edges[1:] + edges[:-1]) / 2.0)
    apart = pressed_rad(course.machine.meshing, states) <= 0.0
    return np.column_stack([edges[:-1][apart], edges[1:][apart]])


def _slide(displacement: Jet, speed_rad_s: Array, acceleration_rad_s2: Array) -> Slide:
    """The slider's motion, from its displacement as a jet by an angle, and the angle's speed and acceleration."""
    slope, bend = displacement.derivative(1), displacement.derivative(2)
    return Slide(displacement.value, slope * speed_rad_s, bend * speed_rad_s**2 + slope * acceleration_rad_s2)
