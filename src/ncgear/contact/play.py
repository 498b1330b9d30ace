"""Play of two outlines as written: how far the one can be turned against the other each way before they touch.

Every vertex of one outline near the mesh is followed along its circle about the driven axis to the chords of the other,
and the other way round, which gives the exact play of two polygons.  The driven outline is cut into runs along which
its radius grows; where a chord of the driving outline begins and ends on such a run is found by bisection, and tells
both which chord its vertex meets and which of the run's vertices meet the chord.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from ncgear.contact.circles import crossing
from ncgear.contact.placement import Placement
from ncgear.contact.polar import polar_outline
from ncgear.contact.radial_runs import RadialRuns, radial_runs, with_feet
from ncgear.numerics.arrays import Array, ComplexArray, IndexArray, Mask
from ncgear.numerics.plane import angle_between, as_complex, square
from ncgear.numerics.ragged import counted_up

REACH_IN_PITCHES = 0.6
"""How far along its circle a vertex is followed: a tooth that it may be inside of is half a pitch thick."""

BLOCK = 256
"""Positions treated at once, so that what belongs to them stays in the processor's cache."""


@dataclass(frozen=True, eq=False)
class Play:
    """Play at n positions, in rad, negative where the outlines overlap; shape (n,) each.

    ``up_rad`` and ``down_rad`` are how far the driving gear, as the driven gear sees it, can be turned up and down
    about the driven axis from the law's position, infinite where nothing is in reach; ``overlap_mm`` is how deep the
    deepest vertex is inside the other gear in the law's position.
    """

    up_rad: Array
    down_rad: Array
    overlap_mm: Array


@dataclass(frozen=True, eq=False)
class _Chords:
    """Chords of the driving outline near the mesh in the driven gear's frame, shape (n,) each.

    Along each its distance from the driven axis grows or falls all the way; ``position`` counts within the block.
    """

    position: IndexArray
    start: ComplexArray
    end: ComplexArray
    sector: IndexArray


@dataclass(frozen=True, eq=False)
class _Meets:
    """Pairs of a driving chord and a driven run that share a range of radii, shape (n,) each."""

    chords: _Chords
    runs: RadialRuns
    chord: IndexArray
    run: IndexArray


@dataclass(frozen=True, eq=False)
class _Crossings:
    """Where circles of vertices cross chords of the other outline, shape (n,) each.

    ``vertex`` numbers the vertices, of which ``position`` (shape (vertices,)) tells the position in the block;
    ``turn_rad`` turns a vertex onto the chord, ``entering`` tells whether a growing angle leads through it into the
    other gear, ``depth_mm`` is the distance across the chord.
    """

    position: IndexArray
    vertex: IndexArray
    turn_rad: Array
    entering: Mask
    depth_mm: Array


def outline_play(driving_mm: Array, driven_mm: Array, placement: Placement, reach_mm: float) -> Play:
    """Play of two outlines in their own frames, counter-clockwise, shape (n, 2) each, around their axes once.

    Outlines are compared within the sector of the driving gear that ``reach_mm`` from the pitch point spans, which must
    cover the line of action.
    """
    driving, driven = as_complex(driving_mm), as_complex(driven_mm)
    pitch_mm = placement.step_mm * placement.per_tooth
    longest = float(np.abs(np.diff(driving, append=driving[:1])).max())
    runs = radial_runs(driven, REACH_IN_PITCHES * pitch_mm + longest, pitch_mm)
    radius = placement.driving_radius_mm
    half_width = np.where(reach_mm < radius, np.arcsin(np.minimum(reach_mm / radius, 1.0)), np.pi)
    first, count = polar_outline(driving).windows(placement.mesh_direction_rad, half_width)
    blocks = []
    for begin in range(0, placement.count, BLOCK):
        position = np.arange(begin, min(begin + BLOCK, placement.count))
        row, vertex = counted_up(first[position], count[position] + 1)
        points = placement.driving_points(driving[vertex % driving.size], position[row])
        blocks.append(_block_play(_near_chords(points, row, runs, longest), runs, position.size))
    return Play(*(np.concatenate(columns) for columns in zip(*blocks, strict=True)))


def _near_chords(points: ComplexArray, row: IndexArray, runs: RadialRuns, longest: float) -> _Chords:
    """The chords between consecutive points of the same row that may come within the driven outline's reach."""
    squared = square(points)
    # A chord's foot may be nearer to the axis than both its ends, by no more than its half length squared.
    least = np.minimum(squared[:-1], squared[1:]) - longest * longest / 4.0
    chord = np.nonzero((least < runs.reach.max()) & (row[1:] == row[:-1]))[0]
    sector = runs.sector(points[chord])
    within = least[chord] < runs.reach[sector]
    chord, sector = chord[within], sector[within]
    start, end = points[chord], points[chord + 1]
    split, foot = with_feet(start, end)
    beyond = end[split]
    end[split] = foot
    return _Chords(
        np.concatenate([row[chord], row[chord[split]]]),
        np.concatenate([start, foot]),
        np.concatenate([end, beyond]),
        np.concatenate([sector, sector[split]]),
    )


