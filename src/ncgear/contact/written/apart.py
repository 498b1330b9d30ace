"""Play of two outlines in the positions in which they stand apart, which are nearly all.

Where no chords of two outlines cross, no point of one gear is inside the other, and the play is the least angle by
which a vertex comes upon a chord.  (Neither outline crosses itself.)  Only chords that are nearly as close as the play
matter, so that few pairs of chords are looked at.  Positions follow each other so closely that one set of pairs serves
a stretch of them.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from ncgear.contact.written.pairs import MeshedOutlines, Pairs, Stretches, near_pairs, stretches_of
from ncgear.numerics.arrays import Array, ComplexArray, IndexArray, Mask
from ncgear.numerics.plane import across

REACHES_IN_PITCHES = 0.005, 0.02, 0.08
"""How far vertices are followed along their circles: without backlash the first is nearly always enough."""

MOVED_IN_PITCHES = 0.06
"""How far chords may move within a stretch of positions that are looked at together, as the other gear sees them."""

BLOCK = 128
"""Positions treated at once, so few that their arrays stay in the processor's cache."""

TOUCHING_IN_PITCHES = 1e-7
"""Chords that are as near as this all along, or much nearer at one end, may cross by a rounding error."""

SLACK_IN_PITCHES = 1e-10
"""By this much chords count as longer, so that rounding errors leave no gap where two of them join."""


@dataclass(frozen=True, eq=False)
class Apart:
    """Play at n positions, shape (n,) each.

    ``known`` tells where outlines are sure to stand apart and the play was found.  There ``up_rad`` and ``down_rad``
    are how far the driving gear, as the driven gear sees it, can be turned up and down; elsewhere they are infinite.
    """

    up_rad: Array
    down_rad: Array
    known: Mask


@dataclass(frozen=True, eq=False)
class _Placed:
    """One chord of each of n pairs in the driven gear's frame at k positions; shapes (n, k), or (n, 1) if it stands.

    ``against`` is the turn that lays the chord along the first axis.
    """

    start: ComplexArray
    against: ComplexArray
    length_mm: Array


