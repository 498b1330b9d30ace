"""Play of two outlines as written: how far one can be turned against the other each way before they touch.

Nearly always outlines stand apart, and ``apart.py`` finds their play.  What is left is judged here vertex by vertex:
where outlines overlap, or their play is great.  Every vertex of one outline near the mesh is followed along its circle
about the driven axis to the chords of the other outline, and the other way round.  That gives the exact play of two
polygons.
"""

from __future__ import annotations

from dataclasses import dataclass
from functools import cached_property

import numpy as np

from ncgear.contact.placement import Placement
from ncgear.contact.written.apart import apart_play, crossings_from_foot, turn_onto
from ncgear.contact.written.pairs import MeshedOutlines, Pairs, meshed_outlines, near_pairs, stretches_of
from ncgear.numerics.arrays import Array, Columns, ComplexArray, IndexArray, Mask
from ncgear.numerics.plane import across, along, as_complex, square

REACHES_IN_PITCHES = 0.4, 0.6
"""How far along its circle a vertex is followed: a tooth that holds it inside is half a pitch thick, so that nearly
always the first reach finds its nearer side.  Where nothing is in reach, or an overlap is deep, it is followed on."""

DEEP_IN_PITCHES = 0.05
"""Overlap from which vertices are followed over the greater reach.  A vertex that is too deep inside for the first
reach has others beside it that the first reach shows to be this deep: along the outline, from the vertex to where it
comes out, the depth falls by no more than a chord's length from vertex to vertex.  That holds if no chord is longer
than the first reach is beyond this depth; where one is, there is no first reach."""

MOVED_IN_REACHES = 0.5
"""How far chords may move, in reaches, within a stretch of positions that are looked at together."""

BLOCK = 64
"""Positions treated at once, so few that their arrays stay in the processor's cache."""


@dataclass(frozen=True, eq=False)
class Play:
    """Play at n positions, in rad, negative where the outlines overlap; shape (n,) each.

    ``up_rad`` and ``down_rad`` are how far the driving gear, as the driven gear sees it, can be turned up and down
    about the driven axis from the law's position; infinite where nothing is in reach.  ``overlap_mm`` is how deep the
    deepest vertex is inside the other gear in the law's position.
    """

    up_rad: Array
    down_rad: Array
    overlap_mm: Array


@dataclass(frozen=True, eq=False)
class _Side:
    """One gear's chords among n pairs, at each position once, in the driven gear's frame; shape (m,) each.

    ``number`` tells the chord of each pair, shape (n,), and ``row`` the position of each chord.  ``at_vertex`` tells
    which chords start at a vertex of the outline, and do not follow another piece of the same chord.
    """

    number: IndexArray
    row: IndexArray
    start: ComplexArray
    end: ComplexArray
    direction: ComplexArray
    at_vertex: Mask

    @cached_property
    def start_square(self) -> Array:
        """Squared distance of each chord's start from the driven axis."""
        return square(self.start)

    @cached_property
    def end_square(self) -> Array:
        """Squared distance of each chord's end."""
        return square(self.end)

    @cached_property
    def least_square(self) -> Array:
        """Squared distance of each chord's nearest point: an end, or the foot of its line if it lies between them."""
        foot_between = (along(self.direction, self.start) < 0.0) & (along(self.direction, self.end) > 0.0)
        least = np.minimum(self.start_square, self.end_square)
        return np.where(foot_between, np.minimum(across(self.direction, self.start) ** 2, least), least)


@dataclass(frozen=True, eq=False)
class _Crossings(Columns):
    """Where circles of vertices cross chords of the other outline, shape (n,) each.

    ``vertex`` and ``chord`` number both; ``turn_rad`` turns the vertex onto the chord, ``entering`` tells whether it
    would go into the other gear there, and ``depth_mm`` is the distance across the chord, to first order in the angle.
    """

    vertex: IndexArray
    chord: IndexArray
    turn_rad: Array
    entering: Mask
    depth_mm: Array


