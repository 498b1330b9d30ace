"""Sections 2.2 and 3.1, eqs. 1 to 8 and 16 to 20: the slider's motion, and counterweights against its inertia."""

from __future__ import annotations

from dataclasses import replace
from functools import cache
from math import radians

import numpy as np
from scipy.special import binom

from ncgear.balance.frame import Chassis, DynamicCounterweights, dynamic_counterweights, static_counterweight_kg
from ncgear.balance.mechanism import CompleteBalance, DrivenCrank, complete_balance
from ncgear.balance.shaking import two_term_formula
from ncgear.mechanisms.crank_slider import CrankSlider
from ncgear.mechanisms.masses import RodMasses
from ncgear.numerics import jet
from ncgear.numerics.arrays import Array
from ncgear.numerics.jet import Jet
from ncgear.numerics.units import RAD_S_PER_RPM
from ncgear.papers.entry import Computed, Entry, Printed, Relation, Verdict, computed, equations, from_readings
from ncgear.ratio.laws.uniform import uniform_law
from ncgear.ratio.transmission import Lobes

LINKAGE = CrankSlider(265.0, 560.0)
SLIDER_KG = 65.0
SPEED_RAD_S = 96.5 * RAD_S_PER_RPM
ROD_ARM_MM, CRANK_ARM_MM = 200.0, 250.0
CHASSIS = Chassis(support_mm=370.0, counterweight_mm=1000.0, tilt_rad=radians(8.0))
WEIGHT_KG, WEIGHT_LEVER_MM = 500.0, 470.0
GRAVITY_M_S2 = 9.81

MECHANISM = DrivenCrank(LINKAGE, uniform_law(Lobes()), SPEED_RAD_S, RodMasses(slider_kg=SLIDER_KG))
"""Rod and crank have no mass: the paper puts all that it weighed at the slider."""

# --- section 2.2, eqs. 1 to 8: the motion, exact and by two terms of the rod's series --------------------------------

CRANK, ROD = LINKAGE.crank_mm, LINKAGE.rod_mm
RATIO = CRANK / ROD
ANGLES_RAD = np.linspace(0.0, 2.0 * np.pi, 73)


def two_term_stroke(linkage: CrankSlider, angles_rad: Array, order: int) -> Jet:
    """Eq. 6: r ((1 - cos t) + (r/l) (1 - cos 2t) / 4) in mm, with derivatives by the angle t.

    Stroke and angle count from the extended dead centre.
    """
    angle = Jet.variable(angles_rad, order)
    ratio = linkage.crank_mm / linkage.rod_mm
    once, twice = (1.0 - jet.sin_cos(angle * turns)[1] for turns in (1.0, 2.0))
    return linkage.crank_mm * (once + (ratio / 4.0) * twice)


def stroke_residual() -> Computed:
    """Eqs. 2 and 3 against the linkage, by the stroke; both count it from the extended dead centre."""
    exact = LINKAGE.stroke_mm - LINKAGE.displacement(Jet.variable(np.pi + ANGLES_RAD, 0)).value
    sine, cosine = np.sin(ANGLES_RAD), np.cos(ANGLES_RAD)
    second = (ROD + CRANK) - (CRANK * cosine + ROD * np.cos(np.arcsin(RATIO * sine)))
    third = CRANK * ((1.0 - cosine) + (1.0 - np.sqrt(1.0 - RATIO**2 * sine**2)) / RATIO)
    return computed(*(float(np.abs(formula - exact).max() / LINKAGE.stroke_mm) for formula in (second, third)))


def two_term_residual() -> Computed:
    """Eq. 6 against eq. 3 with the root of eq. 5, by the stroke."""
    sine, cosine = np.sin(ANGLES_RAD), np.cos(ANGLES_RAD)
    with_root = CRANK * (1.0 - cosine) + ROD * 0.5 * RATIO**2 * sine**2
    return computed(float(np.abs(two_term_stroke(LINKAGE, ANGLES_RAD, 0).value - with_root).max() / LINKAGE.stroke_mm))


def velocity_residual() -> Computed:
    """Eq. 7 against the derivative of eq. 6."""
    formula = SPEED_RAD_S * CRANK * (np.sin(ANGLES_RAD) + RATIO / 2.0 * np.sin(2.0 * ANGLES_RAD))
    return computed(_off(formula, two_term_stroke(LINKAGE, ANGLES_RAD, 1).derivative(1) * SPEED_RAD_S))


