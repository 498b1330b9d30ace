"""Loads of shafts, keys, bearings and joints in a jam: the output is held, and the driving shaft turns on.

The torque T1 at the driving gear makes T1 / (dphi2/dphi1) at the driven gear, and the mesh force of both.  The force
that holds the output is that torque over the output's way per rad of the crank.  Near its dead centres that way
vanishes, and no torque bounds the force: there the force counts as where the output moves HELD of its fastest, which a
plain crank does 30 degrees before its dead centre, where presses are rated.  Nothing moves, so no mass counts; friction
is left out.  The weakest part in a jam need not be the weakest under the law or in knocks: ``deciding`` names the load.
"""

from __future__ import annotations

from collections.abc import Mapping
from math import inf, pi
from typing import Literal

import numpy as np

from ncgear.drivetrain.bearings import BornePeaks, Seats, bending_moment_n_mm, borne_sizes, gear_sides_mm
from ncgear.drivetrain.cycle import ShaftLoads, loads_at
from ncgear.drivetrain.shafts import ShaftSection
from ncgear.dynamics.loaded_machine import Loads, RigidMachine
from ncgear.dynamics.rigid import LoadPeaks, searched_peaks
from ncgear.frozen import dataclass
from ncgear.mechanisms.forces import EvenPace, JointForces
from ncgear.numerics.arrays import Array
from ncgear.numerics.extrema import Extremum
from ncgear.numerics.highest import largest_of_each
from ncgear.numerics.jet import Jet

Load = Literal["law", "knocks", "swings", "jam"]
"""Load of a part: the law, teeth that knock, a driven side that swings on its teeth, or a jam."""

MORE = 1e-6
"""Relative difference of two loads that exceeds rounding errors."""


def deciding(sizes: Mapping[Load, float]) -> Load:
    """The load under which a part bears most, by sizes of stress or force; within MORE, the load named first."""
    most = max(sizes.values())
    return next(load for load, size in sizes.items() if size * (1.0 + MORE) >= most)


HELD = 0.5
"""Share of the output's fastest way above which its force in a jam follows from the torque."""


@dataclass(frozen=True, eq=False)
class Jam:
    """A machine with gears whose output is held under a torque in N mm at its driving gear.

    ``places_rad`` (shape (n,), rising) are driving angles of a cycle, between which largest values are searched, and
    ``least_way_mm`` the least way of the output per rad of the crank by which its force counts.
    """

    rigid: RigidMachine
    driving_n_mm: float
    places_rad: Array
    least_way_mm: float

    @classmethod
    def of(cls, rigid: RigidMachine, driving_n_mm: float, places_rad: Array) -> Jam:
        """The jam of a machine; its fastest place is searched."""
        (fastest,) = largest_of_each(lambda phi1: np.abs(_held(rigid, phi1).torque_n_mm.value)[None], places_rad)
        return cls(rigid, driving_n_mm, places_rad, HELD * fastest.value)

    def at(self, phi1_rad: Array) -> Loads:
        """The loads at driving angles in rad, shape (n,): every pair passes on the torque of the driving gear."""
        rigid, angles, held = self.rigid, self.rigid.angles(phi1_rad, 2), _held(self.rigid, phi1_rad)
        slope, driving = angles[-1].differentiated(), Jet(np.full((1, *phi1_rad.shape), self.driving_n_mm))
        driven, passed = driving / slope.truncated(0), (driving,) * len(rigid.places)
        way = held.torque_n_mm.value
        output = driven.value / (np.where(way < 0.0, -1.0, 1.0) * np.maximum(np.abs(way), self.least_way_mm))
        mesh, before = rigid.meshes(slope, driven, angles[1:-1], passed)
        assert mesh is not None
        joints = {name: force * output for name, force in held.joints.items()}
        bearing = held.crank_axis * output - mesh.force
        return Loads(driving, driven, joints, bearing, held.guide_n * output, mesh, before, passed)

    def shaft(self, number: int, phi1_rad: Array) -> ShaftLoads:
        """The loads of a shaft, counted from the driving shaft on, at driving angles, shape (n,)."""
        return loads_at(self.rigid, phi1_rad, (), self.at).shafts[number]

    def peaks(self) -> LoadPeaks:
        """The largest forces of a cycle, in the form of a running machine."""
        return searched_peaks(self.at, self.rigid.machine.linkage, self.places_rad)


def _held(rigid: RigidMachine, phi1_rad: Array) -> JointForces:
    """The forces in the joints, without masses, of 1 N (or N mm) against the output."""
    linkage, angle = rigid.machine.linkage, rigid.machine.transmission.driven_angle(phi1_rad, 2)
    one = Jet(np.ones((1, phi1_rad.size)))
    return linkage.joint_forces(angle, linkage.MASSES(), EvenPace(rigid.machine.speed_rad_s), one)


@dataclass(frozen=True)
class JammedShaft:
    """A shaft in a jam: both bearings' largest force across the shaft, the same with thrust, and static safety, if
    rated; the keyways' least safety, if given; the torque at each gear."""

    largest_n: tuple[Extremum, Extremum]
    static_n: tuple[float, float]
    static_safety: tuple[float | None, float | None]
    yielding: float | None
    torques_n_mm: tuple[float, ...]


def jammed_shaft(jam: Jam, number: int, seats: Seats, section: ShaftSection | None) -> JammedShaft:
    """The largest loads of a shaft and its bearings in a jam; yielding is the full section's, as in ``shafts``."""

    def sizes(phi1: Array) -> Array:
        loads, strained = jam.shaft(number, phi1), list[Array]()
        for at_mm, gear in zip(seats.gears_mm, loads.gears, strict=True):
            bent = [np.abs(bending_moment_n_mm(loads, seats, at)) for at in gear_sides_mm(loads, at_mm)]
            # sigma^2 + 3 tau^2 of a full section, times its resistance.
            strained.append(np.sqrt(np.max(bent, axis=0) ** 2 + 0.75 * gear.torque_n_mm**2))
        torques = (gear.torque_n_mm for gear in loads.gears)
        return np.stack([*borne_sizes(loads, seats), np.max(strained, axis=0), *torques])

    found = largest_of_each(sizes, jam.places_rad)
    first, second, (strained, *torques) = BornePeaks(*found[:3]), BornePeaks(*found[3:6]), found[6:]
    safety = None
    if section is not None:
        resistance_mm3 = pi * section.diameter_mm**3 / 32.0
        safety = section.yield_mpa * resistance_mm3 / strained.value if strained.value else inf
    dents = first.denting_n.value, second.denting_n.value
    static = [
        None if bearing.static_rating_n is None else bearing.static_rating_n / most
        for bearing, most in zip(seats.bearings, dents, strict=True)
    ]
    turning = tuple(torque.value for torque in torques)
    return JammedShaft((first.across_n, second.across_n), dents, (static[0], static[1]), safety, turning)
