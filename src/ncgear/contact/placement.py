"""The places of the two gears in the analysed positions, and the flanks that meet in them.

The whole analysis uses the driven gear's own frame: its curves stand still and the driving gear moves.  Everything that
depends on the gears' senses of turning, and on their sides of the pitch point, is here.
"""

from __future__ import annotations

from dataclasses import replace
from functools import cached_property, lru_cache
from math import ceil, floor, lcm, pi

import numpy as np

from ncgear.frozen import dataclass
from ncgear.numerics.arrays import Array, Columns, ComplexArray, IndexArray, Mask, counted_up, distinct
from ncgear.pitch.pair import PitchPair, ToothedArc
from ncgear.pitch.shape import Gear, Mesh, meeting_direction_rad
from ncgear.teeth.flank import made_mates, mating_flanks
from ncgear.teeth.gear import ToothedPair

PER_TOOTH = 20
"""Positions per tooth pitch.  It is even, so that each tooth and each space stands on the pitch point once."""

FEWEST = 400
"""Least number of positions in a cycle, however few the teeth are."""

PUSHING, BACK = 0, 1
"""The side of the driving gear's flanks that push the driven gear on, and the side of the flanks that would hold it
back: the rows of tables of shape (2, ...).  Arc length grows against the driving gear's turning, so a pushing flank
faces falling arc length."""

BOTH_SIDES = PUSHING, BACK

URGE = np.array([1.0, -1.0])
"""+1 on pushing flanks, where the first contact is farthest ahead; -1 on their backs."""


