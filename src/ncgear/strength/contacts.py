"""The contacts of the teeth under load over a whole cycle of meetings, as the methods of strength need them."""

from __future__ import annotations

from dataclasses import replace

import numpy as np

from ncgear.frozen import dataclass
from ncgear.numerics.arrays import Array, Columns, ComplexArray, IndexArray, Mask, equal_rows, largest_rows
from ncgear.pitch.shape import Gear


@dataclass(frozen=True, eq=False)
class FlankPlaces(Columns):
    """n places on the flanks of one gear, in the gear's own frame; shape (n,) each.

    ``flank`` numbers the flanks from 0, two for each tooth, as in ``ncgear.teeth.flank``; ``point`` is the place as
    x + i y in mm, ``inwards`` the unit normal of the flank there that leads into the tooth.  ``section`` numbers their
    sections of the face width; None where the teeth are the same over the width.
    """

    flank: IndexArray
    point: ComplexArray
    inwards: ComplexArray
    section: IndexArray | None = None

    @property
    def tooth(self) -> IndexArray:
        """Number of each place's tooth, from 1."""
        return self.flank // 2 + 1


@dataclass(frozen=True, eq=False)
class LoadedContacts(Columns):
    """n loaded contacts, in the order of positions; shape (n,) each.

    ``position`` numbers the positions of the cycle and ``phi1_rad`` is the driving angle there.  ``side`` is PUSHING or
    BACK.  ``force_n`` is the normal force that the pair bears, in the plane across the axes.  ``relative_curvature``
    is the sum of both flanks' curvatures in 1/mm, infinite where an edge touches; ``flanks`` is false there.
    ``rolling_mm_s`` (shape (n, 2)) are the speeds at which the contact moves along the driving and the driven flank.
    ``stiffness_n_mm`` is the stiffness of the pair.  ``section`` numbers the sections of the face width, ``share`` is
    the section's part of it; force and stiffness are the pair's in that section.  Straight teeth have section 0 alone.
    """

    position: IndexArray
    phi1_rad: Array
    side: IndexArray
    force_n: Array
    stiffness_n_mm: Array
    relative_curvature: Array
    flanks: Mask
    rolling_mm_s: Array
    driving_flank: IndexArray
    driving_point: ComplexArray
    driving_inwards: ComplexArray
    driven_flank: IndexArray
    driven_point: ComplexArray
    driven_inwards: ComplexArray
    section: IndexArray
    share: Array

    def on(self, gear: Gear) -> FlankPlaces:
        """The places on one gear's flanks."""
        if gear is Gear.DRIVING:
            return FlankPlaces(self.driving_flank, self.driving_point, self.driving_inwards, self.section)
        return FlankPlaces(self.driven_flank, self.driven_point, self.driven_inwards, self.section)

    @property
    def over_width_n(self) -> Array:
        """The force of a pair with this load for each mm over the whole face width, shape (n,)."""
        return self.force_n / self.share

    @property
    def pair_force_n(self) -> Array:
        """The force of the whole pair that each contact belongs to, in all its sections, shape (n,)."""
        pair = self._pairs
        return np.asarray(np.bincount(pair, self.force_n).astype(float)[pair])

    def of_pairs(self) -> LoadedContacts:
        """The same with one contact for each position and pair: its most loaded section, with the force of all."""
        pair = self._pairs
        rows = np.sort(largest_rows(self.over_width_n, pair, int(pair.max(initial=-1)) + 1))
        return replace(self, force_n=self.pair_force_n).kept(rows)

    @property
    def _pairs(self) -> IndexArray:
        """A number for each position and pair of flanks, shape (n,)."""
        key = np.stack([self.position, self.driving_flank, self.driven_flank], axis=1)
        return equal_rows(key)[1]

    @property
    def sliding_mm_s(self) -> Array:
        """Speed of sliding, shape (n,)."""
        return np.abs(self.rolling_mm_s[:, 0] - self.rolling_mm_s[:, 1])
