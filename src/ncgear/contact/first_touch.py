"""The first touch of two flanks found by search: for flanks that are not conjugate where the curvature jumps.

There their distance may have two least values, or none with tangents in common.  Points of the driving flank are
followed along their circles about the driven axis to the driven flank; the point that gets there first is closed in on.
"""

from __future__ import annotations

from math import cos, sin

import numpy as np

from ncgear.contact.facing import FacingFlanks, Touches
from ncgear.numerics.arrays import Array, ComplexArray
from ncgear.numerics.plane import along, angle_between, square

REACH_IN_PITCHES = 0.15
"""Rolled length to either side of the closed form's contact within which the first touch is looked for."""

SHARES = np.linspace(-1.0, 1.0, 33)
ROUNDS = 4
"""Points per round and rounds, each a sixteenth as wide as the one before: the height comes out to some millionths of a
module, and the driven angle, which is stationary there, to rounding errors."""

CIRCLE_STEPS = 8
"""Steps of Newton's method to a circle; four do on flanks, which cross circles about their axis steeply."""

ON_CIRCLE = 1e-11
"""Relative error of the squared radius at which a point counts as on its circle."""


def first_touches(facing: FacingFlanks, limits_mm: Array) -> Touches:
    """The first touch of each pair of flanks, between the least and the greatest height that each has.

    ``limits_mm`` has shape (2, 2, n): driving and driven flank, least and greatest height.
    """
    rack = facing.teeth.driving.flanks.rack
    angle = rack.pressure_angle_rad
    middle, reach = facing.driving_mm, REACH_IN_PITCHES * rack.pitch_mm * sin(angle) * cos(angle)
    first = np.arange(middle.size), np.zeros(middle.size, dtype=int)
    for _ in range(ROUNDS):
        height = np.clip(middle[:, None] + reach * SHARES, *limits_mm[0, ..., None])
        point, slope = facing.driving_curve(height)
        other_height, other = _on_circles(
            facing, square(point), (facing.driving_mm + facing.driven_mm)[:, None] - height
        )
        least, greatest = limits_mm[1, ..., None]
        there = np.isfinite(other_height) & (other_height >= least) & (other_height <= greatest)
        turn = np.where(there, angle_between(point, other), -facing.urge * np.inf)
        first = first[0], np.argmax(facing.urge * turn, axis=1)
        middle, reach = height[first], reach * (SHARES[1] - SHARES[0])
    found = there[first]
    turn = np.where(found, turn[first], 0.0)
    turned = np.exp(1j * turn)
    return Touches(middle, other_height[first], turn, point[first] * turned, slope[first] * turned, found)


def _on_circles(facing: FacingFlanks, squared: Array, start_mm: Array) -> tuple[Array, ComplexArray]:
    """Heights (NaN where there is none) and points at which the driven flanks have squared radii, shape (n, m) each."""
    height = start_mm
    for _ in range(CIRCLE_STEPS):
        point, slope = facing.driven_curve(height)
        rate = 2.0 * along(point, slope)
        height = height + (squared - square(point)) / np.where(rate == 0.0, np.inf, rate)
    point, _ = facing.driven_curve(height)
    return np.where(np.abs(square(point) - squared) <= ON_CIRCLE * squared, height, np.nan), point