@dataclass(frozen=True, eq=False)
class Placement:
    """Both gears in n positions of a cycle in which every tooth meets all its mates.

    ``rolled_mm`` is the pitch curves' arc length, ``phi1_rad`` and ``phi2_rad`` are the law's angles and ``speed`` is
    dphi2/dphi1, shape (n,) each.  Positions from ``placed`` are evenly spaced in rolled length over the whole cycle;
    ``step_mm`` is the rolled length between two of these, and ``per_tooth`` of them make a tooth pitch.  Gears that
    turn less than once have no cycle: their positions go from the beginning of the range to its end, both included,
    and ``toothed`` tells their teeth.
    """

    mesh: Mesh
    center_distance_mm: float
    driving_teeth: int
    driven_teeth: int
    step_mm: float
    per_tooth: float
    rolled_mm: Array
    phi1_rad: Array
    phi2_rad: Array
    speed: Array
    toothed: ToothedArc | None = None

    @property
    def count(self) -> int:
        """Number of positions."""
        return self.phi1_rad.size

    def followed_by(self, other: Placement) -> Placement:
        """These positions and then the positions of ``other``, of the same cycle."""
        return replace(
            self,
            rolled_mm=np.concatenate([self.rolled_mm, other.rolled_mm]),
            phi1_rad=np.concatenate([self.phi1_rad, other.phi1_rad]),
            phi2_rad=np.concatenate([self.phi2_rad, other.phi2_rad]),
            speed=np.concatenate([self.speed, other.speed]),
        )

    def beginning(self, count: int) -> Placement:
        """The first positions."""
        rolled, phi1, phi2, speed = (
            values[:count] for values in (self.rolled_mm, self.phi1_rad, self.phi2_rad, self.speed)
        )
        return replace(self, rolled_mm=rolled, phi1_rad=phi1, phi2_rad=phi2, speed=speed)

    def repeat(self, driving: ComplexArray, driven: ComplexArray) -> int:
        """Positions after which both gears stand as at first, each turned by whole teeth; all where they never do.

        ``driving`` and ``driven`` are places of the gears in their own frames, in the order in which they come to the
        mesh, equally many for each tooth along the first axis; other places repeat nothing.
        """
        share = (part for part in range(1, self.meetings) if self.meetings % part == 0 and self.toothed is None)
        for pitches in share:
            after = round(pitches * self.per_tooth)
            turns = 2.0 * pi * pitches / self.driving_teeth, 2.0 * pi * pitches / self.driven_teeth
            angles = (self.phi1_rad, turns[0]), (self.phi2_rad, turns[1])
            if all(np.abs(angle[after:] - angle[:-after] - turn).max() <= ALIKE for angle, turn in angles) and all(
                _repeats(places, turn / (2.0 * pi), sense)
                for places, turn, sense in zip((driving, driven), turns, (1.0, self.mesh.sense), strict=True)
            ):
                return after
        return self.count

    @property
    def meetings(self) -> int:
        """Number of meetings of two teeth in the cycle, one in each tooth pitch."""
        return lcm(self.driving_teeth, self.driven_teeth)

    @property
    def steps(self) -> int:
        """Steps from position to position: as many as positions where the last position leads to the first."""
        return self.count - (self.toothed is not None)

    @property
    def cycle_rad(self) -> float:
        """Driving angle of the whole cycle, or of the range."""
        if self.toothed is not None:
            return self.toothed.covered_rad
        return 2.0 * pi * self.meetings / self.driving_teeth

    def teeth_at(self, position: int) -> tuple[int, int]:
        """Numbers, from 1, of the driving and the driven tooth nearest to the pitch point at a position."""
        # Rounding errors of the rolled length must not decide between two teeth.
        pitches = round(float(self.rolled_mm[position]) / self.pitch_mm, 9)
        driving, driven = round(pitches), floor(pitches)
        if self.toothed is not None:
            driving, driven = driving + self.toothed.before, driven + self.toothed.before
        return driving % self.driving_teeth + 1, driven % self.driven_teeth + 1

    @property
    def pitch_mm(self) -> float:
        """Tooth pitch along the pitch curves."""
        return self.step_mm * self.per_tooth

    @property
    def cycle_mm(self) -> float:
        """Rolled length of the whole cycle."""
        return self.pitch_mm * self.meetings

    @property
    def driving_radius_mm(self) -> Array:
        """Distance of the pitch point from the driving axis."""
        return self.speed * self.driven_radius_mm

    @property
    def driven_radius_mm(self) -> Array:
        """Distance of the pitch point from the driven axis."""
        return self.center_distance_mm / (1.0 - self.mesh.sense * self.speed)

    @property
    def mesh_direction_rad(self) -> Array:
        """Polar angle, in the driving gear's frame, at which the pitch point lies."""
        return meeting_direction_rad(Gear.DRIVING, self.mesh) - self.phi1_rad

    @property
    def ahead(self) -> float:
        """Sense, +1 for up, in which the driven gear's frame turns the driving gear where the driven gear leads."""
        return -self.mesh.sense

    @property
    def driven_inside(self) -> bool:
        """Whether the driven gear is a ring, with its material beyond its teeth as seen from its axis."""
        return self.mesh is Mesh.INTERNAL

    def driving_points(self, points: ComplexArray, row: IndexArray) -> ComplexArray:
        """Points of the driving gear's frame in the driven gear's, at positions ``row``; shapes broadcast."""
        return points * self._turn[row] + self._driving_axis[row]

    def driving_directions(self, vectors: ComplexArray, row: IndexArray) -> ComplexArray:
        """Directions of the driving gear's frame in the driven gear's; shapes broadcast."""
        return vectors * self._turn[row]

    def bounds_rad(self, up_rad: Array, down_rad: Array) -> tuple[Array, Array]:
        """Driven angles beyond the law's at which the pushing flanks touch and at which their backs touch.

        In the driven gear's frame the driving gear can turn up by ``up_rad`` and down by ``down_rad``.
        """
        return (-down_rad, up_rad) if self.ahead > 0.0 else (-up_rad, down_rad)

    def fixed_points(self, points: ComplexArray, row: IndexArray, ahead_rad: Array) -> ComplexArray:
        """Points of the driven gear's frame in the fixed frame, where the driven gear is ``ahead_rad`` of the law."""
        return self.fixed_directions(points, row, ahead_rad) + self.center_distance_mm

    def fixed_directions(self, vectors: ComplexArray, row: IndexArray, ahead_rad: Array) -> ComplexArray:
        """Directions of the driven gear's frame in the fixed frame, where the gear is ``ahead_rad`` of the law."""
        return vectors * np.exp(1j * self.mesh.sense * (self.phi2_rad[row] + ahead_rad))

    def relative_velocity(self, points: ComplexArray, row: IndexArray) -> ComplexArray:
        """Velocity of the driving gear against the driven gear at points of the fixed frame, in mm per rad of phi1."""
        return 1j * points - 1j * self.mesh.sense * self.speed[row] * (points - self.center_distance_mm)

    @cached_property
    def pitch_point(self) -> ComplexArray:
        """The pitch point in the driven gear's frame, shape (n,)."""
        return self._driving_axis * (self.driven_radius_mm / self.center_distance_mm)

    @cached_property
    def _turn(self) -> ComplexArray:
        return np.exp(1j * (self.phi1_rad - self.mesh.sense * self.phi2_rad))

    @cached_property
    def _driving_axis(self) -> ComplexArray:
        return -self.center_distance_mm * np.exp(-1j * self.mesh.sense * self.phi2_rad)


