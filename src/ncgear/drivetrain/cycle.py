"""The loads of a whole cycle at constant driving speed, at points from which means over the cycle follow.

The points are Gauss points between all places at which a load, or its size, has a kink: joints of the law, places at
which the resistance turns, and zeros of the driving torque and of the guide's force.  Means of smooth functions of the
loads are then exact to about 1e-12.
"""

from __future__ import annotations

from dataclasses import replace
from math import pi
from typing import TYPE_CHECKING

import numpy as np

from ncgear.dynamics.loaded_machine import RigidMachine
from ncgear.dynamics.mesh_force import MeshForce, MeshPlace
from ncgear.dynamics.rigid import Rigid
from ncgear.frozen import dataclass
from ncgear.kinematics.motion import stretches
from ncgear.numerics.arrays import Array, ComplexArray
from ncgear.numerics.chebyshev import fitted
from ncgear.numerics.jet import Jet
from ncgear.numerics.plane import Vector
from ncgear.numerics.quadrature import gauss_points
from ncgear.numerics.zeros import all_zeros

if TYPE_CHECKING:
    from ncgear.dynamics.knocking import KnockingMachine

NODES = 10
"""Gauss points of a panel: exact to degree 19."""

WIDEST_RAD = 2.0 * pi / 48.0
"""Width of the widest panel in driving angle; half of it changes the figures of the shipped designs by less than 1e-10
of themselves (tests/test_drivetrain.py)."""


@dataclass(frozen=True, eq=False)
class ShaftLoads:
    """Loads of one shaft at n driving angles, all of shape (n,).

    ``turned_rad`` is the angle that the shaft has turned, counter-clockwise in the frame of the mechanism.  ``gear_n``
    and ``crank_n`` are the forces as x + i y in N that press on the shaft where the gear and the crank are; the driving
    shaft has no crank.  ``torque_n_mm`` is the torque that the shaft passes on at its gear.  Torque and force of the
    driving shaft's gear are larger by the share that friction between the teeth takes: the motor's torque goes through
    that shaft, its key and its bearings.  ``thrust_n`` is the force along the shaft, positive towards the side of the
    gear's hub, and ``couple_n_mm`` the couple by which it tilts the gear (``MeshPlace.couples_mm``).
    """

    turned_rad: Array
    gear_n: ComplexArray
    crank_n: ComplexArray
    torque_n_mm: Array
    thrust_n: Array
    couple_n_mm: ComplexArray

    @classmethod
    def pair(
        cls,
        place: MeshPlace,
        mesh: MeshForce,
        angles_rad: tuple[Array, Jet],
        crank_n: ComplexArray,
        torques_n_mm: tuple[Array, Array],
        rubbing: Array | float = 0.0,
    ) -> tuple[ShaftLoads, ShaftLoads]:
        """The driving and the driven shaft under the mesh force on the driven gear and the force of the crank.

        ``angles_rad`` are phi1, and phi2 with its slope.  The driving gear bears ``rubbing`` of the mesh force beyond.
        """
        (driving, driven), force, thrust, more = angles_rad, complex_of(mesh.force), mesh.thrust_n.value, 1.0 + rubbing
        tilting, tilted = (one * thrust for one in place.couples_mm(driven.derivative(1)))
        turned, idle = -place.mesh.sense * driving, np.zeros_like(force)
        return (
            cls(turned, -force * more, idle, torques_n_mm[0], -thrust * more, tilting * more),
            cls(-driven.value, force, crank_n, torques_n_mm[1], thrust, tilted),
        )


@dataclass(frozen=True, eq=False)
class LoadsAt:
    """The loads of a machine with gears at n driving angles, shape (n,).

    ``driven_slope`` is dphi2/dphi1 and ``way_mm`` the slider's way in mm per rad of phi1; ``guide_n`` presses the
    slider on its guide.
    """

    phi1_rad: Array
    driven_slope: Array
    driving: ShaftLoads
    driven: ShaftLoads
    guide_n: Array
    way_mm: Array


def with_tooth_friction(driving_torque: Array, mesh_share: float) -> Array:
    """The driving torque plus its share that friction between the teeth takes, which always resists."""
    return driving_torque + mesh_share * np.abs(driving_torque)


def loads_at(
    rigid: RigidMachine, phi1_rad: Array, mesh_share: float = 0.0, knocking: KnockingMachine | None = None
) -> LoadsAt:
    """The loads at driving angles in rad; the machine must have gears.

    ``mesh_share`` is the share of the driving torque's size that friction between the teeth takes.  With ``knocking``
    the loads are those of a machine whose teeth knock.

    The crank turns clockwise in the frame of the mechanism, the driving gear against it or, inside a ring, with it.
    """
    loads = (knocking or rigid).at(phi1_rad)
    assert rigid.place is not None
    mesh, torque = loads.mesh_force, loads.driving_torque.value
    angle = rigid.machine.transmission.driven_angle(phi1_rad, 1)
    driving, driven = ShaftLoads.pair(
        rigid.place,
        mesh,
        (phi1_rad, angle),
        # All forces on the crank's shaft are in balance with the forces of its bearings
        -complex_of(loads.crank_bearing) - complex_of(mesh.force),
        (with_tooth_friction(torque, mesh_share), loads.driven_torque.value),
        mesh_share * np.sign(torque),
    )
    way = rigid.machine.displacement(phi1_rad, 1).derivative(1)
    return LoadsAt(phi1_rad, angle.derivative(1), driving, driven, loads.guide.value, way)


