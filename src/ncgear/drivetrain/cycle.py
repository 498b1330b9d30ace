"""The loads of a whole cycle at constant driving speed, at places from which means over the cycle follow.

The places are Gauss points between all places at which a load, or its size, has a kink: joints of the law, places at
which the resistance turns, and zeros of the driving torque and of the guide's force; and these kinks themselves, which
have no weight.  Means of smooth functions of the loads are then exact to about 1e-12.
"""

from __future__ import annotations

from collections.abc import Callable, Sequence
from dataclasses import replace
from functools import cached_property
from math import pi
from typing import TYPE_CHECKING

import numpy as np

from ncgear.dynamics.loaded_machine import Loads, RigidMachine
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
class GearLoads:
    """Loads of one gear of a shaft at n driving angles, all of shape (n,).

    ``force_n`` presses on the shaft at the gear, as x + i y in N.  ``torque_n_mm`` is the torque that the shaft passes
    on at the gear.  ``thrust_n`` is the force along the shaft, positive towards the side of the gear's hub, and
    ``couple_n_mm`` the couple by which it tilts the gear (``MeshPlace.couples_mm``).
    """

    force_n: ComplexArray
    torque_n_mm: Array
    thrust_n: Array
    couple_n_mm: ComplexArray


@dataclass(frozen=True, eq=False)
class ShaftLoads:
    """Loads of one shaft at n driving angles, all of shape (n,).

    ``turned_rad`` is the angle that the shaft has turned, counter-clockwise in the frame of the mechanism, and
    ``slope`` how fast it turns by the driving angle.  ``gears`` has a shaft between two pairs twice, the gear that is
    driven first.  ``crank_n`` presses on the last shaft where the crank is.  Friction between the teeth makes torques
    and forces larger on all gears before them, since the motor's torque goes through these.
    """

    turned_rad: Array
    slope: Array
    gears: tuple[GearLoads, ...]
    crank_n: ComplexArray

    @property
    def thrust_n(self) -> Array:
        """The force of all gears along the shaft."""
        return np.asarray(sum(gear.thrust_n for gear in self.gears))


def shafts_of(
    places: Sequence[MeshPlace],
    meshes: Sequence[MeshForce],
    angles: Sequence[Jet],
    torques_n_mm: Sequence[tuple[Array, Array]],
    crank_n: ComplexArray,
    shares: Sequence[float] = (),
) -> tuple[ShaftLoads, ...]:
    """The loads of all shafts, from the driving shaft on, under the mesh forces on the driven gears and the crank.

    ``angles`` are the angles of all shafts by the driving angle, with their slopes, and ``torques_n_mm`` those at the
    driving and the driven gear of each pair.  ``shares`` are the parts of a pair's torque that its friction takes.
    """
    gears: list[list[GearLoads]] = [[] for _ in angles]
    for pair, (place, mesh, torques) in enumerate(zip(places, meshes, torques_n_mm, strict=True)):
        slopes = angles[pair].derivative(1), angles[pair + 1].derivative(1)
        force, thrust, couples = complex_of(mesh.force), mesh.thrust_n.value, place.couples_mm(slopes[1] / slopes[0])
        for end, sign in ((0, -1.0), (1, 1.0)):
            share = float(sum(shares[pair + end :]))
            more = 1.0 + share * np.sign(torques[end])
            torque = with_tooth_friction(torques[end], share)
            loads = GearLoads(sign * force * more, torque, sign * thrust * more, couples[end] * thrust * more)
            gears[pair + end].append(loads)
    senses = [places[0].driven_sense * places[0].mesh.sense, *(place.driven_sense for place in places)]
    idle = np.zeros_like(crank_n)
    return tuple(
        ShaftLoads(sense * angle.value, angle.derivative(1), tuple(own), crank_n if angle is angles[-1] else idle)
        for sense, angle, own in zip(senses, angles, gears, strict=True)
    )


@dataclass(frozen=True, eq=False)
class LoadsAt:
    """The loads of a machine with gears at n driving angles, shape (n,).

    ``shafts`` are those of all shafts, from the driving shaft on, and ``way_mm`` is the slider's way in mm per rad of
    phi1; ``guide_n`` presses the slider on its guide.
    """

    phi1_rad: Array
    shafts: tuple[ShaftLoads, ...]
    guide_n: Array
    way_mm: Array

    @property
    def driving_torque_n_mm(self) -> Array:
        """The torque at the first gear."""
        return self.shafts[0].gears[0].torque_n_mm


def with_tooth_friction(torque_n_mm: Array, mesh_share: float) -> Array:
    """A torque plus its share that friction between the teeth takes, which always resists."""
    return torque_n_mm + mesh_share * np.abs(torque_n_mm)


