"""What the teeth of a design bear: the torque of its machine; and how stiff its pairs of teeth are under it."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Literal

import numpy as np

from ncgear.dynamics.mesh_force import MeshPlace
from ncgear.dynamics.rigid import RigidMachine, refuse_locked
from ncgear.errors import NoSuchMechanism
from ncgear.kinematics.motion import Machine
from ncgear.mechanisms.masses import Masses
from ncgear.numerics.arrays import Array
from ncgear.strength.estimate import estimate_of
from ncgear.strength.material import Material
from ncgear.strength.method import ToothMethod
from ncgear.strength.stiffness import EvenTeeth, LinearTeeth
from ncgear.teeth.gear import ToothedGear, ToothedPair


@dataclass(frozen=True, eq=False)
class ToothLoad:
    """The machine whose torque the teeth bear at constant driving speed.

    ``load`` says what it counts: its masses with the resistance, or the resistance alone.
    """

    load: Literal["masses", "resistance"]
    machine: RigidMachine

    def torque_n_mm(self, phi1_rad: Array) -> Array:
        """Torque asked of the driven gear at driving angles in rad, shape (n,)."""
        return np.asarray(self.machine.at(phi1_rad).driven_torque.value)

    def peak_n(self, phi1_rad: Array) -> float:
        """Largest normal force of all pairs together at driving angles in rad, shape (n,)."""
        return float(np.abs(self.machine.at(phi1_rad).mesh_force.size_n.value).max())


def load_by_masses(machine: Machine, masses: Masses, place: MeshPlace | None) -> ToothLoad:
    """The load of the masses with the resistance; raises as ``load_by_resistance`` does."""
    rigid = RigidMachine(machine, masses, place)
    refuse_locked(rigid)
    return ToothLoad("masses", rigid)


def load_by_resistance(machine: Machine, place: MeshPlace) -> ToothLoad:
    """The load of the resistance alone; raises NoSuchMechanism where teeth cannot hold it."""
    rigid = RigidMachine(machine, machine.linkage.MASSES(), place)
    refuse_locked(rigid)
    return ToothLoad("resistance", rigid)


LIGHTEST_N_MM = 1.0
"""Load per mm of face width at which contacts are taken to be flattened where the teeth bear less: next to nothing."""


def linear_teeth(
    load: ToothLoad,
    phi1_rad: Array,
    teeth: ToothedPair,
    face_width_mm: float,
    methods: tuple[ToothMethod, ToothMethod],
    materials: tuple[Material, Material],
) -> LinearTeeth:
    """The stiffness of pairs of teeth by methods for the driving and the driven gear, at their largest load.

    That load is looked for at driving angles in rad, shape (n,).
    """
    line_load = max(load.peak_n(phi1_rad) / face_width_mm, LIGHTEST_N_MM)
    return LinearTeeth(teeth, methods, materials, face_width_mm, line_load)


def estimated(gear: ToothedGear, material: Material) -> ToothMethod:
    """The estimate of the teeth of a gear; where it does not reach, for want of a fillet, teeth that are all alike."""
    try:
        return estimate_of(gear, material)
    except NoSuchMechanism:
        return EvenTeeth(material.youngs_modulus_mpa)
