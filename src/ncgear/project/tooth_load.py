"""What the teeth of a pair of gears bear: the torque that the machine behind them asks for."""

from __future__ import annotations

from typing import Literal

import numpy as np

from ncgear.dynamics.mesh_force import MeshForce, MeshPlace, mesh_force
from ncgear.dynamics.rigid import RigidMachine, refuse_locked_at
from ncgear.frozen import dataclass
from ncgear.kinematics.motion import Machine, sample_angles
from ncgear.mechanisms.masses import Masses
from ncgear.numerics.arrays import Array
from ncgear.numerics.jet import Jet
from ncgear.pitch.shape import tangent_slope
from ncgear.ratio.transmission import Pair


@dataclass(frozen=True, eq=False)
class ToothLoad:
    """The torque that a machine at constant driving speed asks of the driven gear of one of its pairs.

    ``load`` says what it counts: the machine's masses with the resistance, or the resistance alone.  ``place`` is how
    the pair's gears lie.  Angles are those of the pair's own driving gear.

    Without friction a pair passes on the power that the driving shaft takes in, so that its torque is the driving
    shaft's times the driving shaft's speed over that of the pair's driven gear.  The inertia of a shaft between two
    pairs, of which a design says nothing, is not counted.
    """

    load: Literal["masses", "resistance"]
    machine: RigidMachine
    pair: Pair
    place: MeshPlace

    def torque_n_mm(self, angle_rad: Array) -> Array:
        """Torque asked of the driven gear, shape (n,)."""
        driven_speed = self.pair.transmission.driven_angle(angle_rad, 1).derivative(1) * self.pair.speed(angle_rad)
        return np.asarray(self.machine.at(self.pair.shaft_rad(angle_rad)).driving_torque.value / driven_speed)

    def mesh_force(self, angle_rad: Array) -> MeshForce:
        """Normal force of all pairs of teeth together."""
        slope = self.pair.transmission.driven_angle(angle_rad, 2).differentiated()
        return mesh_force(self.place, slope, Jet(self.torque_n_mm(angle_rad)[None, :]))

    @property
    def peak_n(self) -> float:
        """Largest normal force of all pairs of teeth together, over evenly spread angles."""
        return float(np.abs(self.mesh_force(sample_angles(self.pair.transmission)).size_n.value).max())


def tooth_load(
    load: Literal["masses", "resistance"], machine: Machine, masses: Masses, pair: Pair, place: MeshPlace
) -> ToothLoad:
    """The load of the teeth of a pair of the machine; raises NoSuchMechanism where they cannot hold it."""
    found = ToothLoad(load, RigidMachine(machine, masses), pair, place)
    # The pressure angle is judged where it is largest, too, which is where the curves lean most, either way.
    leaning = pair.transmission.extremes(lambda slope: tangent_slope(slope, place.mesh), 1)
    angle = np.append(sample_angles(pair.transmission), [extremum.at for extremum in leaning])
    refuse_locked_at(angle, found.torque_n_mm(angle), found.mesh_force(angle).pressure_angle_rad.value)
    return found
