"""The form of helical teeth whose tips change evenly from section to section.

Sections are fitted at advances over the helix, up to one pitch, after which they repeat.  All sections shorten fouling
tips in the same way.  All flanks stay exact: lower tips cost contact only.

The possible height of a tip depends on the place of its tooth on the curve.  Along the curve that height may jump:
where the mate's undercut begins or ends with the curvature, or where another way to shorten fouling tips becomes the
best.  Tips of helical teeth would then jump from section to section.  A ceiling limits the tips to the lower side of
each jump, and rises evenly away from it.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import replace
from math import ceil

import numpy as np

from ncgear.errors import NoSuchMechanism
from ncgear.numerics.arrays import Array, Mask
from ncgear.pitch.pair import PitchPair
from ncgear.pitch.shape import Gear
from ncgear.solids.helical.helix import Helix
from ncgear.solids.helical.sections import said_of_section
from ncgear.teeth.fitting import least_overlap
from ncgear.teeth.form import WAYS, Ceiling, Ceilings, TipShortening, ToothForm
from ncgear.teeth.gear import pair_tips
from ncgear.teeth.tips import Limit, Tips

FEWEST, PER_PITCH = 4, 48
"""Least number of steps between fitted sections, and number of steps in one pitch of advance."""

Fits = list[tuple[Tips, Tips]]
"""Tips of both gears in sections one step apart."""


def with_even_tips(pitch: PitchPair, form: ToothForm, helix: Helix) -> ToothForm:
    """The form with one way and ceilings for all sections; raises NoSuchMechanism with the height that has no teeth."""
    heights, step = heights_fitted(helix, form.rack.pitch_mm)
    way, fits = _best_fits(pitch, form, helix, heights)
    return replace(form, limits=replace(form.limits, way=way, ceilings=ceilings_over(fits, step)))


def heights_fitted(helix: Helix, pitch_mm: float) -> tuple[Array, float]:
    """Heights of fitted sections, up to the end or to one pitch of advance, and the rolled step in mm."""
    share = min(1.0, pitch_mm / helix.largest_advance_mm)
    advance = share * helix.largest_advance_mm
    steps = max(FEWEST, ceil(PER_PITCH * advance / pitch_mm))
    heights = np.linspace(0.0, helix.rise_mm * share, steps + 1)
    return heights[: steps + (share == 1.0)], advance / steps


def _best_fits(pitch: PitchPair, form: ToothForm, helix: Helix, heights: Array) -> tuple[TipShortening, Fits]:
    """The way that leaves most contact in the worst section, and its fitted sections; the first way if no tip fouls."""
    found: list[tuple[TipShortening, Fits]] = []
    refusals: list[NoSuchMechanism] = []
    # Tips foul near concave stretches only; without such stretches all ways give the same tips.
    for way in WAYS[:1] if all(pitch.convex(gear) for gear in Gear) else WAYS:
        try:
            found.append((way, _fits(pitch, form, helix, heights, way)))
            if not any(np.any(tips.limit == Limit.FOULING) for fit in found[-1][1] for tips in fit):
                break
        except NoSuchMechanism as refusal:
            refusals.append(refusal)
    if not found:
        raise refusals[0]
    return max(found, key=lambda tips: min(map(least_overlap, tips[1])))


def _fits(pitch: PitchPair, form: ToothForm, helix: Helix, heights: Array, way: TipShortening) -> Fits:
    """Tips in all sections, fitted in one way; raises NoSuchMechanism with the height at which no tooth can stand."""
    fits, one_way = [], replace(form, limits=replace(form.limits, way=way))
    for height in heights:
        with said_of_section(float(height)):
            fits.append(pair_tips(pitch, one_way, helix.advance_mm(float(height)))[1])
    return fits


RISE = 0.5
"""How steeply ceilings rise along the pitch curve: steeper ones cost less contact, but take more sections."""

STANDS_OUT = 1e-3
"""A step of the height counts as a jump when it differs by this much, in modules, from the steps beside it.  Heights
that only bend do not count; smaller jumps are lost in the chord tolerance."""

HIGH = 10.0
"""Height, in modules, that means: no ceiling."""


def ceilings_over(fits: Sequence[tuple[Tips, Tips]], step_mm: float) -> Ceilings:
    """The ceilings that keep tips from jumping, from both gears' fitted tips at advances ``step_mm`` apart."""
    driving, driven = (_ceiling([fit[gear] for fit in fits], step_mm) for gear in (0, 1))
    return driving, driven


def _ceiling(fits: list[Tips], step: float) -> Ceiling:
    flanks = fits[0].flanks
    at = np.stack([fit.flanks.crossing_mm for fit in fits]) % flanks.curve.length_mm
    height = np.stack([fit.flanks.tip_height_mm for fit in fits])
    # Rows: back flanks, then front flanks, each in the order of arc lengths
    at, height = (values.reshape(-1, 2).T for values in (at, height))
    order = np.argsort(at, axis=1)
    at, height = (np.take_along_axis(values, order, axis=1) for values in (at, height))
    ceilings = []
    for along, high in zip(at, height, strict=True):
        gap = np.diff(along, append=along[0] + flanks.curve.length_mm)
        low = _low_sides(high, gap, gap < 1.5 * step, flanks.rack.module_mm)
        ceilings.append(_rising(along, np.minimum(low, np.roll(low, 1)), flanks.curve.length_mm))
    return Ceiling(flanks.curve.length_mm, at, np.stack(ceilings))


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
    """The greatest heights that are nowhere above ``low`` and nowhere rise more steeply than ``RISE``."""
    around = np.concatenate([at - length, at, at + length])
    heights = np.tile(low, 3)
    ahead = np.minimum.accumulate(heights - RISE * around) + RISE * around
    behind = np.minimum.accumulate((heights + RISE * around)[::-1])[::-1] - RISE * around
    return np.minimum(ahead, behind)[at.size : 2 * at.size]
