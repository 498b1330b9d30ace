"""Table 1 and section 4.3, Figs.  4 and 9 to 14: the mechanism of the paper, and its simulation."""

from __future__ import annotations

from functools import cache
from math import degrees, pi

import numpy as np

from ncgear.kinematics.check import KinematicCheck, kinematic_check
from ncgear.kinematics.motion import Machine
from ncgear.mechanisms.crank_slider import CrankSlider
from ncgear.mechanisms.resistance import PolynomialResistance
from ncgear.mechanisms.slider_load import SliderLoad
from ncgear.numerics.arrays import Array
from ncgear.numerics.extrema import extremes
from ncgear.numerics.jet import Jet
from ncgear.numerics.units import RAD_S_PER_RPM
from ncgear.papers.entry import Below, Computed, Entry, Finding, computed, printed
from ncgear.pitch.pair import PitchPair, sized_pair
from ncgear.ratio.laws.three_segment import StrokeLaw, stroke_law
from ncgear.ratio.laws.uniform import uniform_law
from ncgear.ratio.transmission import Lobes, Transmission
from ncgear.ratio.working_stroke import ClosedStroke, StrokeRequest, solved_stroke

LINKAGE = CrankSlider(380.0, 960.0)
RESISTANCE = PolynomialResistance((-131.2779, 3.447, 1.846e-2, -1.575e-4, 2.498e-7))
THETAS_RAD = (0.4 * pi, 0.7 * pi, pi, 1.3 * pi)
V1_MM_S, V2_MM_S, A1_MM_S2 = 1600.0, 1100.0, -1500.0
STROKE_MM = 760.0
TEETH, MODULE_MM, CENTER_DISTANCE_MM = 25, 3.0, 200.0
SIMULATION_RPM = 20.0

EARLIER_RPM = 60.0
"""Speed of the earlier mechanism's figures: an inference, which assumes this linkage and resistance for the even crank.

The paper prints no speed.  The power of 18750 W, 28.6 % below the even crank's power, gives 60.44 r/min."""

EARLIER_POWER_W, EARLIER_ACCELERATION_MM_S2 = 18750.0, 45000.0
PROPOSED_POWER_W = 6300.0


def stroke_at(law_rpm: float | None, a1_rpm: float | None, stroke_mm: float | None) -> ClosedStroke:
    """The working stroke of Table 1; v1 and v2 hold at ``law_rpm``, a1 at ``a1_rpm``.

    A speed or a stroke of None follows from the rest; without ``a1_rpm``, a1 holds at the speed of v1 and v2.
    """
    law_speed, a1_speed = (None if rpm is None else rpm * RAD_S_PER_RPM for rpm in (law_rpm, a1_rpm))
    return solved_stroke(StrokeRequest(*THETAS_RAD, V1_MM_S, V2_MM_S, A1_MM_S2, law_speed, stroke_mm, a1_speed))


@cache
def law() -> StrokeLaw:
    """The reading of designs/baler.yaml: a1 at the simulation's speed, v1 and v2 at the speed closing the stroke."""
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
    """Power and peaks of the mechanism with ``other_law`` at a driving speed in r/min."""
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


NOT_THERE = "It is taken from an earlier paper, whose law and speed are not given."


def working_speeds(rpm: float) -> Computed:
    """Largest speed of the working stroke and speed of pressing in mm/s, at a driving speed in r/min."""
    _, theta2, theta3, _ = THETAS_RAD
    fastest = extremes(lambda phi1: slider_displacement(0, phi1, 3).differentiated(), 0.0, theta2)[1].value
    pressing = float(slider_displacement(1, np.array([0.5 * (theta2 + theta3)]), 1).derivative(1)[0])
    return computed(*(speed * rpm * RAD_S_PER_RPM for speed in (fastest, pressing)))


def end_acceleration() -> Computed:
    """Acceleration of the slider in mm/s^2 at the retracted dead centre, where the return ends, at 20 r/min."""
    slope = float(slider_displacement(0, np.array([0.0]), 2).derivative(2)[0])
    return computed(slope * (SIMULATION_RPM * RAD_S_PER_RPM) ** 2)


