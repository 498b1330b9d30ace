"""The rigid level: the peaks of all forces in a loaded machine at constant driving speed.

Gears whose carrying flanks cannot hold the torque, because their pressure angle reaches 90 degrees, are refused.
"""

from __future__ import annotations

from collections.abc import Callable, Mapping, Sequence
from dataclasses import replace
from functools import partial
from math import degrees, pi
from operator import attrgetter
from typing import Any

import numpy as np

from ncgear.dynamics.driving_shaft import DrivingShaft, Fluctuation
from ncgear.dynamics.loaded_machine import (
    IDLE,
    Broken,
    Loads,
    RigidMachine,
    along,
    broken_cycle,
    largest_over,
    range_over,
)
from ncgear.dynamics.mesh_force import MeshForce, MeshPlace
from ncgear.errors import NoSuchMechanism
from ncgear.frozen import dataclass
from ncgear.kinematics.motion import stretches
from ncgear.mechanisms.mechanism import Mechanism
from ncgear.numerics.arrays import Array
from ncgear.numerics.extrema import Extremum, extremes, grid_between
from ncgear.numerics.highest import largest_of_each
from ncgear.numerics.jet import Jet
from ncgear.numerics.plane import Vector
from ncgear.numerics.units import in_words

MeshOf = Callable[[Loads], MeshForce]
"""One of the meshes of a machine's loads."""

_mesh: MeshOf = attrgetter("mesh_force")


def _one(of: str, number: int) -> Callable[[Loads], Any]:
    """One of several values of loads, by their name."""
    return lambda loads: getattr(loads, of)[number]


def refuse_locked(rigid: RigidMachine) -> None:
    """Raises NoSuchMechanism, with the driving angle, where flanks carry at a pressure angle of 90 degrees or more."""
    meshes: list[tuple[MeshOf, Callable[[Loads], Jet]]] = [(_mesh, attrgetter("driven_torque"))] if rigid.place else []
    meshes += [(_one("meshes_before", number), _one("passed", number)) for number, _ in enumerate(rigid.places_before)]
    for stretch in stretches(rigid.machine):
        breaks = rigid.breaks(stretch)
        ends = stretch.start_rad, stretch.end_rad
        for mesh, torque in meshes:

            def angle(loads: Loads, mesh: MeshOf = mesh) -> Jet:
                return mesh(loads).pressure_angle_rad

            steepest = extremes(partial(along, rigid, stretch, angle), *ends, breaks)[1]
            phi1 = np.append(grid_between(*ends, breaks), steepest.at)
            loads = rigid.on(stretch, phi1)
            refuse_locked_at(phi1, torque(loads).value, angle(loads).value)


def refuse_locked_at(phi1_rad: Array, torque: Array, pressure_angle_rad: Array) -> None:
    """Raises as ``refuse_locked``, by torques on the driven gear and pressure angles at driving angles, shape (n,)."""
    locked = (np.abs(torque) > IDLE * np.abs(torque).max()) & (pressure_angle_rad >= pi / 2.0)
    if locked.any():
        worst = int(np.argmax(np.where(locked, pressure_angle_rad, 0.0)))
        flanks = "push the driven gear" if torque[worst] > 0.0 else "hold the driven gear back"
        raise NoSuchMechanism(
            f"the teeth cannot {flanks} at phi1 = {in_words(float(phi1_rad[worst]))}, where their pressure angle is "
            f"{degrees(pressure_angle_rad[worst]):.4g} deg; under 90 deg is needed: a law whose ratio changes more "
            "slowly there",
            key="motion",
        )


@dataclass(frozen=True)
class MeshPeak:
    """Largest mesh force in N and the pressure angle in rad there."""

    force_n: Extremum
    pressure_angle_rad: float


