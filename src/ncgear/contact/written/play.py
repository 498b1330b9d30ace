"""Play of two written outlines: the angles by which a gear can turn each way against the other before they touch.

Nearly always outlines stand apart, and ``apart.py`` finds their play.  This file finds it where outlines may overlap.
Every vertex of one outline near the mesh is followed along its circle about the driven axis to the chords of the other
outline, and the other way round.  That gives the exact play of two polygons.  The driven outline is cut into runs along
which its radius grows; bins of the radius tell where a chord of the driving outline begins and ends on such a run, and
so tell both the chord that a vertex meets and the run's vertices that meet a chord.
"""

from __future__ import annotations

import numpy as np

from ncgear.contact.placement import Placement
from ncgear.contact.written.apart import Facing, apart_play, half_width_rad
from ncgear.contact.written.polar import TURN, RadialRuns, headings, polar_outline, radial_runs, with_feet
from ncgear.frozen import dataclass
from ncgear.numerics.arrays import Array, ComplexArray, IndexArray, Mask, counted_up
from ncgear.numerics.plane import as_complex, square

REACHES_IN_PITCHES = 0.4, 0.6
"""Lengths over which a vertex is followed along its circle: a tooth that holds it inside is half a pitch thick, so the
first reach nearly always finds its nearer side.  The second is for nothing in the first reach, or a deep overlap."""

DEEP_IN_PITCHES = 0.05
"""Overlap from which vertices are followed over the greater reach.  A vertex that is too deep inside for the first
reach has other vertices beside it, which the first reach shows to be this deep.  This holds if no chord is longer than
the first reach beyond this depth; where a chord is longer, there is no first reach."""

BLOCK = 128
"""Positions treated at once, so few that their arrays stay in the processor's cache."""


@dataclass(frozen=True, eq=False)
class WrittenPlay:
    """Play at n positions, in rad, negative where the outlines overlap; shape (n,) each.

    ``up_rad`` and ``down_rad`` are the angles by which the driving gear can turn up and down about the driven axis from
    the law's position, in the driven gear's frame; infinite where nothing is in reach.  ``overlap_mm`` is the depth of
    the deepest vertex inside the other gear in the law's position.
    """

    up_rad: Array
    down_rad: Array
    overlap_mm: Array


@dataclass(frozen=True, eq=False)
class _Setting:
    """Values for all positions: the driven outline's runs, the driving outline's vertices and longest chord.

    ``reach_mm`` is the length over which vertices are followed.  At each position ``windows`` hold the tested driving
    vertices; everything within twice the reach around their ``core`` is in the windows.  Both are first numbers and
    counts.
    """

    placement: Placement
    runs: RadialRuns
    driving: ComplexArray
    longest_mm: float
    reach_mm: float
    windows: tuple[IndexArray, IndexArray]
    core: tuple[IndexArray, IndexArray]


@dataclass(frozen=True, eq=False)
class _Chords:
    """Chords of the driving outline near the mesh in the driven gear's frame, shape (n,) each.

    Along each chord the distance from the driven axis grows or falls all the way.  ``position`` counts within the
    block, ``start_rad`` is the polar angle of the start; ``core`` tells whether all chords within twice the reach
    around it are there as well.
    """

    position: IndexArray
    start: ComplexArray
    end: ComplexArray
    start_rad: Array
    core: Mask


@dataclass(frozen=True, eq=False)
class _Meets:
    """Pairs of a driving chord and a driven run that share a range of radii.

    ``start_square`` and ``end_square`` are the squared radii of all chords' ends.  Pairs, shape (n,) each, have the
    numbers of the ``chord`` and the ``run``, and the first entries of the run at or beyond the radius of the chord's
    start and of its end.
    """

    chords: _Chords
    runs: RadialRuns
    start_square: Array
    end_square: Array
    chord: IndexArray
    run: IndexArray
    at_start: IndexArray
    at_end: IndexArray


@dataclass(frozen=True, eq=False)
class _Crossings:
    """Crossings of vertices' circles with chords of the other outline, shape (n,) each.

    ``vertex`` numbers the vertices, of which ``position`` (shape (vertices,)) tells the position in the block;
    ``turn_rad`` turns a vertex onto the chord, ``entering`` tells whether a growing angle leads through it into the
    other gear, ``depth_mm`` is the distance across the chord.
    """

    position: IndexArray
    vertex: IndexArray
    turn_rad: Array
    entering: Mask
    depth_mm: Array

    def kept(self, mask: Mask) -> _Crossings:
        rows = np.nonzero(mask)[0]
        columns = self.vertex[rows], self.turn_rad[rows], self.entering[rows], self.depth_mm[rows]
        return _Crossings(self.position, *columns)

    @property
    def leading_out(self) -> Mask:
        """Whether the vertex would come out of the other gear there."""
        return np.signbit(self.turn_rad) == self.entering