def fluctuation_over_cycle() -> Computed:
    """Largest speed over speed of pressing: this mechanism over the whole cycle, and the earlier one as printed."""
    pressing = working_speeds(SIMULATION_RPM).values[1]
    return computed(at_speed(SIMULATION_RPM).peak_speed.value / pressing, 2100.0 / 820.0)


def speeds_at_equal_speed() -> Computed:
    """Largest speed, below the earlier mechanism's, and speed of pressing, above it, at its inferred speed."""
    fastest, pressing = working_speeds(EARLIER_RPM).values
    return computed(fastest, 2100.0, 820.0, pressing)


INFERRED = (
    "The 60 r/min are inferred, not printed: the round number nearest to the 60.44 r/min at which an even crank with "
    "this linkage and resistance needs 28.6 % more than 18750 W."
)

SPEED = (
    Entry("Fig. 9, Fig. 11, section 4.3.1", "largest displacement", printed("760 mm"), Finding.GIVEN_BACK,
          lambda: float(slider_displacement(2, np.array([THETAS_RAD[3]]), 0).value[0]), "H of Table 1."),
    Entry("Fig. 4, Fig. 10, Fig. 12, section 4.3.1", "largest speed of the working stroke and speed of pressing",
          printed("1600 1100 mm/s"), Finding.GIVEN_BACK, lambda: working_speeds(law_rpm()),
          "v1 and v2 of Table 1, at the 52.81 r/min at which they are made to hold."),
    Entry("Fig. 12", "speeds of the slider at 20 r/min, the speed of Figs. 13 and 14", printed("1600 1100 mm/s"),
          Finding.NOT_REPRODUCIBLE, lambda: working_speeds(SIMULATION_RPM), "Speeds, power and acceleration are "
          "printed for different driving speeds."),
    Entry("section 4.3.1", "earlier mechanism: largest speed and speed of pressing", printed("2100 820 mm/s"),
          Finding.NEEDS_DATA, None, NOT_THERE),
    Entry("section 4.3.1, section 5", "less fluctuation: largest speed by speed of pressing, in the working stroke",
          Below("less speed fluctuation"), Finding.REPRODUCED, lambda: (1600.0 / 1100.0, 2100.0 / 820.0),
          "The quotients do not depend on the driving speeds.", of_printed=True),
    Entry("section 4.3.1, section 5", "less fluctuation: largest speed of the whole cycle by speed of pressing",
          Below("less speed fluctuation"), Finding.NOT_REPRODUCIBLE, fluctuation_over_cycle,
          "The return is much faster than the working stroke; that of the earlier mechanism is not printed."),
    Entry("section 4.3.1", "lower largest speed and higher speed of pressing, at equal driving speed",
          Below("lower, higher"), Finding.UNDER_READING, speeds_at_equal_speed, INFERRED),
    Entry("section 4.2", "acceleration where the return ends", printed("0 mm/s2"), Finding.NOT_REPRODUCIBLE,
          end_acceleration, "It is said to come back to zero; at a dead centre the slider turns round, and the law "
          "has its acceleration from eq. 2.6 there."),
    Entry("section 4.3.1", "driving angle of the working stroke", printed("234 deg"), Finding.GIVEN_BACK,
          lambda: degrees(THETAS_RAD[3]), "theta4 of Table 1."),
    Entry("section 4.3.1", "driving angle of the working stroke of a crank that turns evenly", printed("180 deg"),
          Finding.REPRODUCED, lambda: degrees(LINKAGE.working_angle_rad)),
    Entry("section 4.3.1, section 1", "longer time of pressing than on a crank that turns evenly", printed("30 %"),
          Finding.REPRODUCED, lambda: 100.0 * (234.0 / 180.0 - 1.0), of_printed=True),
)  # fmt: skip


def saving(one_w: float, other_w: float) -> tuple[float]:
    """Percent by which one power is below the other."""
    return (100.0 * (1.0 - one_w / other_w),)


A1_AT_20 = "a1 is read at the simulation's 20 r/min, and v1 and v2 at the 52.81 r/min that closes the stroke"