def acceleration_residual() -> Computed:
    """Eq. 8 against minus the second derivative of eq. 6."""
    formula = -(SPEED_RAD_S**2) * CRANK * (np.cos(ANGLES_RAD) + RATIO * np.cos(2.0 * ANGLES_RAD))
    return computed(_off(formula, -two_term_stroke(LINKAGE, ANGLES_RAD, 2).derivative(2) * SPEED_RAD_S**2))


def _off(formula: Array, exact: Array) -> float:
    return float(np.abs(formula - exact).max() / np.abs(exact).max())


MOTION = (
    Entry(equations("1", "2", "3"), "stroke against crank angle, from the extended dead centre", Relation(),
          Verdict.REPRODUCED, stroke_residual),
    Entry(equations("4"), "coefficients of the root's series", Printed(("0.5", "0.125", "0.0625")), Verdict.REPRODUCED,
          lambda: computed(*(abs(float(binom(0.5, power))) for power in (1, 2, 3)))),
    Entry(equations("5", "6"), "stroke by two terms of the series", Relation(), Verdict.REPRODUCED, two_term_residual),
    Entry(equations("7"), "velocity by two terms", Relation(), Verdict.REPRODUCED, velocity_residual),
    Entry(equations("8", "16"), "acceleration by two terms, growing with the square of the speed", Relation(),
          Verdict.UNDER_READING, acceleration_residual,
          "Counted positive away from the crank axis, against the sense in which the stroke is counted."),
    Entry(equations("8", "16"), "two terms for the exact acceleration of this linkage", Relation(),
          Verdict.NOT_REPRODUCIBLE, lambda: computed(two_term_formula(MECHANISM).largest_error),
          "At a crank of 0.473 rods the terms left out are not small."),
)  # fmt: skip

# --- section 3.1, eqs. 16 to 20: counterweights of the mechanism and of the chassis ----------------------------------


@cache
def tail_weights() -> DynamicCounterweights:
    """M1, against the slider's inertia: at both dead centres, and the largest over the turn, at the paper's gravity."""
    weighing = replace(MECHANISM, masses=replace(MECHANISM.masses, gravity_m_s2=(0.0, -GRAVITY_M_S2)))
    return dynamic_counterweights(CHASSIS, weighing)


@cache
def complete() -> CompleteBalance:
    """Counterweights that keep the common centre of mass on the crank axis."""
    return complete_balance(MECHANISM, ROD_ARM_MM, CRANK_ARM_MM)


def against_dead_weight_kg() -> float:
    """M2, against the dead weight."""
    return static_counterweight_kg(CHASSIS, SLIDER_KG, WEIGHT_KG, WEIGHT_LEVER_MM)


COUNTERWEIGHTS = (
    Entry(("section 3.1",), "counterweight beyond the crank pin, and mass at the pin", Printed(("182", "247"), "kg"),
          Verdict.REPRODUCED, lambda: computed(complete().rod.mass_kg, complete().pin_kg)),
    Entry(("section 3.1",), "counterweight beyond the crank axis", Printed(("261.82",), "kg"), Verdict.FITTED,
          lambda: computed(complete().crank.mass_kg),
          "At 250 mm from the axis: its place is not printed, and this round one gives the printed mass."),
    Entry(("section 3.5",), "crank's speed from 96.5 r/min", Printed(("10.10",), "rad/s"), Verdict.NOT_REPRODUCIBLE,
          lambda: computed(SPEED_RAD_S), "Cut off, not rounded."),
    Entry((*equations("16", "17", "18"), "section 3.5"), "weight against the slider's inertia", Printed(("5",), "kg"),
          Verdict.FITTED, lambda: computed(tail_weights().retracted_kg), "With the inertia force at the retracted "
          "dead centre, the smaller of the two: the text names no dead centre."),
    Entry(equations("16", "17", "18"), "weight against the slider's largest inertia force", Printed(("5",), "kg"),
          Verdict.NOT_REPRODUCIBLE, lambda: computed(tail_weights().worst_kg.value),
          "The force is largest at the extended dead centre; the printed weight is not the safe one."),
    Entry((*equations("19"), "section 3.5"), "weight against the dead weight", Printed(("260",), "kg"),
          Verdict.REPRODUCED, lambda: computed(against_dead_weight_kg())),
    Entry((*equations("20"), "section 3.5"), "both weights", Printed(("265",), "kg"), Verdict.REPRODUCED,
          lambda: from_readings(lambda one, other: (one + other,), "5", "260"), of_printed=True),
    Entry(equations("20"), "both weights, from the dimensions", Printed(("265",), "kg"), Verdict.NOT_REPRODUCIBLE,
          lambda: computed(tail_weights().retracted_kg + against_dead_weight_kg()),
          "Each of the printed weights is rounded up; unrounded they make less."),
)  # fmt: skip
