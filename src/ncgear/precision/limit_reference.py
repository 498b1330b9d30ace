"""The baler's certified limit in closed form, to fifty digits.

With u = v^2 / 2, the fastest motion under a peak of acceleration A and a power P rises along u = A x, turns onto the
line of slope -A that touches the ceiling of power u = (P / F(x))^2 / 2, follows the ceiling from there, where it falls
less steeply, and comes to rest along u = A (H - x).  The return is even acceleration and even braking.  With v_p at the
turn and v_t, v_b where the ceiling begins and ends to be followed, the cycle takes

    (2 v_p - v_t + v_b) / A + (W(x_b) - W(x_t)) / P + 2 sqrt(H / A),

W being the resistance's work, a polynomial.  The A for which that is the cycle's time is the limit: no law has less,
and laws come as close to it as one likes.
"""

from __future__ import annotations

from collections.abc import Callable, Sequence
from functools import partial
from typing import Any

DIGITS = 50

STEEP_MM, LEAST_MM = 400.0, 0.01
"""Where the baler's ceiling falls more steeply than any acceleration looked for, and how far from the end it still
falls less steeply."""

FOUND = 1e-40
"""Of roots, relative to their brackets: ten digits fewer than those worked with."""


def least_acceleration_mm_s2(
    coefficients: Sequence[float], stroke_mm: float, power_w: float, cycle_s: float, between: tuple[float, float]
) -> float:
    """Least peak acceleration against a resistance of polynomial ``coefficients`` (N over mm), ratios not limited.

    It is looked for in the range ``between``.  Raises ArithmeticError where the motion is not of the kind described.
    """
    from mpmath import mp, mpf

    with mp.workdps(DIGITS):
        exact, power, stroke = [mpf(c) for c in coefficients], 1000 * mpf(power_w), mpf(stroke_mm)
        return float(_root(lambda most: _cycle_s(exact, power, stroke, most) - mpf(cycle_s), *between))


def _cycle_s(coefficients: Sequence[Any], power: Any, stroke: Any, most: Any) -> Any:
    """Time of the fastest motion under an acceleration; lengths in mm, power in N mm/s."""
    from mpmath import polyval, sqrt

    rising = [n * c for n, c in enumerate(coefficients)][1:]
    worked = [0, *(c / (n + 1) for n, c in enumerate(coefficients))]
    force, slope, work = (partial(polyval, own[::-1]) for own in (coefficients, rising, worked))
    last = stroke - LEAST_MM
    touching = _root(lambda x: power**2 * slope(x) / force(x) ** 3 - most, STEEP_MM, last)
    braking = _root(lambda x: most * (stroke - x) - (power / force(x)) ** 2 / 2, touching, last)
    begins, ends = power / force(touching), power / force(braking)
    fastest = sqrt(begins**2 / 2 + most * touching)
    return (2 * fastest - begins + ends) / most + (work(braking) - work(touching)) / power + 2 * sqrt(stroke / most)


def _root(function: Callable[[Any], Any], low: Any, high: Any) -> Any:
    """The root in a bracket; raises ArithmeticError where there is none."""
    from mpmath import findroot

    if function(low) * function(high) > 0:
        raise ArithmeticError("the fastest motion is not of the kind whose closed form is known")
    return findroot(function, (low, high), solver="anderson", tol=FOUND**2 * abs(high), verify=False)
