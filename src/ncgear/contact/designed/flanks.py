"""Contacts of flanks with flanks, and how long each pair of flanks touches."""

from __future__ import annotations

from dataclasses import dataclass
from math import cos, sin

import numpy as np

from ncgear.contact.designed.curves import Contacts
from ncgear.contact.designed.tangency import FacingFlanks, tangencies
from ncgear.contact.placement import BACK, PUSHING, Meetings, Placement, meetings
from ncgear.numerics.arrays import Array, IndexArray
from ncgear.teeth.flank import FLANK
from ncgear.teeth.gear import ToothedGear, ToothedPair

BEYOND_IN_PITCHES = 0.15
"""Flanks are also solved over this rolled length beyond their ends, so that the ends lie between solved positions.  It
is three positions long, which also covers what backlash shifts."""

END_IN_MODULES = 1e-9
"""Height beyond its end at which a flank still counts as touching: rounding errors where an end meets a position."""

TOUCHING_MM = 1e-3
"""Distance at which teeth count as touching along with the first ones: a micrometre, which the lightest load closes."""

GAP = 1e-3
"""Share of a step between positions by which one pair must part before the next one meets to count as a gap.  Beside
tip relief the lead is no straight line between positions; half a hundredth of a per cent of a pitch matters nowhere."""

NOWHERE_MM = 1e9
"""Height that no flank reaches; finite, so that differences of two are numbers."""


@dataclass(frozen=True, eq=False)
class _Heights:
    """What is left of each flank: up to r runs between heights in mm, shape (r, flanks).

    A run that does not exist has its top below its bottom.
    """

    top: Array
    bottom: Array

    @property
    def limits(self) -> Array:
        """Least and greatest height of each flank, shape (2, flanks)."""
        return np.stack([self.bottom.min(axis=0), self.top.max(axis=0)])

    def room(self, flank: IndexArray, height: Array) -> Array:
        """Distances in mm to both ends of each run, negative beyond it, shape (2, r, ...)."""
        shape = self.top.shape[0], *flank.shape
        top, bottom = self.top[:, flank].reshape(shape), self.bottom[:, flank].reshape(shape)
        return np.stack([top - height, height - bottom])


@dataclass(frozen=True, eq=False)
class PairsInContact:
    """How the pairs of flanks on one side of the teeth touch over the whole cycle.

    ``arcs`` (shape (m,)) is how long the flanks of each meeting touch, in pitches.  ``gaps`` (shape (k, 2)) are starts
    and ends, in positions, of where no flanks touch.  ``fewest`` is the least number of pairs that touch at any angle.
    ``positions`` is the number of positions in the cycle.
    """

    arcs: Array
    gaps: Array
    fewest: int
    positions: int

    @property
    def contact_ratio(self) -> float:
        """Mean number of pairs that touch: there is one meeting in each pitch, so it is the mean of all arcs."""
        return float(self.arcs.mean())

    @property
    def least_arc(self) -> float:
        """Least arc of contact of any pair, in pitches."""
        return float(self.arcs.min())

    @property
    def longest_gap(self) -> float:
        """Longest way without contact of flanks, in positions."""
        return float(np.max(self.gaps[:, 1] - self.gaps[:, 0], initial=0.0))

    @property
    def parted_at(self) -> int:
        """The position nearest to the middle of the longest way without contact of flanks."""
        middle = float(self.gaps[int(np.argmax(self.gaps[:, 1] - self.gaps[:, 0]))].mean())
        return round(middle) % self.positions


