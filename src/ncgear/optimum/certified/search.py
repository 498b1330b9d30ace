"""Where a condition that only ever turns from false to true, as a quantity grows, does so."""

from __future__ import annotations

from collections.abc import Callable
from math import sqrt

FINE = 1e-7
"""Relative width of the interval in which the turn is left."""

DOUBLINGS = 60


def turning_point(holds: Callable[[float], bool], guess: float) -> tuple[float, float] | None:
    """A value at which the condition fails and a higher one, 1e-7 apart, at which it holds.

    The first is 0 where the condition never fails down to 2^-60 of the guess, which must be positive.  None where it
    does not hold up to 2^60 times the guess.
    """
    low, high = guess, guess
    if holds(guess):
        low = _first(lambda value: not holds(value), guess, 0.5)
        if not low:
            return 0.0, guess * 2.0**-DOUBLINGS
        high = 2.0 * low
    else:
        high = _first(holds, guess, 2.0)
        if not high:
            return None
        low = high / 2.0
    while high > low * (1.0 + FINE):
        middle = sqrt(low * high)
        low, high = (low, middle) if holds(middle) else (middle, high)
    return low, high


def _first(wanted: Callable[[float], bool], guess: float, factor: float) -> float:
    """The first of guess * factor, guess * factor^2, ... that is wanted; 0 if none of sixty is."""
    value = guess
    for _ in range(DOUBLINGS):
        value *= factor
        if wanted(value):
            return value
    return 0.0
