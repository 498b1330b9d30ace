"""Sections 2.2 and 3.2, Table 2: critical speeds, and the first balancing of the drum in the field.

Readings and weights are complex numbers: amplitude or mass times exp(i phase).
"""

from __future__ import annotations

from cmath import phase, rect
from math import degrees, radians

from ncgear.balance.excitation import critical_speed_rpm
from ncgear.balance.rotor import GRADES_MM_S, TrialRun, balanced
from ncgear.papers.entry import Below, Computed, Entry, Printed, Verdict, computed, from_readings, texts

NATURAL_HZ = texts("143.76 143.77 197.05 293.1 298.33 198.41")
CRITICAL_RPM = texts("8625.60 8626.20 11823 17586 17899.80 11904.60")

FIRST = ("1.234", "159")
"""Reading before balancing: amplitude in mm/s, phase in degrees."""

TRIAL = ("107.7", "90", "0.562", "204")
"""Weight in g at an angle in degrees, and the reading with it."""


def polar(amplitude: float, phase_deg: float) -> complex:
    """The complex number with an amplitude and a phase in degrees."""
    return rect(amplitude, radians(phase_deg))


def phase_deg(number: complex) -> float:
    """Phase of a complex number in degrees, in [0, 360)."""
    return degrees(phase(number)) % 360.0


def effect(*readings: float) -> complex:
    """Change of the reading in mm/s per g at 0 degrees, from the numbers of ``FIRST`` and ``TRIAL`` in their order."""
    first, weight, reading = polar(*readings[:2]), polar(*readings[2:4]), polar(*readings[4:6])
    return complex(balanced([first], [TrialRun(weight, (reading,))]).coefficients[0, 0])


def measured_effect() -> float:
    """Size of the effect that the first balancing found, in mm/s per g."""
    return abs(effect(*map(float, (*FIRST, *TRIAL))))


def correction(*readings: float) -> tuple[float, ...]:
    """The weight in g that cancels the first reading, and its angle in degrees."""
    weight = -polar(*readings[:2]) / effect(*readings)
    return abs(weight), phase_deg(weight)


def after_correction(*readings: float) -> tuple[float, ...]:
    """Amplitude and phase that the 142.45 g put on at 120 degrees should leave."""
    left = polar(*readings[:2]) + effect(*readings) * polar(142.45, 120.0)
    return abs(left), phase_deg(left)


def with_weight_added(*readings: float) -> tuple[float, ...]:
    """Phase of the reading once 58.8 g at 240 degrees are added; the last two readings are what was left before."""
    *known, amplitude, phase = readings
    return (phase_deg(polar(amplitude, phase) + effect(*known) * polar(58.8, 240.0)),)


def finest_grade() -> Computed:
    """The finest balance grade that allows the centre of mass a speed of 0.37 mm/s."""
    return computed(next(grade for grade in GRADES_MM_S if grade >= 0.37))


RECORDS = "The records of the measurement."
MODEL = "The drum's geometry and its finite-element model."

ENTRIES = (
    Entry(("Table 2", "section 3.1"), "natural frequencies", Printed(NATURAL_HZ, "Hz"), Verdict.NEEDS_DATA, None,
          f"{MODEL} The sixth is printed below the fourth and the fifth."),
    Entry(("Table 2", "section 3.1"), "critical speeds", Printed(CRITICAL_RPM, "r/min"), Verdict.REPRODUCED,
          lambda: computed(*(critical_speed_rpm(float(text)) for text in NATURAL_HZ)), of_printed=True),
    Entry(("section 3.1",), "working speeds below the first critical speed", Below("much higher than working speeds"),
          Verdict.REPRODUCED, lambda: computed(1000.0, 8625.6), of_printed=True),
    Entry(("section 3.2",), "first balancing: weight and its phase", Printed(("143.4", "115"), "g, deg"),
          Verdict.REPRODUCED, lambda: from_readings(correction, *FIRST, *TRIAL)),
    Entry(("section 3.2",), "reading left by 142.45 g at 120 deg", Printed(("0.37", "161"), "mm/s, deg"),
          Verdict.NEEDS_DATA, lambda: from_readings(after_correction, *FIRST, *TRIAL),
          f"{RECORDS} Computed is what the influence coefficient foretells."),
    Entry(("section 3.2",), "reduction of the amplitude", Printed(("70",), "%"), Verdict.REPRODUCED,
          lambda: from_readings(lambda left, first: (100.0 * (1.0 - left / first),), "0.37", "1.234"), of_printed=True),
    Entry(("section 3.2",), "grade that 0.37 mm/s meets", Printed(("0.4",), "mm/s"), Verdict.UNDER_READING,
          finest_grade, "With the reading on the bearing taken for the speed of the drum's centre of mass, which it is "
          "not: a grade needs the unbalance by the mass."),
    Entry(("section 3.2", "section 4"), "least phase to expect once 58.8 g at 240 deg are added",
          Printed(("161",), "deg"), Verdict.NOT_REPRODUCIBLE,
          lambda: from_readings(with_weight_added, *FIRST, *TRIAL, "0.37", "161"), "The paper adds the weight at its "
          "own phase. By its first balancing a weight shows at another phase than it is put at, and the phase to "
          "expect lies below 161 deg without any chain."),
    Entry(("section 3.2", "Fig. 6"), "phase measured then", Printed(("108",), "deg"), Verdict.NEEDS_DATA,
          lambda: from_readings(with_weight_added, *FIRST, *TRIAL, "0.37", "161"),
          f"{RECORDS} Computed is what the influence coefficient foretells."),
    Entry(("section 3.2",), "range of the trial weight", Printed(("82.03", "164"), "g"), Verdict.NEEDS_DATA, None,
          "The instrument's rule: the drum's mass and the radius of the weight."),
)  # fmt: skip
