"""A law written as an expression in ``phi``: the ratio i12 itself, or the driven angle phi2."""

from __future__ import annotations

from collections.abc import Callable

import numpy as np

from ncgear.errors import NoSuchMechanism
from ncgear.numerics.arrays import Array
from ncgear.numerics.formula import compiled
from ncgear.numerics.jet import Jet
from ncgear.ratio.laws.integrated import NEARLY_CLOSED, integrated_law
from ncgear.ratio.transmission import Lobes, Piece, Transmission

NO_JUMP = 1e-9
"""Relative difference of the ratio between both ends of the cycle that counts as none: ten written digits give it."""


def ratio_expression_law(text: str, lobes: Lobes, *, scale_to_close: bool) -> Transmission:
    """The law of a ratio i12(phi); raises WrongInput or NoSuchMechanism for the key ``motion.ratio``."""
    key = "motion.ratio"
    ratio = compiled(text, key)
    _refuse_jump(ratio, lobes, key)

    def slope(phi1: Array, order: int) -> Jet:
        with np.errstate(all="ignore"):
            value = ratio(phi1, order)
            inverse = 1.0 / value
        # At a pole itself the derivatives are infinity less infinity, but the driven gear stands still.
        return Jet(np.where(np.isinf(value.value), 0.0, inverse.coefficients))

    return integrated_law(slope, np.empty(0), lobes, scale_to_close=scale_to_close, key=key)


def driven_angle_expression_law(text: str, lobes: Lobes) -> Transmission:
    """The law of a driven angle phi2(phi), shifted so that phi2 = 0 at phi1 = 0; key ``motion.driven_angle``."""
    key = "motion.driven_angle"
    angle = compiled(text, key)

    def slope(phi1: Array, order: int) -> Jet:
        return angle(phi1, order + 1).differentiated()

    _refuse_jump(slope, lobes, key)
    start, end = (float(value) for value in angle(np.array([0.0, lobes.driving_period_rad]), 0).value)
    if not abs(end - start - lobes.driven_period_rad) <= NEARLY_CLOSED * lobes.driven_period_rad:
        raise NoSuchMechanism(
            f"the cycle does not close: the driven angle grows by {end - start:.12g} rad over a cycle, "
            f"and must grow by {lobes.driven_period_rad:.12g}",
            key=key,
        )
    panels = integrated_law(slope, np.empty(0), lobes, scale_to_close=True, key=key).pieces[0]
    factor = lobes.driven_period_rad / (end - start)

    def driven_angle(phi1: Array, order: int) -> Jet:
        return (angle(phi1, order) - start) * factor

    return Transmission((Piece(panels.start_rad, panels.end_rad, driven_angle, panels.knots_rad),), lobes)


def _refuse_jump(function: Callable[[Array, int], Jet], lobes: Lobes, key: str) -> None:
    """The ratio must come back to its value, or the slider's velocity would jump."""
    ends = function(np.array([0.0, lobes.driving_period_rad]), 0).value
    if not np.all(np.isfinite(ends)):
        raise NoSuchMechanism("the expression has no finite value at the cycle's ends, phi1 = 0 or its period", key=key)
    if abs(ends[1] - ends[0]) > NO_JUMP * np.max(np.abs(ends)):
        raise NoSuchMechanism(
            f"the ratio jumps where the cycle begins again: it goes from {ends[1]:.9g} at the end to {ends[0]:.9g} at "
            f"phi1 = 0; an expression of period {lobes.driving_period_rad:.6g} rad is needed",
            key=key,
        )
