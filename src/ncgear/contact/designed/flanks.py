"""Contacts of flanks with flanks, and how long each pair of flanks touches."""

from __future__ import annotations

from functools import cached_property

import numpy as np

from ncgear.contact.designed.curves import Contacts
from ncgear.contact.designed.tangency import FacingFlanks, tangencies
from ncgear.contact.placement import BOTH_SIDES, URGE, Meetings, Placement, meetings
from ncgear.frozen import dataclass
from ncgear.numerics.arrays import Array, IndexArray, Mask, largest_rows
from ncgear.teeth.flank import FLANK
from ncgear.teeth.gear import ToothedGear, ToothedPair

BEYOND_IN_PITCHES = 0.15
"""Flanks are also solved over this rolled length beyond their ends, so that the ends lie between solved positions.  It
is three positions long, which also covers the shift by backlash."""

END_IN_MODULES = 1e-9
"""Height beyond its end up to which a flank still counts as touching: rounding errors where an end meets a position."""

TOUCHING_IN_PITCHES = 1e-4
"""Distance that the lightest load closes, so teeth touch with the first teeth: a micrometre for module 3."""

GAP = 1e-3
"""Least gap between the contacts of two pairs that counts, as a share of a step between positions.  Beside tip relief
the lead is no straight line between positions; half a hundredth of a per cent of a pitch never matters."""


def touching_mm(placement: Placement) -> float:
    """That distance for the teeth of a pair."""
    return TOUCHING_IN_PITCHES * placement.pitch_mm


NOWHERE_MM = 1e9
"""Height that no flank reaches, whatever its size; finite, so that differences of two are numbers."""


