"""The pair as designed: where its exact curves touch, over a whole cycle of meetings, on both sides of the teeth."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from dataclasses import replace
from functools import cached_property, lru_cache

import numpy as np

from ncgear.contact.designed.clearance import TipClearance, tip_clearances
from ncgear.contact.designed.curves import Contacts, SidePaths, side_paths
from ncgear.contact.designed.edges import EdgeHits, edge_contacts, edge_hits, first_edge_contacts
from ncgear.contact.designed.flanks import (
    FlankContacts,
    PairsInContact,
    flank_contacts,
    foremost_two,
    touching_mm,
)
from ncgear.contact.placement import BACK, BOTH_SIDES, PUSHING, URGE, Meetings, Placement, meetings, single_meetings
from ncgear.errors import NoSuchMechanism
from ncgear.frozen import dataclass
from ncgear.numerics.arrays import Array, IndexArray, Mask, distinct, largest_rows
from ncgear.numerics.units import in_words
from ncgear.shown import Shown
from ncgear.teeth.gear import ToothedPair

ALIKE_RAD = 1e-12
"""Difference of driven angles up to which contacts count as equally first: a hundred rounding errors."""

BESIDE_IN_PITCHES = 0.0064
"""Depth behind the first contact to which corners are followed where flanks part: the lead of the flanks over the
corners at two positions gives the place between them where the flanks begin to touch."""


@dataclass(frozen=True, eq=False)
class SideTouch:
    """The contacts on a ``side`` of the teeth, PUSHING or BACK.

    ``first`` has the first contact at each of the n positions, in order; of several contacts that are equally first,
    the contact nearest to the pitch point.  ``touching`` has all contacts that touch together with the first.
    """

    side: int
    first: Contacts
    touching: Contacts

    @property
    def error_rad(self) -> Array:
        """Driven angle beyond the law's at which the teeth touch at each position, shape (n,)."""
        return self.first.error_rad

    @property
    def ahead_mm(self) -> Array:
        """Depth of the teeth in each other at the law's driven angle, negative where they are apart, shape (n,)."""
        return self.first.lead_rad * self.first.lever_mm

    @property
    def overlap_mm(self) -> Array:
        """Depth of the teeth's overlap at the law's driven angle, 0 without overlap, shape (n,)."""
        return np.where(self.first.lead_rad > ALIKE_RAD, self.ahead_mm, 0.0)


@dataclass(frozen=True, eq=False)
class SideContact(SideTouch):
    """Contact on one side of the teeth over the whole cycle.

    ``meetings`` are the meetings of its flanks, ``pairs`` the pairs that touch without load; ``reaches`` (shape (m,))
    are the arcs in pitches over which the flanks of each meeting could touch, if nothing held them apart.
    ``driving_tips`` and ``driven_tips`` are the clearances of the tips of both gears.
    """

    meetings: Meetings
    pairs: PairsInContact
    reaches: Array
    driving_tips: TipClearance
    driven_tips: TipClearance

    @property
    def transmission_error_rad(self) -> float:
        """Peak to peak variation of ``error_rad`` over the positions."""
        return float(np.ptp(self.error_rad))

    @property
    def held_apart(self) -> bool:
        """Whether any flanks touch over a shorter arc than they could, for example because of tip relief."""
        return bool(np.any(self.pairs.arcs < self.reaches))

    @cached_property
    def simultaneous(self) -> IndexArray:
        """Number of pairs of flanks that touch at each position, shape (n,)."""
        return np.bincount(self.touching.position[self.touching.flanks], minlength=self.error_rad.size)

    def variation_by_tooth(self, error_rad: Array) -> dict[int, float]:
        """Peak to peak variation of errors in rad (shape (n,)) over the positions where each driving tooth carries."""
        tooth, error = self.touching.driving_tooth, error_rad[self.touching.position]
        high, low = np.full(tooth.max() + 1, -np.inf), np.full(tooth.max() + 1, np.inf)
        np.maximum.at(high, tooth, error)
        np.minimum.at(low, tooth, error)
        return {int(number): float(high[number] - low[number]) for number in distinct(tooth)}


