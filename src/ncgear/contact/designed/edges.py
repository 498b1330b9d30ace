"""Edge contact: corners of one gear's teeth against the curves of the other.

As one gear turns against the other about the driven axis, its corners run along circles.  Chords of the curves tell
which corners come near enough to matter; only for those the crossing of circle and exact curve is solved.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np
from scipy.optimize import elementwise

from ncgear.contact.designed.curves import Contacts, SeenGear, SidePaths
from ncgear.contact.placement import Meetings, Placement
from ncgear.numerics.arrays import Array, Columns, ComplexArray, IndexArray, Mask
from ncgear.numerics.crossing import circle_crossings, refined_crossings
from ncgear.numerics.plane import angle_between, as_points, square
from ncgear.teeth.tool import AGREEMENT

REACH_IN_PITCHES = 0.6
"""How far along its circle a corner is followed: beyond are another tooth or the other side of the same tooth."""

NEAR_IN_MODULES = 0.02
"""How much nearer a corner may be to a curve than to its chords: several times what those chords stray."""

ON_CIRCLE = 1e-12
"""Relative error of the radius at which a point counts as on its corner's circle: rounding errors."""


@dataclass(frozen=True, eq=False)
class EdgeHits(Columns):
    """Corners of one gear whose circles cross chords of the other's ``curves``, all of shape (n,).

    ``driving`` and ``driven`` number the flanks that meet in ``position``.  ``corner`` is in the driven gear's frame.
    ``chord`` is the chord's place in its flank's row of the paths' tables, ``share`` how far along the chord the
    crossing lies, ``lever_mm`` the arm of a force across it.  Turned by ``turn_rad`` the corner is on the chord; the
    driven gear is then ``error_rad`` ahead of the law.  ``facing`` is false where the curve holds the corner in the
    other sense than flanks of its side do, as in the notch of an undercut tooth or at the far side of a space.
    """

    curves: SeenGear
    driving: IndexArray
    driven: IndexArray
    position: IndexArray
    corner: ComplexArray
    chord: IndexArray
    share: Array
    lever_mm: Array
    turn_rad: Array
    error_rad: Array
    facing: Mask

    @property
    def run(self) -> IndexArray:
        """Number of the run that each chord belongs to."""
        return self.curves.paths.run[self._place]

    @property
    def ends(self) -> tuple[Array, Array]:
        """Parameters of the curves at both ends of each chord."""
        return self.curves.paths.first[self._place], self.curves.paths.last[self._place]

    @property
    def _place(self) -> tuple[IndexArray, IndexArray]:
        return (self.driving if self.curves.moving else self.driven), self.chord


def edge_hits(driving: SidePaths, driven: SidePaths, placement: Placement, meetings: Meetings) -> list[EdgeHits]:
    """Corners of the driving gear on the driven gear's curves, and the other way round, of the flanks that meet."""
    moving = SeenGear(driving, meetings.driving, placement, moving=True)
    resting = SeenGear(driven, meetings.driven, placement, moving=False)
    return [_hits(moving, resting, meetings), _hits(resting, moving, meetings)]


def _hits(corners: SeenGear, curves: SeenGear, meetings: Meetings) -> EdgeHits:
    """Crossings of the corners' circles with the chords of the flanks they meet."""
    position, pitch_mm = meetings.position, curves.paths.flanks.rack.pitch_mm
    corner = corners.points(corners.paths.corner[corners.flank][:, None], position[..., None])
    corner = np.broadcast_to(corner, (*position.shape, corner.shape[2]))
    before, after = curves.squares(curves.paths.start, position), curves.squares(curves.paths.end, position)
    radius = square(corner)[..., None]
    # Whether circles cross chords, shape (m, positions, corners, chords).
    crossed = (before[:, :, None] <= radius) != (after[:, :, None] <= radius)
    row, column, number, chord = np.unravel_index(np.flatnonzero(crossed), crossed.shape)
    at, place = corner[row, column, number], (curves.flank[row], chord)
    flanks = meetings.driving[row], meetings.driven[row], position[row, column]
    begin = curves.points(curves.paths.start[place], flanks[2])
    whole = curves.directions(curves.paths.step[place], flanks[2])
    outwards = np.broadcast_to(before, (*position.shape, before.shape[2]))[row, column, chord] <= square(at)
    hit, lever = circle_crossings(
        np.where(outwards, begin, begin + whole), np.where(outwards, whole, -whole), square(at)
    )
    turn, share = angle_between(at, hit), np.abs(hit - begin) / np.abs(whole)
    facing = outwards == curves.rootwards_out
    hits = EdgeHits(curves, *flanks, at, chord, share, lever, turn, _ahead(curves, turn), facing)
    near = np.nonzero(np.abs(turn) * np.abs(at) <= REACH_IN_PITCHES * pitch_mm)[0]
    hits = hits.kept(near)
    group = np.ravel_multi_index((row[near], column[near], number[near]), corner.shape)
    return hits.kept(_met_first(hits, group, meetings.urge))


