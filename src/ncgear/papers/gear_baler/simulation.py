"""Section 4.3, Figs. 4 and 9 to 14: motion and power of the simulated slider, beside other mechanisms."""

from __future__ import annotations

from math import degrees

import numpy as np

from ncgear.numerics.extrema import extremes
from ncgear.numerics.units import RAD_S_PER_RPM
from ncgear.papers.entry import Computed, Entry, Printed, Verdict, computed, equations
from ncgear.papers.gear_baler.published import (
    EARLIER_ACCELERATION_MM_S2,
    EARLIER_POWER_W,
    EARLIER_RPM,
    LINKAGE,
    PROPOSED_POWER_W,
    SIMULATION_RPM,
    THETAS_RAD,
    at_speed,
    law_rpm,
    other_at_speed,
    slider_displacement,
    uniform_at_speed,
)

NOT_THERE = "It is taken from an earlier paper, whose law and speed are not given."


def largest_displacement() -> Computed:
    """Displacement in mm at the end of the working stroke."""
    return computed(float(slider_displacement(2, np.array([THETAS_RAD[3]]), 0).value[0]))


def working_speeds(rpm: float) -> Computed:
    """Largest speed of the working stroke and speed of pressing in mm/s, at a driving speed in r/min."""
    _, theta2, theta3, _ = THETAS_RAD
    fastest = extremes(lambda phi1: slider_displacement(0, phi1, 3).differentiated(), 0.0, theta2)[1].value
    pressing = float(slider_displacement(1, np.array([0.5 * (theta2 + theta3)]), 1).derivative(1)[0])
    return computed(*(speed * rpm * RAD_S_PER_RPM for speed in (fastest, pressing)))


SPEED = (
    Entry(
        ("Fig. 9", "Fig. 11"), "largest displacement", Printed(("760",), "mm"), Verdict.REPRODUCED,
        largest_displacement,
    ),
    Entry(
        ("Fig. 4", "Fig. 10", "Fig. 12"), "largest speed of the working stroke and speed of pressing",
        Printed(("1600", "1100"), "mm/s"), Verdict.UNDER_READING, lambda: working_speeds(law_rpm()),
        "At 52.81 r/min, where Table 1 closes with a1 at 20 r/min.",
    ),
    Entry(
        ("Fig. 12",), "speeds of the slider at 20 r/min, the speed of Figs. 13 and 14",
        Printed(("1600", "1100"), "mm/s"), Verdict.NOT_REPRODUCIBLE, lambda: working_speeds(SIMULATION_RPM),
        "Speeds, power and acceleration are printed for different driving speeds.",
    ),
    Entry(
        ("section 4.3.1",), "earlier mechanism: largest speed and speed of pressing", Printed(("2100", "820"), "mm/s"),
        Verdict.NEEDS_DATA, None, NOT_THERE,
    ),
    Entry(
        ("section 4.3.1",), "driving angle of the working stroke, and of a crank that turns evenly",
        Printed(("234", "180"), "deg"), Verdict.REPRODUCED,
        lambda: computed(degrees(THETAS_RAD[3]), degrees(LINKAGE.working_angle_rad)),
    ),
    Entry(
        ("section 4.3.1",), "longer time of pressing than on a crank that turns evenly", Printed(("30",), "%"),
        Verdict.REPRODUCED, lambda: computed(100.0 * (THETAS_RAD[3] / LINKAGE.working_angle_rad - 1.0)),
    ),
)  # fmt: skip


def power(rpm: float) -> Computed:
    """Largest power of the working stroke in W."""
    return computed(at_speed(rpm).peak_power_w.value)


def saving(one_w: float, other_w: float) -> Computed:
    """Percent by which one power is below the other."""
    return computed(100.0 * (1.0 - one_w / other_w))


def power_and_acceleration_of_other_reading() -> Computed:
    """Largest power in W and largest acceleration of the working stroke in mm/s^2, at 20 r/min."""
    found = other_at_speed(SIMULATION_RPM)
    return computed(found.peak_power_w.value, found.peak_acceleration_working_mm_s2.value)


