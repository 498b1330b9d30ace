"""The load on the teeth of a pair of gears: the torque that the machine behind them asks for."""

from __future__ import annotations

from functools import cached_property, partial
from typing import TYPE_CHECKING

import numpy as np

from ncgear.dynamics.loaded_machine import RigidMachine
from ncgear.dynamics.mesh_force import MeshForce, MeshPlace, mesh_force
from ncgear.dynamics.rigid import refuse_locked_at
from ncgear.errors import WrongInput
from ncgear.frozen import dataclass
from ncgear.kinematics.motion import sample_angles
from ncgear.numerics.arrays import Array
from ncgear.numerics.highest import largest_of_each
from ncgear.numerics.jet import Jet
from ncgear.project.tooth_form import mesh_place
from ncgear.ratio.transmission import Pair

if TYPE_CHECKING:
    from ncgear.project.geared import Geared
    from ncgear.strength.answer import LoadBy


@dataclass(frozen=True, eq=False)
class ToothLoad:
    """The torque that a machine at constant driving speed asks of the driven gear of one of its pairs.

    ``load`` names its source: the machine's masses with the resistance, the resistance only, or only a jam.
    ``jam_n_mm`` is the jam's torque at the driving shaft; without a jam such teeth carry nothing.  ``place`` is the
    place of the pair's gears.  Angles are of the pair's own driving gear.

    A pair transmits the power that its driven gear's shaft takes; friction between the teeth is not counted.  Of pairs
    in series, ``number`` is the pair's place from 0 on; all but the last turn a shaft between, whose inertia the whole
    machine counts.
    """

    load: LoadBy
    machine: RigidMachine
    pair: Pair
    place: MeshPlace
    turns_crank: bool
    number: int = 0
    jam_n_mm: float | None = None

    def torque_n_mm(self, angle_rad: Array) -> Array:
        """Torque asked of the driven gear, shape (n,)."""
        loads = self.machine.at(self.pair.shaft_rad(angle_rad))
        if self.turns_crank:
            return loads.driven_torque.value
        # Without masses the shafts between take nothing, and their laws are left out.
        passed = loads.passed[min(self.number, len(loads.passed) - 1)]
        return self.passed_on_n_mm(passed.value, angle_rad)

    @property
    def loads_return(self) -> bool:
        """Whether the gears turn to and fro, less than once, and bear load on their way back."""
        open_range = self.pair.transmission.lobes.range is not None
        return open_range and self.machine.machine.load.loads_return

    def returning_n_mm(self, angle_rad: Array) -> Array:
        """Torque asked of the driven gear on the way back, positive as on the way out, shape (n,)."""
        return self.machine.coming_back(angle_rad).driven_torque.value

    def passed_on_n_mm(self, driving_n_mm: Array | float, angle_rad: Array) -> Array:
        """The torque on the driven gear from a torque on the machine's driving shaft, shape (n,)."""
        return np.asarray(driving_n_mm / (self.slope(angle_rad) * self.pair.speed(angle_rad)))

    @property
    def knocks_are_judged(self) -> bool:
        """Whether the loads of changing flanks are computed for this pair by itself, which needs masses.

        Two pairs in series are computed together (``ncgear.project.forces.train_borne_by``).
        """
        return self.load == "masses" and not self.machine.laws_before

    def mesh_force(self, angle_rad: Array, torque_n_mm: Array | None = None) -> MeshForce:
        """Normal force of all pairs of teeth together; ``torque_n_mm`` if it is known already."""
        torque = self.torque_n_mm(angle_rad) if torque_n_mm is None else torque_n_mm
        slope = self.pair.transmission.driven_angle(angle_rad, 2).differentiated()
        return mesh_force(self.place, slope, Jet(torque[None, :]))

    def slope(self, angle_rad: Array) -> Array:
        """The driven gear's angle by the driving gear's, shape (n,)."""
        return self.pair.transmission.driven_angle(angle_rad, 1).derivative(1)

    def arms_mm(self, angle_rad: Array, urge: Array) -> Array:
        """The arms of the mesh force about both axes, shape (n, 2).

        ``urge`` is +1 where pushing flanks carry, -1 where backs carry.
        """
        slope = self.slope(angle_rad)
        return np.stack([slope, np.ones(slope.shape)], axis=1) / self.mesh_force(angle_rad, urge).size_n.value[:, None]

    @cached_property
    def peak_n(self) -> float:
        """Largest normal force of all pairs of teeth together; the force of the jam if they have no other load."""

        def size_n(angle_rad: Array) -> Array:
            torque = self.torque_n_mm if self.jam_n_mm is None else partial(self.passed_on_n_mm, self.jam_n_mm)
            return np.abs(self.mesh_force(angle_rad, torque(angle_rad)).size_n.value).reshape(1, -1)

        (peak,) = largest_of_each(size_n, sample_angles(self.pair.transmission))
        return peak.value


def asked_of(drive: Geared) -> ToothLoad:
    """The load of a drive's pair of gears: from the masses, or without masses from the resistance only.

    Raises WrongInput where there is neither, nor a jam, and where there are two pairs and the drive has no stage.
    """
    pair, place, design = drive.pair, mesh_place(drive.gears, drive.pitch.center_distance_mm), drive.design
    of = drive.stage in (None, design.stages), (drive.stage or 1) - 1
    if design.masses is not None:
        return ToothLoad("masses", drive.loaded_machine(drive.machine), pair, place, *of)
    if design.resistance is None and design.strength.overload is None:
        raise WrongInput(
            "missing, and so are masses; the load of the teeth follows from the force against the slider, from the "
            "moving masses, or from both: give one of them",
            key="resistance",
        )
    machine = RigidMachine(drive.machine, drive.linkage.MASSES())
    jam = drive.conditions.overload
    if design.resistance is not None:
        found = ToothLoad("resistance", machine, pair, place, *of)
        # A resistance of zero everywhere leaves only the jam.
        if jam is None or np.any(found.torque_n_mm(sample_angles(pair.transmission))):
            return found
    return ToothLoad("jam", machine, pair, place, *of, None if jam is None else jam.driving_n_mm)


def tooth_load(drive: Geared) -> ToothLoad:
    """The load of the teeth of a drive's pair, as ``asked_of``; raises NoSuchMechanism where they cannot carry it."""
    found, pair = asked_of(drive), drive.pair
    # The pressure angle is also judged at its largest, where the curves lean most to either side.
    angle = np.append(sample_angles(pair.transmission), [extremum.at for extremum in drive.pitch.leanings])
    torque = found.torque_n_mm(angle)
    refuse_locked_at(angle, torque, found.mesh_force(angle, torque).pressure_angle_rad.value)
    return found