def outline_play(driving_mm: Array, driven_mm: Array, placement: Placement, reach_mm: float) -> Play:
    """Play of two outlines in their own frames, counter-clockwise, shape (n, 2) each, each around its axis once.

    Outlines are compared within the sector of the driving gear that ``reach_mm`` from the pitch point spans, which must
    cover the line of action.
    """
    # Outlines are followed with the material on their left: a ring's goes round the hole the other way.
    driving, driven = as_complex(driving_mm), as_complex(driven_mm[::-1] if placement.driven_inside else driven_mm)
    outlines, pitch = meshed_outlines(driving, driven, placement), placement.pitch_mm
    apart = apart_play(outlines, reach_mm)
    play = np.stack([apart.up_rad, apart.down_rad, np.zeros(placement.count)])
    open_still, longest = np.nonzero(~apart.known)[0], _longest_chord_mm(driving, driven)
    for followed in REACHES_IN_PITCHES:
        if followed < max(REACHES_IN_PITCHES) and longest > (followed - DEEP_IN_PITCHES) * pitch:
            continue
        if not open_still.size:
            break
        play[:, open_still] = _play_by_vertices(outlines, open_still, reach_mm, followed * pitch)
        up, down, depth = play[:, open_still]
        shallow = depth <= DEEP_IN_PITCHES * pitch
        open_still = open_still[~(np.isfinite(up) & np.isfinite(down) & shallow)]
    return Play(*play)


def _longest_chord_mm(*outlines: ComplexArray) -> float:
    return max(float(np.abs(np.diff(outline, append=outline[:1])).max()) for outline in outlines)


