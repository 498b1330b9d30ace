"""The return of least acceleration."""

from __future__ import annotations

import numpy as np

from ncgear.errors import NoSuchMechanism
from ncgear.machine.linkage import CrankSlider
from ncgear.numerics import chebyshev
from ncgear.numerics.arrays import Array
from ncgear.ratio.compensation.closing import polished
from ncgear.ratio.compensation.ends import ReturnEnds
from ncgear.ratio.compensation.families import BUMP, inverse_family, ratio_family
from ncgear.ratio.compensation.law import ReturnLaw


def return_of_least_acceleration(ends: ReturnEnds, linkage: CrankSlider, *, inverse: bool) -> ReturnLaw:
    """The return whose peak slider acceleration is least within its basis.

    The skewness of the polynomial is scanned, and the best of the scan refined by a bounded minimisation.
    """
    from scipy.optimize import minimize_scalar

    family = inverse_family(ends) if inverse else ratio_family(ends)
    evaluator = _ReturnAcceleration(ends, linkage)

    def peak(skewness: float) -> float:
        try:
            return evaluator.peak(family(skewness))
        except NoSuchMechanism:
            return np.inf

    scale = 16.0 * (ends.driven_length_rad / ends.length_rad) ** (1 if inverse else -1)
    grid = scale * np.sinh(np.linspace(-3.0, 3.0, 31))
    peaks = np.array([peak(skewness) for skewness in grid])
    best = int(np.argmin(peaks))
    if not np.isfinite(peaks[best]):
        family(0.0)  # refuses by itself where the return cannot close
        raise NoSuchMechanism("no return of this basis has a finite acceleration", key="motion.return")
    bounds = grid[max(best - 1, 0)], grid[min(best + 1, grid.size - 1)]
    wall = 1e6 * peaks[best]  # a minimiser that interpolates cannot work with infinities
    refined = minimize_scalar(
        lambda skewness: min(peak(skewness), wall), bounds=bounds, method="bounded", options={"xatol": 1e-7 * scale}
    )
    law = family(float(refined.x) if refined.fun <= peaks[best] else float(grid[best]))
    return law if inverse else polished(law, BUMP)


class _ReturnAcceleration:
    """Peak of |d2x/dphi1^2| over a return, on one Chebyshev grid whose integration matrix is made once."""

    DEGREE = 128

    def __init__(self, ends: ReturnEnds, linkage: CrankSlider) -> None:
        self._start = ends.start_driven_rad
        self._linkage = linkage
        start, end = np.array([ends.start_rad]), np.array([ends.end_rad])
        self._points = chebyshev.nodes(start, end, self.DEGREE).ravel()
        self._integration = chebyshev.integration_matrix(self.DEGREE) * (ends.length_rad / 2.0)

    def peak(self, law: ReturnLaw) -> float:
        """The peak; infinite where the ratio is zero at a point of the grid."""
        with np.errstate(all="ignore"):
            slope = law.slope(self._points, 1)
            driven = slope.integrated(self._start + self._integration @ slope.value)
            peak = _interpolated_peak(self._points, np.abs(self._linkage.displacement(driven).derivative(2)))
        return peak if np.isfinite(peak) else np.inf


def _interpolated_peak(points: Array, values: Array) -> float:
    """Largest value of samples, of the parabola through the largest and its neighbours where it lies inside."""
    top = int(np.argmax(values))
    if not 0 < top < values.size - 1:
        return float(values[top])
    before, after = points[[top - 1, top + 1]] - points[top]
    fall_before, fall_after = values[[top - 1, top + 1]] - values[top]
    bend = (fall_after / after - fall_before / before) / (after - before)
    slope = fall_before / before - bend * before
    return float(values[top] - slope**2 / (4.0 * bend)) if bend < 0.0 else float(values[top])