@dataclass(frozen=True, eq=False)
class PairTouch:
    """The contacts at n positions, on pushing flanks and on their backs."""

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
class AsDesigned(PairTouch, Shown):
    """Contact of the exact curves over a whole cycle of meetings."""

    pushing: SideContact
    back: SideContact

    def __repr__(self) -> str:
        error, play = self.pushing.transmission_error_rad, float(self.backlash_rad.max())
        overlap = float(self.overlap_mm.max())
        return (
            f"AsDesigned(at {self.placement.count} positions: transmission error {error:.3g} rad, backlash up to "
            f"{play:.3g} rad, overlap {overlap:.3g} mm)"
        )

    @property
    def overlap_mm(self) -> Array:
        """Depth of the teeth's overlap at the law's driven angle, 0 without overlap, shape (n,)."""
        return np.maximum(self.pushing.overlap_mm, self.back.overlap_mm)

    @property
    def contact_ratio(self) -> float:
        """Mean number of pairs of flanks that touch without load, on the side of the teeth with the smaller number."""
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
    """Contact of the exact curves over a cycle of meetings; raises NoSuchMechanism where no tooth touches another."""
    paths = _paths_of(teeth)
    met = meetings(teeth, placement)
    found = _candidates(teeth, paths, placement, met, BESIDE_IN_PITCHES * placement.pitch_mm)
    contacts, foremost = _rigid_contacts(found, placement)
    touches, pairs = _touch(contacts, foremost, placement), found.flanks.touching(foremost)
    tips = tip_clearances(*paths, met)
    pushing, back = (
        SideContact(
            side,
            touches[side].first,
            touches[side].touching,
            met.on(side),
            pairs[side],
            found.flanks.reaches[met.side == side],
            *tips[side],
        )
        for side in BOTH_SIDES
    )
    return AsDesigned(placement, pushing, back)


def touch_at(teeth: ToothedPair) -> Callable[[Placement], PairTouch]:
    """A function from a placement, whose positions need not be even, to its contacts; raises as ``as_designed``."""
    paths = _paths_of(teeth)

    def touch(placement: Placement) -> PairTouch:
        within_mm = touching_mm(placement)
        found = _candidates(teeth, paths, placement, single_meetings(teeth, placement), within_mm)
        contacts = _contacts_among(found, within_mm)
        return PairTouch(placement, *_touch(contacts, foremost_two(contacts, placement), placement))

    return touch


def contacts_within(teeth: ToothedPair, placement: Placement, within_mm: float) -> tuple[Contacts, Contacts]:
    """The contacts on pushing flanks and on their backs when the first contacts are pressed in by ``within_mm``."""
    found = _candidates(teeth, _paths_of(teeth), placement, meetings(teeth, placement), within_mm)
    contacts = _contacts_among(found, within_mm)
    return contacts.on(PUSHING), contacts.on(BACK)


def repeat_of(teeth: ToothedPair, placement: Placement) -> int:
    """Positions after which the teeth, which are alike, meet as at first; all where they never do."""
    driving, driven = _paths_of(teeth)
    return placement.repeat(driving.places, driven.places)


def first_within(
    teeth: ToothedPair, placement: Placement, within_mm: float, sides: Sequence[int], count: int
) -> list[Contacts]:
    """As ``contacts_within`` on some sides of the teeth: at least the first contact of each pair at each position.

    Only the first ``count`` positions have contacts.
    """
    met = meetings(teeth, placement)
    met = replace(met, there=met.there & (met.position < count))
    met = met.kept(np.isin(met.side, sides) & met.there.any(axis=1))
    found = _candidates(teeth, _paths_of(teeth), placement, met, within_mm)
    flanks, hits = found.flanks.contacts, [hits.kept(np.isin(hits.side, sides)) for hits in found.hits]
    contacts = Contacts.joined([flanks, first_edge_contacts(hits, flanks, found.first_rad, within_mm)])
    return [contacts.on(side) for side in sides]


def pairs_under_load(
    teeth: ToothedPair, placement: Placement, error_rad: Array
) -> tuple[PairsInContact, PairsInContact]:
    """Pairs of flanks that touch with the driven gear ``error_rad`` (n,) beyond the law; rigid if unloaded."""
    beside_mm = BESIDE_IN_PITCHES * placement.pitch_mm
    found = _candidates(teeth, _paths_of(teeth), placement, meetings(teeth, placement), beside_mm)
    return found.flanks.touching(_rigid_contacts(found, placement)[1], error_rad)


