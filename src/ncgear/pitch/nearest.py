"""The nearest point of a rolling curve, and how far away it is."""

from __future__ import annotations

from typing import Protocol

import numpy as np

from ncgear.numerics.arrays import Array
from ncgear.pitch.curve import CurvePoints

STEPS = 40
"""Newton's method converges quadratically from within a radius of curvature; a damped start costs some steps."""

LEAST_SHARE = 0.2
"""Least share of the way to the centre of curvature that a step is divided by, so that none leaps over the centre."""


class RollingCurve(Protocol):
    """A curve by its arc length in mm, in a frame of its own; normals point away from its material."""

    def at_length(self, sigma_mm: Array) -> CurvePoints:
        """Positions, tangents, normals and curvatures at arc lengths of any shape."""


def nearest(curve: RollingCurve, point_mm: Array, start_mm: Array, tolerance_mm: float) -> tuple[Array, Array]:
    """Arc lengths of the nearest points and signed distances, positive along the normal; shape (n,) each.

    ``point_mm`` has shape (n, 2), ``start_mm`` (n,).  NaN for points that have none near their start.
    """
    sigma = start_mm
    for _ in range(STEPS):
        at = curve.at_length(sigma)
        arm = point_mm - at.position
        along, outwards = np.sum(arm * at.tangent, axis=1), np.sum(arm * at.normal, axis=1)
        if np.all(np.abs(along) <= tolerance_mm):
            break
        sigma = sigma + along / np.maximum(1.0 + outwards * at.curvature, LEAST_SHARE)
    found = np.abs(along) <= tolerance_mm
    return np.where(found, sigma, np.nan), np.where(found, outwards, np.nan)
