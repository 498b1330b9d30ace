"""Bounds as people read and type them: rounded to the side on which the told value itself is allowed."""

from __future__ import annotations

from collections.abc import Callable
from math import ceil, floor, isfinite, log10

DIGITS = 5
"""Significant digits of a bound."""


def shown_above(value: float, digits: int = DIGITS) -> str:
    """The value rounded up to so many digits: as text it is never below the value."""
    return _rounded(value, ceil, 1, digits)


def shown_below(value: float, digits: int = DIGITS) -> str:
    """The value rounded down to so many digits: as text it is never above the value."""
    return _rounded(value, floor, -1, digits)


def _rounded(value: float, to: Callable[[float], int], way: int, digits: int) -> str:
    if value == 0.0 or not isfinite(value):
        return f"{value + 0.0:g}"
    scale = 10.0 ** (digits - 1 - floor(log10(abs(value))))
    whole = to(value * scale)
    # The product may have been rounded to a whole number from the other side.
    on_time = way * (float(f"{whole / scale:.{digits + 1}g}") - value) >= 0.0
    return f"{(whole if on_time else whole + way) / scale:.{digits + 1}g}"
