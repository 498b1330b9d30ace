"""What laws that are given by their ratio share: 1/i12 is integrated, and the cycle is closed by a constant factor."""

from __future__ import annotations

from collections.abc import Callable

import numpy as np

from ncgear.errors import NoSuchMechanism
from ncgear.numerics import chebyshev
from ncgear.numerics.arrays import Array
from ncgear.numerics.chebyshev import NotSmooth
from ncgear.numerics.jet import Jet
from ncgear.numerics.units import in_words
from ncgear.ratio.transmission import Lobes, Piece, Transmission

NEARLY_CLOSED = 1e-9
"""Relative closure error that is removed without being asked for: a ratio written with ten digits has one of this
size."""


def integrated_law(
    slope: Callable[[Array, int], Jet], knots: Array, lobes: Lobes, *, scale_to_close: bool, key: str
) -> Transmission:
    """The law whose dphi2/dphi1 is ``slope`` times the constant that closes the cycle.

    ``knots`` (shape (m,), inner points of [0, period]) are where derivatives may jump.  Raises NoSuchMechanism where
    the slope is not finite, or when the constant is not 1 and ``scale_to_close`` is not asked for.
    """
    period = lobes.driving_period_rad
    breaks = np.concatenate([[0.0], knots, [period]])
    try:
        integral = chebyshev.fitted(lambda phi1: slope(phi1, 0).value, breaks).integrated()
    except NotSmooth as fault:
        raise NoSuchMechanism(
            f"the ratio is zero, infinite or jumps near phi1 = {in_words(fault.at)}; it must be smooth "
            "and positive over the whole cycle",
            key=key,
        ) from fault
    factor = _closing_factor(integral.final, lobes, scale_to_close, key)

    def driven_angle(phi1: Array, order: int) -> Jet:
        values = factor * integral(phi1)
        return (slope(phi1, order - 1) * factor).integrated(values) if order else Jet(values[None, :])

    # The panels' ends are knots too, so that nobody who looks at the law misses what the integral had to resolve.
    panels = integral.breaks
    inner = np.unique(np.concatenate([panels[1:-1], knots]))
    return Transmission((Piece(float(panels[0]), float(panels[-1]), driven_angle, tuple(inner.tolist())),), lobes)


def _closing_factor(covered: float, lobes: Lobes, scale_to_close: bool, key: str) -> float:
    """What 1/i12 is multiplied by, so that the driven gear, which turns by ``covered`` rad, turns by its period."""
    target = lobes.driven_period_rad
    if not covered > 0.0:
        raise NoSuchMechanism("the ratio is negative; it must be positive over the whole cycle", key=key)
    factor = target / covered
    if not scale_to_close and abs(factor - 1.0) > NEARLY_CLOSED:
        raise NoSuchMechanism(
            f"the cycle does not close: the driven gear turns by {covered:.12g} rad while the driving gear turns by "
            f"{lobes.driving_period_rad:.6g} rad, and it must turn by {target:.12g}; multiply the ratio by "
            f"{1.0 / factor:.12g}, or set scale_to_close: true",
            key=key,
        )
    return factor
