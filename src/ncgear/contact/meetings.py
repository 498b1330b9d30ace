"""Which flanks meet, and in which positions a pair of them is looked at."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from ncgear.contact.placement import BACK, PUSHING, Placement
from ncgear.numerics.arrays import Array, IndexArray
from ncgear.teeth.gear import ToothedPair
from ncgear.teeth.meeting import mating_flanks

REACH_IN_PITCHES = 2.0
"""Rolled length, before and after a pair of flanks crosses the pitch point, in which it is looked at: twice what a rack
tooth as high as the module covers at 20 degrees; corners touch beyond the flanks' own contact."""


@dataclass(frozen=True, eq=False)
class Meetings:
    """The m meetings of two flanks in a cycle, on one side of the teeth, each looked at in k positions.

    ``driving`` and ``driven`` number the flanks, shape (m,).  ``position`` numbers the positions, shape (m, k);
    ``driving_ahead_mm`` and ``driven_ahead_mm`` are the rolled lengths until each flank crosses the pitch point.
    """

    side: float
    driving: IndexArray
    driven: IndexArray
    position: IndexArray
    driving_ahead_mm: Array
    driven_ahead_mm: Array

    @property
    def urge(self) -> float:
        """+1 where the first contact is the one farthest ahead, on pushing flanks; -1 on the others."""
        return 1.0 if self.side == PUSHING else -1.0


def meetings(teeth: ToothedPair, placement: Placement, side: float) -> Meetings:
    """All meetings on the driving gear's flanks of ``side`` (PUSHING or BACK)."""
    number = np.arange(placement.meetings)
    driving, driven = _mates(placement, side)
    own, other = teeth.driving.flanks, teeth.driven.flanks
    driving_mm = own.crossing_mm[driving] + number // placement.driving_teeth * own.curve.length_mm
    turns = np.round((driving_mm - other.crossing_mm[driven]) / other.curve.length_mm)
    driven_mm = other.crossing_mm[driven] + turns * other.curve.length_mm
    reach = REACH_IN_PITCHES * placement.per_tooth
    first = np.ceil(driving_mm / placement.step_mm - reach).astype(int)
    position = first[:, None] + np.arange(int(2 * reach))
    rolled = position * placement.step_mm
    ahead = driving_mm[:, None] - rolled, driven_mm[:, None] - rolled
    return Meetings(side, driving, driven, position % placement.count, *ahead)


def _mates(placement: Placement, side: float) -> tuple[IndexArray, IndexArray]:
    """The driving and the driven flank of each meeting, in the order in which they meet."""
    driving, driven = mating_flanks(placement.driving_teeth, placement.driven_teeth)
    rows = slice(None, placement.meetings) if side == BACK else slice(placement.meetings, None)
    return driving[rows], driven[rows]
