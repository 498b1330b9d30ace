"""Extreme values of the contact as designed, between the positions of the table as well.

From the even positions of a cycle the search closes in on each extreme: where contact passes from one pair of teeth to
another, errors have kinks and the sliding has jumps.  Teeth have no feature between two positions only: a dent of the
pitch curves that is so narrow and deep enough to show is curved too sharply for a flank.
"""

from __future__ import annotations

from collections.abc import Callable, Sequence
from dataclasses import replace

import numpy as np
from numpy.lib.stride_tricks import sliding_window_view

from ncgear.contact.designed.as_designed import ALIKE_RAD, AsDesigned, PairTouch, touch_at
from ncgear.contact.placement import BACK, PUSHING, Placement, placed_at
from ncgear.frozen import dataclass
from ncgear.numerics.arrays import Array
from ncgear.numerics.extrema import Extremum
from ncgear.numerics.highest import largest_from
from ncgear.numerics.plane import angle_between
from ncgear.pitch.pair import PitchPair
from ncgear.teeth.gear import ToothedPair

KNOWN, CLOSELY = 1e-3, 1e-6
"""Largest errors of an extreme, as shares of its variation over the cycle.  The first is for an error, which has a kink
at every change of teeth and is limited by rounding of angles.  The second is for a pressure angle, the sliding or the
lever, which is a one-sided limit where the teeth change at the extreme."""


@dataclass(frozen=True)
class ValueRange:
    """The least and the greatest value of a quantity over a cycle, each ``at`` a driving angle in rad."""

    low: Extremum
    high: Extremum

    @property
    def width(self) -> float:
        """Peak to peak variation."""
        return self.high.value - self.low.value


@dataclass(frozen=True)
class ContactExtremes:
    """Extremes over a whole cycle, ``at`` driving angles in rad; quantities as in ``AsDesigned``.

    ``least_lever_mm`` is the lever of the first contact of pushing flanks about the driven axis.  ``overlap_mm`` is 0
    where teeth never overlap; ``overlap_teeth`` are the numbers of the driving and the driven tooth at the pitch point
    where they overlap most.
    """

    pushing_error_rad: ValueRange
    back_error_rad: ValueRange
    backlash_rad: ValueRange
    pushing_pressure_angle_rad: ValueRange
    back_pressure_angle_rad: ValueRange
    sliding_mm_s: Extremum
    least_lever_mm: Extremum
    overlap_mm: Extremum
    overlap_teeth: tuple[int, int]


def contact_extremes(
    teeth: ToothedPair, pitch: PitchPair, designed: AsDesigned, speed_rad_s: Callable[[Array], Array]
) -> ContactExtremes:
    """The extremes of a pair of known contact; ``speed_rad_s`` is the driving gear's.  Raises as ``as_designed``."""
    touch, even = touch_at(teeth), designed.placement

    def quantities(rolled_mm: Array) -> Array:
        return _quantities(touch(placed_at(pitch, even, rolled_mm)), speed_rad_s)

    known = _quantities(designed, speed_rad_s)
    places, values = over_cycle(even, known)
    counts = [ERRORS, len(known) - ERRORS - 1, 1]
    shares = np.repeat([KNOWN, CLOSELY, KNOWN], counts)
    told = np.repeat([ALIKE_RAD, 0.0, ALIKE_RAD * float(designed.pushing.first.lever_mm.max())], counts)
    missed = np.maximum(shares * np.ptp(values, axis=1), told)
    level = {row: at for row, side in LEAST_ANGLES.items() if (at := _level_mm(designed, side)) is not None}
    if level:
        there = quantities(np.array(list(level.values())))
        level = {row: at for number, (row, at) in enumerate(level.items()) if there[row, number] >= -missed[row]}
    # No angle is below that, so these quantities need no search.
    missed[list(level)] = np.inf
    found = largest_from(quantities, places, values, missed)
    found = [Extremum(0.0, level[row]) if row in level else extremum for row, extremum in enumerate(found)]
    *ranges, sliding, lever, ahead = at_angles(pitch, even, found)
    pushing, back, backlash, *angles = ranges_of(ranges)
    pushing_angle, back_angle = (_settled(side) for side in angles)
    overlap, deepest = replace(ahead, value=max(ahead.value, 0.0)), placed_at(pitch, even, np.array([found[-1].at]))
    found_at = pushing_angle, back_angle, sliding, replace(lever, value=-lever.value), overlap
    return ContactExtremes(pushing, back, backlash, *found_at, deepest.teeth_at(0))


