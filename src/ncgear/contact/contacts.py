"""Places where two teeth touch, whatever of them it is that touches."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, fields

import numpy as np

from ncgear.contact.placement import Placement
from ncgear.numerics.arrays import Array, ComplexArray, IndexArray, Mask
from ncgear.numerics.plane import along


@dataclass(frozen=True, eq=False)
class Contacts:
    """n places of contact on one side of the teeth, all of shape (n,).

    ``driving`` and ``driven`` number the flanks that meet in ``position``; ``error_rad`` is the driven angle beyond the
    law's at which they touch; ``point`` and ``tangent`` (of any length) are in the driven gear's frame as it then
    stands; ``flanks`` tells the contact of two flanks from that of an edge.
    """

    driving: IndexArray
    driven: IndexArray
    position: IndexArray
    error_rad: Array
    point: ComplexArray
    tangent: ComplexArray
    flanks: Mask

    @staticmethod
    def joined(parts: Sequence[Contacts]) -> Contacts:
        """All contacts of several parts."""
        return Contacts(*(np.concatenate([getattr(part, field.name) for part in parts]) for field in fields(Contacts)))

    def kept(self, rows: Mask | IndexArray) -> Contacts:
        """The chosen contacts."""
        return Contacts(*(getattr(self, field.name)[rows] for field in fields(self)))

    @property
    def driving_tooth(self) -> IndexArray:
        """Number of each contact's driving tooth, from 1."""
        return self.driving // 2 + 1

    @property
    def driven_tooth(self) -> IndexArray:
        """Number of each contact's driven tooth, from 1."""
        return self.driven // 2 + 1

    @property
    def lever_mm(self) -> Array:
        """Arm about the driven axis of a force across the tangent."""
        return np.asarray(np.abs(along(self.tangent, self.point)) / np.abs(self.tangent))

    @property
    def pressure_angle_rad(self) -> Array:
        """Angle between the common normal and the velocity of the driven gear's point."""
        return np.arccos(np.minimum(self.lever_mm / np.abs(self.point), 1.0))

    def fixed_points(self, placement: Placement) -> ComplexArray:
        """The places of contact in the fixed frame, as x + i y in mm."""
        return placement.fixed_points(self.point, self.position, self.error_rad)

    def sliding_mm(self, placement: Placement) -> Array:
        """Speed at which the driving tooth slides over the driven one, in mm per rad of phi1; outwards is positive."""
        place = self.fixed_points(placement)
        tangent = placement.fixed_directions(self.tangent, self.position, self.error_rad) / np.abs(self.tangent)
        outwards = np.sign(along(tangent, place))
        return outwards * along(tangent, placement.relative_velocity(place, self.position))
