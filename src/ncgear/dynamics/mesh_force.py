"""The force between the teeth, from the torque on the driven gear.

Wherever teeth touch, the normal of the flanks goes through the pitch point, so the force turns the driven gear by its
part across the line of centres alone: F_across = T2 / r2.  The flanks' normal leans from the pitch curves' tangent by
the rack's angle alpha of the touching side, the tangent from the normal to the line of centres by mu = atan(r1'/r1);
the pressure angle is alpha - mu where the driving gear pushes and alpha + mu where the driven gear runs ahead and the
back flanks hold it (F. L. Litvin, A. Fuentes-Aznar, I. Gonzalez-Perez, K. Hayasaka, "Noncircular Gears", Cambridge
2009, chapter 2).

Helical teeth press along the axes as well: the flank of their rack is a plane, so that the thrust is tan(beta) times
the force's part along the pitch line of the rack.  It acts at the pitch point, as books on machine parts take it.
"""

from __future__ import annotations

from math import cos, sin

import numpy as np

from ncgear.frozen import dataclass
from ncgear.numerics import jet
from ncgear.numerics.arrays import Array, ComplexArray
from ncgear.numerics.jet import Jet
from ncgear.numerics.plane import Vector
from ncgear.pitch import shape
from ncgear.pitch.shape import Gear, Mesh


@dataclass(frozen=True)
class MeshPlace:
    """Arrangement of the gears: distance of their axes, angle of the rack, kind of mesh.

    ``driving_axis_rad`` is the direction from the crank's axis to the driving gear's, in the frame of the mechanism,
    counter-clockwise from the slider's line.  ``idle_angle_rad`` is the rack's angle of the flanks that hold the driven
    gear back, None where it equals that of the pushing flanks.  ``driven_sense`` is the sense in which the driven gear
    turns; the crank turns clockwise, -1.  ``thrust_share`` is the driven gear's thrust towards the side of its hub over
    the force along the pitch line: 0 for teeth without thrust, below 0 where the driving gear is right-hand.
    """

    center_distance_mm: float
    rack_angle_rad: float
    mesh: Mesh
    driving_axis_rad: float
    idle_angle_rad: float | None = None
    driven_sense: float = -1.0
    thrust_share: float = 0.0

    def couples_mm(self, slope: Array) -> tuple[ComplexArray, ComplexArray]:
        """Couples of 1 N of thrust on the driven gear, which tilts the driving and the driven shaft, shape (n,) each.

        They are x + i y in the mechanism's frame: the direction of two opposite forces across the shaft with the same
        effect, of which the upper force, on the side of the hub, points there.
        """
        radius = shape.radius(Jet(slope[None]), Gear.DRIVEN, self.mesh).value * self.center_distance_mm
        towards = np.exp(1j * self.driving_axis_rad)
        return towards * (radius - self.center_distance_mm), -towards * radius


@dataclass(frozen=True, eq=False)
class MeshForce:
    """Force in N on the driven gear, its size, and its pressure angle in rad, as jets by the driving angle.

    On helical teeth it is the component perpendicular to the axes, and ``thrust_n`` is the component along them on the
    driven gear, positive towards the side of its hub.  The pressure angle is counted from the normal to the line of
    centres, positive where the force drives the axes apart (on a ring: together).  From 90 degrees on no force can hold
    the torque, and the size is negative.
    """

    force: Vector
    size_n: Jet
    pressure_angle_rad: Jet
    thrust_n: Jet


def mesh_force(place: MeshPlace, slope: Jet, torque_n_mm: Jet, speed: Jet | float = 1.0) -> MeshForce:
    """The force for a torque on the driven gear, in its sense of turning.

    ``slope`` is dphi2/dphi1 with one derivative more than the torque; ``speed`` is that of the pair's own driving gear
    over that of the shaft by whose angle jets are taken, as of the second of two pairs.  Where the torque is 0, the
    pressure angle is that of the pushing flanks.
    """
    side = np.where(torque_n_mm.value < 0.0, -1.0, 1.0)
    radius = shape.radius(slope, Gear.DRIVEN, place.mesh).truncated(torque_n_mm.order) * place.center_distance_mm
    idle = place.rack_angle_rad if place.idle_angle_rad is None else place.idle_angle_rad
    rack = np.where(side > 0.0, place.rack_angle_rad, idle)
    angle = rack - jet.arctan(shape.tangent_slope(slope, place.mesh) / speed) * side
    sine, cosine = jet.sin_cos(angle)
    size = torque_n_mm * side / (radius * cosine)
    turning, apart = _directions(place)
    thrust = size * (place.thrust_share * side * np.cos(rack))
    return MeshForce(turning * (size * cosine * side) + apart * (size * sine), size, angle, thrust)


def _directions(place: MeshPlace) -> tuple[Vector, Vector]:
    """Unit vectors at the pitch point: as the driven gear moves there, and away from the driving axis.

    The pitch point lies towards the driving axis, or beyond it on a ring.
    """
    towards = Vector(cos(place.driving_axis_rad), sin(place.driving_axis_rad))
    turning = Vector(-towards.y * place.driven_sense, towards.x * place.driven_sense)
    return turning, towards * place.mesh.sense
