"""The pair as designed: where its exact curves touch, over a whole cycle of meetings, on both sides of the teeth."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass
from functools import cached_property

import numpy as np

from ncgear.contact.designed.clearance import TipClearance, tip_clearances
from ncgear.contact.designed.curves import Contacts, SidePaths, side_paths
from ncgear.contact.designed.edges import EdgeHits, edge_contacts, edge_hits
from ncgear.contact.designed.flanks import TOUCHING_MM, FlankContacts, PairsInContact, flank_contacts, foremost_two
from ncgear.contact.placement import BACK, PUSHING, Meetings, Placement, meetings, single_meetings
from ncgear.errors import NoSuchMechanism
from ncgear.numerics.arrays import Array, IndexArray
from ncgear.numerics.units import in_words
from ncgear.teeth.gear import ToothedPair

ALIKE_RAD = 1e-12
"""Difference of driven angles at which contacts count as equally first: a hundred rounding errors."""


@dataclass(frozen=True, eq=False)
class SideTouch:
    """What touches on one side of the teeth.

    ``first`` has the first contact at each of the n positions, in order; of several equally first ones, the one nearest
    to the pitch point.  ``touching`` has all contacts that touch along with the first.
    """

    meetings: Meetings
    first: Contacts
    touching: Contacts

    @property
    def error_rad(self) -> Array:
        """Driven angle beyond the law's at which the teeth touch at each position, shape (n,)."""
        return self.first.error_rad

    @property
    def ahead_mm(self) -> Array:
        """How deep the teeth are in each other at the law's driven angle, negative where they are apart, shape (n,)."""
        return self.meetings.urge * self.error_rad * self.first.lever_mm

    @property
    def overlap_mm(self) -> Array:
        """Depth by which the teeth run into each other at the law's driven angle, 0 where they do not, shape (n,)."""
        return np.where(self.meetings.urge * self.error_rad > ALIKE_RAD, self.ahead_mm, 0.0)


@dataclass(frozen=True, eq=False)
class SideContact(SideTouch):
    """Contact on one side of the teeth over the whole cycle.

    ``pairs`` are the pairs of flanks that touch without load; ``reaches`` (shape (m,)) is how long the flanks of each
    meeting could touch, in pitches, if nothing held them apart.  ``driving_tips`` and ``driven_tips`` are the
    clearances of these gears' tips.
    """

    pairs: PairsInContact
    reaches: Array
    driving_tips: TipClearance
    driven_tips: TipClearance

    @property
    def transmission_error_rad(self) -> float:
        """Peak to peak variation of ``error_rad``."""
        return float(np.ptp(self.error_rad))

    @property
    def held_apart(self) -> bool:
        """Whether any flanks touch for a shorter time than they could, as tip relief makes it."""
        return bool(np.any(self.pairs.arcs < self.reaches))

    @cached_property
    def simultaneous(self) -> IndexArray:
        """Number of pairs of flanks that touch at each position, shape (n,)."""
        return np.bincount(self.touching.position[self.touching.flanks], minlength=self.error_rad.size)

    def variation_by_tooth(self, error_rad: Array) -> dict[int, float]:
        """Peak to peak variation of errors in rad (shape (n,)) where each driving tooth carries."""
        tooth, error = self.touching.driving_tooth, error_rad[self.touching.position]
        high, low = np.full(tooth.max() + 1, -np.inf), np.full(tooth.max() + 1, np.inf)
        np.maximum.at(high, tooth, error)
        np.minimum.at(low, tooth, error)
        return {int(number): float(high[number] - low[number]) for number in np.unique(tooth)}


@dataclass(frozen=True, eq=False)
class PairTouch:
    """What touches at n positions, on pushing flanks and on their backs."""

    placement: Placement
    pushing: SideTouch
    back: SideTouch

    @property
    def backlash_rad(self) -> Array:
        """Play of the driven gear at each position, shape (n,); negative where the teeth have no room."""
        return self.back.error_rad - self.pushing.error_rad

    @property
    def largest_sliding_mm(self) -> Array:
        """Largest speed of sliding of any touching teeth, in mm per rad of phi1, at each position, shape (n,)."""
        largest = np.zeros(self.placement.count)
        for side in (self.pushing, self.back):
            np.maximum.at(largest, side.touching.position, np.abs(side.touching.sliding_mm(self.placement)))
        return largest