def complex_of(force: Vector) -> ComplexArray:
    """A force as x + i y."""
    return np.asarray(force.x.value + 1j * force.y.value)


@dataclass(frozen=True, eq=False)
class Cycle:
    """One cycle of a machine: where its loads have kinks, and its loads at n Gauss points.

    ``breaks_rad`` (shape (m,)) are the driving angles between which loads and their sizes are smooth, ends included.
    ``weight_rad`` (shape (n,)) are the weights of an integral over the driving angle.  ``mesh_share`` is the share of
    the driving torque that friction between the teeth takes, which its loads count.  With ``knocking`` they are the
    loads of teeth that knock.
    """

    rigid: RigidMachine
    breaks_rad: Array
    weight_rad: Array
    loads: LoadsAt
    mesh_share: float = 0.0
    knocking: KnockingMachine | None = None

    def loads_at(self, phi1_rad: Array) -> LoadsAt:
        """The loads at driving angles in rad, shape (n,)."""
        return loads_at(self.rigid, phi1_rad, self.mesh_share, self.knocking)

    @property
    def places_rad(self) -> Array:
        """Driving angles at which searches for largest values begin, shape (n + m,): loads have kinks at the breaks."""
        return np.union1d(self.breaks_rad, self.loads.phi1_rad)

    @property
    def cycle_rad(self) -> float:
        """Driving angle of the cycle."""
        return float(np.ptp(self.breaks_rad))

    @property
    def speed_rad_s(self) -> float:
        """Speed of the driving shaft."""
        return self.rigid.machine.speed_rad_s

    def integral(self, values: Array) -> float:
        """Integral over the driving angle of values at the points, shape (n,)."""
        return float(np.sum(self.weight_rad * values))


def rubbing(cycle: Cycle, mesh_share: float) -> Cycle:
    """The cycle with the share of the driving torque that friction between the teeth takes."""
    loads = loads_at(cycle.rigid, cycle.loads.phi1_rad, mesh_share)
    return replace(cycle, loads=loads, mesh_share=mesh_share)


def with_knocks(cycle: Cycle, knocking: KnockingMachine) -> Cycle:
    """The cycle with the loads of teeth that knock; its panels end where one of their swings turns round."""
    first, last = float(cycle.breaks_rad[0]), float(cycle.breaks_rad[-1])
    turns = first + (knocking.turns_rad - first) % cycle.cycle_rad
    breaks = apart(np.concatenate([cycle.breaks_rad, turns]), first, last)
    points, weights = gauss_points(panels_between(breaks, WIDEST_RAD), NODES)
    loads = loads_at(cycle.rigid, points, cycle.mesh_share, knocking)
    return replace(cycle, breaks_rad=breaks, weight_rad=weights, loads=loads, knocking=knocking)


def cycle_of(rigid: Rigid) -> Cycle:
    """The cycle of a machine with gears."""
    machine = rigid.machine
    edges = np.unique(np.concatenate([machine.breaks(stretch) for stretch in stretches(machine.machine)]))
    guide = fitted(lambda phi1: machine.at(phi1).guide.value, edges)
    breaks = apart(np.concatenate([edges, rigid.fluctuation.flank_changes_rad, all_zeros(guide)]), edges[0], edges[-1])
    points, weights = gauss_points(panels_between(breaks, WIDEST_RAD), NODES)
    return Cycle(machine, breaks, weights, loads_at(machine, points))


CLOSE_RAD = 1e-9
"""Driving angles that count as one: zeros are found to less, and no load changes within it."""


def apart(places: Array, first: float, last: float) -> Array:
    """The places (shape (n,)) in order from the first to the last, both included; of close places one is kept."""
    inner = np.unique(places)
    inner = inner[(inner > first + CLOSE_RAD) & (inner < last - CLOSE_RAD)]
    kept = np.diff(inner, prepend=first) > CLOSE_RAD
    return np.concatenate([[first], inner[kept], [last]])


def panels_between(breaks: Array, widest: float) -> Array:
    """Ends of panels no wider than ``widest`` that have all the breaks (shape (m,), rising) among them."""
    counts = np.maximum(np.ceil(np.diff(breaks) / widest), 1.0).astype(int)
    share = np.arange(counts.sum()) - np.repeat(np.cumsum(counts) - counts, counts)
    inner = np.repeat(breaks[:-1], counts) + share * np.repeat(np.diff(breaks) / counts, counts)
    return np.append(inner, breaks[-1])
