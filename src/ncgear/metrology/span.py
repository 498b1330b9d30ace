"""Chords of a pitch curve that make the rack's pressure angle with it at both ends: where a span can be measured.

The normal of a flank goes through its pitch point P at the pressure angle alpha to the tangent (flank.py).  Two plates
touch the back flank of one tooth and the front flank of another along one common normal only where that line is a chord
from P1 to P2 which leaves the curve inwards at alpha and comes out at alpha.  Flanks do not enter: these chords belong
to the curve.  On a circle every chord of the central angle 2 alpha is one, on other curves a few are.

With d the direction inwards at P1, the curve turns by 2 alpha from P1 to P2, and q = (P2 - P1) x d vanishes.  Plates
that are turned a little from the common normal are apart by more where both flanks' radii of curvature together exceed
their distance, that is where sin(alpha) (1/k1 + 1/k2) exceeds the chord; else by less.

Span (base tangent length) over some teeth of a gear, in the places where two plates have a common normal.

With the chord from P1 to P2 (chords.py), sigma1 and sigma2 the arc lengths of its ends, and c1, c2 those at which the
back flank of the first tooth and the front flank of the last one cross the pitch curve,

    W = |P2 - P1| + cos(alpha) ((c2 - c1) - (sigma2 - sigma1)).

On a circle of z teeth that is the usual W = m cos(alpha) (pi (k - 1/2) + z inv(alpha)) + 2 x m sin(alpha).
"""

from __future__ import annotations

from dataclasses import dataclass
from math import cos, sin

import numpy as np

from ncgear.metrology.working import WorkingFlanks
from ncgear.numerics.arrays import Array, IndexArray, Mask
from ncgear.numerics.zeros import zeros_between
from ncgear.pitch.curve import CurvePoints, PitchCurve
from ncgear.pitch.shape import Gear

STEPS = 1024
"""Of the arc length in which chords are looked for: two of them nearer than a thousandth of the curve, whose signs
cancel, are as good as none, since the reading hardly changes between them."""

EVEN = 1e-9
"""Share of a chord under which the offset q counts as rounding: on a circle it is 1e-15 of it, on a curve whose radius
varies by a millionth 1e-7."""

NEIGHBOURS = 1.5
"""Steps up to which two starts are neighbours on the grid: one is, two, with a start left out between them, are not."""

HAIR = 1e-6
"""Of a step, by which brackets are widened so that rounding at their ends does no harm."""


@dataclass(frozen=True, eq=False)
class MeasuringChords:
    """Arc lengths in mm of both ends, shape (n,), and whether plates turned from the common normal are farther apart.

    ``everywhere`` says that the curve is a circle, for which one chord stands for all.
    """

    start_mm: Array
    end_mm: Array
    least: Mask
    everywhere: bool = False


NO_CHORDS = MeasuringChords(np.empty(0), np.empty(0), np.zeros(0, dtype=bool))


def measuring_chords(curve: PitchCurve, angle_rad: float) -> MeasuringChords:
    """All such chords of one turn between stretches on which the curve is convex; none on a ring.

    Of a dented curve, those that begin where it has turned farther than anywhere before.
    """
    if curve.is_ring:
        return NO_CHORDS
    start, end, offset, length = _tried(curve, angle_rad)
    if np.all(np.abs(offset) <= EVEN * length):
        return MeasuringChords(start[:1], end[:1], np.ones(1, dtype=bool), everywhere=True)
    neighbours = np.diff(start) < NEIGHBOURS * curve.length_mm / STEPS
    change = np.nonzero(((offset[:-1] < 0.0) != (offset[1:] < 0.0)) & neighbours)[0]
    found = _closed_in(curve, angle_rad, (start, end), change)
    return MeasuringChords(*found, _is_least(curve, angle_rad, *found))