@dataclass(frozen=True, eq=False)
class _Heights:
    """The remaining parts of each flank: up to r runs between heights in mm, (r, flanks); no run where top < bottom."""

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
    """Contact of the pairs of flanks on one side of the teeth over the whole cycle.

    ``arcs`` (shape (m,)) are the arcs of contact of the meetings in pitches.  ``gaps`` (shape (k, 2)) are the starts
    and ends, in positions, of the stretches without contact of flanks.  ``fewest`` is the least number of pairs that
    touch at any angle.  ``positions`` is the number of positions in the cycle, and ``pitches`` the number of pitches.
    Where gears turn less than once, the flanks that touch at an end of the range do so over a part of their arc:
    ``whole`` (shape (m,)) marks the meetings whose whole arc lies within the range.
    """

    arcs: Array
    gaps: Array
    fewest: int
    positions: int
    pitches: float
    whole: Mask

    @property
    def contact_ratio(self) -> float:
        """Mean number of pairs that touch, over the cycle or the range."""
        return float(self.arcs.sum() / self.pitches)

    @property
    def least_arc(self) -> float:
        """Least arc of contact of any pair, in pitches; infinite where all touch at an end of a range."""
        return float(np.min(self.arcs, where=self.whole, initial=np.inf))

    @property
    def shortest(self) -> int:
        """The meeting whose flanks touch over the least length."""
        return int(np.argmin(np.where(self.whole, self.arcs, np.inf)))

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
    """Contacts of flanks on each side of the teeth, if nothing else holds the gears apart.

    ``contacts`` are the contacts within the remaining parts of both flanks.  ``near`` are these and the contacts a
    little beyond the flanks' ends, shape (n,): ``room`` (shape (4, combinations, n)) are their distances in mm from the
    ends of both flanks' runs, negative beyond them, and ``place`` their rows and columns in the table of ``meetings``.
    """

    contacts: Contacts
    near: Contacts
    room: Array
    place: tuple[IndexArray, IndexArray]
    meetings: Meetings
    placement: Placement

    @cached_property
    def reaches(self) -> Array:
        """How long the flanks of each meeting can touch, in pitches, shape (m,): as far as both flanks reach."""
        return self._arcs(*self._reaching)

    def touching(self, foremost: Array, error_rad: Array | None = None) -> tuple[PairsInContact, PairsInContact]:
        """The pairs whose flanks really touch, on pushing flanks and on their backs, by the values of ``foremost_two``.

        Rigid flanks touch along with the first contact at each position; where others hold them apart, as beside a tip
        relief, they do not.  Under a load the driven gear stands at ``error_rad`` beyond the law at each position
        (shape (n,)), and all flanks that are as far ahead touch.
        """
        near = self.near
        first, second = foremost[:, near.side, near.position]
        # The lead over the others goes smoothly through zero where flanks part, so that it may be interpolated.
        others = np.where((near.lead_rad >= first) & np.isfinite(second), second, first)
        closer = (
            touching_mm(self.placement) - np.where(np.isfinite(others), others - near.lead_rad, 0.0) * near.lever_mm
        )
        if error_rad is not None:
            pressed_mm = (near.lead_rad - near.urge * error_rad[near.position]) * near.lever_mm
            closer = np.maximum(closer, pressed_mm)
        closer = np.where(near.flanks, closer, -1.0)
        enters, leaves = self._reaching
        if np.any(closer < 0.0):
            meet, part = _between(closer[None, None], *self.place, self.meetings.position.shape)
            enters, leaves = np.maximum(enters, meet), np.minimum(leaves, part)
        arcs = self._arcs(enters, leaves)
        _, row, column = touch = np.nonzero(leaves > enters)
        before = self.meetings.position[row, column]
        starts, ends = before + enters[touch], before + leaves[touch]
        pushing, back = (
            self._pairs(arcs[self.meetings.side == side], starts[own], ends[own], side)
            for side, own in ((side, self.meetings.side[row] == side) for side in BOTH_SIDES)
        )
        return pushing, back

    def _pairs(self, arcs: Array, starts: Array, ends: Array, side: int) -> PairsInContact:
        """Pairs that touch over ``arcs``, from ``starts`` to ``ends`` in positions."""
        placement = self.placement
        steps, pitches = placement.steps, placement.steps / placement.per_tooth
        whole = self.whole[self.meetings.side == side]
        if not starts.size:
            return PairsInContact(arcs, np.array([[0.0, steps]]), 0, placement.count, pitches, whole)
        starts, ends = np.sort(starts), np.sort(ends)
        if placement.toothed is None:
            began, ended = np.append(starts[1:], starts[0] + steps), ends
        else:
            began, ended = np.append(starts, steps), np.append(0.0, ends)
        # Before a gap as many stretches have ended as have begun.
        parted = began - ended > GAP
        gaps = np.column_stack([ended[parted], began[parted]])
        fewest = 0 if len(gaps) else _fewest(starts, ends, steps)
        return PairsInContact(arcs, gaps, fewest, placement.count, pitches, whole)

    @cached_property
    def whole(self) -> Mask:
        """Whether the whole arc of contact of each meeting lies within the positions, shape (m,).

        For flanks that cannot touch at all, whether the crossing of the pitch point does.
        """
        if self.placement.toothed is None:
            return np.ones(self.meetings.side.size, dtype=bool)
        enters, leaves = self._reaching
        lasting, before = leaves > enters, self.meetings.position[:, :-1]
        first = np.min(before + enters, axis=(0, 2), where=lasting, initial=np.inf)
        last = np.max(before + leaves, axis=(0, 2), where=lasting, initial=-np.inf)
        inside = (first > GAP) & (last < self.placement.steps - GAP)
        ahead = self.meetings.driving_ahead_mm
        crosses = np.any((ahead[:, :-1] >= 0.0) & (ahead[:, 1:] <= 0.0) & self._steps_there, axis=1)
        return np.where(lasting.any(axis=(0, 2)), inside, crosses)

    @property
    def reach_ends(self) -> Array:
        """Places where the flanks of each meeting begin and cease to reach each other, shape (2, m).

        They are counted in positions from the first of the meeting's row; infinite where flanks never reach.
        """
        enters, leaves = self._reaching
        lasting, before = leaves > enters, np.arange(enters.shape[2])
        first = np.min(before + enters, axis=(0, 2), where=lasting, initial=np.inf)
        last = np.max(before + leaves, axis=(0, 2), where=lasting, initial=-np.inf)
        return np.stack([first, last])

    @property
    def _steps_there(self) -> Mask:
        """Which steps between two positions of a meeting there are, shape (m, k - 1)."""
        return self.meetings.there[:, :-1] & self.meetings.there[:, 1:]

    def beside_parted(self, foremost: Array) -> Mask:
        """Whether flanks near contact do not touch at or next to each position, shape (2, n)."""
        near, parted = self.near, np.zeros(foremost.shape[1:], dtype=bool)
        behind_mm = (foremost[0, near.side, near.position] - near.lead_rad) * near.lever_mm
        apart = ~(near.flanks & (behind_mm <= touching_mm(self.placement)))
        parted[near.side[apart], near.position[apart]] = True
        return parted | np.roll(parted, 1, axis=1) | np.roll(parted, -1, axis=1)

    @cached_property
    def _reaching(self) -> tuple[Array, Array]:
        """Places between positions where the flanks of each meeting begin and cease to reach each other."""
        enters, leaves = _between(self.room, *self.place, self.meetings.position.shape)
        return enters, np.where(self._steps_there, leaves, enters)

    def _arcs(self, enters: Array, leaves: Array) -> Array:
        return np.maximum(leaves - enters, 0.0).sum(axis=(0, 2)) / self.placement.per_tooth


