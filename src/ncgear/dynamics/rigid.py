"""The rigid level: the peaks of all forces in a loaded machine at constant driving speed.

Gears whose carrying flanks cannot hold the torque, because their pressure angle reaches 90 degrees, are refused.
"""

from __future__ import annotations

from collections.abc import Callable, Mapping, Sequence
from dataclasses import replace
from math import degrees, pi, sqrt

import numpy as np

from ncgear.dynamics.driving_shaft import DrivingShaft, Fluctuation
from ncgear.dynamics.loaded_machine import IDLE, Loads, RigidMachine, broken_cycle, ranges_on
from ncgear.dynamics.mesh_force import MeshPlace
from ncgear.errors import NoSuchMechanism
from ncgear.frozen import dataclass
from ncgear.mechanisms.mechanism import Mechanism
from ncgear.numerics.arrays import Array
from ncgear.numerics.extrema import Extremum, grid_between
from ncgear.numerics.highest import largest_of_each
from ncgear.numerics.jet import Jet
from ncgear.numerics.plane import Vector
from ncgear.numerics.units import in_words


def refuse_locked(rigid: RigidMachine) -> None:
    """Raises NoSuchMechanism, with the driving angle, where flanks carry at a pressure angle of 90 degrees or more."""

    def angles(loads: Loads) -> list[Jet]:
        return [mesh.pressure_angle_rad for mesh in loads.meshes]

    for stretch, breaks in broken_cycle(rigid) if rigid.place else ():
        steepest = ranges_on(rigid, (stretch, breaks), angles)
        grid = grid_between(stretch.start_rad, stretch.end_rad, breaks)
        phi1 = np.append(grid, [high.at for _, high in steepest])
        loads = rigid.on(stretch, phi1)
        torques = [*loads.passed[: len(loads.meshes_before)], loads.driven_torque]
        for torque, angle in zip(torques, angles(loads), strict=True):
            refuse_locked_at(phi1, torque.value, angle.value)


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
    linkage = rigid.machine.linkage

    def sizes(loads: Loads) -> list[Jet]:
        squares = (force.dot(force) for force in _forces(loads, linkage))
        return [loads.guide * loads.guide, *squares, *(mesh.size_n for mesh in loads.meshes)]

    each = [[(high, part[0]) for _, high in ranges_on(rigid, part, sizes)] for part in broken_cycle(rigid)]
    highest = [max(found, key=lambda peak: peak[0].value) for found in zip(*each, strict=True)]
    count = len(highest) - len(rigid.places)
    meshes = [(peak, rigid.on(stretch, np.array([peak.at]))) for peak, stretch in highest[count:]]
    return _named([Extremum(sqrt(peak.value), peak.at) for peak, _ in highest[:count]], linkage, meshes)


def searched_peaks(at: Callable[[Array], Loads], linkage: Mechanism, places_rad: Array) -> LoadPeaks:
    """Peaks of loads ``at`` driving angles that have no slopes, searched between ``places_rad``, shape (n,)."""

    def sizes(phi1: Array) -> Array:
        loads = at(phi1)
        forces = [*_forces(loads, linkage), *(mesh.force for mesh in loads.meshes)]
        lengths = (np.hypot(force.x.value, force.y.value) for force in forces)
        return np.stack([np.abs(np.zeros(phi1.shape) + loads.guide.value), *lengths])

    found = largest_of_each(sizes, places_rad)
    count = len(found) - len(at(places_rad[:1]).meshes)
    return _named(found[:count], linkage, [(extremum, at(np.array([extremum.at]))) for extremum in found[count:]])


def _forces(loads: Loads, linkage: Mechanism) -> list[Vector]:
    """The forces in joints, in the crank's bearing and in the bearings between pairs."""
    return [*(loads.joints[name] for name in linkage.JOINTS), loads.crank_bearing, *loads.between_bearings]


def _named(peaks: list[Extremum], linkage: Mechanism, pressed: list[tuple[Extremum, Loads]]) -> LoadPeaks:
    """Peaks in the guide and of ``_forces``, and those of all meshes with the loads there."""
    guide, *joints = peaks[: 1 + len(linkage.JOINTS)]
    bearing, *between = peaks[1 + len(linkage.JOINTS) :]
    named = dict(zip(linkage.JOINTS, joints, strict=True))
    angles = (float(loads.meshes[pair].pressure_angle_rad.value[0]) for pair, (_, loads) in enumerate(pressed))
    meshes = [MeshPeak(peak, angle) for (peak, _), angle in zip(pressed, angles, strict=True)]
    return LoadPeaks(named, bearing, guide, meshes[-1] if meshes else None, tuple(meshes[:-1]), tuple(between))


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