@dataclass(frozen=True, eq=False)
class _Candidates:
    """Possible contacts: of flanks, and of corners before curves; leads (2, n) at which flanks first touch."""

    flanks: FlankContacts
    first_rad: Array
    hits: list[EdgeHits]


@lru_cache(maxsize=2)
def _paths_of(teeth: ToothedPair) -> tuple[SidePaths, SidePaths]:
    """The paths of both gears, kept: even positions, extremes and gaps of a pair ask for the same, 3 ms of 40 teeth."""
    driving, driven = (side_paths(gear.flanks, gear.sides) for gear in (teeth.driving, teeth.driven))
    return driving, driven


def _candidates(
    teeth: ToothedPair, paths: tuple[SidePaths, SidePaths], placement: Placement, met: Meetings, within_mm: float
) -> _Candidates:
    """The possible contacts in the given meetings, with the corners within ``within_mm`` of contact."""
    flanks = flank_contacts(teeth, placement, met)
    first = foremost_two(flanks.contacts, placement)[0]
    return _Candidates(flanks, first, edge_hits(paths, placement, met, first, within_mm))


def _contacts_among(found: _Candidates, within_mm: Array | float) -> Contacts:
    """All contacts of flanks, and corners within ``within_mm`` (broadcasts with (2, n)) of the first contacts."""
    return Contacts.joined([found.flanks.contacts, edge_contacts(found.hits, found.first_rad, within_mm)])


def _rigid_contacts(found: _Candidates, placement: Placement) -> tuple[Contacts, Array]:
    """All contacts that touch, those that tell where flanks begin to touch, and the values of ``foremost_two``."""
    contacts = _contacts_among(found, touching_mm(placement))
    foremost = foremost_two(contacts, placement)
    beside = found.flanks.beside_parted(foremost)
    if beside.any():
        within_mm = np.where(beside, BESIDE_IN_PITCHES * placement.pitch_mm, touching_mm(placement))
        contacts = _contacts_among(found, within_mm)
        foremost = foremost_two(contacts, placement)
    return contacts, foremost


def _touch(contacts: Contacts, foremost: Array, placement: Placement) -> tuple[SideTouch, SideTouch]:
    """The first contacts among all, on pushing flanks and on their backs, by the values of ``foremost_two``."""
    later = foremost[0, contacts.side, contacts.position] - contacts.lead_rad
    first = _foremost(contacts, later <= ALIKE_RAD, placement)
    touching = later * contacts.lever_mm <= touching_mm(placement)
    pushing, back = (
        SideTouch(side, contacts.kept(first[side]), contacts.kept(touching & (contacts.side == side)))
        for side in BOTH_SIDES
    )
    return pushing, back


def _foremost(contacts: Contacts, alike: Mask, placement: Placement) -> IndexArray:
    """First contacts, ``alike``, by side and position: flanks, then nearest the pitch point; or NoSuchMechanism."""
    rows, count = np.flatnonzero(alike), len(URGE) * placement.count
    place, flanks, position = contacts.place(placement)[rows], contacts.flanks[rows], contacts.position[rows]
    between_flanks = np.zeros(count, dtype=bool)
    between_flanks[place[flanks]] = True
    ahead = np.exp(-1j * placement.mesh.sense * contacts.error_rad[rows])
    distance = np.abs(contacts.point[rows] - placement.pitch_point[position] * ahead)
    nearest = largest_rows(np.where(flanks | ~between_flanks[place], -distance, -np.inf), place, count)
    missing = np.flatnonzero(nearest < 0) % placement.count
    if missing.size:
        phi1 = in_words(float(placement.phi1_rad[missing[0]]))
        raise NoSuchMechanism(
            f"no tooth touches another at phi1 = {phi1}: the teeth are too short or too far apart there; "
            "more teeth of a smaller module, less backlash or a larger addendum are needed",
            key="gears.teeth",
        )
    return rows[nearest].reshape(len(URGE), -1)
