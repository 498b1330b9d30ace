"""Outlines of so many points on each of its curves, evenly spaced in their parameters, as is usual elsewhere."""

from __future__ import annotations

import numpy as np

from ncgear.numerics.arrays import Array, IndexArray
from ncgear.pitch.pair import PitchPair
from ncgear.teeth.flank import FILLET, FLANK
from ncgear.teeth.form import ToothForm
from ncgear.teeth.gear import pair_tips
from ncgear.teeth.outline import simple_polygon
from ncgear.teeth.sides import Sides, refuse_folded_lands, regular_sides
from ncgear.teeth.tips import Tips


def even_outlines(pitch: PitchPair, form: ToothForm, count: int) -> tuple[Array, Array]:
    """Both outlines by ``count`` chords on every flank, fillet and land; shape (6 z count, 2), counter-clockwise.

    With the checks that ncgear's own have.  Raises ArithmeticError for teeth that are undercut, whose curves end
    elsewhere.
    """
    _, (driving, driven) = pair_tips(pitch, form, 0.0)
    share = np.linspace(0.0, 1.0, count + 1)
    return _outline(driving, share)[::-1], _outline(driven, share)


def _outline(tips: Tips, share: Array) -> Array:
    """In the sense of growing arc length, clockwise on the driving gear."""
    sides, irregular = regular_sides(tips)
    if irregular.any():
        raise ArithmeticError("only outlines of regular teeth are sampled evenly")
    refuse_folded_lands(tips.flanks, sides)
    outline = _tooth_by_tooth(tips, sides, share)
    simple_polygon(outline, f"gears.{tips.flanks.curve.gear.value}")
    return outline


def _tooth_by_tooth(tips: Tips, sides: Sides, share: Array) -> Array:
    """Up the back, over the tip, down the front, along the root; shape (6 z (n - 1), 2)."""
    flank, fillet = (_runs(tips, sides, kind, share) for kind in (FLANK, FILLET))
    back, front = slice(0, None, 2), slice(1, None, 2)
    curves = [
        fillet[back, ::-1],
        flank[back, ::-1],
        _tip_lands(tips, sides, share),
        flank[front],
        fillet[front],
        _root_lands(sides, share),
    ]
    return np.concatenate([curve[:, :-1] for curve in curves], axis=1).reshape(-1, 2)


def _runs(tips: Tips, sides: Sides, kind: int, share: Array) -> Array:
    """Points of one kind of curve from the tip inwards, shape (2 z, n, 2)."""
    chosen = sides.kind == kind
    start, end = sides.start[chosen, None], sides.end[chosen, None]
    owner: IndexArray = sides.owner[chosen]
    return tips.flanks.curve_of(sides.kind[chosen], owner, start + (end - start) * share)[0]


def _tip_lands(tips: Tips, sides: Sides, share: Array) -> Array:
    start, end = sides.tip_mm[0::2, None], sides.tip_mm[1::2, None]
    return tips.flanks.offset(start + (end - start) * share, tips.flanks.tip_height_mm[0::2, None])[0]


def _root_lands(sides: Sides, share: Array) -> Array:
    start, end = (ends[:, None] for ends in sides.roots.lands())
    return sides.roots.land(np.arange(start.size)[:, None], start + (end - start) * share)[0]
