"""Farthest reach of a gear's teeth from its axis, and nearest reach of their spaces.

A land follows the pitch curve, so that it slopes: its middle is neither its farthest nor its nearest place.  A curve
p(t) of the outline is farthest and nearest at its ends and at zeros of p . p', which are searched on every curve.
"""

from __future__ import annotations

import numpy as np

from ncgear.frozen import dataclass
from ncgear.numerics.arrays import Array, IndexArray
from ncgear.numerics.zeros import zeros_between
from ncgear.teeth.gear import ToothedGear
from ncgear.teeth.outline import exact_curves
from ncgear.teeth.stretch import CurveStretch

FLANK_CURVE, FILLET_CURVE, TIP_LAND, ROOT_LAND = range(4)
"""The numbers of kinds of curves among ``exact_curves``; later kinds are beyond the teeth of an open gear."""

PROBES = np.linspace(0.0, 1.0, 9)
"""Shares of each curve between which its radius has at most one extreme: it turns by far less than half a turn."""


@dataclass(frozen=True, eq=False)
class Reach:
    """Distances from the axis: of each tooth's tip the greatest (in a ring the least), of the bottom of the space after
    each tooth the least (in a ring the greatest), shape (z,) each, and the greatest of the whole outline.
    """

    tip_mm: Array
    root_mm: Array
    farthest_mm: float


def reach_of(gear: ToothedGear) -> Reach:
    """How far the teeth of a gear reach, and its spaces."""
    curves, flanks = exact_curves(gear.tips, gear.sides), gear.flanks
    extremes = {kind: _extremes(curve) for kind, curve in enumerate(curves) if curve.owner.size}

    def of_teeth(kinds: tuple[int, int], *, outwards: bool) -> Array:
        found = np.full(flanks.count // 2, -np.inf if outwards else np.inf)
        for kind in extremes.keys() & set(kinds):
            # A fillet before a back flank is in the space after the tooth before.
            tooth = (curves[kind].owner - (kind == FILLET_CURVE)) // 2 % found.size
            (np.maximum if outwards else np.minimum).at(found, tooth, extremes[kind][int(outwards)])
        return found[: gear.teeth]

    is_ring = flanks.curve.is_ring
    tip_mm = of_teeth((FLANK_CURVE, TIP_LAND), outwards=not is_ring)
    root_mm = of_teeth((FILLET_CURVE, ROOT_LAND), outwards=is_ring)
    return Reach(tip_mm, root_mm, max(float(far.max()) for _, far in extremes.values()))


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
