"""Sections 2.2, 2.3 and 3.1 to 3.3, eqs. 1 to 13 and 16 to 20, Tables 1, 3, 4: motion, counterweights, frequencies."""

from __future__ import annotations

from dataclasses import replace
from functools import cache
from math import radians

import numpy as np
from scipy.special import binom

from ncgear.balance.excitation import Engine, Shaft, margins, of_engine, of_shaft
from ncgear.balance.frame import Chassis, DynamicCounterweights, dynamic_counterweights, static_counterweight_kg
from ncgear.balance.mechanism import CompleteBalance, DrivenCrank, complete_balance
from ncgear.balance.shaking import two_term_formula
from ncgear.mechanisms.crank_slider import CrankSlider
from ncgear.mechanisms.forces import RodMasses
from ncgear.numerics import jet
from ncgear.numerics.arrays import Array
from ncgear.numerics.jet import Jet
from ncgear.numerics.units import RAD_S_PER_RPM
from ncgear.papers.entry import Computed, Entry, Finding, Printed, Relation, computed, from_readings, printed
from ncgear.ratio.laws.uniform import uniform_law
from ncgear.ratio.transmission import Lobes

SHAFTS = (
    Shaft("engine", 2400.0, 15),
    Shaft("engine drive shaft", 1354.0, 14, 32),
    Shaft("knotter shaft", 96.5, 13, 32),
    Shaft("mower shaft", 96.5, 13, 32),
    Shaft("bale transport shaft", 193.0, 13, 21),
    Shaft("gear transmission", 391.7, 15, 73),
    Shaft("feeding wheel I", 569.8, 13, 30),
    Shaft("feeding wheel II", 341.8, 13, 21),
    Shaft("feeding auger", 226.0, 14),
    Shaft("pick-up", 141.0, 13, 58),
)
ROTATION = ("40", "22.57", "1.61", "1.61", "3.22", "6.53", "9.50", "5.70", "3.77", "2.35")
ROLLERS = ("600", "315.98", "20.93", "20.93", "41.86", "97.95", "123.5", "74.1", "52.78", "30.55")
TEETH = ("722.24", "51.52", "51.52", "67.62", "476.69", "285", "119.7", "136.3")
ENGINE = Engine("engine", 2400.0, cylinders=4, strokes=4)
AUGER_HZ = 226.0 / 60.0

SIMULATED_HZ = ("4.62", "17.26", "29.82", "63.85", "83.73", "141.58")
NATURAL_HZ = tuple(map(float, SIMULATED_HZ))
MEASURED_HZ = ("4.39", "18.29", "29.41", "63.48", "82.03", "125.49")


def of_kind(kind: str) -> list[float]:
    """Frequencies of the shafts of one kind in Hz, in the table's order."""
    return [excitation.frequency_hz for shaft in SHAFTS for excitation in of_shaft(shaft) if excitation.kind == kind]


def from_printed(counts: list[int | None]) -> Computed:
    """Rollers or teeth times the printed frequencies of the shafts, in Hz; shafts without a count are left out."""
    known, printed = zip(*((count, text) for count, text in zip(counts, ROTATION, strict=True) if count), strict=True)
    return from_readings(lambda *rates: tuple(count * rate for count, rate in zip(known, rates, strict=True)), *printed)


def engine(kind: str) -> float:
    """One of the engine's frequencies in Hz."""
    return next(excitation.frequency_hz for excitation in of_engine(ENGINE) if excitation.kind == kind)


def errors(*orders: int) -> Computed:
    """Differences of simulated and measured natural frequencies in percent of the measured ones; orders from 1."""
    texts = [text for order in orders for text in (SIMULATED_HZ[order - 1], MEASURED_HZ[order - 1])]

    def percent(*readings: float) -> tuple[float, ...]:
        return tuple(100.0 * abs(one - other) / other for one, other in zip(readings[::2], readings[1::2], strict=True))

    return from_readings(percent, *texts)