def _block_play(chords: _Chords, runs: RadialRuns, positions: int) -> tuple[Array, Array, Array]:
    """Play up and down and the deepest overlap at each position of a block."""
    meets = _meets(chords, runs)
    own_up, own_down, own_depth = _free(_of_driving_vertices(meets), positions)
    up, down, depth = _free(_of_driven_vertices(meets, positions), positions)
    # To turn the driving gear up is to turn the driven one's vertices down.
    return np.minimum(own_up, down), np.minimum(own_down, up), np.maximum(own_depth, depth)


def _meets(chords: _Chords, runs: RadialRuns) -> _Meets:
    near = runs.near[chords.sector]
    start, end = square(chords.start)[:, None], square(chords.end)[:, None]
    shared = (runs.inner[near] <= np.maximum(start, end)) & (runs.outer[near] >= np.minimum(start, end))
    chord, column = np.nonzero(shared)
    return _Meets(chords, runs, chord, near[chord, column])


def _of_driving_vertices(meets: _Meets) -> _Crossings:
    """Circles of the chords' starts across the driven outline."""
    runs, squared = meets.runs, square(meets.chords.start)[meets.chord]
    crossed = np.nonzero((runs.inner[meets.run] <= squared) & (squared < runs.outer[meets.run]))[0]
    vertex, run, squared = meets.chord[crossed], meets.run[crossed], squared[crossed]
    before = np.maximum(runs.entry_beyond(run, squared) - 1, runs.first[run])
    place, lever = crossing(runs.point[before], runs.step[before], squared)
    turn = angle_between(meets.chords.start[vertex], place)
    return _Crossings(meets.chords.position, vertex, turn, runs.rising[run], np.abs(turn) * lever)


def _of_driven_vertices(meets: _Meets, positions: int) -> _Crossings:
    """Circles of the driven outline's vertices across the chords."""
    runs, chords = meets.runs, meets.chords
    start, end = square(chords.start), square(chords.end)
    low, high = np.minimum(start, end)[meets.chord], np.maximum(start, end)[meets.chord]
    first = runs.entry_beyond(meets.run, low)
    pair, entry = counted_up(first, runs.entry_beyond(meets.run, high) - first)
    chord, rising = meets.chord[pair], end > start
    inner = np.where(rising, chords.start, chords.end)
    outwards = np.where(rising, chords.end - chords.start, chords.start - chords.end)
    place, lever = crossing(inner[chord], outwards[chord], runs.square[entry])
    turn = angle_between(runs.point[entry], place)
    position, vertex = _numbered(chords.position[chord], entry, runs.point.size, positions)
    return _Crossings(position, vertex, turn, rising[chord], np.abs(turn) * lever)


def _numbered(position: IndexArray, entry: IndexArray, entries: int, positions: int) -> tuple[IndexArray, IndexArray]:
    """Numbers for pairs of a position and an entry: the position of each number, and the number of each pair.

    Entries that are met in one position are neighbours around the outline, so they are counted from one of them.
    """
    some = np.zeros(positions, dtype=int)
    some[position] = entry
    beside = (entry - some[position] + entries // 2) % entries
    least = int(beside.min(initial=entries))
    span = int(beside.max(initial=least)) - least + 1
    return np.repeat(np.arange(positions), span), position * span + beside - least


def _free(crossings: _Crossings, positions: int) -> tuple[Array, Array, Array]:
    """Least angles by which the vertices of each position can move up and down, and the deepest one's depth.

    A vertex is inside the other gear where it would leave it both ways; it then counts as past the nearer side.
    """
    least = np.full(4 * crossings.position.size, np.inf)
    kind = 2 * np.signbit(crossings.turn_rad) + crossings.entering
    np.minimum.at(least, 4 * crossings.vertex + kind, np.abs(crossings.turn_rad))
    left_above, entered_above, left_below, entered_below = least.reshape(-1, 4).T
    inside = (left_above < entered_above) & (entered_below < left_below)
    past_upper = inside & (left_above <= entered_below)
    up = np.where(inside, np.where(past_upper, np.inf, -entered_below), np.minimum(entered_above, left_above))
    down = np.where(inside, np.where(past_upper, -left_above, np.inf), np.minimum(entered_below, left_below))
    bounds = np.full((2, positions), np.inf)
    np.minimum.at(bounds[0], crossings.position, up)
    np.minimum.at(bounds[1], crossings.position, down)
    return bounds[0], bounds[1], _deepest(crossings, inside, positions)


def _deepest(crossings: _Crossings, inside: Mask, positions: int) -> Array:
    """Largest depth, at each position, of vertices inside the other gear: the distance to the nearest chord."""
    deep = np.nonzero(inside[crossings.vertex])[0]
    depth = np.where(inside, np.inf, 0.0)
    np.minimum.at(depth, crossings.vertex[deep], crossings.depth_mm[deep])
    deepest = np.zeros(positions)
    np.maximum.at(deepest, crossings.position, depth)
    return deepest
