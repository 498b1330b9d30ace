"""The equivalent-gear method: each flank from the circular gear of the local radius of curvature.

Where a flank crosses the pitch curve the curve is replaced by its circle of curvature, and the flank is the involute of
that circular gear.  Exact where the curvature is constant; else the flank strays with the curvature's change over the
distance rolled.  J. Wang, C. Wang and L. Miao call it the conversion tooth profile method and used it for their baler.
"""

from __future__ import annotations

import numpy as np

from ncgear.numerics.arrays import Array
from ncgear.pitch.curve import CurvePoints


def on_circles(touched: CurvePoints, rolled_mm: Array) -> CurvePoints:
    """Points at arc lengths ``rolled_mm`` along the circles of curvature that touch a curve at ``touched``.

    The touched points' shape broadcasts against that of ``rolled_mm``.
    """
    tangent, normal = touched.tangent, touched.normal
    curvature = np.broadcast_to(touched.curvature, rolled_mm.shape)
    turned = (rolled_mm * curvature)[..., None]
    # Along and across without dividing by the curvature, which may vanish: sin(x) / x and (1 - cos x) / x.
    along = rolled_mm[..., None] * np.sinc(turned / np.pi)
    across = rolled_mm[..., None] * np.sin(turned / 2.0) * np.sinc(turned / (2.0 * np.pi))
    return CurvePoints(
        touched.position + along * tangent - across * normal,
        np.cos(turned) * tangent - np.sin(turned) * normal,
        np.sin(turned) * tangent + np.cos(turned) * normal,
        curvature,
    )