ALIKE = 1e-11
"""Difference of angles in rad, and of places as a share of the largest, of gears that repeat: rounding leaves 1e-14."""


def _repeats(places: ComplexArray, turn: float, sense: float) -> bool:
    """Whether places repeat after a part of a turn, against the gear's ``sense`` of turning."""
    after = len(places) * turn
    turned = places * np.exp(-2j * pi * sense * turn)
    astray = np.abs(np.roll(places, -round(after), axis=0) - turned).max()
    return abs(after - round(after)) < 1e-6 and bool(astray <= ALIKE * np.abs(places).max())


@lru_cache(maxsize=4)
def placed(pitch: PitchPair, per_tooth: int | None = None) -> Placement:
    """The pair at ``per_tooth`` positions (even; 20, or more with few teeth) per tooth, until all teeth have met.

    Gears that turn less than once have at least this number, evenly from end to end of their range.  Kept, since every
    load and every section of helical teeth asks for the same one, which takes 2 ms of 40 teeth.
    """
    size, toothed = pitch.size, pitch.toothed
    if toothed is not None:
        pitch_mm = pi * size.module_mm
        steps = ceil(max(toothed.covered_mm / pitch_mm * (per_tooth or PER_TOOTH), 0.0 if per_tooth else FEWEST))
        step = toothed.covered_mm / steps
        rolled = np.linspace(0.0, toothed.covered_mm, steps + 1)
        sizes = size.center_distance_mm, size.driving_teeth, size.driven_teeth, step, pitch_mm / step
        return Placement(pitch.mesh, *sizes, rolled, *_law_at(pitch, rolled), toothed)
    meetings = lcm(size.driving_teeth, size.driven_teeth)
    per_tooth = per_tooth or max(PER_TOOTH, 2 * ceil(FEWEST / meetings / 2))
    step = pitch.driving.length_mm / size.driving_teeth / per_tooth
    rolled = step * np.arange(meetings * per_tooth, dtype=float)
    fixed = pitch.mesh, size.center_distance_mm, size.driving_teeth, size.driven_teeth, step, per_tooth
    return Placement(*fixed, rolled, *_law_at(pitch, rolled))


def placed_at(pitch: PitchPair, even: Placement, rolled_mm: Array) -> Placement:
    """The pair at any rolled lengths of the cycle of ``even`` positions, shape (n,)."""
    phi1, phi2, speed = _law_at(pitch, rolled_mm)
    return replace(even, rolled_mm=rolled_mm, phi1_rad=phi1, phi2_rad=phi2, speed=speed)


def _law_at(pitch: PitchPair, rolled_mm: Array) -> tuple[Array, Array, Array]:
    covered = pitch.transmission.lobes.range
    # Rounding errors must not put the first position before the seam of the law, or the last position beyond a range.
    phi1 = np.clip(pitch.driving.driving_angle(rolled_mm), 0.0, covered.driving_rad if covered else np.inf)
    angle = pitch.transmission.driven_angle(phi1, 1)
    return phi1, angle.value, angle.derivative(1)


REACH_IN_PITCHES = 2.0
"""Rolled length before and after the pitch point over which a pair of flanks is analysed.  It is twice the length that
a rack tooth as high as the module covers at 20 degrees, since corners touch beyond the flanks' own contact."""


NEARLY_IN_PITCHES = 1e-6
"""A rolled length beyond it, far above rounding errors."""


@dataclass(frozen=True, eq=False)
class Meetings(Columns):
    """The m meetings of two flanks in a cycle, each analysed in k positions.

    ``side`` is PUSHING or BACK, ``driving`` and ``driven`` number the flanks, shape (m,).  ``position`` numbers the
    positions, shape (m, k); ``driving_ahead_mm`` and ``driven_ahead_mm`` are the rolled lengths until each flank
    crosses the pitch point.  ``there`` (shape (m, k)) marks the positions that exist: none lie beyond the ends of a
    range.
    """

    side: IndexArray
    driving: IndexArray
    driven: IndexArray
    position: IndexArray
    driving_ahead_mm: Array
    driven_ahead_mm: Array
    there: Mask

    @property
    def urge(self) -> Array:
        """``URGE`` of each meeting, shape (m,)."""
        return URGE[self.side]

    def on(self, side: int) -> Meetings:
        """The meetings on one side of the teeth."""
        return self.kept(self.side == side)


