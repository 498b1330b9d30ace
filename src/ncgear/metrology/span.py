"""Span (base tangent length) over some teeth of a gear, in the places where two plates have a common normal.

With the chord from P1 to P2 (chords.py), sigma1 and sigma2 the arc lengths of its ends, and c1, c2 those at which the
back flank of the first tooth and the front flank of the last one cross the pitch curve,

    W = |P2 - P1| + cos(alpha) ((c2 - c1) - (sigma2 - sigma1)).

On a circle of z teeth that is the usual W = m cos(alpha) (pi (k - 1/2) + z inv(alpha)) + 2 x m sin(alpha).
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from ncgear.metrology.chords import NO_CHORDS, MeasuringChords, measuring_chords
from ncgear.metrology.working import WorkingFlanks
from ncgear.numerics.arrays import Array, IndexArray, Mask


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
