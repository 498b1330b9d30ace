"""Functions of one angle as piecewise polynomials that are quick to evaluate at a single angle.

Integrators ask for one angle at a time, where closed forms cost hundreds of microseconds and a table a few.  A table's
slope is the exact derivative of its value, as the balance of energy needs it.
"""

from __future__ import annotations

from bisect import bisect_right
from collections.abc import Sequence
from typing import Any

import numpy as np
from numpy.typing import ArrayLike

from ncgear.frozen import dataclass
from ncgear.numerics.arrays import Array, IndexArray


@dataclass(frozen=True, eq=False)
class PeriodicTable:
    """Functions that repeat except for a constant rise: f(x + period) = f(x) + rise.

    ``breaks`` (shape (m + 1,)) run from 0 to the period; ``coefficients`` (shape (degree + 1, m, ...), highest power
    first) belong to powers of the distance from the break below.  ``rise`` broadcasts with the trailing axes.
    """

    breaks: Array
    coefficients: Array
    rise: Array | float = 0.0

    def at(self, x: ArrayLike, slot: IndexArray | None = None) -> tuple[Array, Array]:
        """Values and slopes at x of any shape, the trailing axes appended.

        With ``slot`` (shape of x) each x takes one row of the first trailing axis, and the other axes are appended.
        """
        turns, index, step = self.place(x)
        chosen: Any = index if slot is None else (index, slot)
        expanded = np.shape(x) + (1,) * (self.coefficients.ndim - 2 - (slot is not None))
        beyond = np.reshape(step, expanded)
        value = self.coefficients[0][chosen]
        slope = np.zeros_like(value)
        for row in self.coefficients[1:]:
            slope = slope * beyond + value
            value = value * beyond + row[chosen]
        return value + np.reshape(turns, expanded) * self.rise, slope

    def values(self, x: ArrayLike, last: int) -> Array:
        """Values at x of any shape of the functions ``last`` on the last axis, the other trailing axes appended."""
        turns, index, step = self.place(x)
        expanded = np.shape(x) + (1,) * (self.coefficients.ndim - 3)
        beyond = np.reshape(step, expanded)
        value = self.coefficients[0, ..., last][index]
        for row in self.coefficients[1:, ..., last]:
            value = value * beyond + row[index]
        rise = self.rise if np.ndim(self.rise) == 0 else np.asarray(self.rise)[..., last]
        return np.asarray(value + np.reshape(turns, expanded) * rise)

    def place(self, x: ArrayLike) -> tuple[Array, IndexArray, Array]:
        """Whole periods before x, the number of the interval, and the distance from the break below."""
        turns, local = np.divmod(x, self.breaks[-1])
        index = np.minimum(self.breaks.searchsorted(local, side="right"), self.breaks.size - 1) - 1
        return turns, index, local - self.breaks[index]


class PlaceByPlace:
    """A table at one place after the other, in plain numbers: a tenth of the time of arrays of one place.

    ``rows`` are those of the interval that was used last, of one for each interval.
    """

    def __init__(self, breaks: Array, rows: Sequence[Any]) -> None:
        self._breaks, self._rows, self.rows = breaks.tolist(), rows, rows[0]
        self._period, self._low, self._high = self._breaks[-1], 0.0, 0.0

    @classmethod
    def of(cls, table: PeriodicTable) -> PlaceByPlace:
        """Its rows are the coefficients of each function, highest power first, nested as the table's trailing axes."""
        return cls(table.breaks, np.moveaxis(table.coefficients, 0, -1).tolist())

    def at(self, x: float) -> tuple[float, float]:
        """Whole periods before x, and the distance from the break below, to which ``rows`` belong."""
        turns, local = divmod(x, self._period)
        if not self._low <= local < self._high:
            index = min(bisect_right(self._breaks, local), len(self._breaks) - 1) - 1
            self._low, self._high = self._breaks[index : index + 2]
            self.rows = self._rows[index]
        return turns, local - self._low


def cubics(width: Array, start: Sequence[Array], end: Sequence[Array]) -> Array:
    """Cubics on intervals with given values and slopes at both ends (Hermite), shape (m, ...) each; width (m,).

    Returns coefficients of shape (4, m, ...), highest power first.
    """
    (value, slope), width = start, _expanded(width, start[0])
    rise, turn = end[0] - value - slope * width, end[1] - slope
    return np.stack([(turn * width - 2.0 * rise) / width**3, (3.0 * rise - turn * width) / width**2, slope, value])


def quintics(width: Array, start: Sequence[Array], end: Sequence[Array]) -> Array:
    """Quintics on intervals with given values, slopes and second derivatives at both ends; shapes as in ``cubics``."""
    (value, slope, bend), width = start, _expanded(width, start[0])
    rise = end[0] - value - slope * width - bend * width**2 / 2.0
    turn, change = (end[1] - slope - bend * width) * width, (end[2] - bend) * width**2 / 2.0
    cubic, quartic = 10.0 * rise - 4.0 * turn + change, -15.0 * rise + 7.0 * turn - 2.0 * change
    quintic = 6.0 * rise - 3.0 * turn + change
    return np.stack([quintic / width**5, quartic / width**4, cubic / width**3, bend / 2.0, slope, value])


def _expanded(width: Array, like: Array) -> Array:
    return width.reshape(width.shape + (1,) * (like.ndim - 1))
