"""The returns of thousands of three-segment strokes at once; equations as in ``ratio/compensation/``.

The ratio, or its inverse, is a polynomial of degree 5 in tau over the return: the Hermite cubic of the end conditions,
a multiple of tau^2 (1 - tau)^2 that closes the cycle, and a multiple of that times 2 tau - 1, the skewness.
"""

from __future__ import annotations

from dataclasses import dataclass
from math import pi

import numpy as np

from ncgear.machine.linkage import CrankSlider, Linkages
from ncgear.numerics.arrays import Array, Mask, Number
from ncgear.numerics.jet import Jet
from ncgear.numerics.sampled import integration, shares
from ncgear.optimum.family.strokes import Strokes

POINTS = 97
SKEWNESS_UNIT = 16.0
"""Of the mean of the ratio: the height of tau^2 (1 - tau)^2 is 1/16."""

CLOSING_STEPS = 8
"""Newton's method on the harmonic mean of the ratio, which is concave in the multiple: five digits after four steps."""

CLOSED = 1e-6
"""Miss of the cycle, relative to the return's mean, that a search may leave; the law itself is closed to rounding."""


@dataclass(frozen=True, eq=False)
class Ends:
    """dphi2/dphi1 and its derivative by phi1 at the extended and the retracted dead centre, each of shape (n,)."""

    extended: Array
    extended_slope: Array
    retracted: Array
    retracted_slope: Array


@dataclass(frozen=True, eq=False)
class ReturnSamples:
    """Accelerations in mm/rad^2 over the return, shape (n, POINTS), and which returns close with a positive ratio."""

    acceleration: Array
    closed: Mask


def return_samples(
    strokes: Strokes, skewness: Array, linkage: CrankSlider, period_rad: float, *, inverse: bool
) -> ReturnSamples:
    """The returns of strokes with their free number, ``skewness`` (shape (n,)), in means of the polynomial."""
    length = period_rad - strokes.theta_rad[:, 3]
    driven = 2.0 * pi - linkage.working_angle_rad
    mean = driven / length if inverse else length / driven
    with np.errstate(all="ignore"):
        ends = ends_of(strokes.approach_slope.T, strokes.braking_slope.T, linkage)
        rows = hermite(ends, length, inverse=inverse).T
        base, base_slope = rows @ _POWERS.T, (rows[:, 1:] * np.arange(1.0, 4.0)) @ _POWERS[:, :3].T
        skew = (SKEWNESS_UNIT * mean * skewness)[:, None]
        base, base_slope = base + skew * _SKEW, base_slope + skew * _SKEW_SLOPE
        closing = _linear_lift(base, mean) if inverse else harmonic_lift(base, _BUMP, mean, _WEIGHTS, CLOSING_STEPS)
        lift = closing[:, None]
        value, slope = base + lift * _BUMP, (base_slope + lift * _BUMP_SLOPE) / length[:, None]
        turning = Jet(np.stack([value.ravel(), slope.ravel()]))
        turning = turning if inverse else 1.0 / turning
        rate = turning.value.reshape(value.shape)
        turned = linkage.working_angle_rad + rate @ _INTEGRATION.T * length[:, None]
        acceleration = linkage.displacement(turning.integrated(turned.ravel())).derivative(2).reshape(value.shape)
        miss = np.abs(turned[:, -1] - 2.0 * pi)
    return ReturnSamples(acceleration, (value.min(axis=1) > 0.0) & (miss <= CLOSED * driven))


def ends_of(approach: Array, braking: Array, linkage: Linkages[Number]) -> Ends:
    """From x(phi1) and x(phi2) to third order at their common double zeros.

    ``approach`` and ``braking`` are v/phi1 in powers of phi1 and v/delta in powers of delta, shape (m, n).
    x = b phi1^2 + c phi1^3 = k phi2^2 + m phi2^3 gives phi2 = w phi1 + w'/2 phi1^2 with w^2 = b/k and
    w' = (c - m w^3)/(k w).
    """
    far, near = (
        linkage.displacement(Jet.variable(np.broadcast_to(centre, approach.shape[1:]), 3)).coefficients[2:]
        for centre in (linkage.working_angle_rad, 0.0)
    )
    return Ends(*_rate(-braking[0] / 2.0, braking[1] / 3.0, *far), *_rate(approach[0] / 2.0, approach[1] / 3.0, *near))


def _rate(second: Array, third: Array, linkage_second: Array, linkage_third: Array) -> tuple[Array, Array]:
    rate = np.sqrt(second / linkage_second)
    return rate, (third - linkage_third * rate**3) / (linkage_second * rate)


def hermite(ends: Ends, length: Array, *, inverse: bool) -> Array:
    """The cubic in powers of tau, shape (4, n)."""
    start, end, rise0, rise1 = ends.extended, ends.retracted, ends.extended_slope, ends.retracted_slope
    if not inverse:
        start, end, rise0, rise1 = 1.0 / start, 1.0 / end, -rise0 / start**2, -rise1 / end**2
    rise0, rise1, total = rise0 * length, rise1 * length, end - start
    return np.stack([start, rise0, 3.0 * total - 2.0 * rise0 - rise1, rise0 + rise1 - 2.0 * total])


def _linear_lift(base: Array, mean: Array) -> Array:
    lift: Array = (mean - base @ _WEIGHTS) / float(_WEIGHTS @ _BUMP)
    return lift


def harmonic_lift(base: Array, direction: Array, mean: Array, weights: Array, steps: int) -> Array:
    """The multiple (shape (n,)) at which the harmonic mean of base + multiple * direction is ``mean``.

    ``base`` has shape (n, points), ``direction`` that or (points,), and is positive but for its double zeros at both
    ends; the mean of values at the points is the sum of ``weights`` (shape (points,)) times them.

    From just above where the polynomial touches zero: of a concave function, Newton's steps never pass the zero.
    """
    inner = slice(2, -2)
    least = np.max(-base[:, inner] / direction[..., inner], axis=1)
    lift: Array = least + 1e-3 * (np.abs(least) + SKEWNESS_UNIT * mean)
    for _ in range(steps):
        inverse = 1.0 / (base + lift[:, None] * direction)
        covered, falling = inverse @ weights, (inverse**2 * direction) @ weights
        step: Array = (mean - 1.0 / covered) * covered**2 / falling
        lift = np.maximum(lift + step, least)
    return lift


_TAU = shares(POINTS)
_POWERS = _TAU[:, None] ** np.arange(4.0)
_BUMP = _TAU**2 * (1.0 - _TAU) ** 2
_BUMP_SLOPE = 2.0 * _TAU * (1.0 - _TAU) * (1.0 - 2.0 * _TAU)
_SKEW = (2.0 * _TAU - 1.0) * _BUMP
_SKEW_SLOPE = 2.0 * _BUMP + (2.0 * _TAU - 1.0) * _BUMP_SLOPE
_INTEGRATION = integration(POINTS)
_WEIGHTS = _INTEGRATION[-1]
