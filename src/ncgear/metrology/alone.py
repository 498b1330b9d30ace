"""Points that stand alone: dust, a probe that slipped, a digit that is wrong; no metal of the gear.

What is of the gear goes on from point to point: a flank that stands off does so along all of it, and wear or a burr
along some of it.  So each point is held against the median of five, itself in their middle, along its flank, root or
tip land: three points that stand off together are the median themselves, and are of the gear; one or two are not.  How
far points are from these medians by the noise of the measurement is told by all of them together, as the median of
their distances, which outliers do not move (Hampel 1974; ``scipy.stats.median_abs_deviation``).
"""

from __future__ import annotations

import numpy as np

from ncgear.metrology.exact_outline import FLANK_CURVE, ExactOutline, Feet
from ncgear.numerics.arrays import Array, IndexArray

TOGETHER = 5
"""Points of a median."""

SIGMAS = 8.0
"""Standard deviations of the noise beyond which no point of a million is by chance, nor of a tail a little heavier."""

LEAST_IN_MODULES = 0.002
"""A point that stands off by less does no harm: that much is the tolerance of small outlines."""

STEEP = 3.0
"""Where the medians themselves change from point to point, as at the edge of a burr, by so many times their change."""

MOST = 0.05
"""Share of the points from which on they are no faults of a measurement: the gear, or the probe, is rough."""


def alone_mm(outline: ExactOutline, feet: Feet) -> Array:
    """How far each point stands off alone from those beside it in mm, shape (n,); 0 of the points that do not.

    Positive is away from the material.  Of a curve with fewer than three points none stands alone.
    """
    from scipy.ndimage import maximum_filter1d, median_filter
    from scipy.stats import median_abs_deviation

    off, least = np.zeros(feet.row.size), np.zeros(feet.row.size)
    order = np.lexsort((feet.place_mm, _curves(outline, feet)))
    for points in np.split(order, np.flatnonzero(np.diff(_curves(outline, feet)[order])) + 1):
        if points.size > TOGETHER // 2:
            among = feet.distance_mm[points]
            middle = median_filter(among, TOGETHER, mode="mirror")
            change = np.abs(np.diff(middle, append=middle[-1]))
            off[points] = among - middle
            least[points] = STEEP * maximum_filter1d(change, TOGETHER + 1, mode="nearest")
    noise = float(median_abs_deviation(off, scale="normal"))
    least = np.maximum(least, max(SIGMAS * noise, LEAST_IN_MODULES * outline.gear.flanks.rack.module_mm))
    alone = np.abs(off) > least
    return np.where(alone & (np.count_nonzero(alone) <= MOST * alone.size), off, 0.0)


def _curves(outline: ExactOutline, feet: Feet) -> IndexArray:
    """A number for the curve that each point is on: a flank is one, however many rows it has; shape (n,)."""
    on_flank = outline.part[feet.row] == FLANK_CURVE
    numbers: IndexArray = np.where(on_flank, outline.flank[feet.row], outline.gear.flanks.count + feet.row)
    return numbers
