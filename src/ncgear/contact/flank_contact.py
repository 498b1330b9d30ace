"""Contact of the exact flanks: how long each pair of flanks touches, and how many pairs touch at once.

Mating flanks cross the pitch curves at the same arc length c and touch, at every rolled length sigma, at the height
h = s (c - sigma) sin(alpha) cos(alpha) over the driving gear's tangent; the driven gear's height is -h.
"""

from __future__ import annotations

from dataclasses import dataclass
from math import cos, lcm, sin

import numpy as np

from ncgear.numerics.arrays import Array
from ncgear.teeth.flank import FLANK
from ncgear.teeth.gear import ToothedGear, ToothedPair

Interval = tuple[float, float]


@dataclass(frozen=True)
class FlankContact:
    """Contact over a whole meeting cycle of both gears, the worse side of the teeth taken.

    ``least_ratio`` is the shortest arc of contact of any flank pair in pitches, ``least_simultaneous`` the smallest
    number of pairs in contact at once.
    """

    least_ratio: float
    least_simultaneous: int


def flank_contact(pair: ToothedPair) -> FlankContact:
    """Contact of all flank pairs, front and back, from the exact ranges of the working flanks."""
    sides = [_side_contact(pair, front) for front in (True, False)]
    return FlankContact(min(ratio for ratio, _ in sides), min(count for _, count in sides))


def _side_contact(pair: ToothedPair, front: bool) -> tuple[float, int]:
    driving, driven = _working_heights(pair.driving), _working_heights(pair.driven)
    rack, meetings = pair.driving.flanks.rack, lcm(pair.driving.teeth, pair.driven.teeth)
    per_height = 1.0 / (sin(rack.pressure_angle_rad) * cos(rack.pressure_angle_rad)) / rack.pitch_mm
    events, ratios = [], []
    for meeting in range(meetings):
        own = driving[2 * (meeting % pair.driving.teeth) + (1 if front else 0)]
        # A front flank crosses a quarter pitch after its tooth's middle, and there stands the back of the driven tooth
        # half a pitch on; a back flank meets the front of the driven tooth half a pitch before.
        mate = driven[2 * ((meeting if front else meeting - 1) % pair.driven.teeth) + (0 if front else 1)]
        touching = [(low * per_height, high * per_height) for low, high in _common(own, [(-b, -a) for a, b in mate])]
        ratios.append(sum(high - low for low, high in touching))
        side = 1.0 if front else -1.0
        events += [tuple(sorted((meeting - side * low, meeting - side * high))) for low, high in touching]
    return min(ratios), _least_count(np.array(events).reshape(-1, 2), meetings)


def _working_heights(gear: ToothedGear) -> list[list[Interval]]:
    """Height ranges (low, high) of the working flank that is left, for each flank."""
    heights: list[list[Interval]] = [[] for _ in range(gear.flanks.count)]
    chosen = gear.sides.kind == FLANK
    for owner, start, end in zip(
        gear.sides.owner[chosen], gear.sides.start[chosen], gear.sides.end[chosen], strict=True
    ):
        heights[owner].append((float(end), float(start)))
    return heights


def _common(first: list[Interval], second: list[Interval]) -> list[Interval]:
    """Overlaps of two lists of intervals."""
    overlaps = [(max(a, c), min(b, d)) for a, b in first for c, d in second]
    return [(low, high) for low, high in overlaps if high > low]


def _least_count(intervals: Array, period: int) -> int:
    """Smallest number of intervals over any place of a closed line of length ``period``."""
    if not intervals.size:
        return 0
    shifts = np.arange(-period, 2 * period, period)
    every = (intervals[None, :, :] + shifts[:, None, None]).reshape(-1, 2)
    places = np.unique(np.mod(intervals.ravel(), period))
    middles = (places + np.append(places[1:], places[0] + period)) / 2.0
    started = np.searchsorted(np.sort(every[:, 0]), middles, side="right")
    ended = np.searchsorted(np.sort(every[:, 1]), middles, side="right")
    return int(np.min(started - ended))
