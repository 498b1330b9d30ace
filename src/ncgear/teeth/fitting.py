"""Spaces and tips of two gears fitted to each other, since each gear's tips need the other's spaces.

A rack or a pinion cutter sets the depth of the spaces; tips are then as high as the mate's spaces allow.  Where the
gears cut each other, tips are as high as regular flanks allow without fouling the mate's tips on concave stretches;
spaces are then as deep as the mate's tips reach.
"""

from __future__ import annotations

from collections.abc import Callable, Sequence
from dataclasses import replace
from functools import cache

import numpy as np

from ncgear.errors import NoSuchMechanism
from ncgear.numerics.arrays import Array, Mask
from ncgear.pitch.curve import ClosedPitchCurve
from ncgear.teeth.flank import Flanks, mating_flanks
from ncgear.teeth.form import WAYS, TipLimits
from ncgear.teeth.fouling import Mates, TipPaths, freed, freed_of_bottoms, paths_near_concave
from ncgear.teeth.regular import CLEAR_OF_CUSPS, regular_depth
from ncgear.teeth.spaces import cut_spaces, mated_spaces
from ncgear.teeth.tips import Bounds, Limit, Tips, bounded, fitted_tips, held_below, no_tip
from ncgear.teeth.tool import PinionCircle

FAR = 2.0
"""Where no tool sets the depth, regular flanks are searched down to this many dedenda: deeper than any tip reaches."""

BLUNT = 0.03
"""Least land, in modules, of teeth that are also tools: they may lose a quarter of it to the land's slope and still
keep the least flat."""

TURNS = 8
"""Most rounds of shortening one gear's tips after the other's.  After them tips count as fouling at any height; three
rounds are usually enough."""

PairTips = tuple[Tips, Tips]
"""The driving and the driven gear's tips."""


