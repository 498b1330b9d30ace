"""The pair as written: where the outlines that are read back from files touch, at the positions of the design."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from ncgear.contact.placement import Placement
from ncgear.contact.play import outline_play
from ncgear.contact.written_lands import root_depths, tip_heights
from ncgear.numerics.arrays import Array
from ncgear.teeth.gear import ToothedPair


@dataclass(frozen=True, eq=False)
class Outlines:
    """Both outlines as read from what was written (mm, shape (n, 2), own frames), and the ``source`` they are from."""

    source: str
    driving_mm: Array
    driven_mm: Array


@dataclass(frozen=True, eq=False)
class AsWritten:
    """Contact of written outlines at n positions.

    ``pushing_rad`` and ``back_rad`` are the driven angles beyond the law's at which pushing flanks and their backs
    touch, ``overlap_mm`` is how deep the outlines overlap at the law's angle, shape (n,) each; ``driving_tips_mm`` and
    ``driven_tips_mm`` are the least clearances of these gears' tips over the other's roots.
    """

    source: str
    pushing_rad: Array
    back_rad: Array
    overlap_mm: Array
    driving_tips_mm: float
    driven_tips_mm: float

    @property
    def transmission_error_rad(self) -> float:
        """Peak to peak variation of the driven angle at which pushing flanks touch."""
        return float(np.ptp(self.pushing_rad))

    @property
    def backlash_rad(self) -> Array:
        """Play of the driven gear at each position, shape (n,); negative where the teeth have no room."""
        return self.back_rad - self.pushing_rad


def as_written(outlines: Outlines, teeth: ToothedPair, placement: Placement, reach_mm: float) -> AsWritten:
    """Contact of outlines over a whole cycle of meetings, compared as far as ``reach_mm`` from the pitch point.

    Raises RuntimeError, a fault of ncgear, where outlines that are written do not reach each other.
    """
    play = outline_play(outlines.driving_mm, outlines.driven_mm, placement, reach_mm)
    tips = _tip_clearances(outlines, teeth, placement)
    if not all(np.isfinite(values).all() for values in (play.up_rad, play.down_rad, tips)):
        raise RuntimeError(f"the outlines written as {outlines.source} do not reach each other")
    bounds = placement.bounds_rad(play.up_rad, play.down_rad)
    return AsWritten(outlines.source, *bounds, play.overlap_mm, *tips)


def _tip_clearances(outlines: Outlines, teeth: ToothedPair, placement: Placement) -> tuple[float, float]:
    """Least clearance in mm of the driving gear's tips and of the driven gear's, tooth over space.

    Driving tooth n stands in the driven space before driven tooth n, driven tooth n in the space after driving tooth n.
    """
    driving, driven = teeth.driving.flanks, teeth.driven.flanks
    number = np.arange(placement.meetings)
    own, other = number % teeth.driving.teeth, number % teeth.driven.teeth
    over_driven = root_depths(outlines.driven_mm, driven)[(number - 1) % teeth.driven.teeth]
    over_driving = root_depths(outlines.driving_mm, driving)[own]
    return (
        float(np.min(over_driven - tip_heights(outlines.driving_mm, driving)[own])),
        float(np.min(over_driving - tip_heights(outlines.driven_mm, driven)[other])),
    )