@dataclass(frozen=True, eq=False)
class FlankContacts:
    """Where flanks on one side of the teeth touch if nothing else holds the gears apart.

    ``contacts`` are those within what is left of both flanks.  ``near`` are these and the ones a little beyond the
    flanks' ends, shape (n,): ``room`` (shape (4, combinations, n)) is how far in mm each is from the ends of both
    flanks' runs, negative beyond them, and ``place`` its row and column in the table of meetings.  ``position``
    numbers the positions of that table.
    """

    contacts: Contacts
    near: Contacts
    room: Array
    place: tuple[IndexArray, IndexArray]
    position: IndexArray
    placement: Placement

    @property
    def reaches(self) -> Array:
        """How long the flanks of each meeting can touch, in pitches, shape (m,): as far as both flanks reach."""
        return self._arcs(*_between(self.room, *self.place, self.position.shape))

    def touching(self, foremost: Array, urge: float, error_rad: Array | None = None) -> PairsInContact:
        """The pairs whose flanks do touch, by the two values of ``foremost_two``.

        Rigid flanks touch along with the first contact at each position; where others hold them apart, as beside a tip
        relief, they do not.  Under a load the driven gear stands at ``error_rad`` beyond the law at each position
        (shape (n,)), and all flanks that are as far ahead touch.
        """
        own = urge * self.near.error_rad
        first, second = foremost[:, self.near.position]
        # The lead over the others goes smoothly through zero where flanks part, so that it may be interpolated.
        others = np.where((own >= first) & np.isfinite(second), second, first)
        closer = TOUCHING_MM - np.where(np.isfinite(others), others - own, 0.0) * self.near.lever_mm
        if error_rad is not None:
            pressed_mm = (own - urge * error_rad[self.near.position]) * self.near.lever_mm
            closer = np.maximum(closer, pressed_mm)
        closer = np.where(self.near.flanks, closer, -1.0)
        room = np.concatenate([self.room, np.broadcast_to(closer, (1, *self.room.shape[1:]))])
        enters, leaves = _between(room, *self.place, self.position.shape)
        arcs, gaps = self._arcs(enters, leaves), self._gaps(enters, leaves)
        return PairsInContact(arcs, gaps, 0 if len(gaps) else self._fewest(enters, leaves), self.placement.count)

    def _arcs(self, enters: Array, leaves: Array) -> Array:
        lasting: Array = np.maximum(leaves - enters, 0.0).sum(axis=(0, 2)) / self.placement.per_tooth
        return lasting

    def _gaps(self, enters: Array, leaves: Array) -> Array:
        touch, count = leaves > enters, self.placement.count
        before = np.broadcast_to(self.position[:, :-1], touch.shape)[touch]
        order = np.argsort(starts := before + enters[touch])
        if not order.size:
            return np.array([[0.0, count]])
        ends = np.maximum.accumulate((before + leaves[touch])[order])
        starts = np.append(starts[order][1:], starts.min() + count)
        parted = starts - ends > GAP
        return np.column_stack([ends[parted], starts[parted]])

    def _fewest(self, enters: Array, leaves: Array) -> int:
        """Least number of pairs that touch anywhere, left out what is shorter than a gap may be."""
        touch = leaves > enters
        before = np.broadcast_to(self.position[:, :-1], touch.shape)[touch]
        place = np.concatenate([before + enters[touch], before + leaves[touch]])
        order = np.argsort(place)
        number = np.cumsum(np.repeat([1, -1], before.size)[order])
        lasting = np.diff(place[order], append=self.placement.count) > GAP
        return int(number[lasting].min())


def flank_contacts(teeth: ToothedPair, placement: Placement, met: Meetings) -> FlankContacts:
    """All contacts of flanks on one side of the teeth."""
    driving, driven = _heights(teeth.driving), _heights(teeth.driven)
    row, column, facing = _near(teeth, placement, met, driving, driven)
    touches = tangencies(facing, np.stack([driving.limits[:, facing.driving], driven.limits[:, facing.driven]]))
    room = _room(driving.room(facing.driving, touches.driving_mm), driven.room(facing.driven, touches.driven_mm))
    least = END_IN_MODULES * facing.module_mm
    touching = touches.found & (room >= -least).all(axis=0).any(axis=0)
    columns = placement.ahead * touches.turn_rad, touches.point, touches.tangent, touches.found
    near = Contacts(facing.driving, facing.driven, facing.position, *columns)
    found = np.where(touches.found, room, -1.0)
    return FlankContacts(near.kept(touching), near, found, (row, column), met.position, placement)