def apart_play(outlines: MeshedOutlines, reach_mm: float) -> Apart:
    """Play of two outlines where they stand apart.

    Outlines are compared within the sector of the driving gear that ``reach_mm`` from the pitch point spans.
    """
    placement = outlines.placement
    most = MOVED_IN_PITCHES * placement.pitch_mm
    stretches = stretches_of(outlines, np.arange(placement.count), reach_mm, most)
    play, known = np.full((2, placement.count), np.inf), np.zeros(placement.count, dtype=bool)
    together = max(BLOCK // stretches.position.shape[1], 1)
    for followed in REACHES_IN_PITCHES:
        open_still = np.nonzero(~known[stretches.position].all(axis=1))[0]
        if not open_still.size:
            break
        reach = followed * placement.pitch_mm
        cells = stretches.cells(reach)
        for start in range(0, open_still.size, together):
            rows = open_still[start : start + together]
            bounds, found = _block_play(stretches, near_pairs(stretches, cells, rows, reach), rows, reach)
            position = stretches.position[rows].ravel()[found]
            play[:, position], known[position] = bounds[:, found], True
            # Where no play is within reach, the next one is tried at once.
            if not position.size:
                break
    return Apart(play[0], play[1], known)


def _block_play(stretches: Stretches, pairs: Pairs, rows: IndexArray, reach_mm: float) -> tuple[Array, Mask]:
    """Play up and down at each position of the given stretches, and whether it is known."""
    outlines, position = stretches.outlines, stretches.position[rows]
    placement = outlines.placement
    driving, driven = _placed(outlines, pairs, position[pairs.row])
    between = driven.start - driving.start
    driving_vertices, driven_vertices = -driven.against * between, driving.against * between
    lean = across(driven.against, driving.against)
    least = (TOUCHING_IN_PITCHES * placement.pitch_mm) ** 2
    # Chords do not cross if both ends of one are on the same side of the other.
    separate = driven_vertices.imag * (driven_vertices.imag + lean * driven.length_mm) > least
    separate |= driving_vertices.imag * (driving_vertices.imag - lean * driving.length_mm) > least
    apart = np.ones(position.size, dtype=bool)
    apart[_places(pairs.row, np.flatnonzero(~separate), position.shape[1])] = False
    slack = SLACK_IN_PITCHES * placement.pitch_mm
    own = _least_turns(driving_vertices, driven, pairs.row, position.size, reach_mm, slack)
    other = _least_turns(driven_vertices, driving, pairs.row, position.size, reach_mm, slack)
    # Where nothing crosses, all vertices are inside if the nearest one is.
    for leaving, entering in (own.min(axis=1), other.min(axis=1)):
        apart &= entering <= leaving
    # To turn the driving gear up is to turn the driven one's vertices down.
    bounds = np.minimum(own, other[:, ::-1]).min(axis=0)
    return bounds, apart & (bounds.max(axis=0) * np.abs(outlines.driven.start).max() <= reach_mm)


def _placed(outlines: MeshedOutlines, pairs: Pairs, position: IndexArray) -> tuple[_Placed, _Placed]:
    """The driving and the driven chords of pairs at positions, shape (n, k)."""
    placement, own, other = outlines.placement, outlines.driving, outlines.driven_twice
    start = placement.driving_points(own.start[pairs.driving][:, None], position)
    against = np.conj(placement.driving_directions(own.direction[pairs.driving][:, None], position))
    driving = _Placed(start, against, own.length_mm[pairs.driving][:, None])
    start, against, length = other.start[pairs.driven], np.conj(other.direction[pairs.driven]), other.length_mm
    return driving, _Placed(start[:, None], against[:, None], length[pairs.driven][:, None])


def _places(row: IndexArray, number: IndexArray, positions: int) -> IndexArray:
    """Numbers of positions within the block, from flat numbers in arrays of shape (pairs, positions)."""
    place: IndexArray = row[number // positions] * positions + number % positions
    return place


def _least_turns(
    vertex: ComplexArray, chord: _Placed, row: IndexArray, places: int, reach_mm: float, slack_mm: float
) -> Array:
    """Least angles by which vertices turn about the driven axis until they are on chords, within reach of them.

    Vertices, shape (n, k), are seen from the chords' starts, with the chords along the first axis.
    The angles have the shape (2, 2, places): those at which a vertex leaves the other gear and at which it enters it,
    each up and down.
    """
    positions, moves = vertex.shape[1], chord.start.shape == vertex.shape
    near = np.flatnonzero(np.abs(vertex.imag) <= reach_mm)
    beside, half = vertex.ravel()[near], (chord.length_mm / 2.0)[near // positions, 0]
    close = np.nonzero(np.abs(beside.real - half) <= half + reach_mm)[0]
    near, beside, half = near[close], beside[close], half[close]
    start, against = (values.ravel()[near if moves else near // positions] for values in (chord.start, chord.against))
    start = against * start
    vertex = start + beside
    squared, from_foot = crossings_from_foot(vertex, beside, start)
    met = (np.abs(from_foot - start.real - half) <= half + slack_mm) & (squared >= 0.0)
    rising, which = np.nonzero(met)
    turn = turn_onto(vertex[which], from_foot[met], start.imag[which])
    down = np.signbit(turn)
    kind = 2 * (down != rising) + down
    least = np.full(4 * places, np.inf)
    np.minimum.at(least, kind * places + _places(row, near[which], positions), np.abs(turn))
    return least.reshape(2, 2, places)


def crossings_from_foot(vertex: ComplexArray, beside: ComplexArray, start: ComplexArray) -> tuple[Array, Array]:
    """Where vertices' circles about the driven axis cross the lines of chords, which lie along the first axis.

    Vertices and the chords' starts are seen from the driven axis, ``beside`` are vertices seen from the starts; shape
    (n,) each.  The circle crosses the line on both sides of its foot, where the radius falls and where it rises:
    returned are the squared distance from the foot and both places, shape (2, n); it does not where that is negative.
    """
    squared = vertex.real**2 + beside.imag * (vertex.imag + start.imag)
    return squared, np.sqrt(np.maximum(squared, 0.0)) * np.array([[-1.0], [1.0]])


def turn_onto(vertex: ComplexArray, from_foot: Array, aside: Array) -> Array:
    """Angles by which vertices turn about the driven axis until they are at crossings, of lines ``aside`` of it."""
    return np.arctan2(vertex.real * aside - vertex.imag * from_foot, vertex.real * from_foot + vertex.imag * aside)