A1_AT_20 = "a1 is read at the simulation's 20 r/min, and v1 and v2 at the 52.81 r/min that closes the stroke"

POWER = (
    Entry(
        ("Fig. 13", *equations("4.1", "4.2")), "largest power", Printed(("6300",), "W"), Verdict.UNDER_READING,
        lambda: power(SIMULATION_RPM),
        f"At 20 r/min; {A1_AT_20}. The resistance is negative below 33.7 mm and counts as zero there.",
    ),
    Entry(
        ("Fig. 13",), "largest power at the speed at which v1 and v2 hold", Printed(("6300",), "W"),
        Verdict.NOT_REPRODUCIBLE, lambda: power(law_rpm()),
        "Power is proportional to speed, and the printed one belongs to 20 r/min.",
    ),
    Entry(
        ("Fig. 13", "Fig. 14"), "largest power and acceleration with a1 read at the speed of v1 and v2",
        Printed(("6300", "1500"), "W, mm/s2"), Verdict.NOT_REPRODUCIBLE, power_and_acceleration_of_other_reading,
        "The stroke then closes at 51.31 r/min, and the ratio runs from 0.12 to 7.65: no gears to use.",
    ),
    Entry(
        ("Fig. 13",), "earlier mechanism: largest power", Printed(("18750",), "W"), Verdict.NEEDS_DATA, None, NOT_THERE
    ),
    Entry(
        ("section 1",), "power of the earlier mechanism below that of an even crank", Printed(("28.6",), "%"),
        Verdict.NEEDS_DATA,
        lambda: saving(EARLIER_POWER_W, uniform_at_speed(EARLIER_RPM).peak_power_w.value),
        "The speed is not given. Computed with this linkage and resistance at 60 r/min, the round number that comes "
        "nearest.",
    ),
    Entry(
        ("Fig. 13",), "power saved, from the two printed powers", Printed(("66.4",), "%"), Verdict.UNDER_READING,
        lambda: saving(PROPOSED_POWER_W, EARLIER_POWER_W),
        "The quotient of the printed numbers, which belong to 20 r/min and to about 60 r/min.",
    ),
    Entry(
        ("Fig. 13",), "power saved at equal productivity", Printed(("66.4",), "%"), Verdict.NOT_REPRODUCIBLE,
        lambda: saving(at_speed(EARLIER_RPM).peak_power_w.value, EARLIER_POWER_W),
        "At the 60 r/min that the earlier mechanism's power belongs to, the new one needs no less.",
    ),
)  # fmt: skip

ACCELERATION = (
    Entry(
        ("Fig. 14",), "largest acceleration, in the working stroke", Printed(("1500",), "mm/s2"),
        Verdict.UNDER_READING, lambda: computed(at_speed(SIMULATION_RPM).peak_acceleration_working_mm_s2.value),
        f"{A1_AT_20}.",
    ),
    Entry(
        ("Fig. 14",), "largest acceleration, over the whole cycle", Printed(("1500",), "mm/s2"),
        Verdict.NOT_REPRODUCIBLE, lambda: computed(at_speed(SIMULATION_RPM).peak_acceleration_cycle_mm_s2.value),
        "The largest is in the return, which the printed curve leaves out.",
    ),
    Entry(
        ("Fig. 14",), "earlier mechanism: largest acceleration", Printed(("45000",), "mm/s2"), Verdict.NEEDS_DATA,
        None, NOT_THERE,
    ),
    Entry(
        ("Fig. 14",), "acceleration by that of the earlier mechanism, at equal speed and over the whole cycle",
        Printed(("0.1",)), Verdict.NOT_REPRODUCIBLE,
        lambda: computed(at_speed(EARLIER_RPM).peak_acceleration_cycle_mm_s2.value / EARLIER_ACCELERATION_MM_S2),
        "An order of magnitude is what 20 r/min and the working stroke alone make of it.",
    ),
)  # fmt: skip

ENTRIES = (*SPEED, *POWER, *ACCELERATION)
