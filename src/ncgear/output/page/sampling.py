"""Where the page's tables are taken: close together, and on both sides of every angle at which a curve may jump."""

from __future__ import annotations

from collections.abc import Iterable
from itertools import pairwise

import numpy as np

from ncgear.drive import Drive
from ncgear.numerics.arrays import Array
from ncgear.output.joints import joints_up_to

LEAST = 2001
"""Samples over a cycle of the slider, between which the page goes along straight lines."""

SIDE_RAD = 1e-9
"""How far beside a jump the samples before and after it stand: far over the rounding of an angle, and too near to be
seen or hit."""


def cycle_angles_rad(drive: Drive) -> Array:
    """Rising driving angles over one cycle of the slider, both ends included, shape (n,) with n >= 2001."""
    cycle = drive.transmission.cycle_rad
    dead_centres = drive.machine.extended_rad, drive.uniform_machine.extended_rad
    return split_angles(cycle, (*joints_up_to(drive.transmission, cycle).tolist(), *dead_centres))


def split_angles(end_rad: float, jumps_rad: Iterable[float]) -> Array:
    """Rising angles from 0 to the end, shape (n,), evenly spread between the jumps.

    There is a sample on either side of each jump, and before the end.
    """
    inner = sorted({jump for jump in jumps_rad if SIDE_RAD < jump < end_rad - SIDE_RAD})
    bounds = [0.0, *inner, end_rad]
    stretches = [_stretch(a, b, end_rad) for a, b in pairwise(bounds)]
    angles = np.concatenate([*stretches, [end_rad]])
    angles[0] = 0.0
    return angles


def _stretch(start: float, end: float, whole: float) -> Array:
    count = 2 + int(np.ceil((LEAST - 1) * (end - start) / whole))
    # Two jumps may lie closer together than both their sides.
    side = min(SIDE_RAD, (end - start) / 3.0)
    return np.linspace(start + side, end - side, count)
