"""What shafts, keys and bearings bear when the machine jams: the output is held, and the driving shaft turns on.

The torque T1 at the driving gear makes T1 / (dphi2/dphi1) at the driven one, and the mesh force of both.  What holds
the output presses on the crank with that torque over the way of the output for each rad of the crank.  Near its dead
centres that way vanishes, and no torque bounds the force: there it counts as where the output moves HELD of its
fastest, which a plain crank does 30 degrees before its dead centre, where presses are rated.  Nothing moves, so that no
mass counts; friction is left out.
"""

from __future__ import annotations

from math import inf, pi

import numpy as np

from ncgear.drivetrain.bearings import Bearing, bearing_forces, bending_moment_n_mm
from ncgear.drivetrain.cycle import ShaftLoads
from ncgear.drivetrain.shafts import ShaftSection
from ncgear.dynamics.loaded_machine import RigidMachine
from ncgear.dynamics.mesh_force import mesh_force
from ncgear.frozen import dataclass
from ncgear.mechanisms.forces import EvenPace
from ncgear.numerics.arrays import Array
from ncgear.numerics.extrema import Extremum
from ncgear.numerics.highest import largest_of_each
from ncgear.numerics.jet import Jet
from ncgear.pitch.shape import Gear

HELD = 0.5
"""Share of the output's fastest way from which on its force in a jam follows from the torque."""


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
        (fastest,) = largest_of_each(lambda phi1: np.abs(_held(rigid, phi1)[1])[None], places_rad)
        return cls(rigid, driving_n_mm, places_rad, HELD * fastest.value)

    def loads(self, gear: Gear, phi1_rad: Array) -> ShaftLoads:
        """What the shaft of a gear bears at driving angles, shape (n,)."""
        place, transmission = self.rigid.place, self.rigid.machine.transmission
        assert place is not None
        angle = transmission.driven_angle(phi1_rad, 2)
        torque = self.driving_n_mm / angle.derivative(1)
        force = mesh_force(place, angle.differentiated(), Jet(torque[None])).force
        mesh = force.x.value + 1j * force.y.value
        if gear is Gear.DRIVING:
            turned = -place.mesh.sense * phi1_rad
            return ShaftLoads(turned, -mesh, np.zeros_like(mesh), np.full(phi1_rad.shape, self.driving_n_mm))
        axis, way = _held(self.rigid, phi1_rad)
        counted = np.where(way < 0.0, -1.0, 1.0) * np.maximum(np.abs(way), self.least_way_mm)
        return ShaftLoads(-angle.value, mesh, -axis * torque / counted, torque)


def _held(rigid: RigidMachine, phi1_rad: Array) -> tuple[Array, Array]:
    """What 1 N (or N mm) against the output makes: the force x + i y on the crank's axis, and the crank's torque."""
    linkage, angle = rigid.machine.linkage, rigid.machine.transmission.driven_angle(phi1_rad, 2)
    one = Jet(np.ones((1, phi1_rad.size)))
    held = linkage.joint_forces(angle, linkage.MASSES(), EvenPace(rigid.machine.speed_rad_s), one)
    return held.crank_axis.x.value + 1j * held.crank_axis.y.value, held.torque_n_mm.value


@dataclass(frozen=True)
class JammedShaft:
    """A shaft in a jam: the largest force and the static safety of both bearings, None without a static rating.

    ``yielding`` is the safety of the shaft at its keyway, None where it is not given.
    """

    largest_n: tuple[Extremum, Extremum]
    static_safety: tuple[float | None, float | None]
    yielding: float | None
    most_n_mm: float


def jammed_shaft(
    jam: Jam, gear: Gear, bearings: tuple[Bearing, Bearing], crank_at_mm: float, section: ShaftSection | None
) -> JammedShaft:
    """What the shaft of a gear and its bearings bear in a jam, the largest of a cycle.

    Yielding is that of the full section, as in ``ncgear.drivetrain.shafts``, bent and twisted at the same angle.
    """

    def sizes(phi1: Array) -> Array:
        loads = jam.loads(gear, phi1)
        bent = bending_moment_n_mm(loads, bearings, crank_at_mm, 0.0)
        # sigma^2 + 3 tau^2 of a full section, times its resistance.
        strained = np.sqrt(np.abs(bent) ** 2 + 0.75 * loads.torque_n_mm**2)
        return np.stack([*np.abs(np.stack(bearing_forces(loads, bearings, crank_at_mm))), strained, loads.torque_n_mm])

    first, second, strained, torque = largest_of_each(sizes, jam.places_rad)
    safety = None
    if section is not None:
        resistance_mm3 = pi * section.diameter_mm**3 / 32.0
        safety = section.yield_mpa * resistance_mm3 / strained.value if strained.value else inf
    static = [
        None if one.static_rating_n is None else one.static_rating_n / most.value
        for one, most in zip(bearings, (first, second), strict=True)
    ]
    return JammedShaft((first, second), (static[0], static[1]), safety, torque.value)