def _level_mm(designed: AsDesigned, side: int) -> float | None:
    """Rolled length at which the pressure angle of first contacts passes zero; None where no four positions show this.

    There it rises or falls on one pair of flanks; the place is that of the cubic through the inverse.
    """
    first, rolled = (designed.pushing, designed.back)[side].first, designed.placement.rolled_mm
    angle = angle_between(first.tangent, first.point)
    angle -= np.pi * np.round(angle / np.pi)
    alike = first.flanks[1:] & first.flanks[:-1] & (np.diff(first.driving) == 0) & (np.diff(first.driven) == 0)
    steps = sliding_window_view(np.where(alike, np.sign(np.diff(angle)), 0.0), 3)
    passing = np.flatnonzero((np.abs(steps.sum(axis=1)) == 3.0) & (angle[1:-2] * angle[2:-1] < 0.0))
    if not passing.size:
        return None
    four = passing[0] + np.arange(4)
    shares = angle[four] / (angle[four] - angle[four, None] + np.diag(angle[four]))
    return float(np.prod(shares, axis=1) @ rolled[four])


def _settled(angle: ValueRange) -> ValueRange:
    """The range of a pressure angle, which is never negative; its least value becomes 0 where rounding hides it."""
    return replace(angle, low=replace(angle.low, value=0.0)) if angle.low.value <= CLOSELY * angle.width else angle


def over_cycle(even: Placement, values: Array) -> tuple[Array, Array]:
    """The rolled lengths of ``even`` positions and the values there, shape (q, n), up to the end of the cycle."""
    if even.toothed is not None:
        return even.rolled_mm, values
    return np.append(even.rolled_mm, even.cycle_mm), np.hstack([values, values[:, :1]])


def at_angles(pitch: PitchPair, even: Placement, found: Sequence[Extremum]) -> list[Extremum]:
    """Extremes at rolled lengths of the cycle of ``even`` positions, as extremes at driving angles in rad."""
    phi1 = placed_at(pitch, even, np.array([extremum.at for extremum in found])).phi1_rad
    return [Extremum(extremum.value, float(at)) for extremum, at in zip(found, phi1, strict=True)]


def ranges_of(largest: Sequence[Extremum]) -> list[ValueRange]:
    """The ranges of quantities, from the largest value of each and the largest value of its negative, in turn."""
    pairs = zip(largest[0::2], largest[1::2], strict=True)
    return [ValueRange(replace(low, value=0.0 - low.value), high) for high, low in pairs]


LEAST_ANGLES = {7: PUSHING, 9: BACK}
"""The quantities that are the negative least pressure angles, and their sides of the teeth."""

ERRORS = 6
"""The first quantities, in this number, are errors and backlash; the last quantity is the overlap."""


def _quantities(touch: PairTouch, speed_rad_s: Callable[[Array], Array]) -> Array:
    """The quantities whose largest values are searched, shape (q, n); errors are without mere rounding."""
    sides = touch.pushing, touch.back
    errors = [_told(side.error_rad) for side in sides]
    angles = [side.first.pressure_angle_rad for side in sides]
    ranges = [*errors, errors[1] - errors[0], *angles]
    lever = touch.pushing.first.lever_mm
    sliding = touch.largest_sliding_mm * speed_rad_s(touch.placement.phi1_rad)
    ahead = [np.where(error == 0.0, 0.0, side.ahead_mm) for error, side in zip(errors, sides, strict=True)]
    return np.stack(
        [*(sign * values for values in ranges for sign in (1.0, -1.0)), sliding, -lever, np.maximum(*ahead)]
    )


def _told(error_rad: Array) -> Array:
    return np.where(np.abs(error_rad) > ALIKE_RAD, error_rad, 0.0)