def facing_outlines(driving_mm: Array, driven_mm: Array, placement: Placement) -> Facing:
    """Two outlines in their own frames, counter-clockwise, (n, 2), with their values for all positions."""
    # Outlines are followed with the material on their left: a ring's goes round the hole the other way.
    driven = as_complex(driven_mm[::-1] if placement.driven_inside else driven_mm)
    return Facing(as_complex(driving_mm), driven, placement.pitch_mm)


def outline_play(facing: Facing, placement: Placement, reach_mm: float) -> WrittenPlay:
    """Play of two outlines at positions, in the sector of ``reach_mm`` that must cover the line of action."""
    driving, driven = facing.driving, facing.driven
    apart = apart_play(facing, placement, reach_mm)
    play = np.stack([apart.up_rad, apart.down_rad, np.zeros(placement.count)])
    open_still, longest = np.nonzero(~apart.known)[0], _longest_chord_mm(driving, driven)
    for followed in REACHES_IN_PITCHES:
        if followed < max(REACHES_IN_PITCHES) and longest > (followed - DEEP_IN_PITCHES) * placement.pitch_mm:
            continue
        if not open_still.size:
            break
        setting = _setting(facing, placement, reach_mm, followed * placement.pitch_mm)
        for start in range(0, open_still.size, BLOCK):
            position = open_still[start : start + BLOCK]
            play[:, position] = _block_play(setting, position)
        up, down, depth = play[:, open_still]
        shallow = depth <= DEEP_IN_PITCHES * placement.pitch_mm
        open_still = open_still[~(np.isfinite(up) & np.isfinite(down) & shallow)]
    return WrittenPlay(*play)


def _longest_chord_mm(*outlines: ComplexArray) -> float:
    return max(float(np.abs(np.diff(outline, append=outline[:1])).max()) for outline in outlines)


def _setting(facing: Facing, placement: Placement, reach_mm: float, followed_mm: float) -> _Setting:
    driving, longest = facing.driving, _longest_chord_mm(facing.driving)
    runs = radial_runs(facing.driven, followed_mm + longest, placement.pitch_mm)
    outline = polar_outline(driving)
    core, windows = (
        outline.windows(placement.mesh_direction_rad, half_width_rad(facing, placement, reach))
        for reach in (reach_mm, reach_mm + longest + 2.0 * followed_mm)
    )
    return _Setting(placement, runs, driving, longest, followed_mm, windows, core)


def _block_play(setting: _Setting, position: IndexArray) -> tuple[Array, Array, Array]:
    """Play up and down and the deepest overlap at each of the given positions."""
    chords = _near_chords(setting, position)
    meets = _meets(chords, setting.runs)
    own_up, own_down, own_depth = _free(_of_driving_vertices(meets, setting.reach_mm), position.size)
    up, down, depth = _free(_of_driven_vertices(meets, setting.reach_mm, position.size), position.size)
    # To turn the driving gear up is to turn the driven gear's vertices down.
    return np.minimum(own_up, down), np.minimum(own_down, up), np.maximum(own_depth, depth)


def _near_chords(setting: _Setting, position: IndexArray) -> _Chords:
    """The driving chords that may come within the driven outline's reach."""
    runs, (first, count) = setting.runs, (numbers[position] for numbers in setting.windows)
    row, vertex = counted_up(first, count + 1)
    outline = np.take(setting.driving, vertex, mode="wrap")
    points = setting.placement.driving_points(outline, position[row])
    squared = square(points)
    # A chord's foot may be nearer to the axis than both its ends, by no more than its half length squared.
    least = np.minimum(squared[:-1], squared[1:]) - setting.longest_mm**2 / 4.0
    greatest = np.maximum(squared[:-1], squared[1:])
    low, high = runs.reach
    chord = np.nonzero((least < high.max()) & (greatest > low.min()) & (row[1:] == row[:-1]))[0]
    start_rad = np.angle(points[chord])
    sector = runs.sector(start_rad)
    within = np.nonzero((least[chord] < high[sector]) & (greatest[chord] > low[sector]))[0]
    chord, start_rad = chord[within], start_rad[within]
    core_first, core_count = (numbers[position[row[chord]]] for numbers in setting.core)
    core = (vertex[chord] >= core_first) & (vertex[chord] < core_first + core_count)
    return _split_at_feet(_Chords(row[chord], points[chord], points[chord + 1], start_rad, core))


def _split_at_feet(chords: _Chords) -> _Chords:
    """The chords; a chord along which the radius falls and then grows is cut in two."""
    split, foot = with_feet(chords.start, chords.end)
    end = chords.end.copy()
    end[split] = foot
    return _Chords(
        np.concatenate([chords.position, chords.position[split]]),
        np.concatenate([chords.start, foot]),
        np.concatenate([end, chords.end[split]]),
        np.concatenate([chords.start_rad, np.angle(foot)]),
        np.concatenate([chords.core, chords.core[split]]),
    )


