"""Digits of numbers for people, and the check that they are numbers."""

from __future__ import annotations

from collections.abc import Mapping
from math import isfinite
from typing import Any

from ncgear.errors import Unanswered

NOISE = 9
"""Decimals beyond which a figure holds rounding errors only: a nanometre of a metre is 1e-9 rad."""


def finite(value: Any, name: str) -> Any:
    """The value, the same; Unanswered, which names it, where it or a part of it is no finite number.

    This is the check at the way out: everything that is told or written as text, table or JSON goes through it.
    """
    if isinstance(value, float) and not isfinite(value):
        raise Unanswered(f"{name} is {value}, which is no figure of a machine")
    if isinstance(value, Mapping):
        for key, part in value.items():
            finite(part, f"{name}.{key}" if name else str(key))
    elif isinstance(value, list | tuple):
        for place, part in enumerate(value):
            finite(part, f"{name}.{place}" if name else str(place))
    return value


def rounded(value: float, decimals: int) -> float:
    """The value to so many decimals; a zero has no sign.  Unanswered for no finite number."""
    return round(float(finite(value, "a figure")), decimals) + 0.0


def to_digits(value: float, digits: int) -> str:
    """A figure to so many significant digits, or to whole numbers; rounding errors about zero are 0.

    Raises Unanswered for no finite number.
    """
    settled = rounded(value, NOISE)
    return f"{settled:.0f}" if abs(settled) >= 10.0**digits else f"{settled:.{digits}g}"
