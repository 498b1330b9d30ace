"""The sides of all teeth as runs of exact curves, from the tip land down to the root land.

A regular flank starts on the tip land and passes into its fillet tangentially.  Where the flank has a cusp (undercut
of a tight convex stretch, or its mirror image at the tip of a concave one), where its fillet folds, or where the
flank alone does not reach the tip, the side is trimmed: see trimming.py.
"""

from __future__ import annotations

from dataclasses import dataclass, replace
from math import tan

import numpy as np

from ncgear.errors import NoSuchMechanism
from ncgear.numerics.angles import in_words
from ncgear.numerics.arrays import Array, IndexArray, Mask
from ncgear.numerics.crossing import chord_crossings, refined_crossings
from ncgear.teeth.flank import FILLET, FLANK, Flanks

PROBES = 25
"""Heights per flank at which its regularity is looked at."""

NEARLY_FOLDED = 0.2
"""Share of a land's length left at the sharpest sample from which the curve is looked at more closely."""

AGREEMENT = 1e-11
"""Distance, in modules, at which two curves count as meeting: about 1000 rounding errors of a gear of 20 modules."""


@dataclass(frozen=True, eq=False)
class Sides:
    """Runs of curves in the order of flanks and, within a flank, from the tip inwards.

    ``owner`` (the flank), ``kind`` (CROWN, FLANK or FILLET), ``start`` and ``end`` (parameters) have shape (runs,);
    ``tip_mm`` is the arc length of the tip land's end at each flank, ``undercut`` and ``pointed`` mark flanks, all of
    shape (2 z,).  A flank's parameter is the height over the rack's pitch line in mm, the others' the arc length in mm.
    """

    owner: IndexArray
    kind: IndexArray
    start: Array
    end: Array
    tip_mm: Array
    undercut: Mask
    pointed: Mask

    def flank_range(self) -> tuple[Array, Array]:
        """Greatest and least height of the working flank at each flank, shape (2 z,) each."""
        on_flank, count = self.kind == FLANK, len(self.tip_mm)
        top, bottom = np.full(count, -np.inf), np.full(count, np.inf)
        np.maximum.at(top, self.owner[on_flank], self.start[on_flank])
        np.minimum.at(bottom, self.owner[on_flank], self.end[on_flank])
        return top, bottom


def regular_sides(flanks: Flanks) -> tuple[Sides, Mask]:
    """All sides as if regular, and which flanks are not."""
    every, depth = np.arange(flanks.count), flanks.rack.flank_depth_mm
    top, tip, reached = _tip_crossing(flanks)
    heights = np.broadcast_to(np.linspace(-depth, depth, 2 * PROBES - 1), (flanks.count, 2 * PROBES - 1))
    regularity = flanks.regularity(every[:, None], heights)
    used = heights <= np.where(reached, top, depth)[:, None]
    undercut = np.any((regularity <= 0.0) & (heights <= 0.0), axis=1)
    irregular = ~reached | ((regularity <= 0.0) & used).any(axis=1) | _disturbed(flanks, tip)
    sides = Sides(
        owner=np.repeat(every, 2),
        kind=np.tile([FLANK, FILLET], flanks.count),
        start=np.column_stack([top, flanks.rolled_mm(every, np.full(flanks.count, -depth))]).ravel(),
        end=np.column_stack([np.full(flanks.count, -depth), flanks.rounding_mm]).ravel(),
        tip_mm=tip,
        undercut=undercut,
        pointed=np.zeros(flanks.count, dtype=bool),
    )
    return sides, irregular


def with_points(flanks: Flanks, sides: Sides) -> Sides:
    """Teeth whose flanks cross below the tip land end in the crossing instead.

    Raises NoSuchMechanism where such a tooth has a trimmed side too.
    """
    sharp = sides.tip_mm[1::2] - sides.tip_mm[0::2] <= 0.0
    if not sharp.any():
        return sides
    back = 2 * np.nonzero(sharp)[0]
    first_run = np.searchsorted(sides.owner, np.arange(flanks.count))
    back_run, front_run = first_run[back], first_run[back + 1]
    plain = (sides.kind[back_run] == FLANK) & (sides.kind[front_run] == FLANK)
    heights = sides.start[back_run], sides.start[front_run]
    first, second, met = refined_crossings(
        lambda h: flanks.flank(back, h),
        lambda h: flanks.flank(back + 1, h),
        *heights,
        AGREEMENT * flanks.rack.module_mm,
    )
    if not (plain & met & (first > sides.end[back_run]) & (second > sides.end[front_run])).all():
        lost = int(back[~(plain & met)][0]) if not (plain & met).all() else int(back[0])
        raise NoSuchMechanism(
            f"{tooth_name(flanks, lost)} has no tip: its flanks meet where they are trimmed; more teeth of a smaller "
            "module are needed",
            key="gears.teeth",
        )
    start, pointed = sides.start.copy(), sides.pointed.copy()
    start[back_run], start[front_run] = first, second
    pointed[back] = pointed[back + 1] = True
    return replace(sides, start=start, pointed=pointed)


