"""The regular parts of flanks and fillets: cusps at their ends, and folds.

Bounds of the curvature prove most of them regular; for the others the exact place is searched.
"""

from __future__ import annotations

import numpy as np

from ncgear.errors import NoSuchMechanism
from ncgear.numerics.arrays import Array, IndexArray, Mask
from ncgear.numerics.chebyshev import NotSmooth
from ncgear.numerics.zeros import first_zeros
from ncgear.pitch.curve import ClosedPitchCurve
from ncgear.teeth.flank import Flanks
from ncgear.teeth.tool import RackLine

CLEAR_OF_CUSPS = 0.99
"""Used share of the height up to a cusp.  At the cusp the flank's radius of curvature is zero; a hundredth of the
height before it, the radius is a tenth of the radius at the pitch curve."""

CLEAR = 1e-9
"""A zero that lies before a fillet's end by less than this share of its rolled length is at the end: rounding."""

AT_END = 1e-12
"""A joint nearer to the end of a range than this share of it counts as the end: no numbers lie between them to separate
the joint's sides."""


def regular_height(flanks: Flanks, limit_mm: float | Array, which: IndexArray | None = None) -> Array:
    """Height over the pitch line, at most ``limit_mm`` (n,), up to which all or the numbered flanks are regular.

    Raises NoSuchMechanism where the pitch curve bends many times along the height of one tooth.
    """
    return _reach(flanks, limit_mm, 1.0, which)


def regular_depth(flanks: Flanks, limit_mm: float | Array) -> Array:
    """Depth below the pitch line, at most ``limit_mm`` (also of shape (2 z,)), of regular flanks; shape (2 z,).

    A tool cuts deeper parts away (undercut).  Raises NoSuchMechanism as ``regular_height`` does.
    """
    return _reach(flanks, limit_mm, -1.0, None)


def _reach(flanks: Flanks, limit: float | Array, sense: float, which: IndexArray | None) -> Array:
    """Largest h in [0, limit] such that sin^2(alpha) + sense h k stays positive from 0 to h."""
    flank = np.arange(flanks.count) if which is None else which
    reached: Array = np.broadcast_to(limit, flank.shape).astype(float)
    rows = np.nonzero(~flanks.surely_regular(flank, sense * reached))[0]
    if not rows.size:
        return reached
    doubtful, per_mm = flank[rows], -sense * flanks.side * flanks.slant.height_per_rolled
    cuts = _cuts(reached[rows], (_joints(flanks) - flanks.crossing_mm[doubtful, None]) * per_mm[doubtful, None])
    try:
        reached[rows] = first_zeros(lambda i, height: flanks.regularity(doubtful[i], sense * height), cuts)
    except NotSmooth as fault:
        problem = (
            f"the {flanks.curve.gear.value} pitch curve bends too often along the height of one tooth for its flanks "
            "to be followed; more teeth of a smaller module are needed"
        )
        raise NoSuchMechanism(problem, key="gears.teeth") from fault
    return reached


def folded_fillets(flanks: Flanks) -> Mask:
    """Which fillets fold between the flank and the root land; shape (2 z,)."""
    if _never_folds(flanks):
        return np.zeros(flanks.count, dtype=bool)
    start = flanks.rolled_mm(np.arange(flanks.count), -flanks.flank_depth_mm)
    length, joints = flanks.rounding.lowest_mm - start, _joints(flanks)
    cuts = _cuts(np.ones(flanks.count), (joints - start[:, None]) / length[:, None])
    regular = first_zeros(lambda i, share: flanks.fillet_regularity(i, start[i] + length[i] * share), cuts)
    return regular < 1.0 - CLEAR


def _never_folds(flanks: Flanks) -> bool:
    """Whether no fillet folds: roundings below the pitch line, cut by the mate or by a rack without dents."""
    below = flanks.flank_depth_mm > flanks.root_radius_mm * flanks.slant.sine
    mated = isinstance(flanks.tool, ClosedPitchCurve)
    straight = isinstance(flanks.tool, RackLine) and not flanks.curve.is_dented
    return bool(below.all()) and (mated or straight)


def _joints(flanks: Flanks) -> Array:
    """Arc lengths of possible jumps of the rolling curve's curvature or of its slope."""
    return np.empty(0) if flanks.equivalent else flanks.curve.panels_around_mm


def _cuts(ends: Array, joints: Array) -> list[Array]:
    """Zero, each of n ends, and the row of ``joints`` (shape (n, m)) between, in order, without joints at an end."""
    apart, cuts = AT_END * ends[:, None], list(np.column_stack([np.zeros(ends.size), ends]))
    inside = (joints > apart) & (joints < ends[:, None] - apart)
    for row in np.nonzero(inside.any(axis=1))[0]:
        cuts[row] = np.concatenate([cuts[row][:1], np.sort(joints[row, inside[row]]), cuts[row][1:]])
    return cuts
