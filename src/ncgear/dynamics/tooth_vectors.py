"""The force of all teeth on the driven gear as a vector, from the speeds at which both gears pass along the tangent.

With t the unit tangent, z the place of contact, both axes on the line of centres a apart and s = -1, of a ring +1: the
arm t.(z - a) is the lever, t.z = s t.(z - a) dphi2/dphi1 by the law of gearing, so that t.a is known from them; in the
same way a across t from the tangential speeds.
"""

from __future__ import annotations

import numpy as np

from ncgear.dynamics.gaps import Near
from ncgear.dynamics.mesh_force import MeshPlace
from ncgear.dynamics.meshing import ToothForces
from ncgear.numerics.arrays import Array, ComplexArray
from ncgear.numerics.vector import Vector


def force_on_driven(teeth: ToothForces, ratio: Array, place: MeshPlace) -> Vector:
    """Force in N in the frame of ``machine.linkage``, shape (n,); ``ratio`` is the law's dphi2/dphi1, shape (n,)."""
    along = tangent(teeth.near, ratio, place)
    across = 1j * along * place.mesh.sense * teeth.near.urge
    force = np.sum(teeth.normal_n * across + teeth.rubbing_n * along, axis=-1)
    # The crank turns clockwise; a ring turns as the driving gear does, so its mesh is looked at from behind.
    seen = np.conj(force) if place.mesh.sense > 0.0 else force
    turned = -seen * np.exp(1j * place.driving_axis_rad)
    return Vector(turned.real, turned.imag)


def tangent(near: Near, ratio: Array, place: MeshPlace) -> ComplexArray:
    """Unit tangents at the contacts, outwards from the driven axis, which lies along +x from the driving one."""
    sense, distance = place.mesh.sense, place.center_distance_mm
    own = ratio[..., None] + near.slopes[0]
    along: ComplexArray = near.lever_mm * (sense * own - 1.0) + 1j * (near.driving_mm - sense * near.driven_mm)
    return along / distance