def tooth_name(flanks: Flanks, flank: int) -> str:
    """A flank in words, with the driving angle at which it crosses the pitch point."""
    facing = "front" if flanks.side[flank] > 0 else "back"
    phi1 = float(flanks.curve.driving_angle(flanks.crossing_mm[flank : flank + 1])[0])
    gear = flanks.curve.gear.value
    return f"the {facing} flank of tooth {flanks.tooth[flank]} of the {gear} gear (phi1 = {in_words(phi1)})"


def refuse_folded_lands(flanks: Flanks) -> None:
    """Refuse a pitch curve that is too sharply curved for its tip and root lands.

    Both are parallel to the pitch curve and fold where its radius of curvature is less than they are far.  Raises
    NoSuchMechanism with the radius and the angle.
    """
    for samples in (16, 512):
        sigma = np.linspace(0.0, flanks.curve.length_mm, samples * flanks.count)
        curvature = flanks.curve.at_length(sigma).curvature
        hollow, sharp = int(np.argmin(curvature)), int(np.argmax(curvature))
        addendum, dedendum = flanks.rack.addendum_mm, flanks.rack.dedendum_mm
        tip_room, root_room = 1.0 + addendum * curvature[hollow], 1.0 - dedendum * curvature[sharp]
        if min(tip_room, root_room) > NEARLY_FOLDED:
            return
    if tip_room <= 0.0:
        raise _folded(
            flanks, sigma[hollow], -1.0 / curvature[hollow], f"concave, less than the addendum of {addendum:.4g}"
        )
    if root_room <= 0.0:
        raise _folded(flanks, sigma[sharp], 1.0 / curvature[sharp], f"convex, less than the dedendum of {dedendum:.4g}")


def _folded(flanks: Flanks, sigma: float, radius: float, problem: str) -> NoSuchMechanism:
    phi1 = float(flanks.curve.driving_angle(np.array([sigma]))[0])
    return NoSuchMechanism(
        f"the {flanks.curve.gear.value} pitch curve's radius is {radius:.4g} mm at phi1 = "
        f"{in_words(phi1)}, {problem} mm; more teeth of a smaller module are needed, or a smaller range of the "
        "ratio",
        key="gears.teeth",
    )


def _tip_crossing(flanks: Flanks) -> tuple[Array, Array, Mask]:
    """Height at which each flank reaches the tip land, its arc length there, and whether it does so on the flank."""
    rack, every = flanks.rack, np.arange(flanks.count)
    height, sigma, met = refined_crossings(
        lambda h: flanks.flank(every, h),
        lambda s: flanks.offset(s, rack.addendum_mm),
        np.full(flanks.count, rack.addendum_mm),
        flanks.crossing_mm - flanks.side * rack.addendum_mm * tan(rack.pressure_angle_rad),
        AGREEMENT * rack.module_mm,
    )
    near = np.abs(sigma - flanks.crossing_mm) < rack.pitch_mm / 2.0
    return height, sigma, met & near & (height > 0.0) & (height <= rack.flank_depth_mm * (1.0 + 1e-9))


def _disturbed(flanks: Flanks, tip_mm: Array) -> Mask:
    """Whether a fillet folds, may fold unseen by any probe just after a jump of the curvature, or a crown dips."""
    every, depth = np.arange(flanks.count), np.full(flanks.count, flanks.rack.flank_depth_mm)
    rolled = _between(flanks.rolled_mm(every, -depth), flanks.rounding_mm)
    folds: Mask = np.any(flanks.envelope_regularity(FILLET, every[:, None], rolled) < 0.0, axis=1)
    joints = flanks.curve.joints_around_mm
    jumps: Mask = np.searchsorted(joints, rolled.max(axis=1)) > np.searchsorted(joints, rolled.min(axis=1))
    return folds | jumps | _dipping_crowns(flanks, tip_mm)


def _dipping_crowns(flanks: Flanks, tip_mm: Array) -> Mask:
    """Whether a crown, which on a convex curve stands clear of the tooth, reaches below the tip land."""
    every, depth = np.arange(flanks.count), np.full(flanks.count, flanks.rack.flank_depth_mm)
    crown = flanks.crown(every[:, None], _between(flanks.rolled_mm(every, depth), flanks.crown_rounding_mm))[0]
    reach = flanks.side * flanks.rack.pitch_mm / 4.0
    land = flanks.offset(_between(tip_mm + reach, tip_mm - reach), flanks.rack.addendum_mm)[0]
    dips = np.zeros(flanks.count, dtype=bool)
    dips[chord_crossings(crown, land)[0]] = True
    return dips


def _between(start: Array, end: Array) -> Array:
    """PROBES numbers from each start to its end, shape (n, PROBES)."""
    return start[:, None] + (end - start)[:, None] * np.linspace(0.0, 1.0, PROBES)
