"""Points that stand alone: dust, a probe that slipped, a wrong digit; they are not metal of the gear.

Metal goes on from point to point: a flank that stands off does so along all of it, wear or a burr along a part.  So
each point is compared with the median of five, itself in their middle, along its flank, root or tip land; at an end of
it, with the median of the last five.  Three points that stand off together are the median themselves, and belong to the
gear; one or two do not.  The noise of the measurement follows from the steps from each point to the next: from the
median of their distances from their median, which outliers do not move (Hampel 1974;
``scipy.stats.median_abs_deviation``).
"""

from __future__ import annotations

from math import sqrt

import numpy as np

from ncgear.metrology.exact_outline import FLANK_CURVE, ExactOutline, Feet
from ncgear.numerics.arrays import Array, IndexArray, Mask

TOGETHER = 5
"""Points of a median."""

FEWEST_PLACES = 3
"""Fewest places of a curve that show that one of them stands alone."""

DIGITS = 9
"""Equal decimals in mm of points at one place: a file has fewer, and rounding of a turned point is less."""

SIGMAS = 8.0
"""Standard deviations of the noise beyond which no point of a million is by chance, even in a slightly heavier tail."""

LEAST_IN_MODULES = 0.002
"""Least distance in modules of a point that stands off: less does no harm, as in small outlines' tolerance."""

STEEP = 3.0
"""Factor of the medians' change from point to point, as at a burr's edge, by which a point must stand off there."""

MOST = 0.05
"""Share of the points above which they are no faults of a measurement: the gear, or the probe, is rough."""


def alone_mm(outline: ExactOutline, feet: Feet) -> Array:
    """Distance in mm of each point that stands alone from its neighbours, away from the material, (n,); 0 for others.

    Points at one place count as one.  No point stands alone on a rough gear, or on a curve of fewer than three places.
    """
    off, same = _standing_off(outline, feet)
    return off[same] if _are_few(off) else np.zeros(same.size)


def rough_points(outline: ExactOutline, feet: Feet) -> int:
    """Number of places that stand off from their neighbours if they are too many to be faults; else 0."""
    off, _ = _standing_off(outline, feet)
    return 0 if _are_few(off) else int(np.count_nonzero(off))


def _are_few(off: Array) -> bool:
    """Whether places that stand off are too few for roughness; one place is, however few points there are."""
    return int(np.count_nonzero(off)) <= max(1.0, MOST * off.size)


def _standing_off(outline: ExactOutline, feet: Feet) -> tuple[Array, IndexArray]:
    """Distance in mm by which each place stands off, 0 where it does not, and the number of each point's place."""
    from scipy.ndimage import maximum_filter1d
    from scipy.stats import median_abs_deviation

    one, same = _places(feet)
    feet = feet.kept(one)
    off, least, steps = np.zeros(one.size), np.zeros(one.size), [np.zeros(0)]
    curves = _curves(outline, feet)
    order = np.lexsort((feet.place_mm, curves))
    for points in np.split(order, np.flatnonzero(np.diff(curves[order])) + 1):
        if points.size >= FEWEST_PLACES:
            among = feet.distance_mm[points]
            middle = _medians(among)
            change = maximum_filter1d(np.abs(np.diff(middle, append=middle[-1])), TOGETHER + 1, mode="nearest")
            off[points] = among - middle
            least[points] = STEEP * change[_about(among.size, min(TOGETHER, among.size))]
            steps.append(np.diff(among))
    # With independent errors a step between neighbours has twice the variance.
    steps_mm = np.concatenate(steps)
    noise = float(median_abs_deviation(steps_mm, scale="normal")) / sqrt(2.0) if steps_mm.size else 0.0
    least = np.maximum(least, max(SIGMAS * noise, LEAST_IN_MODULES * outline.gear.flanks.rack.module_mm))
    return np.where(np.abs(off) > least, off, 0.0), same


def are_judged(outline: ExactOutline, feet: Feet) -> Mask:
    """Mask of points with enough others on their curve to show whether they stand alone, shape (n,)."""
    one, same = _places(feet)
    _, curve, places = np.unique(_curves(outline, feet.kept(one)), return_inverse=True, return_counts=True)
    return (places[curve] >= FEWEST_PLACES)[same]


def _medians(among: Array) -> Array:
    """Medians of the five values about each, or of the five at an end; of four, the middle one nearest to each."""
    from numpy.lib.stride_tricks import sliding_window_view

    width = min(TOGETHER, among.size)
    ordered = np.sort(sliding_window_view(among, width), axis=1)
    about = _about(among.size, width) - width // 2
    return np.clip(among, ordered[about, (width - 1) // 2], ordered[about, width // 2])


def _about(count: int, width: int) -> IndexArray:
    """The middle of the window about each point, or of the nearest whole window."""
    return np.clip(np.arange(count), width // 2, count - (width + 1) // 2)


def _places(feet: Feet) -> tuple[IndexArray, IndexArray]:
    _, one, same = np.unique(feet.point.round(DIGITS), return_index=True, return_inverse=True)
    return one, same


def _curves(outline: ExactOutline, feet: Feet) -> IndexArray:
    """Number of the curve of each point: a flank is one curve, however many rows it has; shape (n,)."""
    on_flank = outline.part[feet.row] == FLANK_CURVE
    return np.where(on_flank, outline.flank[feet.row], outline.gear.flanks.count + feet.row)
