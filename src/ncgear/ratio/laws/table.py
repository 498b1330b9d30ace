"""A law given by points: displacements of the slider, or ratios, interpolated by a periodic quintic spline.

The mechanism first turns displacements into crank angles, point by point, and the driven angle is interpolated: it is
smooth at the dead centres, where the displacement's own spline would have to hit a double zero.
Ratios are interpolated as 1/i12, so that the driven angle is the spline's exact integral.
"""

from __future__ import annotations

import numpy as np
from scipy.interpolate import BSpline, make_interp_spline

from ncgear.errors import WrongInput
from ncgear.mechanisms.mechanism import Mechanism
from ncgear.numerics.arrays import Array, Mask
from ncgear.numerics.jet import Jet
from ncgear.ratio.laws.integrated import integrated_law, splined_slope
from ncgear.ratio.transmission import Lobes, Piece, Transmission

DEGREE = 5
MOST_POINTS = 2000
"""Points of a cycle beyond which the curvature of the pitch curves is lost: a spline through points h apart magnifies
their rounding by 1/h^3 there, which for 16 digits and 4000 points is 1e-7 (tests/test_laws.py)."""

AT_DEAD_CENTRE = 1e-6
"""Share of the stroke within which a point counts as the dead centre: a micrometre a metre, finer than tables are."""


def displacement_table_law(phi1_rad: Array, displacement_mm: Array, linkage: Mechanism, lobes: Lobes) -> Transmission:
    """The law through displacements (shape (n,)) at driving angles within one cycle.

    The first point must be phi1 = 0 at the retracted end, one point the extended end, displacements rising before and
    falling after it.  Raises WrongInput for points that are not so, NoSuchMechanism where the slider would turn back.
    """
    key = "motion.displacement_mm"
    lobes.require_one_cycle()
    phi1, displacement = _without_closing_row(phi1_rad, displacement_mm, lobes, key)
    crank = linkage.crank_angle(*_strokes(phi1, displacement, linkage, key))
    excess = crank - phi1 * lobes.driving
    spline = _periodic_spline(phi1, excess, lobes, key)

    def driven_angle(points: Array, order: int) -> Jet:
        return _jet(spline, points, order) + Jet.variable(points, order) * float(lobes.driving)

    return Transmission((Piece(0.0, lobes.driving_period_rad, driven_angle, tuple(phi1[1:].tolist())),), lobes)


def ratio_table_law(phi1_rad: Array, ratio: Array, lobes: Lobes, *, scale_to_close: bool) -> Transmission:
    """The law through ratios i12 (shape (n,)) at driving angles within one cycle.

    Raises WrongInput for ratios that are not positive, NoSuchMechanism when the cycle does not close.
    """
    key = "motion.ratio"
    phi1, values = _without_closing_row(phi1_rad, ratio, lobes, key)
    if not np.all(values > 0.0):
        worst = int(np.argmin(values))
        raise WrongInput(
            f"the ratio is {values[worst]:g} at phi1 = {phi1[worst]:.6g} rad; it must be positive", key=key
        )
    spline = _periodic_spline(phi1, 1.0 / values, lobes, key)

    def slope(points: Array, order: int) -> Jet:
        return _jet(spline, points, order)

    whole = splined_slope(slope, phi1[phi1 > 0.0], lobes, key)
    return integrated_law([whole], lobes, scale_to_close=scale_to_close, key=key)


def _without_closing_row(phi1: Array, values: Array, lobes: Lobes, key: str) -> tuple[Array, Array]:
    """The points without a last one that only repeats the first; raises WrongInput where it differs from that."""
    period = lobes.driving_period_rad
    if phi1[-1] > period * (1.0 + 1e-12):
        raise WrongInput(f"the last point is at {phi1[-1]:.6g} rad; one cycle ends at {period:.6g} rad", key=key)
    if phi1[-1] < period * (1.0 - 1e-12):
        return phi1, values
    if phi1[0] == 0.0 and abs(values[-1] - values[0]) > AT_DEAD_CENTRE * np.max(np.abs(values)):
        raise WrongInput(f"the cycle ends with {values[-1]:g} but begins with {values[0]:g}", key=key)
    return phi1[:-1], values[:-1]


def _strokes(phi1: Array, displacement: Array, linkage: Mechanism, key: str) -> tuple[Array, Mask]:
    """Displacements snapped to the dead centres, and which of them belong to the return."""
    stroke, near = linkage.stroke_mm, AT_DEAD_CENTRE * linkage.stroke_mm
    top = int(np.argmax(displacement))
    if phi1[0] != 0.0 or abs(displacement[0]) > near:
        raise WrongInput(
            f"the first point is ({phi1[0]:g} rad, {displacement[0]:g} mm); it must be (0, 0), the retracted end",
            key=key,
        )
    if abs(displacement[top] - stroke) > near:
        raise WrongInput(
            f"the largest displacement is {displacement[top]:g} mm; one point must be the extended end, "
            f"{stroke:.9g} mm",
            key=key,
        )
    steps = np.diff(displacement)
    wrong = np.nonzero(np.where(np.arange(steps.size) < top, steps <= 0.0, steps >= 0.0))[0]
    if wrong.size:
        raise WrongInput(
            f"the slider turns back after phi1 = {phi1[wrong[0]]:.6g} rad; it may only at both ends", key=key
        )
    snapped = np.clip(displacement, 0.0, stroke)
    snapped[0], snapped[top] = 0.0, stroke
    return snapped, np.arange(snapped.size) > top


def _periodic_spline(phi1: Array, values: Array, lobes: Lobes, key: str) -> BSpline:
    if phi1.size > MOST_POINTS:
        raise WrongInput(
            f"{phi1.size} points a cycle; a smooth curve through so many magnifies their rounding until the pitch "
            f"curves have no curvature. At most {MOST_POINTS} are right: keep every {-(-phi1.size // MOST_POINTS)}th",
            key=key,
        )
    degree = DEGREE if phi1.size > DEGREE else 3
    closed = np.append(phi1, phi1[0] + lobes.driving_period_rad), np.append(values, values[0])
    return make_interp_spline(*closed, k=degree, bc_type="periodic")


def _jet(spline: BSpline, points: Array, order: int) -> Jet:
    """Values and derivatives; the spline is periodic, whatever its first knot."""
    rows, factorial = [], 1.0
    for k in range(order + 1):
        factorial *= max(k, 1)
        rows.append(np.asarray(spline(points, nu=k, extrapolate="periodic")) / factorial)
    return Jet(np.array(rows))
