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

from ncgear.drivetrain.bearings import Bearing, bending_moment_n_mm, gear_sides_mm, largest_borne
from ncgear.drivetrain.cycle import ShaftLoads, complex_of
from ncgear.drivetrain.shafts import ShaftSection
from ncgear.dynamics.loaded_machine import RigidMachine
from ncgear.dynamics.mesh_force import MeshForce, mesh_force
from ncgear.dynamics.rigid import LoadPeaks, MeshPeak
from ncgear.frozen import dataclass
from ncgear.mechanisms.forces import EvenPace, JointForces
from ncgear.numerics.arrays import Array
from ncgear.numerics.extrema import Extremum
from ncgear.numerics.highest import largest_of_each
from ncgear.numerics.jet import Jet
from ncgear.pitch.shape import Gear

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

    def loads(self, gear: Gear, phi1_rad: Array) -> ShaftLoads:
        """The loads of the shaft of a gear at driving angles, shape (n,)."""
        place, angle = self.rigid.place, self.rigid.machine.transmission.driven_angle(phi1_rad, 1)
        assert place is not None
        held, output = self._held(phi1_rad)
        driving, driven = ShaftLoads.pair(
            place,
            self._mesh(phi1_rad),
            (phi1_rad, angle),
            -complex_of(held.crank_axis) * output,
            (np.full(phi1_rad.shape, self.driving_n_mm), self._driven_n_mm(phi1_rad)),
        )
        return driving if gear is Gear.DRIVING else driven

    def peaks(self) -> LoadPeaks:
        """The largest forces of a cycle, in the form of a running machine."""
        linkage = self.rigid.machine.linkage

        def sizes(phi1: Array) -> Array:
            held, output = self._held(phi1)
            bearing = -complex_of(held.crank_axis) * output + complex_of(self._mesh(phi1).force)
            joints = (complex_of(held.joints[name]) * output for name in linkage.JOINTS)
            guide = np.zeros(phi1.shape) + held.guide_n.value * output
            return np.asarray(np.abs(np.stack([*joints, bearing, complex_of(self._mesh(phi1).force), guide])))

        *joints, bearing, mesh, guide = largest_of_each(sizes, self.places_rad)
        steep = self._mesh(np.array([mesh.at])).pressure_angle_rad.value
        return LoadPeaks(
            dict(zip(linkage.JOINTS, joints, strict=True)), bearing, guide, MeshPeak(mesh, float(steep[0]))
        )

    def _driven_n_mm(self, phi1_rad: Array) -> Array:
        return np.asarray(self.driving_n_mm / self.rigid.machine.transmission.driven_angle(phi1_rad, 1).derivative(1))

    def _mesh(self, phi1_rad: Array) -> MeshForce:
        place, torque = self.rigid.place, Jet(self._driven_n_mm(phi1_rad)[None])
        assert place is not None
        return mesh_force(place, self.rigid.machine.transmission.driven_angle(phi1_rad, 2).differentiated(), torque)

    def _held(self, phi1_rad: Array) -> tuple[JointForces, Array]:
        """The forces of 1 N (or N mm) against the output, and the force that holds it, shape (n,)."""
        held = _held(self.rigid, phi1_rad)
        way = held.torque_n_mm.value
        counted = np.where(way < 0.0, -1.0, 1.0) * np.maximum(np.abs(way), self.least_way_mm)
        return held, self._driven_n_mm(phi1_rad) / counted


def _held(rigid: RigidMachine, phi1_rad: Array) -> JointForces:
    """The forces in the joints, without masses, of 1 N (or N mm) against the output."""
    linkage, angle = rigid.machine.linkage, rigid.machine.transmission.driven_angle(phi1_rad, 2)
    one = Jet(np.ones((1, phi1_rad.size)))
    return linkage.joint_forces(angle, linkage.MASSES(), EvenPace(rigid.machine.speed_rad_s), one)


@dataclass(frozen=True)
class JammedShaft:
    """A shaft in a jam: both bearings' largest force across the shaft, the same with thrust, and static safety, if
    rated; the keyway's safety, if given; torque."""

    largest_n: tuple[Extremum, Extremum]
    static_n: tuple[float, float]
    static_safety: tuple[float | None, float | None]
    yielding: float | None
    most_n_mm: float


def jammed_shaft(
    jam: Jam, gear: Gear, bearings: tuple[Bearing, Bearing], crank_at_mm: float, section: ShaftSection | None
) -> JammedShaft:
    """The largest loads of a gear's shaft and bearings in a jam; yielding is the full section's, as in ``shafts``."""

    def sizes(phi1: Array) -> Array:
        loads = jam.loads(gear, phi1)
        bent = [np.abs(bending_moment_n_mm(loads, bearings, crank_at_mm, at)) for at in gear_sides_mm(loads)]
        # sigma^2 + 3 tau^2 of a full section, times its resistance.
        return np.stack([np.sqrt(np.max(bent, axis=0) ** 2 + 0.75 * loads.torque_n_mm**2), loads.torque_n_mm])

    strained, torque = largest_of_each(sizes, jam.places_rad)
    borne = largest_borne(lambda phi1: jam.loads(gear, phi1), bearings, crank_at_mm, jam.places_rad)
    (first, _, _), (second, _, _) = borne
    dents = borne[0][1].value, borne[1][1].value
    safety = None
    if section is not None:
        resistance_mm3 = pi * section.diameter_mm**3 / 32.0
        safety = section.yield_mpa * resistance_mm3 / strained.value if strained.value else inf
    static = [
        None if one.static_rating_n is None else one.static_rating_n / most
        for one, most in zip(bearings, dents, strict=True)
    ]
    return JammedShaft((first, second), dents, (static[0], static[1]), safety, torque.value)
