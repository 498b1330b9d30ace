"""Edge contact: corners of one gear's teeth against the curves of the other.

As one gear turns against the other about the driven axis, its corners run along circles.  Chords of the curves tell
which corners come near enough to matter, since the largest distance of curves from chords is known.  Only for these
corners the crossing of circle and exact curve is solved.
"""

from __future__ import annotations

from collections.abc import Sequence
from functools import cached_property

import numpy as np

from ncgear.contact.designed.curves import TINY, Contacts, SeenGear, SidePaths
from ncgear.contact.placement import BACK, PUSHING, URGE, Meetings, Placement
from ncgear.errors import Unanswered, searched_for
from ncgear.frozen import dataclass
from ncgear.numerics.arrays import Array, Columns, ComplexArray, IndexArray, Mask, largest_rows, row_blocks
from ncgear.numerics.crossing import circle_crossings
from ncgear.numerics.plane import along, angle_between, square
from ncgear.numerics.units import in_words
from ncgear.numerics.zeros import zeros_between
from ncgear.teeth.tool import AGREEMENT

REACH_IN_PITCHES = 0.6
"""Length of the circle over which a corner is followed: beyond it lies another tooth, or this tooth's other side."""

NEWTON_STEPS = 12
"""Most steps of Newton's method to a circle.  From the cubics of chords two do."""

CLOSE_IN_MODULES = 1e-10
"""Last step of Newton's method, which is taken along the tangent: the curve leaves that by the square of the step."""

SURELY = 2.0
"""Largest difference between the angles at which the curve and its chord hold a corner, in strays over the lever: a
curve leans from its chord, and its arm is a little shorter."""

CUBIC_STEPS = 2
"""Steps of Newton's method from a chord to a circle along the cubic that has the curve's slopes at the chord's ends."""

ON_CIRCLE = 1e-12
"""Relative error of the radius up to which a point counts as on its corner's circle: rounding errors."""


@dataclass(frozen=True, eq=False)
class EdgeHits(Columns):
    """Corners of one gear whose circles cross chords of the other gear's ``curves``, all of shape (n,).

    ``driving`` and ``driven`` number the flanks that meet in ``position``.  ``corner`` is in the driven gear's frame.
    ``run`` and ``chord`` number the chord, ``share`` the place of the crossing along it, ``lever_mm`` the arm of a
    force across it.  Turned by ``turn_rad`` the corner is on the chord.  ``side`` is the side of the teeth whose flanks
    hold the corner in the same sense: the side of the flanks that meet, and the other side in the notch of an undercut
    tooth or at the far side of a space.
    """

    curves: SeenGear
    side: IndexArray
    driving: IndexArray
    driven: IndexArray
    position: IndexArray
    corner: ComplexArray
    run: IndexArray
    chord: IndexArray
    share: Array
    lever_mm: Array
    turn_rad: Array

    @cached_property
    def lead_rad(self) -> Array:
        """As in ``Contacts``, for the chords."""
        return URGE[self.side] * _ahead(self.curves, self.turn_rad)

    @property
    def place(self) -> IndexArray:
        """As in ``Contacts``."""
        return self.side * self.curves.placement.count + self.position

    @property
    def stray_mm(self) -> Array:
        """Largest possible distance of the curves from the chords."""
        return self.curves.paths.stray_mm[self.run, self.chord]

    @property
    def ends(self) -> tuple[Array, Array]:
        """Parameters of the curves at both ends of each chord."""
        parameter = self.curves.paths.parameter
        return parameter[self.run, self.chord], parameter[self.run, self.chord + 1]

    def named(self, number: int) -> str:
        """A hit in the words of messages."""
        driving, driven = self.driving[number] // 2 + 1, self.driven[number] // 2 + 1
        phi1 = in_words(float(self.curves.placement.phi1_rad[self.position[number]]))
        return f"the contact of driving tooth {driving} and driven tooth {driven} at phi1 = {phi1}"


def edge_hits(
    paths: tuple[SidePaths, SidePaths], placement: Placement, meetings: Meetings, first_rad: Array, within_mm: float
) -> list[EdgeHits]:
    """Corners of the driving gear on the driven gear's curves, and the other way round, for the flanks that meet.

    ``paths`` are the paths of the driving gear and of the driven gear.  Corners that flanks hold farther away than
    ``within_mm`` are left out; ``first_rad`` (shape (2, n)) is the lead with which flanks first touch on both sides of
    the teeth at each position, -inf where no flanks touch.
    """
    driving, driven = paths
    moving, resting = SeenGear(driving, placement, moving=True), SeenGear(driven, placement, moving=False)
    first = first_rad.ravel()
    return [_hits(moving, resting, meetings, first, within_mm), _hits(resting, moving, meetings, first, within_mm)]