def nearer_than_the_auger() -> Computed:
    """Number of other excitations that are as near to a natural frequency as the auger's rotation is to the first."""
    excitations = [*of_engine(ENGINE), *(excitation for shaft in SHAFTS for excitation in of_shaft(shaft))]
    found = margins(excitations, NATURAL_HZ, 1.0 - AUGER_HZ / NATURAL_HZ[0])
    return computed(sum(excitation.near and excitation.excitation.source != "feeding auger" for excitation in found))


GEOMETRY = "The part's geometry and its finite-element model."

SHAFTS_AND_ENGINE = (
    Entry("eq. 9, Table 1, section 2.3", "frequencies of the ten shafts", Printed(ROTATION, "Hz"), Finding.REPRODUCED,
          lambda: (*of_kind("rotation"),)),
    Entry("eq. 11, Table 1", "rollers passing in their bearings", Printed(ROLLERS, "Hz"), Finding.REPRODUCED,
          lambda: from_printed([shaft.rollers for shaft in SHAFTS]), of_printed=True),
    Entry("eq. 11", "frequencies at which rollers pass a place of either race", Printed(ROLLERS, "Hz"),
          Finding.NEEDS_DATA, None, "Diameters of rollers and pitch circles: the cage turns at about 0.4 of the "
          "shaft's speed, not with it."),
    Entry("eq. 10, Table 1", "teeth of sprockets and gears", Printed(TEETH, "Hz"), Finding.REPRODUCED,
          lambda: from_printed([shaft.teeth for shaft in SHAFTS]), of_printed=True),
    Entry("eq. 12, eq. 13, section 2.3", "combustion and inertia of the engine", printed("80 80 Hz"),
          Finding.REPRODUCED, lambda: (engine("combustion"), engine("inertia"))),
)  # fmt: skip

NATURAL = (
    Entry("Table 3, Fig. 12, Table 4, section 3.2", "natural frequencies by finite elements",
          Printed(SIMULATED_HZ, "Hz"), Finding.NEEDS_DATA, None, GEOMETRY),
    Entry("Table 4, Fig. 14", "natural frequencies measured", Printed(MEASURED_HZ, "Hz"), Finding.NEEDS_DATA, None,
          "The records of the measurement."),
    Entry("Table 4", "differences of the 1st, 3rd, 4th and 5th", printed("5.2 1.4 0.6 2 %"), Finding.REPRODUCED,
          lambda: errors(1, 3, 4, 5), of_printed=True),
    Entry("Table 4, section 3.3", "differences of the 2nd and the 6th, which is the largest", printed("5.9 11.3 %"),
          Finding.NOT_REPRODUCIBLE, lambda: errors(2, 6), "By the measured frequency, as the other four are; the "
          "printed ones are by the simulated frequency, cut off.", of_printed=True),
    Entry("section 3.3", "the auger's frequency by the first natural one", printed("0.8"), Finding.REPRODUCED,
          lambda: from_readings(lambda auger, first: (auger / first,), "3.77", "4.62"), of_printed=True),
    Entry("section 3.3", "other excitations as near to a natural frequency as that", printed("0"),
          Finding.NOT_REPRODUCIBLE, nearer_than_the_auger, "Rollers of the pick-up stand nearer to the third natural "
          "frequency, and combustion to the fifth, than the auger to the first."),
)  # fmt: skip


LINKAGE = CrankSlider(265.0, 560.0)
SLIDER_KG = 65.0
SPEED_RAD_S = 96.5 * RAD_S_PER_RPM
ROD_ARM_MM, CRANK_ARM_MM = 200.0, 250.0
CHASSIS = Chassis(support_mm=370.0, counterweight_mm=1000.0, tilt_rad=radians(8.0))
WEIGHT_KG, WEIGHT_LEVER_MM = 500.0, 470.0
GRAVITY_M_S2 = 9.81

