"""The formulas of textbooks for the same forces: two terms of the rod's series, and a crank that turns evenly.

a = -w^2 r (cos t + (r/l) cos 2t), t from the extended dead centre: Z. Tang, Y. Li, Y. Zhou, H. Zhang, Shock and
Vibration 2019, eq. 8; the pin's acceleration is w^2 r towards the axis.  Terms of (r/l)^3 are left out, and all that
follows from a crank that does not turn evenly.
"""

from __future__ import annotations

from dataclasses import dataclass
from enum import StrEnum
from math import pi

import numpy as np

from ncgear.numerics.units import N_PER_KG_MM_S2
from ncgear.balance.accelerations import PIN_X, PIN_Y, WRIST, Accelerations, functions_at
from ncgear.balance.mechanism import Mechanism
from ncgear.balance.shaking import shaking
from ncgear.errors import WrongInput
from ncgear.numerics import chebyshev
from ncgear.numerics.arrays import Array
from ncgear.numerics.chebyshev import PiecewiseChebyshev

BALANCED = 1e-12
"""Share of the force of all masses at the pin below which a shaking force is rounding error."""


class Speed(StrEnum):
    """The crank's speed that a formula takes: its mean, or the one it has at the moment."""

    MEAN = "mean"
    MOMENTARY = "momentary"


@dataclass(frozen=True)
class Failure:
    """A formula beside the exact shaking force: its peak in N, and its largest error by the exact peak.

    Of a force that is balanced to rounding error no formula is wrong: the error is 0.
    """

    peak_n: float
    largest_error: float


def classical_accelerations(mechanism: Mechanism, speed: Speed = Speed.MEAN) -> Accelerations:
    """What the formulas take for the accelerations of pin and slider; moments they do not give (nothing there).

    For linkages in line; raises WrongInput with an offset.
    """
    _require_in_line(mechanism)
    return Accelerations(chebyshev.fitted(lambda phi1: _formula(mechanism, speed, phi1), mechanism.breaks_rad))


def failure(mechanism: Mechanism, speed: Speed = Speed.MEAN) -> Failure:
    """By how much the formula fails for the shaking force of a mechanism in line; raises WrongInput with an offset."""
    _require_in_line(mechanism)
    # In one form, so that the difference is taken of coefficients: what two forms evaluate to differs by noise
    both = chebyshev.fitted(
        lambda phi1: np.hstack([functions_at(mechanism, phi1), _formula(mechanism, speed, phi1)]), mechanism.breaks_rad
    )
    exact, formula = both.coefficients[:, :, :7], both.coefficients[:, :, 7:]
    true, given, error = (
        shaking(mechanism, Accelerations(PiecewiseChebyshev(both.breaks, part))).peak.value
        for part in (exact, formula, formula - exact)
    )
    unit = N_PER_KG_MM_S2 * mechanism.total_kg * mechanism.linkage.crank_mm * mechanism.speed_rad_s**2
    return Failure(given, error / true if true > BALANCED * unit else 0.0)


def _require_in_line(mechanism: Mechanism) -> None:
    if mechanism.linkage.offset_mm != 0.0:
        raise WrongInput("the two-term formula is for linkages in line; leave the offset out", key="linkage.offset_mm")


def _formula(mechanism: Mechanism, speed: Speed, phi1: Array) -> Array:
    """What the formula gives for each of the functions, shape (n, 7)."""
    driven = mechanism.transmission.driven_angle(phi1, 1)
    mean = 2.0 * pi / mechanism.transmission.cycle_rad
    squared = (np.full(phi1.shape, mean) if speed is Speed.MEAN else driven.derivative(1)) ** 2
    beyond, ratio = driven.value - pi, mechanism.linkage.crank_mm / mechanism.linkage.rod_mm
    rows = np.zeros((phi1.size, 7))
    rows[:, PIN_X], rows[:, PIN_Y] = -squared * np.cos(beyond), squared * np.sin(beyond)
    rows[:, WRIST] = -squared * (np.cos(beyond) + ratio * np.cos(2.0 * beyond))
    return rows
