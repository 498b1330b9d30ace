"""What the paper gives: Table 1, the resistance, and the speed of its simulation, and the mechanism they make."""

from __future__ import annotations

from functools import cache
from math import pi

from ncgear.kinematics.check import KinematicCheck, kinematic_check
from ncgear.kinematics.motion import Machine
from ncgear.mechanisms.crank_slider import CrankSlider
from ncgear.mechanisms.resistance import PolynomialResistance
from ncgear.numerics.units import RAD_S_PER_RPM
from ncgear.pitch.pair import PitchPair, sized_pair
from ncgear.ratio.laws.three_segment import StrokeLaw, stroke_law
from ncgear.ratio.laws.uniform import uniform_law
from ncgear.ratio.transmission import Lobes, Transmission
from ncgear.ratio.working_stroke import StrokeRequest, WorkingStroke, solved_stroke

LINKAGE = CrankSlider(380.0, 960.0)
RESISTANCE = PolynomialResistance((-131.2779, 3.447, 1.846e-2, -1.575e-4, 2.498e-7))
THETAS_RAD = (0.4 * pi, 0.7 * pi, pi, 1.3 * pi)
V1_MM_S, V2_MM_S, A1_MM_S2 = 1600.0, 1100.0, -1500.0
STROKE_MM = 760.0
TEETH, MODULE_MM, CENTER_DISTANCE_MM = 25, 3.0, 200.0
SIMULATION_RPM = 20.0

EARLIER_RPM = 60.0
"""Speed that the earlier mechanism's figures belong to, if its uniform crank has this linkage and resistance."""

EARLIER_POWER_W, EARLIER_ACCELERATION_MM_S2 = 18750.0, 45000.0
PROPOSED_POWER_W = 6300.0


def stroke_at(law_rpm: float | None, a1_rpm: float | None, stroke_mm: float | None) -> WorkingStroke:
    """The working stroke of Table 1; what is None follows from the rest, ``a1_rpm`` being that of the law then."""
    speeds = (None if rpm is None else rpm * RAD_S_PER_RPM for rpm in (law_rpm, a1_rpm))
    law, a1 = speeds
    request = StrokeRequest(*THETAS_RAD, V1_MM_S, V2_MM_S, A1_MM_S2, law, stroke_mm, a1)
    return solved_stroke(request)


@cache
def law() -> StrokeLaw:
    """The reading of designs/baler.yaml: a1 at the simulation's speed, v1 and v2 at the one that closes the stroke."""
    return stroke_law(stroke_at(None, SIMULATION_RPM, STROKE_MM), LINKAGE, Lobes(), constant=0.0)


@cache
def other_law() -> StrokeLaw:
    """The reading of designs/baler-a1-at-law-speed.yaml: v1, v2 and a1 all at the speed that closes the stroke."""
    return stroke_law(stroke_at(None, None, STROKE_MM), LINKAGE, Lobes(), constant=0.0)


@cache
def law_rpm() -> float:
    """Speed at which v1 and v2 hold in that reading."""
    return law().stroke.law_speed_rad_s / RAD_S_PER_RPM


@cache
def at_speed(rpm: float) -> KinematicCheck:
    """Peaks of that mechanism at a driving speed in r/min."""
    return _check(law().transmission, rpm)


@cache
def other_at_speed(rpm: float) -> KinematicCheck:
    """Peaks of the mechanism of the other reading."""
    return _check(other_law().transmission, rpm)


@cache
def uniform_at_speed(rpm: float) -> KinematicCheck:
    """Peaks of the same linkage on a crank that turns evenly."""
    return _check(uniform_law(Lobes()), rpm)


@cache
def pitch() -> PitchPair:
    """The pitch curves at the printed centre distance, with the printed number of teeth."""
    return sized_pair(law().transmission, TEETH, None, CENTER_DISTANCE_MM)


def _check(transmission: Transmission, rpm: float) -> KinematicCheck:
    return kinematic_check(Machine(transmission, LINKAGE, RESISTANCE, rpm * RAD_S_PER_RPM))