def _meets(chords: _Chords, runs: RadialRuns) -> _Meets:
    near = runs.near[runs.sector(chords.start_rad)]
    start, end = square(chords.start), square(chords.end)
    low, high = np.minimum(start, end)[:, None], np.maximum(start, end)[:, None]
    chord, column = np.nonzero((runs.inner[near] <= high) & (runs.outer[near] >= low))
    run = near[chord, column]
    ends = (runs.entry_beyond(run, squared[chord]) for squared in (start, end))
    return _Meets(chords, runs, start, end, chord, run, *ends)


def _of_driving_vertices(meets: _Meets, reach_mm: float) -> _Crossings:
    """Circles of the chords' starts across the driven outline, as far as within reach."""
    runs, squared = meets.runs, meets.start_square[meets.chord]
    crossed = np.nonzero((runs.inner[meets.run] <= squared) & (squared < runs.outer[meets.run]))[0]
    vertex, run = meets.chord[crossed], meets.run[crossed]
    before = np.maximum(meets.at_start[crossed] - 1, runs.first[run])
    radius, aside = np.sqrt(meets.start_square)[vertex], runs.aside_mm[before]
    turn = _turned(meets.chords.start_rad[vertex], runs.heading_rad[before], aside, radius)
    found = _Crossings(meets.chords.position, vertex, turn, runs.rising[run], _across(turn, radius, aside))
    return found.kept(np.abs(turn) * radius <= reach_mm)


def _of_driven_vertices(meets: _Meets, reach_mm: float, positions: int) -> _Crossings:
    """Circles of the driven outline's vertices across the chords, up to the reach.

    A vertex that only meets chords at the edge of the windows, where nearer chords are missing, counts as outside.
    """
    runs, chords = meets.runs, meets.chords
    first = np.minimum(meets.at_start, meets.at_end)
    pair, entry = counted_up(first, np.maximum(meets.at_start, meets.at_end) - first)
    chord, rising = meets.chord[pair], meets.end_square > meets.start_square
    heading, aside = headings(chords.start, np.where(rising, 1.0, -1.0) * (chords.end - chords.start))
    radius, aside = runs.radius_mm[entry], aside[chord]
    turn = _turned(runs.polar_rad[entry], heading[chord], aside, radius)
    position, vertex = _numbered(chords.position[chord], entry, runs.point.size, positions)
    found = _Crossings(position, vertex, turn, rising[chord], _across(turn, radius, aside))
    within = np.abs(turn) * radius <= reach_mm
    surrounded = np.zeros(position.size, dtype=bool)
    surrounded[vertex[within & chords.core[chord]]] = True
    return found.kept(within & (surrounded[vertex] | ~found.leading_out))


def _turned(vertex_rad: Array, heading_rad: Array, aside_mm: Array, radius_mm: Array) -> Array:
    """Angles, from -pi to pi, from vertices along their circles to chords; see ``headings``."""
    share = np.clip(aside_mm / radius_mm, -1.0, 1.0)
    turn = heading_rad + np.arcsin(share) - vertex_rad
    return turn - TURN * np.rint(turn / TURN)


def _across(turn_rad: Array, radius_mm: Array, aside_mm: Array) -> Array:
    """Distances across chords of vertices that angles turn onto them, to first order in the angle."""
    lever = np.sqrt(np.maximum((radius_mm - aside_mm) * (radius_mm + aside_mm), 0.0))
    return np.abs(turn_rad) * lever


def _numbered(position: IndexArray, entry: IndexArray, entries: int, positions: int) -> tuple[IndexArray, IndexArray]:
    """Numbers for pairs of a position and an entry: the position of each number, and the number of each pair.

    Entries met in a position are neighbours around the outline, so counting may start at any of them.
    """
    some = np.zeros(positions, dtype=int)
    some[position] = entry
    beside = (entry - some[position] + entries // 2) % entries
    least = int(beside.min(initial=entries))
    span = int(beside.max(initial=least)) - least + 1
    return np.repeat(np.arange(positions), span), position * span + beside - least


def _free(crossings: _Crossings, positions: int) -> tuple[Array, Array, Array]:
    """Least angles by which the vertices of each position can move up and down, and the depth of the deepest vertex.

    A vertex is inside if, turned either way, it comes out of the gear before it goes in; it counts as past the
    nearer side.
    """
    least = np.full((4, crossings.position.size), np.inf)
    kind = 2 * np.signbit(crossings.turn_rad) + crossings.entering
    np.minimum.at(least.ravel(), crossings.position.size * kind + crossings.vertex, np.abs(crossings.turn_rad))
    left_above, entered_above, left_below, entered_below = least
    inside = (left_above < entered_above) | (entered_below < left_below)
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
