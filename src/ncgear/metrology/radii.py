"""Distances of the lands from the gear's axis."""

from __future__ import annotations

import numpy as np

from ncgear.numerics.arrays import Array
from ncgear.teeth.gear import ToothedGear


def tip_radii_mm(gear: ToothedGear) -> Array:
    """Distance of each tooth's tip from the axis in mm, at the middle of its land, shape (z,)."""
    flanks, at = gear.flanks, gear.sides.tip_mm.reshape(-1, 2)
    points = flanks.offset(at.mean(axis=1), flanks.tip_height_mm.reshape(-1, 2).mean(axis=1))[0]
    radii: Array = np.linalg.norm(points, axis=1)
    return radii


def root_radii_mm(gear: ToothedGear) -> Array:
    """Distance from the axis of the bottom of the space after each tooth, at the middle of its land, shape (z,)."""
    start, end = gear.sides.roots.lands()
    points = gear.sides.roots.land(np.arange(gear.teeth), (start + end) / 2.0)[0]
    radii: Array = np.linalg.norm(points, axis=1)
    return radii