def _hits(corners: SeenGear, curves: SeenGear, meetings: Meetings, first_rad: Array, within_mm: float) -> EdgeHits:
    """Crossings of the corners' circles with the chords of the flanks they meet."""
    paths, ends = curves.paths, curves.paths.places.shape[1]
    corner = corners.points(corners.paths.corner[corners.flank(meetings)][:, None], meetings.position[..., None])
    circles, every = square(corner)[..., None], (*meetings.position.shape, corner.shape[2])
    # Each crossing is one row; ``number`` counts the corners in all meetings and positions.
    found = [(np.empty(0, dtype=int), np.empty(0, dtype=int), np.empty(0, dtype=bool))]
    for rows in row_blocks(*meetings.position.shape):
        # Whether the ends of chords are inside the circles, shape (m, positions, corners, ends).
        inside = curves.squares(meetings.kept(rows))[:, :, None] <= circles[rows]
        number, chord = np.divmod(np.flatnonzero(inside[..., 1:] != inside[..., :-1]), ends - 1)
        starts_inside = inside.reshape(-1, ends)[number, chord]
        found.append((number + rows.start * every[1] * every[2], chord, starts_inside))
    number, chord, starts_inside = (np.concatenate(of) for of in zip(*found, strict=True))
    looked_at = number // corner.shape[2]
    row, position = looked_at // meetings.position.shape[1], meetings.position.ravel()[looked_at]
    at, flank = np.broadcast_to(corner, every).ravel()[number], curves.flank(meetings)[row]
    begin = flank * ends + chord
    start, end = paths.places.ravel()[begin], paths.places.ravel()[begin + 1]
    start, step = curves.points(start, position), curves.directions(end - start, position)
    share, lever = circle_crossings(start, step, square(at))
    turn = angle_between(at, start + share * step)
    side = np.where(starts_inside == curves.rootwards_out, meetings.side[row], PUSHING + BACK - meetings.side[row])
    lead = URGE[side] * _ahead(curves, turn)
    near = np.abs(turn) * np.abs(at) <= REACH_IN_PITCHES * paths.flanks.rack.pitch_mm
    near &= meetings.there.ravel()[looked_at]
    near &= _met_first(turn, np.where(near, lead, -np.inf), number)
    behind_mm = (first_rad[side * curves.placement.count + position] - lead) * lever
    near &= behind_mm <= within_mm + paths.stray_mm.max()
    row, flanks = row[near], (side[near], meetings.driving[row[near]], meetings.driven[row[near]], position[near])
    chords = paths.chord(flank[near], chord[near])
    return EdgeHits(curves, *flanks, at[near], *chords, share[near], lever[near], turn[near])


def _met_first(turn_rad: Array, lead_rad: Array, corner: IndexArray) -> Mask:
    """Whether each hit holds its corner (given by its number ``corner``), seen from the law's position.

    If the corner would come out through its nearest curve, that curve holds it; else all curves that it would enter do.
    """
    out = lead_rad > 0.0
    held: Mask = ~out
    if held.all():
        return held
    rows = np.flatnonzero(np.isin(corner, corner[out]))
    found, group = np.unique(corner[rows], return_inverse=True)
    nearest = rows[largest_rows(-np.abs(turn_rad[rows]), group, found.size)]
    comes_out = out[nearest]
    held[rows[comes_out[group]]] = False
    held[nearest[comes_out]] = True
    return held


def edge_contacts(found: Sequence[EdgeHits], first_rad: Array, within_mm: Array | float) -> Contacts:
    """Corners that touch first or at most ``within_mm`` behind the first contact, and a few farther corners.

    ``first_rad`` is as in ``edge_hits``; ``within_mm`` broadcasts with it and is nowhere greater than there.  Depths
    are measured across the chords.  Raises Unanswered if a corner that comes near is not found on its curve.
    """
    return Contacts.joined([_touching(hits) for hits in _hits_within(found, first_rad, within_mm)])