def meetings(teeth: ToothedPair, placement: Placement) -> Meetings:
    """All meetings on both sides of the teeth, in the order in which the flanks of each side meet."""
    side, driving, driven, driving_mm, driven_mm = _crossings_mm(teeth, placement)
    reach = REACH_IN_PITCHES * placement.per_tooth
    first = np.ceil(driving_mm / placement.step_mm - reach).astype(int)
    position = first[:, None] + np.arange(int(2 * reach))
    rolled = position * placement.step_mm
    ahead = driving_mm[:, None] - rolled, driven_mm[:, None] - rolled
    there = (position >= 0) & (position < placement.count) | (placement.toothed is None)
    return Meetings(side, driving, driven, position % placement.count, *ahead, there)


def single_meetings(teeth: ToothedPair, placement: Placement) -> Meetings:
    """As ``meetings`` for positions at any rolled lengths: every meeting in each position near it, m of k = 1."""
    side, driving, driven, driving_mm, driven_mm = _crossings_mm(teeth, placement)
    number, position = _near(driving_mm, placement)
    first = driving_mm[number] - placement.rolled_mm[position]
    if placement.toothed is None:
        cycle = placement.cycle_mm
        first = (first + cycle / 2.0) % cycle - cycle / 2.0
    near = np.abs(first) <= REACH_IN_PITCHES * placement.pitch_mm
    number, position, first = number[near], position[near, None], first[near, None]
    second = first + (driven_mm - driving_mm)[number][:, None]
    there = np.ones(first.shape, dtype=bool)
    return Meetings(side[number], driving[number], driven[number], position, first, second, there)


def _near(driving_mm: Array, placement: Placement) -> tuple[IndexArray, IndexArray]:
    """Meetings and their near positions, with a few more, in the meetings' order; shape (n,) each."""
    crossing, rolled, who = driving_mm, placement.rolled_mm, np.arange(driving_mm.size)
    reach = (REACH_IN_PITCHES + NEARLY_IN_PITCHES) * placement.pitch_mm
    if placement.toothed is None:
        # Meetings at the beginning of the cycle are near positions at its end.
        cycle = placement.cycle_mm
        turns = np.arange(-ceil(reach / cycle), ceil(reach / cycle) + 1)
        crossing, rolled = (crossing % cycle + turns[:, None] * cycle).ravel(), rolled % cycle
        who = np.tile(who, turns.size)
    order = np.argsort(crossing)
    begin, end = (np.searchsorted(crossing[order], rolled + way) for way in (-reach, reach))
    position, place = counted_up(begin, end - begin)
    # Around a short cycle a meeting may come near twice.
    pair = distinct(who[order[place]] * rolled.size + position)
    return pair // rolled.size, pair % rolled.size


def _crossings_mm(teeth: ToothedPair, placement: Placement) -> tuple[IndexArray, IndexArray, IndexArray, Array, Array]:
    """The sides and flanks of all meetings, and the rolled lengths at which both cross the pitch point in the cycle."""
    if placement.toothed is not None:
        return _made_crossings_mm(teeth)
    driving, driven = mating_flanks(placement.driving_teeth, placement.driven_teeth)
    side = np.repeat([BACK, PUSHING], placement.meetings)
    turn = np.tile(np.arange(placement.meetings) // placement.driving_teeth, 2)
    own, other = teeth.driving.flanks, teeth.driven.flanks
    driving_mm = own.crossing_mm[driving] + turn * own.curve.length_mm
    turns = np.round((driving_mm - other.crossing_mm[driven]) / other.curve.length_mm)
    return side, driving, driven, driving_mm, other.crossing_mm[driven] + turns * other.curve.length_mm


def _made_crossings_mm(teeth: ToothedPair) -> tuple[IndexArray, IndexArray, IndexArray, Array, Array]:
    """As ``_crossings_mm`` for gears that turn less than once: neither makes a whole turn."""
    own, other = teeth.driving.flanks, teeth.driven.flanks
    driving, driven = made_mates(own, other)
    side = np.where(own.side[driving] > 0.0, BACK, PUSHING)
    return side, driving, driven, own.crossing_mm[driving], other.crossing_mm[driven]
