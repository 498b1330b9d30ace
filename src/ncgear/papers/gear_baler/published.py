"""What the paper gives: Table 1, the resistance and the speed of the simulation; and the mechanism that these make."""

from __future__ import annotations

from functools import cache
from math import pi

from ncgear.kinematics.check import KinematicCheck, kinematic_check
from ncgear.kinematics.motion import Machine
from ncgear.mechanisms.crank_slider import CrankSlider
from ncgear.mechanisms.resistance import PolynomialResistance
from ncgear.mechanisms.slider_load import SliderLoad
from ncgear.numerics.arrays import Array
from ncgear.numerics.jet import Jet
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
"""Speed of the earlier mechanism's figures: an inference, if the even crank beside it has this linkage and resistance.

The paper prints none.  Of the powers 18750 W against an even crank's, and 28.6 % below it, follow 60.44 r/min."""

EARLIER_POWER_W, EARLIER_ACCELERATION_MM_S2 = 18750.0, 45000.0
PROPOSED_POWER_W = 6300.0


def stroke_at(law_rpm: float | None, a1_rpm: float | None, stroke_mm: float | None) -> WorkingStroke:
    """The working stroke of Table 1, v1 and v2 holding at ``law_rpm`` and a1 at ``a1_rpm``.

    A speed or a stroke of None follows from the rest; without ``a1_rpm`` a1 holds at the speed of v1 and v2.
    """
    law_speed, a1_speed = (None if rpm is None else rpm * RAD_S_PER_RPM for rpm in (law_rpm, a1_rpm))
    return solved_stroke(StrokeRequest(*THETAS_RAD, V1_MM_S, V2_MM_S, A1_MM_S2, law_speed, stroke_mm, a1_speed))


@cache
def law() -> StrokeLaw:
    """The reading of designs/baler.yaml: a1 at the simulation's speed, v1 and v2 at that which closes the stroke."""
    return stroke_law(stroke_at(None, SIMULATION_RPM, STROKE_MM), LINKAGE, Lobes(), constant=0.0)


@cache
def other_law() -> StrokeLaw:
    """The reading of designs/baler-a1-at-law-speed.yaml: v1, v2 and a1 all at the speed that closes the stroke."""
    return stroke_law(stroke_at(None, None, STROKE_MM), LINKAGE, Lobes(), constant=0.0)


@cache
def law_rpm() -> float:
    """Speed at which v1 and v2 hold in the reading of ``law``."""
    return law().stroke.law_speed_rad_s / RAD_S_PER_RPM


def slider_displacement(segment: int, phi1_rad: Array, order: int) -> Jet:
    """Displacement in mm on a segment of the working stroke, through gears and linkage, with ``order`` derivatives."""
    return LINKAGE.displacement(law().transmission.pieces[segment].driven_angle(phi1_rad, order))


@cache
def at_speed(rpm: float) -> KinematicCheck:
    """Power and peaks of the mechanism with ``law`` at a driving speed in r/min."""
    return _check(law().transmission, rpm)


@cache
def other_at_speed(rpm: float) -> KinematicCheck:
    """The same with ``other_law``."""
    return _check(other_law().transmission, rpm)


@cache
def uniform_at_speed(rpm: float) -> KinematicCheck:
    """The same linkage on a crank that turns evenly."""
    return _check(uniform_law(Lobes()), rpm)


@cache
def pitch() -> PitchPair:
    """The pitch curves at the printed centre distance, with the printed number of teeth."""
    return sized_pair(law().transmission, TEETH, None, CENTER_DISTANCE_MM)


def _check(transmission: Transmission, rpm: float) -> KinematicCheck:
    return kinematic_check(Machine(transmission, LINKAGE, SliderLoad(RESISTANCE), rpm * RAD_S_PER_RPM))
