"""Section 2.2.1, eqs. 2 to 5: the slider's motion by two terms, and small figures of the text."""

from __future__ import annotations

import numpy as np

from ncgear.numerics.jet import Jet
from ncgear.papers.entry import Computed, Entry, Printed, Relation, Verdict, equations, of
from ncgear.papers.readings import two_term_stroke
from ncgear.papers.sieve_and_pan.published import CRANK_MM, PAN_LINKAGE, SIEVE_LINKAGE, SPEED_RPM

ANGLES_RAD = np.linspace(0.0, 2.0 * np.pi, 73)


def place_residual() -> Computed:
    """Eq. 2 against both linkages, by the stroke; from the crank axis, angles from the extended dead centre."""
    worst = []
    for linkage in (PAN_LINKAGE, SIEVE_LINKAGE):
        exact = linkage.nearest_mm + linkage.displacement(Jet.variable(np.pi + ANGLES_RAD, 0)).value
        tilt = np.arcsin(linkage.crank_mm / linkage.rod_mm * np.sin(ANGLES_RAD))
        formula = linkage.crank_mm * np.cos(ANGLES_RAD) + linkage.rod_mm * np.cos(tilt)
        worst.append(float(np.abs(formula - exact).max() / linkage.stroke_mm))
    return of(*worst)


def acceleration_residual() -> Computed:
    """Eq. 3 against the second derivative of the two-term stroke, towards the crank axis."""
    worst = []
    for linkage in (PAN_LINKAGE, SIEVE_LINKAGE):
        formula = np.cos(ANGLES_RAD) + linkage.crank_mm / linkage.rod_mm * np.cos(2.0 * ANGLES_RAD)
        exact = two_term_stroke(linkage, ANGLES_RAD, 2).derivative(2) / CRANK_MM
        worst.append(float(np.abs(formula - exact).max()))
    return of(*worst)


ENTRIES = (
    Entry(
        equations("2"), "slider's place against crank angle", Relation(), Verdict.UNDER_READING, place_residual,
        "With the sine of the rod's angle as crank by rod times that of the crank's; it is printed upside down.",
    ),
    Entry(
        equations("3", "4", "5"), "acceleration by two terms, of which the inertia forces are made", Relation(),
        Verdict.UNDER_READING, acceleration_residual,
        "With the square of the crank's speed, and counted positive towards the crank axis.",
    ),
    Entry(
        ("section 2.2",), "crank by connecting rod", Printed(("0.01", "0.01")), Verdict.REPRODUCED,
        lambda: of(*(CRANK_MM / linkage.rod_mm for linkage in (PAN_LINKAGE, SIEVE_LINKAGE))),
    ),
    Entry(
        ("section 3.1",), "speed of 350 r/min in the simulation", Printed(("2100",), "r/s"), Verdict.UNDER_READING,
        lambda: of(SPEED_RPM * 6.0), "In degrees per second.",
    ),
    Entry(
        ("section 3.1",), "time of one turn", Printed(("0.17",), "s"), Verdict.REPRODUCED,
        lambda: of(60.0 / SPEED_RPM),
    ),
)  # fmt: skip
