"""Thousands of three-segment strokes at once, by numbers that always close: for searches, not for designs.

A stroke matters as a function of the driving angle only: speeds scale, so the law speed is redundant, and v1, v2 and
a1 are per radian.  What is left are six numbers, the shape:

    theta4 / period,  theta3 / theta4,  theta2 / theta3,  theta1 / theta2,  chi,  brake

The approach's velocity, a quartic with v' = 0 at theta1 and theta2, is given by the factors of its derivative,
v' ~ (1 - t)(rho - t)(cos chi + sin chi t), t = phi1/theta2, rho = theta1/theta2, which stays regular where theta1 comes
near theta2 and v1 near v2.  ``brake`` is -a1 (theta4 - theta3)/v2.  The stroke is linear in v2, which closes it.
Equations as in ``machine/stroke.py``.

The returns of thousands of three-segment strokes at once; equations as in ``ratio/compensation/``.

The ratio, or its inverse, is a polynomial of degree 5 in tau over the return: the Hermite cubic of the end conditions,
a multiple of tau^2 (1 - tau)^2 that closes the cycle, and a multiple of that times 2 tau - 1, the skewness.
"""

from __future__ import annotations

from dataclasses import dataclass
from math import pi

import numpy as np

from ncgear.mechanisms.mechanism import Mechanism, Mechanisms
from ncgear.numerics.arrays import Array, Mask, Number
from ncgear.numerics.jet import Jet
from ncgear.numerics.sampled import integration, shares
from ncgear.ratio.working_stroke import StrokeRequest

BOUNDS = np.array([[0.2, 0.9], [0.3, 0.995], [0.3, 1.0], [0.05, 0.98], [-1.55, 1.55], [0.02, 12.0]])
"""Of each number of a shape; wide enough that no optimum on the baler's linkage lies at them but at theta2 = theta3."""

APPROACH, PRESSING, BRAKING = 65, 17, 33
"""Points on each segment, ends included; the accelerations are of degree 3, 0 and 2."""


@dataclass(frozen=True, eq=False)
class Strokes:
    """Many strokes; per radian of the driving angle, the first axis of every array counting them.

    ``theta_rad`` (shape (n, 4)), ``pressing_mm_rad`` (v2, shape (n,)), ``approach_slope`` (v/phi1 in powers of phi1,
    shape (n, 4)), ``braking_slope`` (v/delta in powers of delta = theta4 - phi1, shape (n, 3)).
    """

    stroke_mm: float
    theta_rad: Array
    pressing_mm_rad: Array
    approach_slope: Array
    braking_slope: Array

    def request(self, number: int, speed_rad_s: float) -> StrokeRequest:
        """One of the strokes as the solver of strokes takes it, v2 left to be found, at a driving speed."""
        theta1, theta2, theta3, theta4 = self.theta_rad[number].tolist()
        slope = float(np.polynomial.polynomial.polyval(theta1, self.approach_slope[number]))
        return StrokeRequest(
            theta1_rad=theta1,
            theta2_rad=theta2,
            theta3_rad=theta3,
            theta4_rad=theta4,
            v1_mm_s=theta1 * slope * speed_rad_s,
            v2_mm_s=None,
            a1_mm_s2=-float(self.braking_slope[number, 0]) * speed_rad_s**2,
            law_speed_rad_s=speed_rad_s,
            stroke_mm=self.stroke_mm,
        )


@dataclass(frozen=True, eq=False)
class WorkingSamples:
    """Displacement in mm, velocity in mm/rad and acceleration in mm/rad^2 over the working stroke, shape (n, points).

    ``advancing`` (shape (n,)) says where the slider neither stops nor turns back on the way.
    """

    displacement: Array
    velocity: Array
    acceleration: Array
    advancing: Mask


def strokes_of(shapes: Array, stroke_mm: float, period_rad: float) -> Strokes:
    """The strokes of shapes (shape (n, 6)); those that cannot be have a negative or infinite ``pressing_mm_rad``."""
    theta4, part3, part2, part1, chi, brake = shapes.T
    theta = np.cumprod([theta4 * period_rad, part3, part2, part1], axis=0)[::-1]
    unit = _approach(part1, chi)
    delta = theta[3] - theta[2]
    covered = theta[1] * (unit / np.arange(2.0, 6.0)).sum(axis=1) + theta[2] - theta[1] + delta * (0.5 + brake / 12.0)
    pressing = stroke_mm / covered
    approach = unit * pressing[:, None] / theta[1][:, None] ** np.arange(1.0, 5.0)
    start, mean = brake * pressing / delta, pressing / delta
    braking = np.stack([start, (3.0 * mean - 2.0 * start) / delta, (start - 2.0 * mean) / delta**2], axis=1)
    return Strokes(stroke_mm, theta.T, pressing, approach, braking)


def _approach(part1: Array, chi: Array) -> Array:
    """v/v2 in powers t, ..., t^4 of phi1/theta2, shape (n, 4)."""
    cosine, sine = np.cos(chi), np.sin(chi)
    both = 1.0 + part1
    slope = [part1 * cosine, part1 * sine - both * cosine, cosine - both * sine, sine]
    velocity = np.stack(slope, axis=1) / np.arange(1.0, 5.0)
    scaled: Array = velocity / velocity.sum(axis=1, keepdims=True)
    return scaled


def working_samples(strokes: Strokes) -> WorkingSamples:
    """The working stroke on points closer to each other towards the segments' ends."""
    theta2, theta3, theta4 = strokes.theta_rad.T[1:, :, None]
    phi1, delta = theta2 * shares(APPROACH), (theta4 - theta3) * shares(BRAKING)
    advanced, speed1, change1, slope = _from_rest(strokes.approach_slope, phi1)
    left, speed3, change3, _ = _from_rest(strokes.braking_slope, delta)
    pressing = strokes.pressing_mm_rad[:, None]
    pressed = advanced[:, -1:] + pressing * (theta3 - theta2) * shares(PRESSING)
    steady = np.broadcast_to(pressing, pressed.shape)
    return WorkingSamples(
        np.hstack([advanced, pressed, strokes.stroke_mm - left]),
        np.hstack([speed1, steady, speed3]),
        np.hstack([change1, 0.0 * pressed, -change3]),
        (slope.min(axis=1) > 0.0) & (strokes.pressing_mm_rad > 0.0),
    )


def _from_rest(slope: Array, angle: Array) -> tuple[Array, Array, Array, Array]:
    """Displacement, velocity, acceleration and v/t of v = t slope(t) at angles t (shape (n, points))."""
    powers = angle[:, :, None] ** np.arange(slope.shape[1])
    order = np.arange(slope.shape[1])
    over = np.einsum("npk,nk->np", powers, slope)
    displacement = angle**2 * np.einsum("npk,nk->np", powers, slope / (order + 2.0))
    return displacement, angle * over, np.einsum("npk,nk->np", powers, slope * (order + 1.0)), over


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
    strokes: Strokes, skewness: Array, linkage: Mechanism, period_rad: float, *, inverse: bool
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


def ends_of(approach: Array, braking: Array, linkage: Mechanisms[Number]) -> Ends:
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
