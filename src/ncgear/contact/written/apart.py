"""Play of two outlines in the positions where they stand apart, which are nearly all positions.

Where no chords of two outlines cross, no point of one gear is inside the other, and the play is the least angle after
which a vertex meets a chord.  (Neither outline crosses itself.)  Only chords that are nearly as close as the play
matter, so that few pairs of chords are tested.  Positions follow each other so closely that a set of pairs serves a
stretch of positions.
"""

from __future__ import annotations

from functools import cached_property
from math import acos, pi, sqrt

import numpy as np
from numpy.lib.stride_tricks import sliding_window_view

from ncgear.contact.placement import Placement
from ncgear.contact.written.cells import ChordGrid, Chords, cells_near, chords_of
from ncgear.contact.written.polar import PolarOutline, polar_outline
from ncgear.frozen import dataclass
from ncgear.numerics.arrays import Array, ComplexArray, IndexArray, Mask, counted_up
from ncgear.numerics.plane import across, square

REACHES_IN_PITCHES = 0.005, 0.02, 0.08
"""Lengths over which vertices are followed along their circles: without backlash the first is nearly always enough."""

FARTHEST = 4.0
"""Grains over which vertices are followed at most: fine chords have too many others within a greater reach."""

GRAIN_IN_PITCHES = 0.04
"""Largest grain.  The grain of outlines is the mean length of their chords, and the unit of the sizes below."""

LONGEST = 4.0
"""Length in grains above which driving chords are cut into pieces: a long chord would give all chords many pairs."""

CELL, MOST_CELLS = 2.0, 2000
"""Size in grains of the cells by which pairs are found, and most cells across an outline.  Smaller cells find fewer
pairs that are not near, and take longer to make."""

SPANS_IN_STEPS, MOST_TOGETHER = (9.0, 3.0, 1.0, 0.25), 9
"""Spans of a stretch in steps of the cycle's even positions, and most positions in a stretch.  The greatest span that
keeps chords near each other is taken; where no span does, each position is a stretch of its own."""

MOVED = 1.5
"""Largest motion of chords within a stretch in the other gear's frame, in grains."""

BLOCK = 128
"""Positions treated at once, so few that their arrays stay in the processor's cache."""

TOUCHING_IN_PITCHES = 1e-7
"""Chords this near all along, or much nearer at one end, may cross by a rounding error."""

ROUNDING = 1e-9
"""Share of a step that rounding may cost a position."""

SLACK_IN_PITCHES = 1e-10
"""Length added to chords, so that rounding errors leave no gap at their joints."""


@dataclass(frozen=True, eq=False)
class Apart:
    """Whether outlines surely stand apart at n positions, and how far the driving gear can then turn up and down."""

    up_rad: Array
    down_rad: Array
    known: Mask


