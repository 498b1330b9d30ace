"""How far flanks and fillets are regular, from the zeros of their exact conditions.

A flank ends where sin^2(alpha) + h k vanishes (flank.py): below the pitch curve on convex stretches, which is undercut,
above it on concave ones.  A fillet folds where its own condition changes sign.
"""

from __future__ import annotations

from math import sin

import numpy as np

from ncgear.numerics.arrays import Array, IndexArray, Mask
from ncgear.numerics.zeros import first_zeros
from ncgear.pitch.curve import PitchCurve
from ncgear.teeth.flank import Flanks
from ncgear.teeth.tool import RackLine

CLEAR_OF_CUSPS = 0.99
"""Share of the height up to a cusp that is used: at the cusp the flank's radius of curvature is zero, a hundredth of
the height before it a tenth of what it is at the pitch curve."""

CLEAR = 1e-9
"""Share of a fillet's rolled length by which a zero may lie before its end and still be its end: rounding."""


AT_END = 1e-12
"""Share of a range within which a joint counts as its end: no numbers are left between them to tell its sides apart."""


def regular_height(flanks: Flanks, limit_mm: float) -> Array:
    """Height over the pitch line, at most ``limit_mm``, up to which each flank is regular; shape (2 z,)."""
    return _reach(flanks, limit_mm, 1.0)


def regular_depth(flanks: Flanks, limit_mm: float) -> Array:
    """The same below the pitch line: what is deeper a tool cuts away (undercut)."""
    return _reach(flanks, limit_mm, -1.0)


def folded_fillets(flanks: Flanks) -> Mask:
    """Which fillets fold between the flank and the root land; shape (2 z,)."""
    rounding = flanks.rounding
    every = np.arange(flanks.count)
    start = flanks.rolled_mm(every, -flanks.flank_depth_mm)
    if _never_folds(flanks):
        return np.zeros(flanks.count, dtype=bool)
    length = rounding.lowest_mm - start
    cuts = [_cuts(np.array([0.0, 1.0]), (joints - start[i]) / length[i]) for i, joints in _joints(flanks, every)]
    regular = first_zeros(lambda i, share: flanks.fillet_regularity(i, start[i] + length[i] * share), cuts)
    folded: Mask = regular < 1.0 - CLEAR
    return folded


def _never_folds(flanks: Flanks) -> bool:
    """Whether both terms of the fillets' condition are surely positive.

    The roundings stand below the pitch line, and the tool is the mate, whose curve rolls with a positive sum of
    curvatures, or a rack on a curve without concave stretch.
    """
    below = flanks.flank_depth_mm > flanks.root_radius_mm * sin(flanks.rack.pressure_angle_rad)
    mated = isinstance(flanks.tool, PitchCurve)
    straight = isinstance(flanks.tool, RackLine) and flanks.curve.curvature_bounds[0] >= 0.0
    return bool(below.all()) and (mated or straight)


def _reach(flanks: Flanks, limit: float, sense: float) -> Array:
    """Largest h in [0, limit] such that sin^2(alpha) + sense h k stays positive from 0 to h."""
    square = sin(flanks.rack.pressure_angle_rad) ** 2
    low, high = flanks.curve.curvature_bounds
    if square + limit * min(sense * low, sense * high) > 0.0:
        return np.full(flanks.count, limit)
    every = np.arange(flanks.count)
    per_mm = -sense * flanks.side * flanks.rack.height_per_rolled
    ends = np.array([0.0, limit])
    cuts = [_cuts(ends, (joints - flanks.crossing_mm[i]) * per_mm[i]) for i, joints in _joints(flanks, every)]
    return first_zeros(lambda i, height: flanks.regularity(i, sense * height), cuts)


def _joints(flanks: Flanks, every: IndexArray) -> list[tuple[int, Array]]:
    """Each flank's number and the arc lengths at which the curvature that rolls may jump."""
    joints = np.empty(0) if flanks.equivalent else flanks.curve.joints_around_mm
    return [(int(i), joints) for i in every]


def _cuts(ends: Array, joints: Array) -> Array:
    """Both ends and the joints between them, in order; a joint at an end, to rounding, is none."""
    apart = AT_END * (ends[1] - ends[0])
    inside = joints[(joints > ends[0] + apart) & (joints < ends[1] - apart)]
    return np.concatenate([ends[:1], np.sort(inside), ends[1:]])
