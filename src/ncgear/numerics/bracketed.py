"""Zeros of one function in many brackets at once.

T. R. Chandrupatla, "A new hybrid quadratic/bisection algorithm for finding the zero of a nonlinear function without
using derivatives", Advances in Engineering Software 28 (1997), 145-149.  SciPy has the method too, with bookkeeping
that takes ten times as long as the functions of this program.
"""

from __future__ import annotations

from collections.abc import Callable

import numpy as np

from ncgear.numerics.arrays import Array, Mask

MOST_STEPS = 200
"""Bisection alone needs 100 for the 32 digits down to a zero at zero; the method falls behind it by little."""

CLOSE = 4.0 * np.finfo(float).eps
"""Width of a bracket, relative to the zero, at which the zero counts as found; for a zero at zero, its square relative
to the first bracket."""


def zeros_between(function: Callable[[Array], Array], low: Array, high: Array) -> Array:
    """A zero in each [low, high] (shape (n,)), at whose ends the function has different signs.

    The function maps points of shape (n,), one of each bracket, to values.  Raises ArithmeticError where it is not
    finite.
    """
    new, old, value, old_value = low, high, function(low), function(high)
    share = np.full(low.shape, 0.5)
    with np.errstate(all="ignore"):
        for _ in range(MOST_STEPS):
            at = new + share * (old - new)
            at_value = function(at)
            if not np.all(np.isfinite(at_value)):
                break
            same = np.sign(at_value) == np.sign(value)
            older, older_value = np.where(same, new, old), np.where(same, value, old_value)
            old, old_value = np.where(same, old, new), np.where(same, old_value, value)
            new, value = at, at_value
            best = np.where(np.abs(value) < np.abs(old_value), new, old)
            least = CLOSE * (np.abs(best) + CLOSE * np.abs(high - low)) / np.abs(old - new)
            if np.all((least > 0.5) | (value == 0.0) | (old_value == 0.0)):
                return best
            share = _next_share((new, old, older), (value, old_value, older_value), least)
    raise ArithmeticError("no zero was found between points at which a function has different signs")


def _next_share(points: tuple[Array, Array, Array], values: tuple[Array, Array, Array], least: Array) -> Array:
    """Where between the newest point and the one across the zero to look next.

    By inverse quadratic interpolation where the three points allow it, else in the middle.
    """
    (a, b, c), (fa, fb, fc) = points, values
    place, height = (a - b) / (c - b), (fa - fb) / (fc - fb)
    trusted: Mask = (height**2 < place) & ((1.0 - height) ** 2 < 1.0 - place)
    share = fa / (fb - fa) * fc / (fb - fc) + (c - a) / (b - a) * fa / (fc - fa) * fb / (fc - fb)
    return np.clip(np.where(trusted & np.isfinite(share), share, 0.5), np.minimum(least, 0.5), 1.0 - least)
