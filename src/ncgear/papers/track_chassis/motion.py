"""Section 2.2, eqs. 1 to 8: the slider's motion, exact and by two terms of the rod's series."""

from __future__ import annotations

import numpy as np
from scipy.special import binom

from ncgear.balance.shaking import failure
from ncgear.numerics.arrays import Array
from ncgear.numerics.jet import Jet
from ncgear.papers.entry import Computed, Entry, Printed, Relation, Verdict, equations, of
from ncgear.papers.readings import two_term_stroke
from ncgear.papers.track_chassis.published import LINKAGE, MECHANISM, SPEED_RAD_S

CRANK, ROD = LINKAGE.crank_mm, LINKAGE.rod_mm
RATIO = CRANK / ROD
ANGLES_RAD = np.linspace(0.0, 2.0 * np.pi, 73)


def stroke_residual() -> Computed:
    """Eqs. 2 and 3 against the linkage, by the stroke; both count from the extended dead centre."""
    exact = LINKAGE.stroke_mm - LINKAGE.displacement(Jet.variable(np.pi + ANGLES_RAD, 0)).value
    sine, cosine = np.sin(ANGLES_RAD), np.cos(ANGLES_RAD)
    second = (ROD + CRANK) - (CRANK * cosine + ROD * np.cos(np.arcsin(RATIO * sine)))
    third = CRANK * ((1.0 - cosine) + (1.0 - np.sqrt(1.0 - RATIO**2 * sine**2)) / RATIO)
    return of(*(float(np.abs(formula - exact).max() / LINKAGE.stroke_mm) for formula in (second, third)))


def series() -> Computed:
    """The first coefficients of (1 - x)^(1/2), signs left out."""
    return of(*(abs(float(binom(0.5, power))) for power in (1, 2, 3)))


def two_term_residual() -> Computed:
    """Eq. 6 against eq. 3 with the root of eq. 5, by the stroke."""
    sine, cosine = np.sin(ANGLES_RAD), np.cos(ANGLES_RAD)
    with_root = CRANK * (1.0 - cosine) + ROD * 0.5 * RATIO**2 * sine**2
    return of(float(np.abs(two_term_stroke(LINKAGE, ANGLES_RAD, 0).value - with_root).max() / LINKAGE.stroke_mm))


def velocity_residual() -> Computed:
    """Eq. 7 against the derivative of eq. 6."""
    formula = SPEED_RAD_S * CRANK * (np.sin(ANGLES_RAD) + RATIO / 2.0 * np.sin(2.0 * ANGLES_RAD))
    return of(_off(formula, two_term_stroke(LINKAGE, ANGLES_RAD, 1).derivative(1) * SPEED_RAD_S))


def acceleration_residual() -> Computed:
    """Eq. 8 against minus the second derivative of eq. 6."""
    formula = -(SPEED_RAD_S**2) * CRANK * (np.cos(ANGLES_RAD) + RATIO * np.cos(2.0 * ANGLES_RAD))
    return of(_off(formula, -two_term_stroke(LINKAGE, ANGLES_RAD, 2).derivative(2) * SPEED_RAD_S**2))


def _off(formula: Array, exact: Array) -> float:
    return float(np.abs(formula - exact).max() / np.abs(exact).max())


ENTRIES = (
    Entry(
        equations("1", "2", "3"), "stroke against crank angle, from the extended dead centre", Relation(),
        Verdict.REPRODUCED, stroke_residual,
    ),
    Entry(
        equations("4"), "coefficients of the root's series", Printed(("0.5", "0.125", "0.0625")), Verdict.REPRODUCED,
        series,
    ),
    Entry(
        equations("5", "6"), "stroke by two terms of the series", Relation(), Verdict.REPRODUCED, two_term_residual
    ),
    Entry(equations("7"), "velocity by two terms", Relation(), Verdict.REPRODUCED, velocity_residual),
    Entry(
        equations("8", "16"), "acceleration by two terms", Relation(), Verdict.UNDER_READING, acceleration_residual,
        "Counted positive away from the crank axis, against the sense in which the stroke is counted.",
    ),
    Entry(
        equations("8", "16"), "two terms for the exact acceleration of this linkage", Relation(),
        Verdict.NOT_REPRODUCIBLE, lambda: of(failure(MECHANISM).largest_error),
        "At a crank of 0.473 rods the terms left out are not small.",
    ),
)  # fmt: skip