def _met_first(hits: EdgeHits, corner: IndexArray, urge: float) -> Mask:
    """Which hits of each corner hold it, seen from the law's position.

    A corner is inside the other gear where it would come out through the nearest curve; then that curve holds it.
    Otherwise the curves through which it would go in hold it.  ``corner`` numbers the corners, in order.
    """
    out: Mask = (urge * hits.error_rad > 0.0) == hits.facing
    if not out.size:
        return out
    away = np.abs(hits.turn_rad)
    first = np.nonzero(np.append(True, corner[1:] != corner[:-1]))[0]
    count = np.diff(np.append(first, out.size))
    # The first of equally near ones.
    least = np.nonzero(away == np.repeat(np.minimum.reduceat(away, first), count))[0]
    least = least[np.append(True, corner[least[1:]] != corner[least[:-1]])]
    nearest = np.zeros(out.size, dtype=bool)
    nearest[least] = True
    held: Mask = np.where(np.repeat(out[least], count), nearest, ~out)
    return held


def edge_contacts(found: Sequence[EdgeHits], urge: float, first_rad: Array, within_mm: float) -> Contacts:
    """Corners that may touch before anything else does, or at most ``within_mm`` behind it.

    ``urge`` is that of ``Meetings``.  ``first_rad`` is the driven angle at which flanks first touch at each position,
    times the urge; -inf where there are none.  Raises ArithmeticError if a corner that comes near is not found on its
    curve.
    """
    first = first_rad.copy()
    for hits in found:
        np.maximum.at(first, hits.position, urge * hits.error_rad)
    touching = []
    for hits in found:
        # How far each corner is from its curve when the first contact of its position touches.
        behind_mm = (first[hits.position] - urge * hits.error_rad) * hits.lever_mm
        near_mm = NEAR_IN_MODULES * hits.curves.paths.flanks.rack.module_mm
        touching.append(_touching(hits.kept(behind_mm <= within_mm + near_mm)))
    return Contacts.joined(touching)


def _touching(hits: EdgeHits) -> Contacts:
    """The exact places of hits on the curves themselves."""
    gear, run = hits.curves, hits.run
    parameter, turn = _solved(hits)
    point, slope = gear.curve(run, parameter, hits.position)
    turned = np.exp(-1j * turn) if gear.moving else np.ones(1)
    columns = _ahead(gear, turn), point * turned, slope * turned, np.zeros(run.size, dtype=bool)
    return Contacts(hits.driving, hits.driven, hits.position, *columns)


def _solved(hits: EdgeHits) -> tuple[Array, Array]:
    """Parameters of the curves at which they meet the corners' circles, and the angles that turn the corners there.

    Newton's method may end beyond the chord where the curve turns close by; there the place is bracketed on the chord.
    """

    def curve(parameter: Array) -> tuple[Array, Array]:
        point, slope = hits.curves.curve(hits.run, parameter, hits.position)
        return as_points(point), as_points(slope)

    def circle(turn: Array) -> tuple[Array, Array]:
        turned = hits.corner * np.exp(1j * turn)
        return as_points(turned), as_points(1j * turned)

    first, last = hits.ends
    agreement = AGREEMENT * hits.curves.paths.flanks.rack.module_mm
    parameter, turn, met = refined_crossings(
        curve, circle, first + (last - first) * hits.share, hits.turn_rad, agreement
    )
    astray = np.nonzero(~met | ((parameter - first) * (parameter - last) > 0.0))[0]
    if astray.size:
        parameter[astray], turn[astray] = _bracketed(hits.kept(astray))
    return parameter, turn


def _bracketed(hits: EdgeHits) -> tuple[Array, Array]:
    """As ``_solved``, by bracketing the radius between the ends of the chords."""

    def missing(parameter: Array, row: IndexArray) -> Array:
        chosen = hits.kept(row)
        return square(chosen.curves.curve(chosen.run, parameter, chosen.position)[0]) - square(chosen.corner)

    # Rows that are found drop out on the way, so each row brings its number along.
    parameter = elementwise.find_root(missing, hits.ends, args=(np.arange(hits.position.size),)).x
    point, _ = hits.curves.curve(hits.run, parameter, hits.position)
    if not np.all(np.abs(np.abs(point) - np.abs(hits.corner)) <= ON_CIRCLE * np.abs(hits.corner)):
        raise ArithmeticError("a tooth's corner was not found on the curve that it touches")
    return parameter, angle_between(hits.corner, point)


def _ahead(curves: SeenGear, turn_rad: Array) -> Array:
    """How far ahead the driven gear is when corners that are turned by angles lie on a gear's curves.

    Corners of the driven gear are at rest: instead of them the driving gear's curves are turned back.
    """
    return curves.placement.ahead * (-turn_rad if curves.moving else turn_rad)