def foremost_two(contacts: Contacts, urge: float, placement: Placement) -> Array:
    """The first and the next driven angle of contacts at each position, times the urge, shape (2, n).

    They are -inf where there is none.
    """
    value = urge * contacts.error_rad
    order = np.lexsort((value, contacts.position))
    rising = contacts.position[order]
    leading = np.ones(rising.size, dtype=bool)
    leading[:-1] = rising[1:] != rising[:-1]
    two = np.full((2, placement.count), -np.inf)
    two[0, rising[leading]] = value[order[leading]]
    np.maximum.at(two[1], rising[~leading], value[order[~leading]])
    return two


def least_arc(teeth: ToothedPair, placement: Placement) -> float:
    """Least arc of contact of any pair of flanks on either side of the teeth, in pitches, without load."""
    least = []
    for side in (PUSHING, BACK):
        met = meetings(teeth, placement, side)
        found = flank_contacts(teeth, placement, met)
        least.append(found.touching(foremost_two(found.contacts, met.urge, placement), met.urge).least_arc)
    return min(least)


def _heights(gear: ToothedGear) -> _Heights:
    """The heights between which flanks are left, from the runs of a gear's sides."""
    chosen = gear.sides.kind == FLANK
    owner = gear.sides.owner[chosen]
    number = np.arange(owner.size) - np.searchsorted(owner, owner)
    shape = int(number.max()) + 1, gear.flanks.count
    top, bottom = np.full(shape, -NOWHERE_MM), np.full(shape, NOWHERE_MM)
    top[number, owner], bottom[number, owner] = gear.sides.start[chosen], gear.sides.end[chosen]
    return _Heights(top, bottom)


def _near(
    teeth: ToothedPair, placement: Placement, meetings: Meetings, driving: _Heights, driven: _Heights
) -> tuple[IndexArray, IndexArray, FacingFlanks]:
    """Where in the meetings' table (row, column) both flanks are on or near what is left of them, and these flanks."""
    rack = teeth.driving.flanks.rack
    # Heights, by the closed form, at which flanks touch before they cross the pitch point.
    first = meetings.side * rack.height_per_rolled * meetings.driving_ahead_mm
    second = -meetings.side * rack.height_per_rolled * meetings.driven_ahead_mm
    room = _room(driving.room(meetings.driving[:, None], first), driven.room(meetings.driven[:, None], second))
    beyond = BEYOND_IN_PITCHES * rack.pitch_mm * sin(rack.pressure_angle_rad) * cos(rack.pressure_angle_rad)
    row, column = place = np.nonzero((room >= -beyond).all(axis=0).any(axis=0))
    numbers = meetings.driving[row], meetings.driven[row], meetings.position[place]
    upward = placement.ahead * meetings.urge
    return row, column, FacingFlanks(teeth, placement, upward, *numbers, first[place], second[place])


def _room(driving: Array, driven: Array) -> Array:
    """Rooms of both flanks for every combination of their runs, shape (4, combinations, ...)."""
    first, second = np.broadcast_arrays(driving[:, :, None], driven[:, None])
    joined = np.concatenate([first, second])
    return joined.reshape(4, -1, *joined.shape[3:])


def _between(room: Array, row: IndexArray, column: IndexArray, shape: tuple[int, ...]) -> tuple[Array, Array]:
    """Where between two positions of the table each meeting begins and ceases to have room, as shares of the step.

    Shape (combinations, rows, columns - 1); where it has none, the first is not less than the second.  On exact flanks
    heights are linear in rolled length, so the shares are exact there.
    """
    table = np.full((*room.shape[:2], *shape), -1.0)
    table[..., row, column] = room
    before, after = table[..., :-1], table[..., 1:]
    crossing = before / np.where(before == after, 1.0, before - after)
    enters = np.where(before >= 0.0, 0.0, np.where(after >= 0.0, crossing, 1.0)).max(axis=0)
    leaves = np.where(after >= 0.0, 1.0, np.where(before >= 0.0, crossing, 0.0)).min(axis=0)
    return enters, leaves