@dataclass(frozen=True, eq=False)
class AsDesigned(PairTouch):
    """Contact of the exact curves over a whole cycle of meetings."""

    pushing: SideContact
    back: SideContact

    def __repr__(self) -> str:
        error, play = self.pushing.transmission_error_rad, float(self.backlash_rad.max())
        overlap = float(self.overlap_mm.max())
        return (
            f"AsDesigned({self.placement.count} positions: transmission error {error:.3g} rad, backlash up to "
            f"{play:.3g} rad, overlap {overlap:.3g} mm)"
        )

    @property
    def overlap_mm(self) -> Array:
        """Depth by which the teeth run into each other at the law's driven angle, 0 where they do not, shape (n,)."""
        return np.maximum(self.pushing.overlap_mm, self.back.overlap_mm)

    @property
    def contact_ratio(self) -> float:
        """Mean number of pairs of flanks that touch without load, on the side of the teeth where it is less."""
        return min(self.pushing.pairs.contact_ratio, self.back.pairs.contact_ratio)

    @property
    def least_arc(self) -> float:
        """Least arc of contact of any pair of flanks on either side of the teeth, in pitches, without load."""
        return min(self.pushing.pairs.least_arc, self.back.pairs.least_arc)

    @property
    def held_apart(self) -> bool:
        """Whether a load would bring more flanks into contact, on either side of the teeth."""
        return self.pushing.held_apart or self.back.held_apart

    @property
    def longest_gap_pitches(self) -> float:
        """Longest rolled length without contact of flanks, on either side of the teeth, in pitches."""
        return max(self.pushing.pairs.longest_gap, self.back.pairs.longest_gap) / self.placement.per_tooth


def as_designed(teeth: ToothedPair, placement: Placement) -> AsDesigned:
    """Contact of the exact curves of a pair over a whole cycle of meetings.

    Raises NoSuchMechanism, with the angle, where no tooth touches another at all.
    """
    paths = _paths_of(teeth)
    pushing, back = _both_sides(teeth, paths, placement)
    return AsDesigned(
        placement,
        _side_contact(pushing, back, placement, tip_clearances(*paths, pushing.meetings)),
        _side_contact(back, pushing, placement, tip_clearances(*paths, back.meetings)),
    )


def touch_at(teeth: ToothedPair) -> Callable[[Placement], PairTouch]:
    """What touches at positions that need not be even, as a function of the placement; raises as ``as_designed``."""
    paths = _paths_of(teeth)

    def touch(placement: Placement) -> PairTouch:
        met = (single_meetings(teeth, placement, side) for side in (PUSHING, BACK))
        pushing, back = (_candidates(teeth, paths, placement, found) for found in met)
        sides = (pushing, back), (back, pushing)
        return PairTouch(placement, *(_touch(*side, placement)[0] for side in sides))

    return touch


def contacts_within(teeth: ToothedPair, placement: Placement, within_mm: float) -> tuple[Contacts, Contacts]:
    """What touches on pushing flanks, and on their backs, once the first contacts are pressed in by ``within_mm``."""
    paths = _paths_of(teeth)
    pushing, back = _both_sides(teeth, paths, placement)
    return _contacts_among(pushing, back, placement, within_mm), _contacts_among(back, pushing, placement, within_mm)


def pairs_under_load(
    teeth: ToothedPair, placement: Placement, error_rad: Array
) -> tuple[PairsInContact, PairsInContact]:
    """The pairs of pushing flanks that touch, and of their backs, where a load has set the driven gear beyond the law.

    ``error_rad`` is its angle beyond the law's at each position, shape (n,).  On a side that bears no load there the
    rigid teeth count.
    """
    paths = _paths_of(teeth)
    pushing, back = _both_sides(teeth, paths, placement)
    first, second = (
        own.flanks.touching(
            foremost_two(_contacts_among(own, other, placement), own.meetings.urge, placement),
            own.meetings.urge,
            error_rad,
        )
        for own, other in ((pushing, back), (back, pushing))
    )
    return first, second