def _tried(curve: PitchCurve, angle: float) -> tuple[Array, Array, Array, Array]:
    """Starts over one turn, the ends after a turning of 2 alpha, their offsets and lengths; shape (n,) each."""
    step = curve.length_mm / STEPS
    grid = np.linspace(-curve.length_mm, 2.0 * curve.length_mm, 3 * STEPS + 1)
    turned = _turned(curve, grid)
    farthest = np.maximum.accumulate(turned)
    first = np.nonzero(turned[STEPS : 2 * STEPS + 1] >= farthest[STEPS : 2 * STEPS + 1])[0] + STEPS
    goal = turned[first] + 2.0 * angle
    after = np.searchsorted(farthest, goal)
    kept = (after < grid.size) & (turned[np.minimum(first + 1, grid.size - 1)] > turned[first])
    first, after = first[kept], after[kept]
    end = _end_of(curve, angle, grid[first], grid[after] - (1.0 + HAIR) * step, grid[after] + HAIR * step)
    return grid[first], end, *_offset(curve, angle, grid[first], end)


def _turned(curve: PitchCurve, sigma: Array) -> Array:
    """How far the curve has turned in rad, growing where it is convex, up to a constant; shape (n,)."""
    tangent = curve.at_length(sigma).tangent
    turned: Array = -_sense(curve) * np.unwrap(np.arctan2(tangent[:, 1], tangent[:, 0]))
    return turned


def _sense(curve: PitchCurve) -> float:
    """+1 where the normal is to the left of the tangent, -1 to the right."""
    return 1.0 if curve.gear is Gear.DRIVING else -1.0


def _inwards(at: CurvePoints, angle: float) -> Array:
    """Directions of chords that begin at points."""
    directions: Array = cos(angle) * at.tangent - sin(angle) * at.normal
    return directions


def _outwards(at: CurvePoints, angle: float) -> Array:
    """Directions of chords that end at points."""
    directions: Array = cos(angle) * at.tangent + sin(angle) * at.normal
    return directions


def _end_of(curve: PitchCurve, angle: float, start: Array, low: Array, high: Array) -> Array:
    """Arc lengths between bounds at which the curve has turned by 2 alpha since the starts; shape (n,) each."""
    wanted, sense = _inwards(curve.at_length(start), angle), _sense(curve)

    def short(sigma: Array) -> Array:
        lacking: Array = sense * _cross(wanted, _outwards(curve.at_length(sigma), angle))
        return lacking

    return zeros_between(short, low, high)


def _offset(curve: PitchCurve, angle: float, start: Array, end: Array) -> tuple[Array, Array]:
    """q, and the length of the chord."""
    first, last = curve.at_length(start), curve.at_length(end)
    way = last.position - first.position
    return _cross(way, _inwards(first, angle)), np.linalg.norm(way, axis=1)


def _closed_in(curve: PitchCurve, angle: float, tried: tuple[Array, Array], change: IndexArray) -> tuple[Array, Array]:
    """Both ends of the chords between neighbours whose offsets differ in sign."""
    start, end = tried
    margin = HAIR * curve.length_mm / STEPS
    low, high = end[change] - margin, end[change + 1] + margin

    def offset(sigma: Array) -> Array:
        return _offset(curve, angle, sigma, _end_of(curve, angle, sigma, low, high))[0]

    found = zeros_between(offset, start[change], start[change + 1])
    return found, _end_of(curve, angle, found, low, high)


def _is_least(curve: PitchCurve, angle: float, start: Array, end: Array) -> Mask:
    first, last = curve.at_length(start), curve.at_length(end)
    radii = 1.0 / first.curvature + 1.0 / last.curvature
    least: Mask = sin(angle) * radii > np.linalg.norm(last.position - first.position, axis=1)
    return least


def _cross(a: Array, b: Array) -> Array:
    product: Array = a[:, 0] * b[:, 1] - a[:, 1] * b[:, 0]
    return product


