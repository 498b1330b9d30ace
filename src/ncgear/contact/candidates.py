"""What may touch on one side of the teeth: pairs of flanks, and corners before curves."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from ncgear.contact.contacts import Contacts
from ncgear.contact.edges import EdgeHits, edge_contacts, edge_hits
from ncgear.contact.flank_contacts import flank_contacts
from ncgear.contact.meetings import Meetings, meetings
from ncgear.contact.placement import BACK, PUSHING, Placement
from ncgear.contact.seen import seen_pair
from ncgear.contact.side_paths import SidePaths, side_paths
from ncgear.numerics.arrays import Array
from ncgear.teeth.gear import ToothedPair


@dataclass(frozen=True, eq=False)
class Candidates:
    """Contacts of flanks on one side of the teeth, how long each meeting's last in pitches, and corners near curves."""

    meetings: Meetings
    flanks: Contacts
    arcs: Array
    hits: list[EdgeHits]


def paths_of(teeth: ToothedPair) -> tuple[SidePaths, SidePaths]:
    """The paths of the driving gear's flanks and of the driven gear's."""
    driving, driven = (side_paths(gear.flanks, gear.sides) for gear in (teeth.driving, teeth.driven))
    return driving, driven


def candidates(teeth: ToothedPair, paths: tuple[SidePaths, SidePaths], placement: Placement, side: float) -> Candidates:
    """The candidates on the driving gear's flanks of ``side`` (PUSHING or BACK)."""
    met = meetings(teeth, placement, side)
    return Candidates(met, *flank_contacts(teeth, placement, met), edge_hits(*seen_pair(*paths, placement, met), met))


def contacts_among(own: Candidates, other: Candidates, placement: Placement, within_mm: float = 0.0) -> Contacts:
    """All contacts of flanks on one side of the teeth, and those corners that come within a distance of the first.

    A corner in a notch or at the far side of its space is held by curves that are gathered on the other side of the
    teeth.
    """
    urge = own.meetings.urge
    hits = [found.kept(found.facing) for found in own.hits] + [found.kept(~found.facing) for found in other.hits]
    return Contacts.joined([own.flanks, edge_contacts(hits, urge, first_of(own.flanks, urge, placement), within_mm)])


def first_of(contacts: Contacts, urge: float, placement: Placement) -> Array:
    """First driven angle of contacts at each position, times the urge, -inf where there is none, shape (n,)."""
    first = np.full(placement.count, -np.inf)
    np.maximum.at(first, contacts.position, urge * contacts.error_rad)
    return first


def contacts_within(teeth: ToothedPair, placement: Placement, within_mm: float) -> tuple[Contacts, Contacts]:
    """What touches on pushing flanks and on their backs once first contacts are pressed in by a depth in mm."""
    paths = paths_of(teeth)
    pushing, back = (candidates(teeth, paths, placement, side) for side in (PUSHING, BACK))
    return contacts_among(pushing, back, placement, within_mm), contacts_among(back, pushing, placement, within_mm)