def _fewest(starts: Array, ends: Array, steps: int) -> int:
    """Least number of ordered stretches that cover any place; parts shorter than a gap may be are left out."""
    place = np.concatenate([starts, ends])
    order = np.argsort(place, kind="stable")
    number = np.cumsum(np.repeat([1, -1], starts.size)[order])
    lasting = np.diff(place[order], append=steps) > GAP
    return int(number[lasting].min())


def flank_contacts(teeth: ToothedPair, placement: Placement, met: Meetings) -> FlankContacts:
    """All contacts of flanks in the given meetings."""
    driving, driven = _heights(teeth.driving), _heights(teeth.driven)
    row, column, facing = _near(teeth, placement, met, driving, driven)
    touches = tangencies(facing, np.stack([driving.limits[:, facing.driving], driven.limits[:, facing.driven]]))
    room = _room(driving.room(facing.driving, touches.driving_mm), driven.room(facing.driven, touches.driven_mm))
    least = END_IN_MODULES * facing.module_mm
    touching = touches.found & (room >= -least).all(axis=0).any(axis=0)
    heights = np.where(touches.found, [touches.driving_mm, touches.driven_mm], np.nan)
    columns = placement.ahead * touches.turn_rad, touches.point, touches.tangent, *heights
    near = Contacts(met.side[row], facing.driving, facing.driven, facing.position, *columns)
    found = np.where(touches.found, room, -1.0)
    return FlankContacts(near.kept(touching), near, found, (row, column), met, placement)


def foremost_two(contacts: Contacts, placement: Placement) -> Array:
    """First and next lead of contacts on both sides at each position, (2, 2, n); -inf where there is no contact."""
    count = len(URGE) * placement.count
    lead, place = contacts.lead_rad, contacts.place(placement)
    foremost = largest_rows(lead, place, count)
    foremost = foremost[foremost >= 0]
    others = np.ones(lead.size, dtype=bool)
    others[foremost] = False
    two = np.full((2, count), -np.inf)
    two[0, place[foremost]] = lead[foremost]
    np.maximum.at(two[1], place[others], lead[others])
    return two.reshape(2, len(URGE), -1)


def least_arc(teeth: ToothedPair, placement: Placement) -> float:
    """Least arc of contact of any pair of flanks on either side of the teeth, in pitches, without load."""
    found = flank_contacts(teeth, placement, meetings(teeth, placement))
    return min(pairs.least_arc for pairs in found.touching(foremost_two(found.contacts, placement)))


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
    """Places in the meetings' table (row, column) of flanks on or near their remaining parts, and these flanks."""
    pitch_mm, slant = teeth.driving.flanks.rack.pitch_mm, teeth.driving.flanks.slant.of(meetings.driving)
    # Heights, by the closed form, at which flanks touch before they cross the pitch point.
    per_rolled = (slant.height_per_rolled * meetings.urge)[:, None]
    first, second = -per_rolled * meetings.driving_ahead_mm, per_rolled * meetings.driven_ahead_mm
    room = _room(driving.room(meetings.driving[:, None], first), driven.room(meetings.driven[:, None], second))
    beyond = np.broadcast_to(BEYOND_IN_PITCHES * pitch_mm * slant.sine * slant.cosine, meetings.side.shape)
    row, column = place = np.nonzero((room >= -beyond[:, None]).all(axis=0).any(axis=0) & meetings.there)
    numbers = meetings.driving[row], meetings.driven[row], meetings.position[place]
    upward = placement.ahead * meetings.urge[row]
    return row, column, FacingFlanks(teeth, placement, upward, *numbers, first[place], second[place])


def _room(driving: Array, driven: Array) -> Array:
    """Rooms of both flanks for every combination of their runs, shape (4, combinations, ...)."""
    first, second = np.broadcast_arrays(driving[:, :, None], driven[:, None])
    joined = np.concatenate([first, second])
    return joined.reshape(4, -1, *joined.shape[3:])


def _between(room: Array, row: IndexArray, column: IndexArray, shape: tuple[int, ...]) -> tuple[Array, Array]:
    """Places between two positions where each meeting begins and ceases to have room, as shares of the step.

    Shape (combinations, rows, columns - 1); without room, the first is not less than the second.  On exact flanks
    heights are linear in rolled length, so the shares are exact there.
    """
    table = np.full((*room.shape[:2], *shape), -1.0)
    table[..., row, column] = room
    before, after = table[..., :-1], table[..., 1:]
    crossing = before / np.where(before == after, 1.0, before - after)
    enters = np.where(before >= 0.0, 0.0, np.where(after >= 0.0, crossing, 1.0)).max(axis=0)
    leaves = np.where(after >= 0.0, 1.0, np.where(before >= 0.0, crossing, 0.0)).min(axis=0)
    return enters, leaves
