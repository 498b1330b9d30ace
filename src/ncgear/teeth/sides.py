"""The sides of all teeth as runs of exact curves, from the tip land down to the root land.

A regular flank starts on the tip land and passes into its fillet tangentially.  Where the tool undercuts the flank, or
its fillet folds, the side is trimmed: see trimming.py.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from ncgear.errors import NoSuchMechanism
from ncgear.numerics.angles import in_words
from ncgear.numerics.arrays import Array, IndexArray, Mask
from ncgear.teeth.flank import FILLET, FLANK, Flanks
from ncgear.teeth.regular import folded_fillets, regular_depth
from ncgear.teeth.roots import Roots, roots_of
from ncgear.teeth.tips import Tips

REMEDY = "more teeth of a smaller module are needed, or a smaller range of the ratio"

PROBES = 17
"""Places on each land at which its folding is looked at; a land is a sixth of a pitch, the curvature changes slowly."""


@dataclass(frozen=True, eq=False)
class Sides:
    """Runs of curves in the order of flanks and, within a flank, from the tip inwards.

    ``owner`` (the flank), ``kind`` (FLANK or FILLET), ``start`` and ``end`` (parameters) have shape (runs,); ``tip_mm``
    (shape (2 z,)) is the arc length of the tip land's end at each flank; ``roots`` tells where the fillets end.  A
    flank's parameter is the height over the rack's pitch line in mm, a fillet's the arc length in mm.
    """

    owner: IndexArray
    kind: IndexArray
    start: Array
    end: Array
    tip_mm: Array
    roots: Roots

    def flank_range(self) -> tuple[Array, Array]:
        """Greatest and least height of the working flank at each flank, shape (2 z,) each."""
        on_flank, count = self.kind == FLANK, len(self.tip_mm)
        top, bottom = np.full(count, -np.inf), np.full(count, np.inf)
        np.maximum.at(top, self.owner[on_flank], self.start[on_flank])
        np.minimum.at(bottom, self.owner[on_flank], self.end[on_flank])
        return top, bottom


def regular_sides(tips: Tips) -> tuple[Sides, Mask]:
    """All sides as if regular, and which flanks are not."""
    flanks = tips.flanks
    every, depth = np.arange(flanks.count), flanks.flank_depth_mm
    deepest = float(np.max(depth))
    undercut = regular_depth(flanks, deepest) < depth if deepest > 0.0 else np.zeros(flanks.count, dtype=bool)
    roots = roots_of(flanks)
    sides = Sides(
        owner=np.repeat(every, 2),
        kind=np.tile([FLANK, FILLET], flanks.count),
        start=np.column_stack([tips.height_mm, flanks.rolled_mm(every, -depth)]).ravel(),
        end=np.column_stack([-depth, roots.end_mm]).ravel(),
        tip_mm=tips.at_mm,
        roots=roots,
    )
    return sides, undercut | folded_fillets(flanks)


def refuse_folded_lands(flanks: Flanks, sides: Sides) -> None:
    """Refuse a pitch curve that is too sharply curved for its tip and root lands.

    A tip land, parallel to the pitch curve, folds where the curve's hollow radius is less than its height; a root land
    where it is deeper than the radius with which gear and tool turn about each other, their curvatures added.  Raises
    NoSuchMechanism with the radius, the tooth and the angle.
    """
    _refuse_folded_tips(flanks, sides)
    start, end = sides.roots.lands()
    sigma = _probes(start, end)
    depth, limit = sides.roots.folding(np.arange(start.size)[:, None], sigma)
    tooth, place = _worst(depth / limit)
    if depth[tooth, place] < limit[tooth, place]:
        return
    raise NoSuchMechanism(
        f"the root of the space after tooth {tooth + 1} of the {flanks.curve.gear.value} gear folds at phi1 = "
        f"{_angle(flanks, sigma[tooth, place])}: gear and tool turn about each other with a radius of "
        f"{limit[tooth, place]:.4g} mm there, less than its depth of {depth[tooth, place]:.4g} mm; {REMEDY}",
        key="gears.teeth",
    )


def _refuse_folded_tips(flanks: Flanks, sides: Sides) -> None:
    back, front = np.arange(0, flanks.count, 2), np.arange(1, flanks.count, 2)
    sigma = _probes(sides.tip_mm[back], sides.tip_mm[front])
    height = np.maximum(flanks.tip_height_mm[back], flanks.tip_height_mm[front])
    folding = -height[:, None] * flanks.curve.at_length(sigma).curvature
    tooth, place = _worst(folding)
    if folding[tooth, place] < 1.0:
        return
    raise NoSuchMechanism(
        f"the {flanks.curve.gear.value} pitch curve is hollow with a radius of "
        f"{height[tooth] / folding[tooth, place]:.4g} mm at phi1 = {_angle(flanks, sigma[tooth, place])}, less "
        f"than the height of {height[tooth]:.4g} mm of tooth {tooth + 1} there; {REMEDY}",
        key="gears.teeth",
    )


def _probes(start: Array, end: Array) -> Array:
    """Arc lengths along lands, shape (z, PROBES)."""
    probes: Array = start[:, None] + (end - start)[:, None] * np.linspace(0.0, 1.0, PROBES)
    return probes


def _worst(values: Array) -> tuple[int, int]:
    """Row and column of the largest value."""
    row, column = np.unravel_index(int(np.argmax(values)), values.shape)
    return int(row), int(column)


def _angle(flanks: Flanks, sigma: float) -> str:
    return in_words(float(flanks.curve.driving_angle(np.array(sigma))))
