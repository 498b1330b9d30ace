"""Counterweight at the tail of a chassis on two supports, against a slider's inertia and against dead weight.

Moments about the supports: Z. Tang, Y. Li, Y. Zhou, H. Zhang, Shock and Vibration 2019, eqs. 16 to 20.
"""

from __future__ import annotations

from dataclasses import dataclass
from math import sin

import numpy as np

from ncgear.balance.mechanism import Mechanism
from ncgear.balance.shaking import shaking
from ncgear.kinematics.slider import Machine
from ncgear.machine.polynomial_resistance import PolynomialResistance
from ncgear.numerics.extrema import Extremum

GRAVITY_M_S2 = 9.81
"""As the paper has it; it cancels out of the dead weight."""


@dataclass(frozen=True)
class Chassis:
    """Levers in mm from the centre of gravity: of the supports (both alike) and of the counterweight.

    ``tilt_rad`` is the slope of the slider's line against the ground.
    """

    support_mm: float
    counterweight_mm: float
    tilt_rad: float


def dynamic_counterweight_kg(chassis: Chassis, force_n: float) -> float:
    """M1 = F a sin(tilt) / (c g): weight that holds the vertical part of an inertia force along the slider's line."""
    return abs(force_n) * sin(chassis.tilt_rad) * chassis.support_mm / (chassis.counterweight_mm * GRAVITY_M_S2)


def static_counterweight_kg(chassis: Chassis, slider_kg: float, weight_kg: float, weight_lever_mm: float) -> float:
    """M2 = (a m1 + d m2) / c: weight that brings the centre of gravity back between the supports."""
    moment = chassis.support_mm * slider_kg + weight_lever_mm * weight_kg
    return moment / chassis.counterweight_mm


@dataclass(frozen=True)
class DynamicCounterweights:
    """M1 in kg: at both dead centres, and the largest over the driving angle, which it takes to be safe."""

    extended_kg: float
    retracted_kg: float
    worst_kg: Extremum


def dynamic_counterweights(chassis: Chassis, mechanism: Mechanism) -> DynamicCounterweights:
    """What the shaking force along the slider's line asks for, from the exact motion.

    The paper's weight is that of the retracted dead centre; evenly driven, the force is larger at the extended one.
    """
    along = shaking(mechanism).along
    machine = Machine(mechanism.transmission, mechanism.linkage, PolynomialResistance(), mechanism.speed_rad_s)
    at_ends = along(np.array([machine.extended_rad, 0.0]))
    largest = max(along.extremes, key=lambda extremum: abs(extremum.value))
    extended, retracted, worst = (
        dynamic_counterweight_kg(chassis, float(force)) for force in (*at_ends, largest.value)
    )
    return DynamicCounterweights(extended, retracted, Extremum(worst, largest.at))
