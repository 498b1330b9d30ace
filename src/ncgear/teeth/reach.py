"""Farthest reach of a gear's teeth from its axis, and nearest reach of their spaces.

A land follows the pitch curve, so that it slopes: its middle is neither its farthest nor its nearest place.  A curve
p(t) of the outline is farthest and nearest at its ends and at zeros of p . p', which are searched on every curve.
"""

from __future__ import annotations

import numpy as np

from ncgear.numerics.arrays import Array, IndexArray
from ncgear.numerics.zeros import zeros_between
from ncgear.teeth.gear import ToothedGear
from ncgear.teeth.outline import exact_curves
from ncgear.teeth.stretch import CurveStretch

FLANK_CURVE, FILLET_CURVE, TIP_LAND, ROOT_LAND = range(4)
"""The numbers of kinds of curves among ``exact_curves``; later kinds are beyond the teeth of an open gear."""

PROBES = np.linspace(0.0, 1.0, 9)
"""Shares of each curve between which its radius has at most one extreme: it turns by far less than half a turn."""


def tip_radii_mm(gear: ToothedGear) -> Array:
    """Greatest radius of each tooth from the axis, in a ring the least, shape (z,)."""
    return _of_teeth(gear, (FLANK_CURVE, TIP_LAND), outwards=not gear.flanks.curve.is_ring)


def root_radii_mm(gear: ToothedGear) -> Array:
    """Least radius of the space after each tooth, in a ring the greatest, shape (z,)."""
    return _of_teeth(gear, (FILLET_CURVE, ROOT_LAND), outwards=gear.flanks.curve.is_ring)


def farthest_mm(gear: ToothedGear) -> float:
    """Greatest distance of the outline from the axis."""
    return max(float(_extremes(curve)[1].max()) for curve in exact_curves(gear.tips, gear.sides) if curve.owner.size)


def _of_teeth(gear: ToothedGear, kinds: tuple[int, int], *, outwards: bool) -> Array:
    """The farthest places from the axis, or the nearest, of curves of some kinds, by the teeth that they belong to."""
    curves, flanks = exact_curves(gear.tips, gear.sides), gear.flanks
    found = np.full(flanks.count // 2, -np.inf if outwards else np.inf)
    for kind in kinds:
        owner = curves[kind].owner
        # A fillet before a back flank is in the space after the tooth before.
        tooth = (owner - (kind == FILLET_CURVE)) // 2 % found.size
        (np.maximum if outwards else np.minimum).at(found, tooth, _extremes(curves[kind])[int(outwards)])
    return found[: gear.teeth]


def _extremes(curve: CurveStretch) -> tuple[Array, Array]:
    """The least and the greatest distance from the axis of each row, shape (n,) each."""
    rows = np.arange(curve.owner.size)
    point, slope = curve.at(rows[:, None], PROBES)
    rise, radius = np.sum(point * slope, axis=-1), np.linalg.norm(point, axis=-1)
    row, step = np.nonzero(np.sign(rise[:, :-1]) * np.sign(rise[:, 1:]) < 0.0)

    def rising(share: Array) -> Array:
        return np.asarray(np.sum(np.multiply(*_at(curve, row, share)), axis=-1))

    low, high = radius.min(axis=1), radius.max(axis=1)
    if row.size:
        known = rise[row, step], rise[row, step + 1]
        turned = _at(curve, row, zeros_between(rising, PROBES[step], PROBES[step + 1], known))[0]
        there = np.linalg.norm(turned, axis=-1)
        np.minimum.at(low, row, there)
        np.maximum.at(high, row, there)
    return low, high


def _at(curve: CurveStretch, row: IndexArray, share: Array) -> tuple[Array, Array]:
    point, slope = curve.at(row[:, None], share[:, None])
    return point[:, 0], slope[:, 0]
