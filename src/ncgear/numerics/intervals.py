"""Interval arithmetic on arrays: bounds that hold for every argument of an interval, not for samples of it.

``Intervals`` follow numpy's protocols as far as jets use them.  A jet whose coefficients are intervals therefore
encloses the value and the derivatives of an expression at every point of a cell, by the same recurrences and the same
functions that give them at points.  Bounds are rounded outwards; where nothing is known they are infinite.  Source of
the rules: R. E. Moore, R. B. Kearfott and M. J. Cloud, "Introduction to Interval Analysis", SIAM 2009, chapters 2 to 6.
"""

from __future__ import annotations

from collections.abc import Callable, Sequence
from dataclasses import dataclass
from math import pi
from typing import Any, cast

import numpy as np

from ncgear.numerics.arrays import Array
from ncgear.numerics.jet import Jet

ROUNDING = 8.0 * np.finfo(float).eps
"""Relative widening of a function's bounds: twice what numpy's vector functions claim, which is four units."""

HUGE = np.finfo(float).max

GROWING = {np.exp, np.log, np.sqrt, np.arctan, np.tanh, np.sinh}
"""Functions that grow wherever they are defined: the bounds of the argument give those of the value."""


@dataclass(frozen=True, eq=False)
class Intervals:
    """Numbers between ``low`` and ``high``, two arrays of the same shape."""

    low: Array
    high: Array

    def __len__(self) -> int:
        return len(self.low)

    @property
    def shape(self) -> tuple[int, ...]:
        """Shape of either bound."""
        return self.low.shape

    @property
    def magnitude(self) -> Array:
        """Largest size of a number in each interval."""
        size: Array = np.maximum(np.abs(self.low), np.abs(self.high))
        return size

    def copy(self) -> Intervals:
        """The same intervals in arrays of their own."""
        return Intervals(self.low.copy(), self.high.copy())

    def sum(self, axis: int) -> Intervals:
        """Sum along an axis."""
        count = self.low.shape[axis]
        slack = count * ROUNDING * self.magnitude.sum(axis=axis)
        return _outwards(self.low.sum(axis=axis) - slack, self.high.sum(axis=axis) + slack)

    def __getitem__(self, place: Any) -> Intervals:
        return Intervals(self.low[place], self.high[place])

    def __setitem__(self, place: Any, value: Any) -> None:
        given = _intervals(value)
        self.low[place], self.high[place] = given.low, given.high

    def __neg__(self) -> Intervals:
        return Intervals(-self.high, -self.low)

    def __add__(self, other: Any) -> Intervals:
        given = _intervals(other)
        return _outwards(self.low + given.low, self.high + given.high)

    def __radd__(self, other: Any) -> Intervals:
        return self + _intervals(other)

    def __sub__(self, other: Any) -> Intervals:
        return self + (-_intervals(other))

    def __rsub__(self, other: Any) -> Intervals:
        return -self + _intervals(other)

    def __mul__(self, other: Any) -> Intervals:
        given = _intervals(other)
        ends = [a * b for a in (self.low, self.high) for b in (given.low, given.high)]
        # Only 0 times an infinite bound is not a number, and the bound itself is not in the interval.
        return _outwards(*_range([np.where(np.isnan(end), 0.0, end) for end in ends]))

    def __rmul__(self, other: Any) -> Intervals:
        return self * _intervals(other)

    def __truediv__(self, other: Any) -> Intervals:
        given = _intervals(other)
        through = (given.low <= 0.0) & (given.high >= 0.0)
        inverse = _outwards(
            np.where(through, -np.inf, 1.0 / given.high),
            np.where(through, np.inf, 1.0 / given.low),
        )
        return self * inverse

    def __rtruediv__(self, other: Any) -> Intervals:
        return _intervals(other) / self

    def __pow__(self, exponent: float) -> Intervals:
        """A constant power, for which jets use this: no whole positive one."""
        one_side = (self.low > 0.0) | ((self.low == 0.0) & (exponent > 0.0))
        one_side |= (self.high < 0.0) & float(exponent).is_integer()
        low, high = _range([self.low**exponent, self.high**exponent])
        return _widened(np.where(one_side, low, -np.inf), np.where(one_side, high, np.inf))

    def __array_ufunc__(self, function: Any, method: str, *inputs: Any, **_: Any) -> Any:
        if method != "__call__":
            return NotImplemented
        if function in OPERATIONS:
            return OPERATIONS[function](*(_intervals(given) for given in inputs))
        if function in GROWING:
            return _widened(function(self.low), function(self.high))
        if function is np.cos:
            return _wave(np.cos, self, 0.0)
        return _wave(np.sin, self, pi / 2.0) if function is np.sin else NotImplemented

    def __array_function__(self, function: Any, _: Any, inputs: Any, options: Any) -> Any:
        if function in (np.empty_like, np.zeros_like):
            return Intervals(np.zeros(self.shape), np.zeros(self.shape))
        if function is np.vstack:
            rows = [_intervals(row) for row in inputs[0]]
            return Intervals(np.vstack([row.low for row in rows]), np.vstack([row.high for row in rows]))
        return NotImplemented


