"""A law by a spline of its ratio: ln i12 is a periodic cubic spline over the driven angle.

    ln i12 = c0 + f(n2 phi2),   f twice continuously differentiable and cubic between the given driven angles

c0 closes the cycle (``ratio/laws/over_driven_angle.py``).  The curvature of a pitch curve depends on ln i12 and its
first two derivatives by the driven angle, so it is continuous.  This is the form in which optimised laws are stored.
"""

from __future__ import annotations

from math import exp, log, pi

import numpy as np

from ncgear.errors import NoSuchMechanism, WrongInput
from ncgear.numerics.arrays import Array
from ncgear.numerics.extrema import Extremum
from ncgear.numerics.periodic_cubic import PeriodicCubic, periodic_cubic
from ncgear.numerics.units import in_words
from ncgear.ratio.laws.over_driven_angle import WIDEST, LogRatioLaw, StagedLaw
from ncgear.ratio.transmission import Lobes, Transmission

SWING = 1.0
"""Most that ln i12 changes between two joints.  Between two distant knots the ratio may change a thousandfold; most of
the driven angle then takes a small share of the driving angle."""


def spline_ratio_law(driven_angle_rad: Array, ratio: Array, lobes: Lobes) -> Transmission:
    """The law through ratios i12 at driven angles, shape (n,) both; times a common factor that closes the cycle.

    The angles rise from 0 to under 2 pi; they stand for t = n2 phi2, so a turn of them is one period.  At least four
    are needed, and more than 2000 magnify rounding.  Raises WrongInput for ratios that are not positive and finite,
    NoSuchMechanism where the ratio's range is beyond 1e6; key ``motion.ratio``.
    """
    return closed_spline(driven_angle_rad, ratio, lobes).transmission


def spline_ratio_staged(driven_angle_rad: Array, ratio: Array, second_ratio: Array) -> StagedLaw:
    """The law of two pairs in series, one lobe each: i12 of the whole and iB of the second pair, shape (n,) all.

    Raises the errors of ``spline_ratio_law``, with the key ``motion.second_stage.ratio`` for the second pair.
    """
    return StagedLaw(
        closed_spline(driven_angle_rad, ratio, Lobes()),
        closed_spline(driven_angle_rad, second_ratio, Lobes(), "motion.second_stage"),
    )


def closed_spline(driven_angle_rad: Array, ratio: Array, lobes: Lobes, key: str = "motion") -> LogRatioLaw:
    """The law of ``spline_ratio_law`` with its spline at hand and without a search for its extrema.

    Raises the same errors, with ``key`` in place of ``motion``.
    """
    wrong = np.nonzero(~((ratio > 0.0) & (ratio < np.inf)))[0]
    if wrong.size:
        raise WrongInput(f"{ratio[wrong[0]]:g} given; a positive number is needed", key=f"{key}.ratio.{wrong[0]}")
    logarithm = np.log(ratio)
    # About their middle, so that the exponential can neither overflow nor vanish
    middle = (np.max(logarithm) + np.min(logarithm)) / 2.0
    spline = periodic_cubic(driven_angle_rad, logarithm - middle)
    low, high = spline.extremes
    if not high.value - low.value <= WIDEST:
        raise _beyond_sense(spline, low, high, float(middle), f"{key}.ratio")
    return LogRatioLaw(spline, spline.exponential_integral(), spline.places(SWING)[1:], lobes)


def _beyond_sense(spline: PeriodicCubic, low: Extremum, high: Extremum, middle: float, key: str) -> NoSuchMechanism:
    """The refusal of too wide a range of the ratio, at the point nearest to the extreme farther from most points."""
    usual = float(np.median(spline.coefficients[0]))
    farther = max((low, high), key=lambda end: abs(end.value - usual))
    number = int(np.argmin(np.abs(spline.knots - farther.at))) % (spline.knots.size - 1)
    between_points = float(np.ptp(spline.coefficients[0]))
    advice = "bring the ratios nearer to each other"
    if between_points <= WIDEST:
        advice = (
            f"the points themselves span only 1:{exp(between_points):.4g}, so more points are needed where the ratio "
            "changes fast, or points that are farther apart"
        )
    # As powers of ten: a spline may swing farther than a number can hold
    ends = " to ".join(f"1e{(end.value + middle) / log(10.0):.4g} at {in_words(end.at)}" for end in (low, high))
    return NoSuchMechanism(
        f"the smooth curve through the ratios goes from {ends}, a range of "
        f"1:1e{(high.value - low.value) / log(10.0):.4g}; over 1:1e6 the driven gear stands still: {advice}",
        key=f"{key}.{number}",
    )


def even_steps(count: int) -> Array:
    """Driven angles in rad that divide a turn evenly, shape (count,)."""
    return np.arange(float(count)) * (2.0 * pi / count)
