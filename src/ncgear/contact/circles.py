"""Where circles about the origin cross chords: the driven gear turns about its axis, so its points run along such."""

from __future__ import annotations

import numpy as np

from ncgear.numerics.arrays import Array, ComplexArray
from ncgear.numerics.plane import along, square

TINY = 1e-300
"""Keeps a division of zero by zero, on chords of no length, from being one."""


def crossing(start: ComplexArray, step: ComplexArray, squared_radius: Array) -> tuple[ComplexArray, Array]:
    """Points at which chords from ``start`` to ``start + step``, along which the radius grows, have a squared radius.

    Also the chord's unit vector's part along the radius times the radius: the arm at which the normal force on the
    chord turns the gear.  All shapes are the same.
    """
    outwards, length = along(start, step), square(step)
    missing = squared_radius - square(start)
    root = np.sqrt(np.maximum(outwards * outwards + length * missing, 0.0))
    share = missing / np.maximum(outwards + root, TINY)
    return start + share * step, root / np.sqrt(np.maximum(length, TINY))