def loads_at(
    rigid: RigidMachine,
    phi1_rad: Array,
    mesh_shares: Sequence[float] = (),
    at: Callable[[Array], Loads] | None = None,
) -> LoadsAt:
    """The loads at driving angles in rad; the machine must have gears.

    ``mesh_shares`` are the shares of their torque's size that friction between the teeth of all pairs takes.  The loads
    are those of the law, or those ``at`` driving angles of knocks or a jam.

    The crank turns clockwise in the frame of the mechanism, the gears of a pair against each other or, inside a ring,
    with each other.
    """
    loads, angles = (at or rigid.at)(phi1_rad), rigid.angles(phi1_rad, 1)
    speeds = [angle.derivative(1) for angle in angles]
    torques = [
        (passed.value / speeds[pair], passed.value / speeds[pair + 1]) for pair, passed in enumerate(loads.passed)
    ]
    torques[-1] = torques[-1][0], loads.driven_torque.value
    # All forces on the crank's shaft are in balance with the forces of its bearings
    crank_n = -complex_of(loads.crank_bearing) - complex_of(loads.mesh_force.force)
    shafts = shafts_of(rigid.places, loads.meshes, angles, torques, crank_n, mesh_shares)
    way = rigid.machine.displacement(phi1_rad, 1).derivative(1)
    return LoadsAt(phi1_rad, shafts, loads.guide.value, way)


def complex_of(force: Vector) -> ComplexArray:
    """A force as x + i y."""
    return np.asarray(force.x.value + 1j * force.y.value)


@dataclass(frozen=True, eq=False)
class Cycle:
    """One cycle of a machine: where its loads have kinks, and its loads there and at Gauss points between, n places.

    ``breaks_rad`` (shape (m,)) are the driving angles between which loads and their sizes are smooth, ends included.
    ``weight_rad`` (shape (n,)) are the weights of an integral over the driving angle.  Searches for largest values
    begin at the driving angles of ``loads``.  ``mesh_shares`` are the shares of its torque that friction between the
    teeth of each pair takes, which its loads count.  With ``knocking`` they are the loads of teeth that knock.
    """

    rigid: RigidMachine
    breaks_rad: Array
    weight_rad: Array
    loads: LoadsAt
    mesh_shares: tuple[float, ...] = ()
    knocking: KnockingMachine | None = None

    def loads_at(self, phi1_rad: Array) -> LoadsAt:
        """The loads at driving angles in rad, shape (n,); kept, since each shaft and each place on it asks for them."""
        asked = phi1_rad.tobytes()
        if asked not in self._known:
            at = None if self.knocking is None else self.knocking.at
            self._known[asked] = loads_at(self.rigid, phi1_rad, self.mesh_shares, at)
        return self._known[asked]

    @cached_property
    def _known(self) -> dict[bytes, LoadsAt]:
        """The loads by the bytes of their driving angles."""
        return {}

    @property
    def cycle_rad(self) -> float:
        """Driving angle of the cycle."""
        return float(np.ptp(self.breaks_rad))

    @property
    def speed_rad_s(self) -> float:
        """Speed of the driving shaft."""
        return self.rigid.machine.speed_rad_s

    def integral(self, values: Array) -> float:
        """Integral over the driving angle of values at the places, shape (n,)."""
        return float(np.sum(self.weight_rad * values))


def rubbing(cycle: Cycle, mesh_shares: tuple[float, ...]) -> Cycle:
    """The cycle with the shares of the torque that friction between the teeth of each pair takes."""
    loads = loads_at(cycle.rigid, cycle.loads.phi1_rad, mesh_shares)
    return replace(cycle, loads=loads, mesh_shares=mesh_shares)


def with_knocks(cycle: Cycle, knocking: KnockingMachine) -> Cycle:
    """The cycle with the loads of teeth that knock; its panels end where one of their swings turns round."""
    first, last = float(cycle.breaks_rad[0]), float(cycle.breaks_rad[-1])
    turns = first + (knocking.turns_rad - first) % cycle.cycle_rad
    breaks = apart(np.concatenate([cycle.breaks_rad, turns]), first, last)
    places, weights = _weighted(breaks)
    loads = loads_at(cycle.rigid, places, cycle.mesh_shares, knocking.at)
    return replace(cycle, breaks_rad=breaks, weight_rad=weights, loads=loads, knocking=knocking)


def cycle_of(rigid: Rigid) -> Cycle:
    """The cycle of a machine with gears."""
    machine = rigid.machine
    edges = np.unique(np.concatenate([machine.breaks(stretch) for stretch in stretches(machine.machine)]))
    guide = fitted(lambda phi1: machine.at(phi1).guide.value, edges)
    breaks = apart(np.concatenate([edges, rigid.fluctuation.flank_changes_rad, all_zeros(guide)]), edges[0], edges[-1])
    places, weights = _weighted(breaks)
    return Cycle(machine, breaks, weights, loads_at(machine, places))


def _weighted(breaks: Array) -> tuple[Array, Array]:
    """Breaks (shape (m,), rising), Gauss points between them, and the weights of both; shape (n,) each."""
    points, weights = gauss_points(panels_between(breaks, WIDEST_RAD), NODES)
    before = np.searchsorted(points, breaks)
    return np.insert(points, before, breaks), np.insert(weights, before, 0.0)


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
