"""Which flanks meet, and in which positions a pair of them is looked at."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from ncgear.contact.placement import PUSHING, Placement
from ncgear.numerics.arrays import Array, IndexArray
from ncgear.teeth.gear import ToothedPair

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
    """All meetings on the driving gear's flanks of ``side`` (PUSHING or BACK).

    A front flank of tooth n of the driving gear meets the back of tooth n of the driven gear, which stands half a pitch
    on; a back flank meets the front of the tooth before.
    """
    number = np.arange(placement.meetings)
    front = 0 if side == PUSHING else 1
    driving, driving_mm = _flank(teeth.driving.flanks.crossing_mm, number, front, teeth.driving.flanks.curve.length_mm)
    driven, driven_mm = _flank(
        teeth.driven.flanks.crossing_mm, number - 1 + front, 1 - front, teeth.driven.flanks.curve.length_mm
    )
    reach = REACH_IN_PITCHES * placement.per_tooth
    first = np.ceil(driving_mm / placement.step_mm - reach).astype(int)
    position = first[:, None] + np.arange(int(2 * reach))
    rolled = position * placement.step_mm
    return Meetings(
        side,
        driving,
        driven,
        position % placement.count,
        driving_mm[:, None] - rolled,
        driven_mm[:, None] - rolled,
    )


def _flank(crossing: Array, tooth: IndexArray, front: int, length: float) -> tuple[IndexArray, Array]:
    """Flanks of teeth counted on over any number of turns, and where each crosses the pitch curve, counted on too."""
    turn, within = np.divmod(tooth, crossing.size // 2)
    flank = 2 * within + front
    return flank, crossing[flank] + turn * length
