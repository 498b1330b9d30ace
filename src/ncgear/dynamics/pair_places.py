"""Contact places of pairs of teeth on both gears in their own frames; the stiffness of a pair depends on them."""

from __future__ import annotations

from collections.abc import Callable

import numpy as np

from ncgear.contact.designed.as_designed import AsDesigned, PairTouch, touch_at
from ncgear.contact.designed.curves import Contacts
from ncgear.contact.designed.extremes import ValueRange, at_angles, over_cycle, ranges_of
from ncgear.contact.placement import Placement, placed_at
from ncgear.frozen import dataclass
from ncgear.numerics.arrays import Array, Columns, ComplexArray, IndexArray, Mask
from ncgear.numerics.highest import largest_from
from ncgear.numerics.plane import along
from ncgear.pitch.pair import PitchPair
from ncgear.teeth.gear import ToothedPair


@dataclass(frozen=True, eq=False)
class PairPlaces(Columns):
    """n pairs of teeth, each at its place of contact, shape (n,) each.

    The flanks are numbered as in ``ncgear.teeth.flank``.  Points in mm and unit normals, which lead into the tooth, are
    in the frame of their own gear.  ``driving_mm`` and ``driven_mm`` are the heights on both flanks, NaN where an edge
    touches.
    """

    driving_flank: IndexArray
    driving_point: ComplexArray
    driving_inwards: ComplexArray
    driven_flank: IndexArray
    driven_point: ComplexArray
    driven_inwards: ComplexArray
    driving_mm: Array
    driven_mm: Array

    @property
    def flanks(self) -> Mask:
        """Whether two flanks touch."""
        return ~np.isnan(self.driving_mm)


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
        contacts.driving_mm,
        contacts.driven_mm,
    )


KNOWN = 1e-4
"""Largest error of an extreme of the stiffness as a share of its variation over the cycle."""


def stiffness_range(pitch: PitchPair, teeth: ToothedPair, designed: AsDesigned, stiffness: PairStiffness) -> ValueRange:
    """The least and the largest stiffness of any pair that touches without load, ``at`` driving angles in rad.

    From the positions of ``designed`` the search closes in on both: a pair is softest where it meets or parts.
    """
    touch, even = touch_at(teeth), designed.placement

    def both(at: PairTouch) -> Array:
        contacts = Contacts.joined([at.pushing.touching, at.back.touching])
        found = stiffness(pair_places(contacts, at.placement))
        largest = np.full((2, at.placement.count), -np.inf)
        for row, values in zip(largest, (found, -found), strict=True):
            np.maximum.at(row, contacts.position, values)
        return largest

    places, values = over_cycle(even, both(designed))
    found = largest_from(
        lambda rolled_mm: both(touch(placed_at(pitch, even, rolled_mm))), places, values, KNOWN * np.ptp(values, axis=1)
    )
    return ranges_of(at_angles(pitch, even, found))[0]
