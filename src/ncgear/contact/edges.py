"""Edge contact: corners of one gear's teeth against the curves of the other, exact along circles about the driven axis.

Chords of the curves tell which corners come near enough to matter; only for those are the curves themselves solved.
"""

from __future__ import annotations

from dataclasses import dataclass, fields

import numpy as np

from ncgear.contact.circles import crossing
from ncgear.contact.contacts import Contacts
from ncgear.contact.meetings import Meetings
from ncgear.contact.seen import SeenGear
from ncgear.numerics.arrays import Array, ComplexArray, IndexArray, Mask
from ncgear.numerics.crossing import refined_crossings
from ncgear.numerics.plane import angle_between, as_points, square
from ncgear.teeth.sides import AGREEMENT

REACH_IN_PITCHES = 0.6
"""How far along its circle a corner is followed: what is farther off is another tooth or another side of this one."""

NEAR_IN_MODULES = 0.02
"""How much nearer than by its chords a corner may be by its curve: several times what those chords stray."""


@dataclass(frozen=True, eq=False)
class _Hits:
    """Corners of one gear whose circles cross chords of the other, all of shape (n,).

    ``corner`` is in the driven gear's frame; ``chord`` is the chord's place in its flank's row of the paths' tables,
    ``share`` how far along it the crossing lies, ``lever_mm`` the arm of a force across it; ``turn_rad`` turns the
    corner onto it, ``urge_rad`` is the driven angle at which they touch, times ``Meetings.urge``.
    """

    curves: SeenGear
    meeting: IndexArray
    position: IndexArray
    corner: ComplexArray
    chord: IndexArray
    share: Array
    lever_mm: Array
    turn_rad: Array
    urge_rad: Array

    def kept(self, rows: Mask) -> _Hits:
        columns = [getattr(self, field.name)[rows] for field in fields(self)[1:]]
        return _Hits(self.curves, *columns)


def edge_contacts(driving: SeenGear, driven: SeenGear, meetings: Meetings, first_rad: Array) -> Contacts:
    """Corners that may touch, on one side of the teeth, before anything else does.

    ``first_rad`` is the first contact of flanks at each position, times ``meetings.urge``; -inf where there is none.
    Raises ArithmeticError if a corner that comes near is not found on its curve.
    """
    found = [_hits(driving, driven, meetings), _hits(driven, driving, meetings)]
    first = first_rad.copy()
    for hits in found:
        np.maximum.at(first, hits.position, hits.urge_rad)
    near = NEAR_IN_MODULES * driving.paths.flanks.rack.module_mm
    chosen = [hits.kept((hits.urge_rad - first[hits.position]) * hits.lever_mm >= -near) for hits in found]
    return Contacts.joined([_touching(hits) for hits in chosen])


def _hits(corners: SeenGear, curves: SeenGear, meetings: Meetings) -> _Hits:
    """Crossings of the corners' circles with the chords of the flanks they meet."""
    position = meetings.position[..., None]
    corner = corners.points(corners.paths.corner[corners.flank][:, None], position)
    start = curves.points(curves.paths.start[curves.flank][:, None], position)
    step = curves.directions(curves.paths.step[curves.flank][:, None], position)
    row, column, number, chord = np.nonzero(_crossed(square(corner), square(start), square(start + step), curves))
    at = _picked(corner, row, column, number)
    begin, whole = _picked(start, row, column, chord), _picked(step, row, column, chord)
    inner, outwards = (begin, whole) if curves.rootwards_out else (begin + whole, -whole)
    place, lever = crossing(inner, outwards, square(at))
    turn = angle_between(at, place)
    share = np.abs(place - begin) / np.abs(whole)
    urge = meetings.urge * _ahead(curves, turn)
    hits = _Hits(curves, row, meetings.position[row, column], at, chord, share, lever, turn, urge)
    return hits.kept(np.abs(turn) * np.abs(at) <= REACH_IN_PITCHES * curves.paths.flanks.rack.pitch_mm)


def _crossed(radius: Array, before: Array, after: Array, curves: SeenGear) -> Mask:
    """Whether circles cross chords in the sense in which facing flanks run, shape (m, k, corners, chords).

    Squared radii of the corners, shape (m, k or 1, corners), and of the chords' ends, shape (m, k or 1, chords).
    """
    inner, outer = (before, after) if curves.rootwards_out else (after, before)
    crossed: Mask = (inner[:, :, None] <= radius[..., None]) & (outer[:, :, None] > radius[..., None])
    return crossed


def _picked(table: ComplexArray, row: IndexArray, column: IndexArray, place: IndexArray) -> ComplexArray:
    """Entries of a table whose second axis has the length 1 where nothing moves."""
    picked: ComplexArray = table[row, column if table.shape[1] > 1 else 0, place]
    return picked


def _touching(hits: _Hits) -> Contacts:
    """The exact places of hits on the curves themselves."""
    gear, place = hits.curves, (hits.curves.flank[hits.meeting], hits.chord)
    run, first, last = gear.paths.run[place], gear.paths.first[place], gear.paths.last[place]

    def curve(parameter: Array) -> tuple[Array, Array]:
        point, slope = gear.curve(run, parameter, hits.position)
        return as_points(point), as_points(slope)

    def circle(turn: Array) -> tuple[Array, Array]:
        turned = hits.corner * np.exp(1j * turn)
        return as_points(turned), as_points(1j * turned)

    start = first + (last - first) * hits.share
    agreement = AGREEMENT * gear.paths.flanks.rack.module_mm
    parameter, turn, met = refined_crossings(curve, circle, start, hits.turn_rad, agreement)
    if not met.all():
        raise ArithmeticError("a tooth's corner was not found on the curve that it touches")
    point, slope = gear.curve(run, parameter, hits.position)
    turned = np.exp(-1j * turn) if gear.moving else np.ones(1)
    flanks = np.zeros(met.size, dtype=bool)
    return Contacts(hits.meeting, hits.position, _ahead(gear, turn), point * turned, slope * turned, flanks)


def _ahead(curves: SeenGear, turn_rad: Array) -> Array:
    """How far ahead the driven gear is when corners that are turned by angles lie on a gear's curves.

    Corners of the driven gear rest: instead of them the driving gear's curves are turned back.
    """
    return curves.placement.ahead * (-turn_rad if curves.moving else turn_rad)