POWER = (
    Entry("Fig. 13, section 4.3.2, eq. 4.1, eq. 4.2", "largest power", printed("6300 W"), Finding.FITTED,
          lambda: at_speed(SIMULATION_RPM).peak_power_w.value, f"At 20 r/min; {A1_AT_20}. The resistance is negative "
          "below 33.7 mm and counts as zero there."),
    Entry("Fig. 13", "largest power at the speed at which v1 and v2 hold", printed("6300 W"), Finding.NOT_REPRODUCIBLE,
          lambda: at_speed(law_rpm()).peak_power_w.value, "Power is proportional to speed, and the printed one "
          "belongs to 20 r/min."),
    Entry("Fig. 13, Fig. 14", "largest power and acceleration with a1 read at the speed of v1 and v2",
          printed("6300 1500 W, mm/s2"), Finding.NOT_REPRODUCIBLE,
          lambda: (other_at_speed(SIMULATION_RPM).peak_power_w.value,
                   other_at_speed(SIMULATION_RPM).peak_acceleration_working.value),
          "The stroke then closes at 51.31 r/min, and the ratio runs from 0.12 to 7.65: no gears to use."),
    Entry("Fig. 13, section 4.3.2", "earlier mechanism: largest power", printed("18750 W"), Finding.NEEDS_DATA, None,
          NOT_THERE),
    Entry("section 1", "power of the earlier mechanism below that of an even crank", printed("28.6 %"),
          Finding.NEEDS_DATA, lambda: (*saving(EARLIER_POWER_W, uniform_at_speed(EARLIER_RPM).peak_power_w.value),),
          f"The speed is not given, nor whether that crank had this linkage and resistance. {INFERRED} Computed at 60 "
          "r/min."),
    Entry("Fig. 13, section 4.3.2, section 5", "power saved", printed("66.4 %"), Finding.REPRODUCED,
          lambda: (*saving(PROPOSED_POWER_W, EARLIER_POWER_W),), "The two powers belong to different speeds, 20 r/min "
          "and about 60 r/min.", of_printed=True),
    Entry("Fig. 13, section 4.3.2", "power saved at equal productivity", printed("66.4 %"), Finding.NOT_REPRODUCIBLE,
          lambda: (*saving(at_speed(EARLIER_RPM).peak_power_w.value, EARLIER_POWER_W),),
          f"At 60 r/min the new mechanism needs no less. {INFERRED}"),
)  # fmt: skip

ACCELERATION = (
    Entry("Fig. 14, section 4.3.3", "largest acceleration, in the working stroke", printed("1500 mm/s2"),
          Finding.GIVEN_BACK, lambda: at_speed(SIMULATION_RPM).peak_acceleration_working.value,
          "The size of a1 of Table 1, at the 20 r/min at which it is read; nothing else in the working stroke is "
          "larger."),
    Entry("Fig. 14", "largest acceleration, over the whole cycle", printed("1500 mm/s2"), Finding.NOT_REPRODUCIBLE,
          lambda: at_speed(SIMULATION_RPM).peak_acceleration_cycle.value, "The largest is in the return, which the "
          "printed curve leaves out."),
    Entry("Fig. 14, section 4.3.3", "earlier mechanism: largest acceleration", printed("45000 mm/s2"),
          Finding.NEEDS_DATA, None, NOT_THERE),
    Entry("Fig. 14, section 4.3.3, section 5", "acceleration below that of the earlier mechanism, by its tenth",
          Below("an order of magnitude"), Finding.REPRODUCED, lambda: (1500.0, 45000.0 / 10.0),
          "Printed for different speeds, and for the working stroke alone.", of_printed=True),
    Entry("Fig. 14", "acceleration by that of the earlier mechanism, at equal speed and over the whole cycle",
          printed("0.1"), Finding.NOT_REPRODUCIBLE,
          lambda: at_speed(EARLIER_RPM).peak_acceleration_cycle.value / EARLIER_ACCELERATION_MM_S2,
          f"An order of magnitude is what 20 r/min and the working stroke alone make of it. {INFERRED}"),
)  # fmt: skip

ENTRIES = (*SPEED, *POWER, *ACCELERATION)