def first_edge_contacts(
    found: Sequence[EdgeHits], flanks: Contacts, first_rad: Array, within_mm: Array | float
) -> Contacts:
    """As ``edge_contacts``: the first corner of each pair of teeth, side and position, and the contacts ``flanks``."""
    near, placement = _hits_within(found, first_rad, within_mm), found[0].curves.placement
    error = [SURELY * hits.stray_mm / np.maximum(hits.lever_mm, TINY) for hits in near]
    places = [flanks.place(placement), *(hits.place for hits in near)]
    met = [(flanks.driving, flanks.driven), *((hits.driving, hits.driven) for hits in near)]
    teeth = [driving // 2 * placement.driven_teeth + driven // 2 for driving, driven in met]
    pair = np.concatenate([own * len(URGE) * placement.count + at for own, at in zip(teeth, places, strict=True)])
    surely = [flanks.lead_rad, *(hits.lead_rad - by for hits, by in zip(near, error, strict=True))]
    order = np.argsort(pair, kind="stable")
    begins = np.flatnonzero(np.append(True, np.diff(pair[order]) != 0))
    first = np.empty(pair.size)
    most = np.maximum.reduceat(np.concatenate(surely)[order], begins)
    first[order] = np.repeat(most, np.diff(begins, append=pair.size))
    of_hits = np.split(first, np.cumsum([of.size for of in places])[:-1])[1:]
    chosen = (hits.kept(hits.lead_rad + by >= leads) for hits, by, leads in zip(near, error, of_hits, strict=True))
    return Contacts.joined([_touching(hits) for hits in chosen])


def _hits_within(found: Sequence[EdgeHits], first_rad: Array, within_mm: Array | float) -> list[EdgeHits]:
    """The hits whose corners ``edge_contacts`` places on their curves."""
    first, within = first_rad.flatten(), np.broadcast_to(within_mm, first_rad.shape).ravel()
    for hits in found:
        # The curve may hold its corner later than the chord does.
        np.maximum.at(first, hits.place, hits.lead_rad - hits.stray_mm / np.maximum(hits.lever_mm, TINY))
    near = []
    for hits in found:
        # Distance of each corner from its chord when the first contact of its position touches.
        behind_mm = (first[hits.place] - hits.lead_rad) * hits.lever_mm
        near.append(hits.kept(behind_mm <= within[hits.place] + hits.stray_mm))
    return near


def _touching(hits: EdgeHits) -> Contacts:
    """Exact places of hits on the curves; where Newton's method ends beyond the chord, it is bracketed there."""
    gear, squared_radius, module = hits.curves, square(hits.corner), hits.curves.paths.flanks.rack.module_mm
    first, last = hits.ends
    parameter = first + (last - first) * _on_cubics(hits)
    point, slope = np.empty_like(hits.corner), np.empty_like(hits.corner)
    met, todo = np.zeros(parameter.size, dtype=bool), np.arange(parameter.size)
    for _ in range(NEWTON_STEPS):
        at, leading = gear.curve(hits.run[todo], parameter[todo], hits.position[todo])
        step = _step_to_circle(at, leading, squared_radius[todo])
        point[todo], slope[todo], parameter[todo] = at + leading * step, leading, parameter[todo] + step
        met[todo] = np.abs(np.abs(point[todo]) - np.sqrt(squared_radius[todo])) <= AGREEMENT * module
        met[todo] &= np.abs(leading * step) <= CLOSE_IN_MODULES * module
        todo = np.flatnonzero(~met)
        if not todo.size:
            break
    astray = np.flatnonzero(~met | ((parameter - first) * (parameter - last) > 0.0))
    if astray.size:
        parameter[astray] = _bracketed(hits.kept(astray))
        point[astray], slope[astray] = gear.curve(hits.run[astray], parameter[astray], hits.position[astray])
    turn = angle_between(hits.corner, point)
    turned = np.exp(-1j * turn) if gear.moving else np.ones(1)
    columns = _ahead(gear, turn), point * turned, slope * turned, *np.full((2, turn.size), np.nan)
    return Contacts(hits.side, hits.driving, hits.driven, hits.position, *columns)


def _on_cubics(hits: EdgeHits) -> Array:
    """Places along chords, as shares, where the cubics with the curves' slopes at both ends meet the circles."""
    first, last = hits.ends
    (begin, end), (leave, arrive) = (
        (table[hits.run, hits.chord], table[hits.run, hits.chord + 1])
        for table in (hits.curves.paths.point, hits.curves.paths.slope)
    )
    leave, arrive = (hits.curves.directions(slope * (last - first), hits.position) for slope in (leave, arrive))
    begin, chord = hits.curves.points(begin, hits.position), hits.curves.directions(end - begin, hits.position)
    second, third = 3.0 * chord - 2.0 * leave - arrive, leave + arrive - 2.0 * chord
    share, squared_radius = hits.share, square(hits.corner)
    for _ in range(CUBIC_STEPS):
        point = begin + share * (leave + share * (second + share * third))
        slope = leave + share * (2.0 * second + share * 3.0 * third)
        share = np.clip(share + _step_to_circle(point, slope, squared_radius), 0.0, 1.0)
    return share


def _step_to_circle(point: ComplexArray, slope: ComplexArray, squared_radius: Array) -> Array:
    """The step of Newton's method along curves to circles about the origin; 0 where a curve is across the radius."""
    rate = 2.0 * along(slope, point)
    return np.asarray((squared_radius - square(point)) / np.where(rate == 0.0, np.inf, rate))


def _bracketed(hits: EdgeHits) -> Array:
    """Parameters at which the curves meet the corners' circles, by bracketing the radius on the chords."""

    def missing(parameter: Array) -> Array:
        return square(hits.curves.curve(hits.run, parameter, hits.position)[0]) - square(hits.corner)

    with searched_for(hits.named, "gears.teeth"):
        parameter = zeros_between(missing, *hits.ends)
    radius = np.abs(hits.corner)
    off = np.abs(np.abs(hits.curves.curve(hits.run, parameter, hits.position)[0]) - radius)
    if lost := np.flatnonzero(~(off <= ON_CIRCLE * radius)).tolist():
        raise Unanswered(f"{hits.named(lost[0])}: the corner was not found on the curve that it touches")
    return parameter


def _ahead(curves: SeenGear, turn_rad: Array) -> Array:
    """Lead of the driven gear when corners, turned by these angles, lie on a gear's curves.

    Corners of the driven gear are at rest: instead of them the driving gear's curves are turned back.
    """
    return curves.placement.ahead * (-turn_rad if curves.moving else turn_rad)
