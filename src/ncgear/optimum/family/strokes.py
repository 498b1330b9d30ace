"""Thousands of three-segment strokes at once, by numbers that always close: for searches, not for designs.

A stroke matters as a function of the driving angle only: speeds scale, so the law speed is redundant, and v1, v2 and
a1 are per radian.  What is left are six numbers, the shape:

    theta4 / period,  theta3 / theta4,  theta2 / theta3,  theta1 / theta2,  chi,  brake

The approach's velocity, a quartic with v' = 0 at theta1 and theta2, is given by the factors of its derivative,
v' ~ (1 - t)(rho - t)(cos chi + sin chi t), t = phi1/theta2, rho = theta1/theta2, which stays regular where theta1 comes
near theta2 and v1 near v2.  ``brake`` is -a1 (theta4 - theta3)/v2.  The stroke is linear in v2, which closes it.
Equations as in ``machine/stroke.py``.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from ncgear.machine.stroke import StrokeRequest
from ncgear.numerics.arrays import Array, Mask
from ncgear.numerics.sampled import shares

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
