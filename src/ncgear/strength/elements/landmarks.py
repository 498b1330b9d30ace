"""Begin and end of the sides of teeth along a gear's exact outline, as lengths at which meshes place their nodes.

The outline is one closed way: root land, back side upwards, tip land, front side downwards, the next root land.  On a
driving gear and round a ring's hole it runs clockwise, on other gears against the clock; nothing here depends on that.
"""

from __future__ import annotations

import numpy as np

from ncgear.frozen import dataclass
from ncgear.numerics.arrays import Array, ComplexArray, IndexArray
from ncgear.numerics.plane import angle_between, as_complex
from ncgear.teeth.flank import FLANK
from ncgear.teeth.gear import ToothedGear
from ncgear.teeth.outline import whole_curves
from ncgear.teeth.stretch import CurveStretch, joined

FINE = 33
"""Points on each curve for computing its length; lengths only space the nodes, which lie on the exact curves."""

TURNS = 64
"""Places on each half of a space where the direction of the outline is computed, to find the corners of teeth."""

CORNER = 0.45
"""Place of a tooth's corner, as a part of the outline's turning from the middle of the root land to the flank's foot:
below the largest stress, where the outline still rises so little that three elements share the corner well."""

ROOT_LAND = 3
"""The number of root lands among the curves of ``whole_curves``."""


@dataclass(frozen=True, eq=False)
class OutlineWay:
    """The outline's curves one after the other as one closed way.

    ``length_mm`` (rising from 0) are the lengths of the way at k places, and ``index`` (shape (k,)) the numbers of the
    curves there, from 0, plus the share of the curve behind the point.
    """

    curves: CurveStretch
    length_mm: Array
    index: Array

    @property
    def total_mm(self) -> float:
        """The length of the outline."""
        return float(self.length_mm[-1])

    def at(self, place_mm: Array) -> tuple[ComplexArray, ComplexArray]:
        """Exact points at places along the way, any shape, and unit vectors along it."""
        index = np.interp(np.remainder(place_mm, self.total_mm), self.length_mm, self.index)
        row = np.minimum(index.astype(int), self.curves.owner.size - 1)
        point, slope = _points(self.curves, row.ravel(), (index - row).ravel())
        return point.reshape(place_mm.shape), (slope / np.abs(slope)).reshape(place_mm.shape)


@dataclass(frozen=True, eq=False)
class MarkedOutline:
    """A gear's outline, and the places of its z teeth along it in mm, shape (z, 2) each.

    The columns are the back and the front side.  ``valley_mm`` are the middles of the root lands before and behind the
    tooth, ``corner_mm`` the corners where meshes of teeth begin, ``foot_mm`` where the flank passes into its fillet,
    and ``tip_mm`` where it ends at the tip land.  ``axis`` (shape (z,)) is the direction from the root to the tip.
    """

    way: OutlineWay
    valley_mm: Array
    corner_mm: Array
    foot_mm: Array
    tip_mm: Array
    axis: ComplexArray

    def at(self, place_mm: Array) -> ComplexArray:
        """Exact points at places along the outline, any shape."""
        return self.way.at(place_mm)[0]


def outline_of(gear: ToothedGear) -> MarkedOutline:
    """The outline of a gear, with its landmarks."""
    parts = [curve.kept(np.abs(curve.end - curve.start) > 0.0) for curve in whole_curves(gear.tips, gear.sides)]
    curves = joined(parts)
    curves = curves.kept(np.argsort(curves.rank, kind="stable"))
    owner = np.concatenate([part.owner for part in parts])[curves.owner]
    rows = np.arange(owner.size)
    fine = _points(curves, np.repeat(rows, FINE), np.tile(np.linspace(0.0, 1.0, FINE), rows.size))[0]
    steps = np.abs(np.diff(fine.reshape(-1, FINE), axis=1))
    lengths = np.concatenate([[0.0], np.cumsum(steps)])
    index = np.concatenate([[0.0], (rows[:, None] + np.linspace(0.0, 1.0, FINE)[1:]).ravel()])
    start, end = lengths[: -1 : FINE - 1], lengths[FINE - 1 :: FINE - 1]
    way = OutlineWay(curves, lengths, index)

    def extreme(kind: int, values: Array, side: int, largest: bool) -> Array:
        """The largest or least value of the rows of a kind, at the back (0) or front (1) flank of each tooth."""
        found = np.full(gear.teeth, -np.inf if largest else np.inf)
        chosen = (curves.kind == kind) & (owner % 2 == side)
        (np.maximum if largest else np.minimum).at(found, owner[chosen] // 2, values[chosen])
        return found

    tip = np.column_stack([extreme(FLANK, end, 0, True), extreme(FLANK, start, 1, False)])
    foot = np.column_stack([extreme(FLANK, start, 0, False), extreme(FLANK, end, 1, True)])
    behind = (extreme(ROOT_LAND, start, 1, False) + extreme(ROOT_LAND, end, 1, True)) / 2.0
    before = np.concatenate([behind[-1:] - way.total_mm, behind[:-1]])
    valley = np.column_stack([before, behind])

    axis = way.at(tip)[0].mean(axis=1) - way.at(valley)[0].mean(axis=1)
    axis = axis / np.abs(axis)
    # The direction upwards along each side against the tooth's axis.  From the land on it turns towards the axis; where
    # the tool undercuts the flank, it turns beyond the axis and back.
    share = (np.arange(TURNS) + 0.5) / TURNS
    places = valley[:, :, None] + (foot - valley)[:, :, None] * share
    upwards = way.at(places)[1] * np.array([1.0, -1.0])[:, None]
    turned = angle_between(axis[:, None, None], upwards)
    turned *= np.sign(turned[:, :, :1])
    passed = np.maximum.accumulate(turned[:, :, 0, None] - turned, axis=2)
    number = np.sum(passed < CORNER * passed[:, :, -1:], axis=2)
    corner = np.take_along_axis(places, number[:, :, None], axis=2)[:, :, 0]
    return MarkedOutline(way, valley, corner, foot, tip, axis)


def _points(curves: CurveStretch, row: IndexArray, share: Array) -> tuple[ComplexArray, ComplexArray]:
    """Points and derivatives at shares of rows in any order, shape (n,)."""
    order = np.argsort(curves.owner[row], kind="stable")
    point, slope = (as_complex(array) for array in curves.at(row[order], share[order]))
    back = np.empty_like(order)
    back[order] = np.arange(order.size)
    return point[back], slope[back]
