"""Section 4.3.1, Figs. 4 and 9 to 12: displacement and speeds of the slider."""

from __future__ import annotations

from math import degrees

import numpy as np

from ncgear.ledger.entry import Entry, Verdict
from ncgear.ledger.gear_baler.motion import displacement
from ncgear.ledger.gear_baler.published import LINKAGE, SIMULATION_RPM, THETAS_RAD, law_rpm
from ncgear.ledger.printed import Computed, Printed, of
from ncgear.numerics.extrema import extremes
from ncgear.numerics.units import RAD_S_PER_RPM


def working_speeds(rpm: float) -> Computed:
    """Largest speed of the working stroke and the speed of pressing in mm/s, at a driving speed."""
    _, theta2, theta3, _ = THETAS_RAD
    fastest = extremes(lambda phi1: displacement(0, phi1, 3).differentiated(), 0.0, theta2)[1].value
    pressing = float(displacement(1, np.array([0.5 * (theta2 + theta3)]), 1).derivative(1)[0])
    return of(*(speed * rpm * RAD_S_PER_RPM for speed in (fastest, pressing)))


def largest_displacement() -> Computed:
    """Displacement at the end of the working stroke."""
    return of(float(displacement(2, np.array([THETAS_RAD[3]]), 0).value[0]))


NOT_THERE = "It is taken from an earlier paper, whose law and speed are not given."

ENTRIES = (
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
        lambda: of(degrees(THETAS_RAD[3]), degrees(LINKAGE.working_angle_rad)),
    ),
    Entry(
        ("section 4.3.1",), "longer time of pressing than on a crank that turns evenly", Printed(("30",), "%"),
        Verdict.REPRODUCED, lambda: of(100.0 * (THETAS_RAD[3] / LINKAGE.working_angle_rad - 1.0)),
    ),
)  # fmt: skip
