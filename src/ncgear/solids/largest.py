"""The largest of a size that fits, told to whoever asked for more."""

from __future__ import annotations

from collections.abc import Callable
from math import floor

RESOLUTION_MM = 1e-4
"""How near the largest is found: a hundredth of what is told of it."""


def largest_fitting(fits: Callable[[float], bool], low_mm: float, high_mm: float) -> float:
    """The largest size that fits between two in mm, by bisection; 0 where none does.

    What is smaller than a fitting size fits; ``low_mm`` itself is not tried.
    """
    fitting = 0.0
    while high_mm - low_mm > RESOLUTION_MM:
        middle = (low_mm + high_mm) / 2.0
        if fits(middle):
            low_mm = fitting = middle
        else:
            high_mm = middle
    return fitting


def floored(size_mm: float) -> float:
    """Rounded down to 0.01 mm, so that the stated size itself fits; smaller ones as they are."""
    return floor(size_mm * 100.0) / 100.0 or size_mm


def said_largest(largest_mm: float, otherwise: str) -> str:
    """The end of a refusal: the largest that fits, or what else would be right where none does."""
    return f"the largest that fits is {floored(largest_mm):g} mm" if largest_mm > 0.0 else otherwise