@dataclass(frozen=True)
class LoadPeaks:
    """Largest sizes of forces in N, with the driving angles of each."""

    joints_n: Mapping[str, Extremum]
    crank_bearing_n: Extremum
    guide_n: Extremum
    mesh: MeshPeak | None
    meshes_before: tuple[MeshPeak, ...] = ()
    between_bearings_n: tuple[Extremum, ...] = ()


def load_peaks(rigid: RigidMachine) -> LoadPeaks:
    """Peaks over one cycle."""
    cycle, before = broken_cycle(rigid), range(len(rigid.places_before))
    return LoadPeaks(
        joints_n={name: largest_over(rigid, cycle, _joint(name)) for name in rigid.machine.linkage.JOINTS},
        crank_bearing_n=largest_over(rigid, cycle, lambda loads: loads.crank_bearing),
        guide_n=largest_over(rigid, cycle, lambda loads: Vector(loads.guide, loads.guide * 0.0)),
        mesh=None if rigid.place is None else _mesh_peak(rigid, cycle, _mesh),
        meshes_before=tuple(_mesh_peak(rigid, cycle, _one("meshes_before", number)) for number in before),
        between_bearings_n=tuple(largest_over(rigid, cycle, _one("between_bearings", number)) for number in before),
    )


def searched_peaks(at: Callable[[Array], Loads], linkage: Mechanism, places_rad: Array) -> LoadPeaks:
    """Peaks of loads ``at`` driving angles that have no slopes, searched between ``places_rad``, shape (n,)."""

    def sizes(phi1: Array) -> Array:
        loads = at(phi1)
        forces = [*(loads.joints[name] for name in linkage.JOINTS), loads.crank_bearing, *loads.between_bearings]
        forces += [mesh.force for mesh in loads.meshes]
        lengths = (np.hypot(force.x.value, force.y.value) for force in forces)
        return np.stack([np.abs(np.zeros(phi1.shape) + loads.guide.value), *lengths])

    guide, *found = largest_of_each(sizes, places_rad)
    joints, (bearing, *others) = found[: len(linkage.JOINTS)], found[len(linkage.JOINTS) :]
    between, pairs = others[: len(others) // 2], others[len(others) // 2 :]
    steep = (at(np.array([one.at])).meshes[pair].pressure_angle_rad.value for pair, one in enumerate(pairs))
    *before, mesh = (MeshPeak(one, float(angle[0])) for one, angle in zip(pairs, steep, strict=True))
    named = dict[str, Extremum](zip(linkage.JOINTS, joints, strict=True))
    return LoadPeaks(named, bearing, guide, mesh, tuple(before), tuple(between))


def _joint(name: str) -> Callable[[Loads], Vector]:
    return lambda loads: loads.joints[name]


def _mesh_peak(rigid: RigidMachine, cycle: Sequence[Broken], mesh: MeshOf) -> MeshPeak:
    found = [(part, range_over(rigid, [part], lambda loads: mesh(loads).size_n)[1]) for part in cycle]
    (stretch, _), highest = max(found, key=lambda item: item[1].value)
    angle = mesh(rigid.on(stretch, np.array([highest.at]))).pressure_angle_rad
    return MeshPeak(highest, float(angle.value[0]))


@dataclass(frozen=True, eq=False)
class Rigid:
    """A machine, the demands on its driving shaft, and its peaks; ``machine.at`` gives the curves."""

    machine: RigidMachine
    driving: DrivingShaft
    peaks: LoadPeaks

    @property
    def fluctuation(self) -> Fluctuation:
        """The driving torque of one cycle."""
        return self.driving.fluctuation


def rigid_level(driving: DrivingShaft, places: Sequence[MeshPlace]) -> Rigid:
    """The forces in a machine from its driving shaft and the places of its pairs of gears, from the driving shaft on.

    Raises NoSuchMechanism where its teeth cannot hold the torque.
    """
    *before, place = places or (None,)
    machine = replace(driving.machine, place=place, places_before=tuple(before))
    refuse_locked(machine)
    return Rigid(machine, driving, load_peaks(machine))
