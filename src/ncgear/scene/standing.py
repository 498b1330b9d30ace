"""What stands still: walls with the hatching that marks the ground, and the grain of the material."""

from __future__ import annotations

from math import pi

import numpy as np

from ncgear.numerics.arrays import Array
from ncgear.scene.chamber import Chamber

HATCHES = 44
"""Strokes along a wall."""

HATCH_LENGTH = 0.07
"""Length of a stroke of the hatching across the wall, as a share of the chamber's height."""

STRAWS = 150
HALF_STRAW = np.array([0.03, 0.065])
"""Half a straw's length where it lies along the chamber, and across it: shares of the depth and of the height."""

SPREAD = np.array([0.8191725134, 0.6710436067, 0.5497004779])
"""Powers of the inverse root of x^4 = x + 1, whose multiples, whole parts left out, fill a cube evenly without any
random number (M. Roberts, "The unreasonable effectiveness of quasirandom sequences", 2018)."""


def wall_mm(chamber: Chamber) -> Array:
    """The open line around the slider's way, shape (n, 2): two sides, and an end where there is material."""
    half = chamber.height_mm / 2.0
    low, high = chamber.linkage.offset_mm - half, chamber.linkage.offset_mm + half
    start, end = chamber.start_mm, chamber.end_mm
    return np.array([[start, low], [end, low], [end, high], [start, high]])


def hatches_mm(chamber: Chamber) -> Array:
    """Strokes outside both sides, shape (n, 2, 2): the wall is part of the frame."""
    wall, length = wall_mm(chamber), HATCH_LENGTH * chamber.height_mm
    foot = np.linspace(chamber.start_mm, chamber.end_mm, HATCHES + 1)[1:]
    (_, low), (_, high) = wall[0], wall[2]
    sides = ((low, -length), (high, length))
    return np.concatenate([_strokes(foot, at, across, length) for at, across in sides])


def _strokes(foot: Array, at: float, across: float, back: float) -> Array:
    """Slanting strokes from points of a level line."""
    level = np.full_like(foot, at)
    return np.stack([np.stack([foot, level], -1), np.stack([foot - back, level + across], -1)], axis=1)


def straws() -> Array:
    """Strokes of the material's grain, shape (n, 2, 2): shares of its depth in x, of the chamber's height in y.

    Drawn over a depth that shrinks, they close up as straw does.
    """
    along, across, lean = np.mod(np.outer(np.arange(1, STRAWS + 1), SPREAD), 1.0).T
    middle = np.stack([along, across - 0.5], axis=-1)
    half = HALF_STRAW * np.stack([np.cos(pi * lean), np.sin(pi * lean)], axis=-1)
    low, high = np.array([0.0, -0.5]), np.array([1.0, 0.5])
    strokes: Array = np.clip(np.stack([middle - half, middle + half], axis=1), low, high)
    return strokes