MECHANISM = DrivenCrank(LINKAGE, uniform_law(Lobes()), SPEED_RAD_S, RodMasses(slider_kg=SLIDER_KG))
"""Rod and crank have no mass: the paper puts all the mass that it weighed at the slider."""

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
    """Eqs.  2 and 3 against the linkage, relative to the stroke; both count it from the extended dead centre."""
    exact = LINKAGE.stroke_mm - LINKAGE.displacement(Jet.variable(np.pi + ANGLES_RAD, 0)).value
    sine, cosine = np.sin(ANGLES_RAD), np.cos(ANGLES_RAD)
    second = (ROD + CRANK) - (CRANK * cosine + ROD * np.cos(np.arcsin(RATIO * sine)))
    third = CRANK * ((1.0 - cosine) + (1.0 - np.sqrt(1.0 - RATIO**2 * sine**2)) / RATIO)
    return computed(*(float(np.abs(formula - exact).max() / LINKAGE.stroke_mm) for formula in (second, third)))


def two_term_residual() -> Computed:
    """Eq.  6 against eq.  3 with the root of eq.  5, relative to the stroke."""
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
    Entry("eq. 1, eq. 2, eq. 3", "stroke against crank angle, from the extended dead centre", Relation(),
          Finding.REPRODUCED, stroke_residual),
    Entry("eq. 4", "coefficients of the root's series", printed("0.5 0.125 0.0625"), Finding.REPRODUCED,
          lambda: (*(abs(float(binom(0.5, power))) for power in (1, 2, 3)),)),
    Entry("eq. 5, eq. 6", "stroke by two terms of the series", Relation(), Finding.REPRODUCED, two_term_residual),
    Entry("eq. 7", "velocity by two terms", Relation(), Finding.REPRODUCED, velocity_residual),
    Entry("eq. 8, eq. 16", "acceleration by two terms, growing with the square of the speed", Relation(),
          Finding.UNDER_READING, acceleration_residual, "Counted positive away from the crank axis, against the sense "
          "in which the stroke is counted."),
    Entry("eq. 8, eq. 16", "two terms for the exact acceleration of this linkage", Relation(),
          Finding.NOT_REPRODUCIBLE, lambda: two_term_formula(MECHANISM).largest_error,
          "At a crank of 0.473 rods the terms left out are not small."),
)  # fmt: skip

# --- section 3.1, eqs. 16 to 20: counterweights of the mechanism and of the chassis ----------------------------------


@cache
def tail_weights() -> DynamicCounterweights:
    """M1, against the slider's inertia: at both dead centres, and the largest of the turn, with the paper's gravity."""
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
    Entry("section 3.1", "counterweight beyond the crank pin, and mass at the pin", printed("182 247 kg"),
          Finding.REPRODUCED, lambda: (complete().rod.mass_kg, complete().pin_kg)),
    Entry("section 3.1", "counterweight beyond the crank axis", printed("261.82 kg"), Finding.FITTED,
          lambda: complete().crank.mass_kg, "At 250 mm from the axis: its place is not printed, and this round one "
          "gives the printed mass."),
    Entry("section 3.5", "crank's speed from 96.5 r/min", printed("10.10 rad/s"), Finding.NOT_REPRODUCIBLE,
          lambda: SPEED_RAD_S, "Cut off, not rounded."),
    Entry("eq. 16, eq. 17, eq. 18, section 3.5", "weight against the slider's inertia", printed("5 kg"),
          Finding.FITTED, lambda: tail_weights().retracted_kg, "With the inertia force at the retracted dead centre, "
          "the smaller of the two: the text names no dead centre."),
    Entry("eq. 16, eq. 17, eq. 18", "weight against the slider's largest inertia force", printed("5 kg"),
          Finding.NOT_REPRODUCIBLE, lambda: tail_weights().worst_kg.value, "The force is largest at the extended dead "
          "centre; the printed weight is not the safe one."),
    Entry("eq. 19, section 3.5", "weight against the dead weight", printed("260 kg"), Finding.REPRODUCED,
          lambda: against_dead_weight_kg()),
    Entry("eq. 20, section 3.5", "both weights", printed("265 kg"), Finding.REPRODUCED,
          lambda: from_readings(lambda one, other: (one + other,), "5", "260"), of_printed=True),
    Entry("eq. 20", "both weights, from the dimensions", printed("265 kg"), Finding.NOT_REPRODUCIBLE,
          lambda: tail_weights().retracted_kg + against_dead_weight_kg(), "Each of the printed weights is rounded up; "
          "unrounded they make less."),
)  # fmt: skip