def fitted_pair(driving: Flanks, driven: Flanks, limits: TipLimits) -> PairTips:
    """Both gears with the heights and depths that their meeting allows, from flanks at full height and depth.

    Raises NoSuchMechanism, naming gear and tooth, where no tip or no space remains.
    """
    pairs = mating_flanks(driving.count // 2, driven.count // 2)
    clearance = driving.rack.dedendum_mm - driving.rack.addendum_mm
    fit = _fitted_to_mates if isinstance(driving.tool, ClosedPitchCurve) else _fitted_to_cutter
    first, second = fit((driving, driven), (pairs, pairs[::-1]), limits, clearance)
    return (
        replace(first, met_depth_mm=_most(driving.count, pairs, second.height_mm)),
        replace(second, met_depth_mm=_most(driven.count, pairs[::-1], first.height_mm)),
    )


def _least(count: int, mates: Mates, of_mate: Array) -> Array:
    """Least value over all mates of each flank, shape (count,)."""
    least = np.full(count, np.inf)
    np.minimum.at(least, mates[0], of_mate[mates[1]])
    return least


def _most(count: int, mates: Mates, of_mate: Array) -> Array:
    """Greatest value over all mates of each flank, shape (count,)."""
    return -_least(count, mates, -of_mate)


def _fitted_to_cutter(
    gears: tuple[Flanks, Flanks], mates: tuple[Mates, Mates], limits: TipLimits, clearance: float
) -> PairTips:
    (driving, undercut1), (driven, undercut2) = (cut_spaces(gear, limits.avoid_undercut) for gear in gears)
    tips = (
        _tips_in(driving, driven, mates[0], undercut1, undercut2, limits, clearance),
        _tips_in(driven, driving, mates[1], undercut2, undercut1, limits, clearance),
    )
    return _below_ceilings(tips, limits)


def _tips_in(
    own: Flanks, mate: Flanks, mates: Mates, undercut: Mask, mate_undercut: Mask, limits: TipLimits, clearance: float
) -> Tips:
    """Tips that leave the clearance to the mate's roots and touch no deeper than the mate's flanks go."""
    contact = _least(own.count, mates, mate.flank_depth_mm)
    if isinstance(own.tool, PinionCircle):
        # A pinion cutter's involute goes up to this height over the pitch curve: its base circle is at R sin^2(alpha).
        contact = np.minimum(contact, own.tool.radius_mm * own.slant.sine**2)
    tip = _least(own.count, mates, mate.root_depth_mm) - clearance
    # Rounding errors of the full depth must not count as a shorter tip.
    tip = np.where(tip > own.tip_height_mm * (1.0 - 1e-9), np.inf, tip)
    blamed = _least(own.count, mates, np.where(mate_undercut, 0.0, 1.0)) < 1.0
    return fitted_tips(own, bounded(own, contact, tip, blamed), undercut, limits.least_land_mm)


def _below_ceilings(tips: PairTips, limits: TipLimits) -> PairTips:
    if limits.ceilings is None:
        return tips
    driving, driven = (
        held_below(tip, over.over(tip.flanks.crossing_mm), Limit.HELIX)
        for tip, over in zip(tips, limits.ceilings, strict=True)
    )
    return driving, driven


Spaces = tuple[Array, Mask]
"""Allowed depths of the spaces beside flanks, and whether flanks are undercut at full depth."""


def _fitted_to_mates(
    gears: tuple[Flanks, Flanks], mates: tuple[Mates, Mates], limits: TipLimits, clearance: float
) -> PairTips:
    """Tips as high as regular flanks allow, then spaces as deep as the mates' tips reach.

    Of the ways to shorten fouling tips, the way that leaves most contact is taken.
    """
    regular = (_regular_spaces(gears[0], limits.avoid_undercut), _regular_spaces(gears[1], limits.avoid_undercut))
    bounds = _bounds(gears[0], regular[1], mates[0]), _bounds(gears[1], regular[0], mates[1])
    undercut = regular[0][1], regular[1][1]
    plain = _regular_tips(gears, bounds, undercut, limits)
    raised = (_raised(gears[0], plain[1], mates[0]), _raised(gears[1], plain[0], mates[1]))
    same = [tips if own is gear else None for tips, own, gear in zip(plain, raised, gears, strict=True)]
    raised_tips = cache(lambda: _regular_tips(raised, bounds, undercut, limits, same))
    paths = None
    if min(gear.curve.curvature_bounds[0] for gear in gears) < 0.0:
        paths = paths_near_concave(gears, mates)
    found: list[PairTips] = []
    refusals: list[NoSuchMechanism] = []
    free_of = cache(freed)
    for way in WAYS if limits.way is None else (limits.way,):
        try:
            tips = raised_tips() if way.raised else plain
            if found and least_overlap(tips) <= max(map(least_overlap, found)):
                # Shorter tips only leave less.
                continue
            free = _freed(tips, paths, way.first, free_of)
            first, second = _below_ceilings(free, limits)
            one, other = _deepened(first, second, mates[0], clearance), _deepened(second, first, mates[1], clearance)
            if paths is not None:
                one, other = (
                    freed_of_bottoms(one, other.flanks, paths[0]),
                    freed_of_bottoms(other, one.flanks, paths[1]),
                )
            found.append((one, other))
        except NoSuchMechanism as refusal:
            refusals.append(refusal)
            continue
        if free is tips:
            break
    if not found:
        raise refusals[-1]
    return max(found, key=least_overlap)


def _regular_spaces(gear: Flanks, avoid_undercut: bool) -> Spaces:
    """Allowed depths of spaces, and whether flanks are undercut at the rack's full depth."""
    far = FAR * gear.rack.dedendum_mm
    regular = regular_depth(gear, far)
    allowed = np.where(regular < far, CLEAR_OF_CUSPS * regular, far)
    return (allowed if avoid_undercut else np.full(gear.count, far)), regular < gear.flank_depth_mm


def _bounds(own: Flanks, mate: Spaces, mates: Mates) -> Bounds:
    """The bounds from regular flanks of the mate, for tips of any height."""
    allowed, undercut = mate
    contact = _least(own.count, mates, allowed)
    blamed = _least(own.count, mates, np.where(undercut, 0.0, 1.0)) < 1.0
    return bounded(own, contact, np.full(own.count, np.inf), blamed)


def _regular_tips(
    gears: tuple[Flanks, Flanks],
    bounds: tuple[Bounds, Bounds],
    undercut: tuple[Mask, Mask],
    limits: TipLimits,
    known: Sequence[Tips | None] = (None, None),
) -> PairTips:
    """Tips that meet regular flanks only; for a gear with known tips, these."""
    first, second = (
        tips or fitted_tips(own, allowed, marked, max(limits.least_land_mm, BLUNT * own.rack.module_mm))
        for own, allowed, marked, tips in zip(gears, bounds, undercut, known, strict=True)
    )
    return first, second


def _raised(own: Flanks, mate: Tips, mates: Mates) -> Flanks:
    """The gear with tips longer by the height that the mate's tips lost to avoid undercut: less contact is lost."""
    short = np.where(mate.limit == Limit.UNDERCUT, mate.flanks.full_tip_mm - mate.flanks.tip_height_mm, 0.0)
    missing = _most(own.count, mates, short)
    if not missing.any():
        return own
    # Contact passes from tooth to tooth: a tip also makes up for contact that the next tooth's pair has lost.
    most = np.max([np.roll(missing, shift) for shift in range(-2, 3)], axis=0)
    return replace(own, tip_height_mm=own.tip_height_mm + most)


def _freed(
    tips: PairTips, paths: tuple[TipPaths, TipPaths] | None, first: int, freed: Callable[[Tips, Tips, TipPaths], Tips]
) -> PairTips:
    """Tips that do not foul each other, gear ``first`` shortened first; unchanged if none fouls, or NoSuchMechanism."""
    if paths is None:
        return tips
    both = list(tips)
    for turn in range(TURNS):
        own = (first + turn) % 2
        free = freed(both[own], both[1 - own], paths[own])
        # The turn before has freed the other gear's tips of these.
        if turn and free is both[own]:
            return tips if all(one is other for one, other in zip(both, tips, strict=True)) else (both[0], both[1])
        both[own] = free
    worst = both[(first + TURNS - 1) % 2]
    raise no_tip(worst.flanks, int(np.argmax(worst.limit == Limit.FOULING)))


def _deepened(own: Tips, mate: Tips, mates: Mates, clearance: float) -> Tips:
    """The gear with spaces for its mate's tips, with rounded bottoms that leave the clearance over the whole play."""
    rack = own.flanks.rack
    touched = _most(own.flanks.count, mates, mate.height_mm)
    deep = clearance + _most(own.flanks.count, mates, mate.flanks.lift_mm)
    radius = np.maximum(rack.root_radius_mm, deep / (1.0 - own.flanks.slant.sine))
    return replace(own, flanks=mated_spaces(own.flanks, touched, radius))


def least_overlap(tips: PairTips) -> float:
    """Least rolled length, times sin(alpha) cos(alpha), by which a pair of flanks meets before the pair ahead parts.

    On front flanks contact runs from the driving tip, h / (sin(alpha) cos(alpha)) before the crossing, to the driven
    tip's height after it; on back flanks the other way round.
    """
    mates = mating_flanks(tips[0].flanks.count // 2, tips[1].flanks.count // 2)
    front, back = (tip.height_mm[flank].reshape(2, -1) for tip, flank in zip(tips, mates, strict=True))
    return float(min(np.min(back[0] + np.roll(front[0], -1)), np.min(front[1] + np.roll(back[1], -1))))


def least_contact_ratio(tips: PairTips) -> float:
    """Least number of pairs of teeth in mesh: the overlap in pitches."""
    rack = tips[0].flanks.rack
    return least_overlap(tips) / (float(rack.slants[0].height_per_rolled) * rack.pitch_mm)
