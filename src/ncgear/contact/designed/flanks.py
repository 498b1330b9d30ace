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


def flank_contacts(teeth: ToothedPair, placement: Placement, met: Meetings) -> tuple[Contacts, Array]:
    """All contacts of flanks on one side of the teeth, and each meeting's arc of contact in pitches, shape (m,)."""
    driving, driven = _heights(teeth.driving), _heights(teeth.driven)
    row, column, facing = _near(teeth, placement, met, driving, driven)
    touches = tangencies(facing, np.stack([driving.limits[:, facing.driving], driven.limits[:, facing.driven]]))
    room = _room(driving.room(facing.driving, touches.driving_mm), driven.room(facing.driven, touches.driven_mm))
    arcs = _arcs(np.where(touches.found, room, -1.0), row, column, met.position.shape) / placement.per_tooth
    least = END_IN_MODULES * facing.module_mm
    touching = touches.found & (room >= -least).all(axis=0).any(axis=0)
    columns = placement.ahead * touches.turn_rad, touches.point, touches.tangent, touches.found
    return Contacts(facing.driving, facing.driven, facing.position, *columns).kept(touching), arcs


def least_arc(teeth: ToothedPair, placement: Placement) -> float:
    """Least arc of contact of any pair of flanks on either side of the teeth, in pitches."""
    return min(
        float(flank_contacts(teeth, placement, meetings(teeth, placement, side))[1].min()) for side in (PUSHING, BACK)
    )


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


def _arcs(room: Array, row: IndexArray, column: IndexArray, shape: tuple[int, int]) -> Array:
    """For how many positions, and fractions between them, each meeting has room; shape (m,).

    On exact flanks heights are linear in rolled length, so the fractions are exact there.
    """
    table = np.full((*room.shape[:2], *shape), -1.0)
    table[..., row, column] = room
    before, after = table[..., :-1], table[..., 1:]
    crossing = before / np.where(before == after, 1.0, before - after)
    enters = np.where(before >= 0.0, 0.0, np.where(after >= 0.0, crossing, 1.0)).max(axis=0)
    leaves = np.where(after >= 0.0, 1.0, np.where(before >= 0.0, crossing, 0.0)).min(axis=0)
    lasting: Array = np.maximum(leaves - enters, 0.0).sum(axis=(0, 2))
    return lasting
