"""An outline seen from its gear's own axis: which of its vertices lie in a given direction."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from ncgear.numerics.arrays import Array, ComplexArray, IndexArray

TURN = 2.0 * np.pi


@dataclass(frozen=True, eq=False)
class PolarOutline:
    """An outline around the origin, with bounds by which vertices are found by their polar angle.

    Over three turns, ``reached`` is the largest angle up to each vertex and ``left`` the smallest from it on; both grow
    all along even where the outline turns back.
    """

    outline: ComplexArray
    reached: Array
    left: Array

    def windows(self, direction: Array, half_width: Array) -> tuple[IndexArray, IndexArray]:
        """Stretches of vertices, as first number and count, that hold all in sectors, and one more at either end.

        Polar angles and half widths in rad, shape (n,).  Numbers may be negative: they count round the outline.
        """
        count = self.outline.size
        base = self.reached[count]
        middle = base + np.mod(direction - base, TURN)
        first = np.searchsorted(self.reached, middle - half_width) - 1
        after = np.searchsorted(self.left, middle + half_width) + 1
        return first - count, np.minimum(after - first, count)


def polar_outline(outline: ComplexArray) -> PolarOutline:
    """The bounds of an outline, shape (n,), that goes round the origin once, counter-clockwise."""
    angle = np.unwrap(np.angle(outline))
    turns = np.concatenate([angle - TURN, angle, angle + TURN])
    return PolarOutline(outline, np.maximum.accumulate(turns), np.minimum.accumulate(turns[::-1])[::-1])
