"""Where pairs of teeth touch, on both gears in their own frames: what the stiffness of a pair depends on."""

from __future__ import annotations

from collections.abc import Callable

import numpy as np

from ncgear.contact.designed.curves import Contacts
from ncgear.contact.placement import Placement
from ncgear.frozen import dataclass
from ncgear.numerics.arrays import Array, Columns, ComplexArray, IndexArray, Mask
from ncgear.numerics.plane import along


@dataclass(frozen=True, eq=False)
class PairPlaces(Columns):
    """n pairs of teeth, each at the place at which it touches, shape (n,) each.

    The flanks are numbered as in ``ncgear.teeth.flank``.  Points in mm and unit normals, which lead into the tooth, are
    in the frame of their own gear.  ``flanks`` is false where an edge touches.
    """

    driving_flank: IndexArray
    driving_point: ComplexArray
    driving_inwards: ComplexArray
    driven_flank: IndexArray
    driven_point: ComplexArray
    driven_inwards: ComplexArray
    flanks: Mask


PairStiffness = Callable[[PairPlaces], Array]
"""Stiffness of pairs of teeth in N/mm along the normal (with a law of impact of another exponent n, in N/mm^n), all
above 0, shape (n,)."""


def fixed_tangents(contacts: Contacts, placement: Placement) -> tuple[ComplexArray, ComplexArray]:
    """Places and unit tangents of contacts in the fixed frame, the driven gear standing where each touches.

    A tangent leads outwards from the driven axis where the flank is not steep; its sense is that of the normal force,
    whose arm about that axis keeps its sign.
    """
    point = contacts.fixed_points(placement)
    tangent = placement.fixed_directions(contacts.tangent, contacts.position, contacts.error_rad)
    outwards = np.sign(along(tangent, point - placement.center_distance_mm))
    return point, tangent / np.abs(tangent) * outwards


def pair_places(contacts: Contacts, placement: Placement) -> PairPlaces:
    """The places of contacts."""
    row, sense = contacts.position, placement.mesh.sense
    point, tangent = fixed_tangents(contacts, placement)
    into_driven = 1j * sense * contacts.urge * tangent
    back = np.exp(-1j * placement.phi1_rad[row])
    driven_back = np.exp(-1j * sense * (placement.phi2_rad[row] + contacts.error_rad))
    return PairPlaces(
        contacts.driving,
        point * back,
        -into_driven * back,
        contacts.driven,
        contacts.point,
        into_driven * driven_back,
        contacts.flanks,
    )
