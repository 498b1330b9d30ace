"""Ceilings over tips along the pitch curves, so that no tip jumps while teeth advance from section to section.

How high a tip can be depends on where its tooth stands.  Along the curve that height may jump: where the mate's
undercut begins or ends with the curvature, or where another way to shorten fouling tips is the best.  Tips of helical
teeth would then jump from section to section.  A ceiling is what the lower side of each jump allows, and rises evenly
away from it.
"""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np

from ncgear.numerics.arrays import Array, Mask
from ncgear.teeth.flank import Flanks
from ncgear.teeth.form import Ceiling, Ceilings
from ncgear.teeth.tips import Tips

RISE = 0.5
"""How steeply ceilings rise along the pitch curve: steeper ones cost less contact, but take more sections."""

STANDS_OUT = 1e-3
"""A step of the height counts as a jump when it differs by this much, in modules, from the steps beside it.  Heights
that only bend do not count; smaller jumps are lost in the chord tolerance."""

HIGH = 10.0
"""Height, in modules, that stands for no ceiling."""


def ceilings_over(fits: Sequence[tuple[Tips, Tips]], step_mm: float) -> Ceilings:
    """The ceilings that keep tips from jumping, from both gears' fitted tips at advances ``step_mm`` apart."""
    driving, driven = (_ceiling([fit[gear] for fit in fits], step_mm) for gear in (0, 1))
    return driving, driven


def _ceiling(fits: list[Tips], step: float) -> Ceiling:
    flanks = fits[0].flanks
    at = np.stack([fit.flanks.crossing_mm for fit in fits]) % flanks.curve.length_mm
    height = np.stack([fit.flanks.tip_height_mm for fit in fits])
    sides = [_of_side(at[:, side::2].ravel(), height[:, side::2].ravel(), flanks, step) for side in (0, 1)]
    return Ceiling(flanks.curve.length_mm, *(np.stack(column) for column in zip(*sides, strict=True)))


def _of_side(at: Array, height: Array, flanks: Flanks, step: float) -> tuple[Array, Array]:
    """Arc lengths in order and the ceilings there, from heights of all flanks of one side."""
    order = np.argsort(at)
    at, height = at[order], height[order]
    gap = np.diff(at, append=at[0] + flanks.curve.length_mm)
    low = _low_sides(height, gap, gap < 1.5 * step, flanks.rack.module_mm)
    return at, _rising(at, np.minimum(low, np.roll(low, 1)), flanks.curve.length_mm)


def _low_sides(height: Array, gap: Array, fitted: Mask, module: float) -> Array:
    """Height on the lower side of the jump from each place to the next; ``HIGH`` where there is no jump.

    Only places that are ``fitted`` next to each other are compared.  A step is a jump where it is steeper than ceilings
    rise, or differs from the steps on both sides.  Heights may go on falling up to the jump as they do beside it.
    """
    rise = np.diff(height, append=height[0])
    before = np.where(np.roll(fitted, 1), np.roll(rise, 1), np.roll(rise, -1))
    after = np.where(np.roll(fitted, -1), np.roll(rise, -1), before)
    apart = np.maximum(rise - np.maximum(before, after), np.minimum(before, after) - rise)
    jumps = fitted & ((np.abs(rise) > RISE * gap) | (apart > STANDS_OUT * module))
    falling = np.minimum(np.maximum(np.abs(before), np.abs(after)), RISE * gap)
    return np.where(jumps, np.minimum(height, np.roll(height, -1)) - falling, HIGH * module)


def _rising(at: Array, low: Array, length: float) -> Array:
    """The greatest heights that are nowhere over ``low`` and rise nowhere more steeply than ``RISE``."""
    around = np.concatenate([at - length, at, at + length])
    heights = np.tile(low, 3)
    ahead = np.minimum.accumulate(heights - RISE * around) + RISE * around
    behind = np.minimum.accumulate((heights + RISE * around)[::-1])[::-1] - RISE * around
    return np.minimum(ahead, behind)[at.size : 2 * at.size]