OPERATIONS: dict[Any, Callable[..., Intervals]] = {
    np.add: lambda a, b: a + b,
    np.subtract: lambda a, b: a - b,
    np.multiply: lambda a, b: a * b,
    np.divide: lambda a, b: a / b,
}
"""What an array to the left of intervals asks for."""


def variable(low: Array, high: Array, order: int) -> Jet:
    """The independent variable on cells (shape (n,)), as a jet of intervals."""
    rows = np.zeros((order + 1, low.size)), np.zeros((order + 1, low.size))
    rows[0][0], rows[1][0] = low, high
    if order:
        rows[0][1] = rows[1][1] = 1.0
    return Jet(cast(Array, Intervals(*rows)))


def coefficients(enclosed: Jet) -> Intervals:
    """The coefficients of a jet of intervals."""
    return cast(Intervals, enclosed.coefficients)


def _intervals(value: Any) -> Intervals:
    if isinstance(value, Intervals):
        return value
    number = np.asarray(value, dtype=float)
    return Intervals(number, number)


def _range(ends: Sequence[Array]) -> tuple[Array, Array]:
    return np.minimum.reduce(list(ends)), np.maximum.reduce(list(ends))


def _outwards(low: Array, high: Array) -> Intervals:
    """Bounds of one rounded operation; what is not a number is not known, and no bound is infinite on its far side."""
    low, high = np.where(np.isnan(low), -np.inf, low), np.where(np.isnan(high), np.inf, high)
    return Intervals(np.minimum(np.nextafter(low, -np.inf), HUGE), np.maximum(np.nextafter(high, np.inf), -HUGE))


def _widened(low: Array, high: Array) -> Intervals:
    """Bounds of a function that is computed to some units of the last digit."""
    return _outwards(low - ROUNDING * np.abs(low), high + ROUNDING * np.abs(high))


def _wave(function: Callable[[Array], Array], argument: Intervals, crest: float) -> Intervals:
    """Sine or cosine, whose crests are at ``crest`` and every turn from there, and its troughs halfway between."""
    low, high = _range([function(argument.low), function(argument.high)])
    slack = ROUNDING * argument.magnitude
    first, last = argument.low - slack, argument.high + slack

    def passes(place: float) -> Any:
        # Beyond all digits, and on infinite cells, everything is passed.
        turns = np.floor((last - place) / (2.0 * pi)) - np.ceil((first - place) / (2.0 * pi))
        return ~(turns < 0.0)

    bounds = _widened(np.where(passes(crest - pi), -1.0, low), np.where(passes(crest), 1.0, high))
    return Intervals(np.maximum(bounds.low, -1.0), np.minimum(bounds.high, 1.0))