@dataclass(frozen=True, eq=False)
class Spans:
    """Where a gear's span can be measured; shape (n,).

    From the back of tooth ``first`` to the front of tooth ``last`` (numbers from 1) over ``teeth`` teeth the plates are
    ``distance_mm`` apart along their common normal.  ``least`` says whether plates turned a little are farther apart (a
    caliper settles there) or nearer (it is swung for its greatest reading; on a circle it does not matter);
    ``phi1_rad`` is the driving angle at which the middle of the curve between is the pitch point.  ``beyond`` counts
    the places whose plates would touch above or below the flanks.
    """

    first: IndexArray
    last: IndexArray
    teeth: IndexArray
    distance_mm: Array
    least: Mask
    phi1_rad: Array
    everywhere: bool
    beyond: int


def spans(working: WorkingFlanks) -> Spans:
    """All spans of a gear whose plates touch flanks, each over the teeth that they touch nearest to the pitch curve.

    Of a circular gear that of every tooth and as many after it as do so.  None of equivalent gears' flanks, which do
    not follow the pitch curve.
    """
    flanks = working.flanks
    chords = _of_teeth(working, _chords(working))
    first, low = _touching(working, chords.start_mm, -1.0)
    last, high = _touching(working, chords.end_mm, 1.0)
    good = np.isfinite(low) & np.isfinite(high)
    first, last = first[good], last[good]
    distance = _chord_length(working, chords)[good] + (low + high)[good] / np.sin(flanks.rack.pressure_angle_rad)
    middle = (chords.start_mm + chords.end_mm)[good] / 2.0
    return Spans(
        flanks.tooth[first],
        flanks.tooth[last],
        (last - first) // 2 % (flanks.count // 2) + 1,
        working.base_cosine * distance,
        chords.least[good],
        flanks.curve.driving_angle(middle),
        chords.everywhere,
        int(np.count_nonzero(~good)),
    )


def _chords(working: WorkingFlanks) -> MeasuringChords:
    flanks = working.flanks
    return NO_CHORDS if flanks.equivalent else measuring_chords(flanks.curve, flanks.rack.pressure_angle_rad)


def _of_teeth(working: WorkingFlanks, chords: MeasuringChords) -> MeasuringChords:
    """On a circle, one chord for every tooth, which lies evenly over as many teeth as it is long."""
    if not chords.everywhere:
        return chords
    flanks = working.flanks
    arc = float((chords.end_mm - chords.start_mm)[0])
    number = flanks.count // 2
    over = max(1, round(arc / flanks.rack.pitch_mm + 0.5))
    back, front = flanks.crossing_mm[::2], flanks.crossing_mm[1::2]
    last = np.arange(number) + over - 1
    ends = front[last % number] + last // number * flanks.curve.length_mm
    start = (back + ends - arc) / 2.0
    return MeasuringChords(start, start + arc, np.ones(number, dtype=bool), everywhere=True)


def _chord_length(working: WorkingFlanks, chords: MeasuringChords) -> Array:
    curve = working.flanks.curve
    way = curve.at_length(chords.end_mm).position - curve.at_length(chords.start_mm).position
    length: Array = np.linalg.norm(way, axis=1)
    return length


def _touching(working: WorkingFlanks, sigma_mm: Array, side: float) -> tuple[IndexArray, Array]:
    """Of the flanks of one side, for each arc length the one that touches nearest to the pitch line, and its height.

    Shapes (n,); heights are infinite where no flank does within its ends.
    """
    flanks = working.flanks
    chosen = np.nonzero(flanks.side == side)[0]
    turn = flanks.curve.length_mm
    ahead = np.mod(flanks.crossing_mm[chosen] - sigma_mm[:, None] + turn / 2.0, turn) - turn / 2.0
    height = side * ahead * flanks.rack.height_per_rolled
    on_flank = (height >= working.low_mm[chosen]) & (height <= working.high_mm[chosen])
    height = np.where(on_flank, height, np.inf)
    nearest = np.argmin(np.abs(height), axis=1)
    return chosen[nearest], np.take_along_axis(height, nearest[:, None], axis=1)[:, 0]