@dataclass(frozen=True, eq=False)
class _Stretches:
    """Stretches of k positions each, and the driving chords that are tested in them.

    ``position`` numbers the positions, shape (stretches, k); the last may be repeated.  ``width`` driving chords are
    tested, from number ``first`` on.  In the driven gear's frame points move about a ``pole`` of the driving gear's
    frame: from their place in the middle of the stretch by at most ``shift_mm`` and ``turn_rad`` times their distance
    from the pole.
    """

    position: IndexArray
    first: IndexArray
    width: int
    pole: ComplexArray
    shift_mm: Array
    turn_rad: Array

    @property
    def middle(self) -> IndexArray:
        """The position in the middle of each stretch."""
        return self.position[:, self.position.shape[1] // 2]


@dataclass(frozen=True, eq=False)
class _Setting:
    """The values for all positions: the chords of both outlines, the driven chords twice round.

    ``windows`` are the middles of driving chords, shape (chords, width): each chord's own and the middles that follow
    it.
    """

    placement: Placement
    stretches: _Stretches
    driving: Chords
    driven: Chords
    windows: ComplexArray


@dataclass(frozen=True, eq=False)
class _Pairs:
    """Chords of both outlines that may be near each other in a stretch, shape (n,); ``row`` numbers the stretch."""

    row: IndexArray
    driving: Chords
    driven: Chords


@dataclass(frozen=True, eq=False)
class _Placed:
    """One chord of each of n pairs at k positions, (n, k) or (n, 1); ``against`` turns it onto the first axis."""

    start: ComplexArray
    against: ComplexArray
    length_mm: Array


@dataclass(frozen=True, eq=False)
class Facing:
    """Two outlines in their own frames, with their material on the left, and their properties at all positions.

    Shape (n,) each, counter-clockwise, but clockwise for a ring; ``pitch_mm`` is the pitch of their teeth.
    """

    driving: ComplexArray
    driven: ComplexArray
    pitch_mm: float

    @cached_property
    def once(self) -> Chords:
        """The chords of the driven outline."""
        return chords_of(self.driven, np.inf)

    @cached_property
    def twice(self) -> Chords:
        """The same chords, twice round."""
        return Chords.joined([self.once, self.once])

    @cached_property
    def grain_mm(self) -> float:
        """The grain, the unit of sizes."""
        return min(GRAIN_IN_PITCHES * self.pitch_mm, float(self.once.length_mm.mean()))

    @cached_property
    def chords(self) -> Chords:
        """The chords of the driving outline, with long chords in pieces."""
        return chords_of(self.driving, LONGEST * self.grain_mm)

    @cached_property
    def around(self) -> PolarOutline:
        """The same chords by the polar angles of their starts."""
        return polar_outline(self.chords.start)

    def meeting_rad(self, center_distance_mm: float) -> float:
        """Half the angle about the driving axis, centred towards the driven axis, that holds all met vertices."""
        own, other = (float(np.abs(outline).max()) for outline in (self.driving, self.driven))
        # A vertex stays on its circle about the driven axis, so it meets a chord that reaches into the outermost
        # circle.
        reached = other + 2.0 * float(self.chords.half_mm.max())
        if reached >= center_distance_mm:
            return pi
        farthest = min(own, sqrt(center_distance_mm**2 - reached**2))
        cosine = (farthest**2 + center_distance_mm**2 - reached**2) / (2.0 * farthest * center_distance_mm)
        return acos(min(cosine, 1.0))

    def cells(self, reach_mm: float) -> ChordGrid:
        """Cells that name the driven chords within reach of driving chords, wherever these move within a stretch."""
        if reach_mm not in self._known_cells:
            margin = float(self.chords.half_mm.max()) + MOVED * self.grain_mm
            outermost = float(np.abs(self.driven).max())
            cell = max(CELL * self.grain_mm, 2.0 * outermost / MOST_CELLS)
            self._known_cells[reach_mm] = cells_near(self.once, reach_mm + margin, cell)
        return self._known_cells[reach_mm]

    @cached_property
    def _known_cells(self) -> dict[float, ChordGrid]:
        return {}


def apart_play(facing: Facing, placement: Placement, reach_mm: float) -> Apart:
    """Play of two outlines where they stand apart, (n,), in the sector of ``reach_mm`` from the pitch point."""
    pitch, grain, chords = facing.pitch_mm, facing.grain_mm, facing.chords
    stretches = _stretches(facing, placement, reach_mm)
    setting = _Setting(placement, stretches, chords, facing.twice, _windows(chords, stretches.width))
    play, crossed = np.full((2, placement.count), np.inf), np.zeros(placement.count, dtype=bool)
    together = max(BLOCK // stretches.position.shape[1], 1)
    outermost = float(np.abs(facing.driven).max())
    for followed in REACHES_IN_PITCHES:
        open_still = np.nonzero((np.isinf(play).any(axis=0) & ~crossed)[stretches.position].any(axis=1))[0]
        if not open_still.size or followed * pitch > FARTHEST * grain:
            break
        cells = facing.cells(followed * pitch)
        for start in range(0, open_still.size, together):
            rows = open_still[start : start + together]
            pairs = _near_pairs(setting, cells, rows, followed * pitch)
            bounds, apart = _block_play(setting, pairs, rows, followed * pitch)
            position, within = stretches.position[rows].ravel(), bounds.max(axis=0) * outermost <= followed * pitch
            crossed[position] = ~apart
            play[:, position[apart & within]] = bounds[:, apart & within]
            # Where no play is within reach, the next reach is tried at once.
            if apart.any() and not within[apart].any():
                break
    return Apart(play[0], play[1], np.isfinite(play).all(axis=0))


def half_width_rad(facing: Facing, placement: Placement, reach_mm: float) -> Array:
    """Half the angle that a circle about the pitch point spans from the driving axis, as far as anything is met there.

    Half a turn around the axis.
    """
    share = reach_mm / placement.driving_radius_mm
    spanned = np.where(share < 1.0, np.arcsin(np.minimum(share, 1.0)), pi)
    return np.minimum(spanned, facing.meeting_rad(placement.center_distance_mm))


def _stretches(facing: Facing, placement: Placement, reach_mm: float) -> _Stretches:
    """The longest stretches within which chords move by ``MOVED`` grains at most."""
    chords, outline = facing.chords, facing.around
    direction, half_width = placement.mesh_direction_rad, half_width_rad(facing, placement, reach_mm)
    for span in (*SPANS_IN_STEPS, 0.0):
        position = _together(placement, span)
        low, high = (direction - half_width)[position].min(axis=1), (direction + half_width)[position].max(axis=1)
        first, count = outline.windows((low + high) / 2.0, (high - low) / 2.0)
        moving = _moving(placement, position)
        stretches = _Stretches(position, first % chords.start.size, int(count.max()), *moving)
        if _moved_mm(chords, stretches) <= MOVED * facing.grain_mm:
            break
    return stretches


def _together(placement: Placement, steps: float) -> IndexArray:
    """Neighbouring positions within a number of steps, shape (stretches, k)."""
    number = np.arange(placement.count)
    if steps:
        # Rounding errors must not part a position from its step.
        number = np.floor(placement.rolled_mm / (steps * placement.step_mm) + ROUNDING)
    begin = np.flatnonzero(np.diff(number, prepend=-np.inf))
    count = np.diff(np.append(begin, placement.count))
    parts = -(-count // MOST_TOGETHER)
    run, part = counted_up(np.zeros_like(parts), parts)
    first, last = (begin[run] + count[run] * end // parts[run] for end in (part, part + 1))
    within = np.arange(int((last - first).max()))
    return np.minimum(first[:, None] + within, last[:, None] - 1)


def _moving(placement: Placement, position: IndexArray) -> tuple[ComplexArray, Array, Array]:
    """The pole of each stretch, and its ``shift_mm`` and ``turn_rad``."""
    middle = position[:, position.shape[1] // 2]
    pole = placement.driving_radius_mm[middle] * np.exp(1j * placement.mesh_direction_rad[middle])
    one = np.ones(1, dtype=complex)
    shift = placement.driving_points(pole[:, None], position) - placement.driving_points(pole, middle)[:, None]
    turn = placement.driving_directions(one, position) - placement.driving_directions(one, middle)[:, None]
    return pole, np.abs(shift).max(axis=1), np.abs(turn).max(axis=1)


def _moved_mm(chords: Chords, stretches: _Stretches) -> float:
    """Largest motion of any tested chord from its place in the middle of its stretch."""
    if stretches.position.shape[1] == 1:
        return 0.0
    window = _windows(chords, stretches.width)[stretches.first]
    farthest = np.sqrt(square(window - stretches.pole[:, None]).max(axis=1)) + chords.half_mm.max()
    return float((stretches.shift_mm + stretches.turn_rad * farthest).max())


def _windows(chords: Chords, width: int) -> ComplexArray:
    return sliding_window_view(np.concatenate([chords.middle, chords.middle[: width - 1]]), width)


def _near_pairs(setting: _Setting, cells: ChordGrid, rows: IndexArray, reach_mm: float) -> _Pairs:
    """All pairs of chords that come as near as ``reach_mm`` somewhere in their stretch, and a few more."""
    placement, stretches = setting.placement, setting.stretches
    first, middle = stretches.first[rows], stretches.middle[rows]
    places = placement.driving_points(setting.windows[first], middle[:, None]).ravel()
    cell = cells.cell(places)
    kept = np.nonzero(cells.beyond[cell])[0]
    row, column = np.divmod(kept, stretches.width)
    chord = (first[row] + column) % setting.driving.start.size
    begin = cells.first[cell[kept]]
    own, other = counted_up(begin, cells.beyond[cell[kept]] - begin)
    between = setting.driven.middle[other] - places[kept][own]
    half, other_half = setting.driving.half_mm[chord], setting.driven.half_mm
    # How near pairs are in the middle of the stretch: chords far from the pole move more.
    away = np.abs(setting.driving.middle[chord] - stretches.pole[rows][row]) + half
    near = reach_mm + stretches.shift_mm[rows][row] + stretches.turn_rad[rows][row] * away
    close = np.nonzero(square(between) <= ((near + half)[own] + other_half[other]) ** 2)[0]
    own, other, between = own[close], other[close], between[close]
    direction = placement.driving_directions(setting.driving.direction[chord], middle[row])[own]
    other_direction, near = setting.driven.direction[other], near[own]
    # Distance of one chord's middle from the other's line, less the amount by which its ends are nearer.
    lean = np.abs(across(direction, other_direction))
    beside = np.abs(across(direction, between)) - lean * other_half[other]
    other_beside = np.abs(across(other_direction, between)) - lean * half[own]
    close = np.nonzero((beside <= near) & (other_beside <= near))[0]
    own, other = own[close], other[close]
    return _Pairs(row[own], setting.driving.kept(chord[own]), setting.driven.kept(other))


def _block_play(setting: _Setting, pairs: _Pairs, rows: IndexArray, reach_mm: float) -> tuple[Array, Mask]:
    """Play up and down at each position of the given stretches, up to the reach, and whether no chords cross."""
    placement, position = setting.placement, setting.stretches.position[rows]
    driving, driven = _placed(placement, pairs, position[pairs.row])
    between = driven.start - driving.start
    driving_vertices, driven_vertices = -driven.against * between, driving.against * between
    lean = across(driven.against, driving.against)
    least = (TOUCHING_IN_PITCHES * placement.pitch_mm) ** 2
    # Chords do not cross if both ends of a chord are on the same side of the other chord.
    separate = driven_vertices.imag * (driven_vertices.imag + lean * driven.length_mm) > least
    separate |= driving_vertices.imag * (driving_vertices.imag - lean * driving.length_mm) > least
    apart = np.ones(position.size, dtype=bool)
    apart[_places(pairs.row, np.flatnonzero(~separate), position.shape[1])] = False
    slack = SLACK_IN_PITCHES * placement.pitch_mm
    own = _least_turns(driving_vertices, driven, pairs.row, position.size, reach_mm, slack)
    other = _least_turns(driven_vertices, driving, pairs.row, position.size, reach_mm, slack)
    # Where nothing crosses, all vertices are inside if the nearest vertex is.
    for leaving, entering in (own.min(axis=1), other.min(axis=1)):
        apart &= entering <= leaving
    # To turn the driving gear up is to turn the driven gear's vertices down.
    return np.minimum(own, other[:, ::-1]).min(axis=0), apart


def _placed(placement: Placement, pairs: _Pairs, position: IndexArray) -> tuple[_Placed, _Placed]:
    driving, driven = pairs.driving, pairs.driven
    start = placement.driving_points(driving.start[:, None], position)
    against = np.conj(placement.driving_directions(driving.direction[:, None], position))
    other_against = np.conj(driven.direction)[:, None]
    return (
        _Placed(start, against, driving.length_mm[:, None]),
        _Placed(driven.start[:, None], other_against, driven.length_mm[:, None]),
    )


def _places(row: IndexArray, number: IndexArray, positions: int) -> IndexArray:
    """Numbers of positions within the block, from flat numbers in arrays of shape (pairs, positions)."""
    return row[number // positions] * positions + number % positions


def _least_turns(
    vertex: ComplexArray, chord: _Placed, row: IndexArray, places: int, reach_mm: float, slack_mm: float
) -> Array:
    """Least angles by which vertices turn about the driven axis to chords within their reach.

    Vertices, shape (n, k), are seen from the chords' starts, with the chords along the first axis.  The angles have the
    shape (2, 2, places): the angles at which a vertex leaves the other gear and at which it enters it, each up and
    down.
    """
    positions, moves = vertex.shape[1], chord.start.shape == vertex.shape
    near = np.flatnonzero(np.abs(vertex.imag) <= reach_mm)
    beside, half = vertex.ravel()[near], (chord.length_mm / 2.0)[near // positions, 0]
    close = np.nonzero(np.abs(beside.real - half) <= half + reach_mm)[0]
    near, beside, half = near[close], beside[close], half[close]
    start, against = (values.ravel()[near if moves else near // positions] for values in (chord.start, chord.against))
    start = against * start
    vertex = start + beside
    # The vertex's circle crosses the chord's line on both sides of its foot, where the radius falls and where it rises.
    squared = vertex.real**2 + beside.imag * (vertex.imag + start.imag)
    from_foot = np.sqrt(np.maximum(squared, 0.0)) * np.array([[-1.0], [1.0]])
    met = (np.abs(from_foot - start.real - half) <= half + slack_mm) & (squared >= 0.0)
    rising, which = np.nonzero(met)
    vertex, along, aside = vertex[which], from_foot[met], start.imag[which]
    turn = np.arctan2(vertex.real * aside - vertex.imag * along, vertex.real * along + vertex.imag * aside)
    down = np.signbit(turn)
    kind = 2 * (down != rising) + down
    least = np.full(4 * places, np.inf)
    np.minimum.at(least, kind * places + _places(row, near[which], positions), np.abs(turn))
    return least.reshape(2, 2, places)