@dataclass(frozen=True, eq=False)
class _Candidates:
    """What may touch on one side of the teeth.

    ``flanks`` are the contacts of flanks, and ``hits`` the corners before curves.
    """

    meetings: Meetings
    flanks: FlankContacts
    hits: list[EdgeHits]


def _paths_of(teeth: ToothedPair) -> tuple[SidePaths, SidePaths]:
    """The paths of the driving gear's flanks and of the driven gear's."""
    driving, driven = (side_paths(gear.flanks, gear.sides) for gear in (teeth.driving, teeth.driven))
    return driving, driven


def _candidates(
    teeth: ToothedPair, paths: tuple[SidePaths, SidePaths], placement: Placement, met: Meetings
) -> _Candidates:
    """The candidates on one side of the teeth."""
    return _Candidates(met, flank_contacts(teeth, placement, met), edge_hits(*paths, placement, met))


def _both_sides(
    teeth: ToothedPair, paths: tuple[SidePaths, SidePaths], placement: Placement
) -> tuple[_Candidates, _Candidates]:
    """The candidates on pushing flanks, and on their backs, at even positions of the cycle."""
    pushing, back = (_candidates(teeth, paths, placement, meetings(teeth, placement, side)) for side in (PUSHING, BACK))
    return pushing, back


def _contacts_among(own: _Candidates, other: _Candidates, placement: Placement, within_mm: float = 0.0) -> Contacts:
    """All contacts of flanks on one side of the teeth, and the corners that touch within ``within_mm`` of the first.

    A corner in a notch, or at the far side of its space, is held by curves that are gathered with the other side of the
    teeth.
    """
    urge = own.meetings.urge
    hits = [found.kept(found.facing) for found in own.hits] + [found.kept(~found.facing) for found in other.hits]
    flanks = own.flanks.contacts
    return Contacts.joined([flanks, edge_contacts(hits, urge, foremost_two(flanks, urge, placement)[0], within_mm)])


def _touch(own: _Candidates, other: _Candidates, placement: Placement) -> tuple[SideTouch, Array]:
    """The first contacts among all candidates, and the two values of ``foremost_two``."""
    urge = own.meetings.urge
    contacts = _contacts_among(own, other, placement)
    foremost = foremost_two(contacts, urge, placement)
    later = foremost[0, contacts.position] - urge * contacts.error_rad
    first = _foremost(contacts.kept(later <= ALIKE_RAD), placement)
    return SideTouch(own.meetings, first, contacts.kept(later * contacts.lever_mm <= TOUCHING_MM)), foremost


def _side_contact(
    own: _Candidates, other: _Candidates, placement: Placement, tips: tuple[TipClearance, TipClearance]
) -> SideContact:
    touch, foremost = _touch(own, other, placement)
    pairs = own.flanks.touching(foremost, own.meetings.urge)
    return SideContact(own.meetings, touch.first, touch.touching, pairs, own.flanks.reaches, *tips)


def _foremost(alike: Contacts, placement: Placement) -> Contacts:
    """One of the first contacts at each position: flanks before edges, then the nearest to the pitch point."""
    distance = np.abs(alike.point - placement.pitch_point[alike.position])
    order = np.lexsort((distance, ~alike.flanks, alike.position))
    position, first = np.unique(alike.position[order], return_index=True)
    if position.size < placement.count:
        phi1 = in_words(float(placement.phi1_rad[np.setdiff1d(np.arange(placement.count), position)[0]]))
        raise NoSuchMechanism(
            f"no tooth touches another at phi1 = {phi1}: the teeth are too short or too far apart there; "
            "more teeth of a smaller module, less backlash or a larger addendum are needed",
            key="gears.teeth",
        )
    return alike.kept(order[first])
