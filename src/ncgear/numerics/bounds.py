"""Bounds as people read and type them: rounded to the side on which the value itself is allowed."""

from __future__ import annotations

from decimal import ROUND_CEILING, ROUND_FLOOR, Decimal
from math import floor, isfinite, log10

DIGITS = 5
"""Significant digits of a bound."""


PLAIN = 1e12
"""Bounds below this are written without a power of ten."""


def shown_above(value: float, digits: int = DIGITS) -> str:
    """The value rounded up to ``digits`` significant digits: as text it is never below the value."""
    return _shown(value, digits, ROUND_CEILING)


def shown_below(value: float, digits: int = DIGITS) -> str:
    """The value rounded down to ``digits`` significant digits: as text it is never above the value."""
    return _shown(value, digits, ROUND_FLOOR)


def rounded_up(value: float, step: float) -> float:
    """The least multiple of a step that is not below the value, both as they are written."""
    return _rounded(value, Decimal(str(step)), ROUND_CEILING)


def _shown(value: float, digits: int, way: str) -> str:
    if value == 0.0 or not isfinite(value):
        return f"{value + 0.0:g}"
    last = Decimal(1).scaleb(floor(log10(abs(value))) - digits + 1)
    bound = _rounded(value, last, way)
    return f"{bound:.0f}" if 10.0**digits <= abs(bound) < PLAIN else f"{bound:.{digits + 1}g}"


def _rounded(value: float, step: Decimal, way: str) -> float:
    # Decimals are exact, so a multiple of the step stays itself.
    return float((Decimal(str(float(value))) / step).to_integral_value(way) * step)