def _play_by_vertices(outlines: MeshedOutlines, position: IndexArray, reach_mm: float, followed_mm: float) -> Array:
    """Play up and down and the deepest overlap at positions, shape (3, positions).

    Driving chords are looked at as far around the core of them, those within ``reach_mm`` of the pitch point, that
    everything is there within twice the way that vertices are followed.
    """
    beyond = reach_mm + 2.0 * followed_mm + float(outlines.driving.length_mm.max())
    stretches = stretches_of(outlines, position, beyond, MOVED_IN_REACHES * followed_mm)
    cells, length = stretches.cells(followed_mm), stretches.position.shape[1]
    together, found = max(BLOCK // length, 1), []
    for start in range(0, len(stretches.position), together):
        rows = np.arange(start, min(start + together, len(stretches.position)))
        pairs = near_pairs(stretches, cells, rows, followed_mm).at_each(length)
        found.append(_block_play(outlines, pairs, stretches.position[rows].ravel(), reach_mm, followed_mm))
    return np.concatenate(found, axis=1)[:, : position.size]


def _block_play(
    outlines: MeshedOutlines, pairs: Pairs, position: IndexArray, reach_mm: float, followed_mm: float
) -> tuple[Array, Array, Array]:
    """Play up and down and the deepest overlap at positions, which the pairs number from 0 on."""
    driving, driven = _driving_side(outlines, pairs, position), _driven_side(outlines, pairs, position.size)
    first, count = outlines.mesh_windows(position[:, None], reach_mm)
    core = np.zeros(driving.row.size, dtype=bool)
    core[driving.number] = (pairs.driving - first[pairs.row]) % outlines.driving.start.size < count[pairs.row]
    up, down, depth = _free(_crossings(driving, driven, followed_mm), driving, position.size)
    crossings = _of_surrounded(_crossings(driven, driving, followed_mm), core, driven.row.size)
    # To turn the driving gear up is to turn the driven one's vertices down.
    other_down, other_up, other_depth = _free(crossings, driven, position.size)
    return np.minimum(up, other_up), np.minimum(down, other_down), np.maximum(depth, other_depth)


def _driving_side(outlines: MeshedOutlines, pairs: Pairs, position: IndexArray) -> _Side:
    chords, placement = outlines.driving, outlines.placement
    number, row, chord = _numbered(pairs.row, pairs.driving, position.size, chords.start.size)
    start, end = (placement.driving_points(ends[chord], position[row]) for ends in (chords.start, chords.end))
    direction = placement.driving_directions(chords.direction[chord], position[row])
    return _Side(number, row, start, end, direction, chords.at_vertex[chord])


def _driven_side(outlines: MeshedOutlines, pairs: Pairs, positions: int) -> _Side:
    chords = outlines.driven
    number, row, chord = _numbered(pairs.row, pairs.driven % chords.start.size, positions, chords.start.size)
    chords = chords.kept(chord)
    return _Side(number, row, chords.start, chords.end, chords.direction, chords.at_vertex)


def _numbered(row: IndexArray, chord: IndexArray, rows: int, chords: int) -> tuple[IndexArray, IndexArray, IndexArray]:
    """Numbers for pairs of a row and a chord, equal pairs having the same, and both of each number."""
    place = row * chords + chord
    seen = np.zeros(rows * chords, dtype=bool)
    seen[place] = True
    number = np.cumsum(seen) - 1
    return number[place], *np.divmod(np.nonzero(seen)[0], chords)


def _crossings(vertices: _Side, chords: _Side, followed_mm: float) -> _Crossings:
    """Where vertices, which the one side's chords start at, come upon the other side's chords within reach.

    A circle crosses the outline where the ends of a chord are on both sides of it, so that none is lost or found
    twice where chords join; and twice where both ends are outside of it, but not the chord's foot.
    """
    squared = vertices.start_square[vertices.number]
    crossed = np.maximum(chords.start_square, chords.end_square)[chords.number] >= squared
    crossed &= (chords.least_square[chords.number] < squared) & vertices.at_vertex[vertices.number]
    pair = np.nonzero(crossed)[0]
    number, chord, squared = vertices.number[pair], chords.number[pair], squared[pair]
    against, start, vertex = np.conj(chords.direction)[chord], chords.start[chord], vertices.start[number]
    beside = against * (vertex - start)
    start, vertex = against * start, against * vertex
    _, from_foot = crossings_from_foot(vertex, beside, start)
    rising, which = np.nonzero(np.stack([chords.start_square[chord] >= squared, chords.end_square[chord] >= squared]))
    from_foot = from_foot[rising, which]
    turn = turn_onto(vertex[which], from_foot, start.imag[which])
    entering: Mask = np.signbit(turn) != rising
    found = _Crossings(number[which], chord[which], turn, entering, np.abs(turn * from_foot))
    return found.kept(np.nonzero(np.abs(turn) * np.sqrt(squared[which]) <= followed_mm)[0])


def _of_surrounded(crossings: _Crossings, core: Mask, vertices: int) -> _Crossings:
    """The crossings of driven vertices, without those that could make one count as inside because chords are missing.

    Of a vertex that meets a chord of the core, all that it meets is within twice the reach of the core, so that no
    chord is missing.  Others, which only meet chords at the windows' edge, count as outside.
    """
    surrounded = np.zeros(vertices, dtype=bool)
    surrounded[crossings.vertex[core[crossings.chord]]] = True
    return crossings.kept(np.nonzero(surrounded[crossings.vertex] | crossings.entering)[0])


def _free(crossings: _Crossings, vertices: _Side, positions: int) -> tuple[Array, Array, Array]:
    """Least angles by which the vertices of each position can move up and down, and the deepest one's depth.

    A vertex is inside the other gear if, turned one way or the other, it would come out of the gear before it goes in;
    the other side of a thick tooth may be out of reach.  It then counts as past the nearer side.
    """
    count = vertices.row.size
    least = np.full((2, 2, count), np.inf)
    kind = 2 * crossings.entering + np.signbit(crossings.turn_rad)
    np.minimum.at(least.ravel(), count * kind + crossings.vertex, np.abs(crossings.turn_rad))
    leaving, entering = least
    inside: Mask = np.any(leaving < entering, axis=0)
    past_upper = leaving[0] <= leaving[1]
    up = np.where(inside, np.where(past_upper, np.inf, -leaving[1]), least[:, 0].min(axis=0))
    down = np.where(inside, np.where(past_upper, -leaving[0], np.inf), least[:, 1].min(axis=0))
    depth = np.where(inside, np.inf, 0.0)
    deep = np.nonzero(inside[crossings.vertex])[0]
    np.minimum.at(depth, crossings.vertex[deep], crossings.depth_mm[deep])
    bounds, deepest = np.full((2, positions), np.inf), np.zeros(positions)
    np.minimum.at(bounds[0], vertices.row, up)
    np.minimum.at(bounds[1], vertices.row, down)
    np.maximum.at(deepest, vertices.row, depth)
    return bounds[0], bounds[1], deepest
