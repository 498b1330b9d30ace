"""Sections 2.2 and 3.2: critical speeds, and the first balancing of the drum."""

from __future__ import annotations

from ncgear.balance.excitation import critical_speed_rpm
from ncgear.balance.rotor import GRADES_MM_S, TrialRun, balanced
from ncgear.papers.entry import Computed, Entry, Printed, Verdict, from_readings, of, texts
from ncgear.papers.readings import phase_deg, polar

NATURAL_HZ = texts("143.76 143.77 197.05 293.1 298.33 198.41")
CRITICAL_RPM = texts("8625.60 8626.20 11823 17586 17899.80 11904.60")

FIRST = ("1.234", "159")
"""Reading before balancing: amplitude in mm/s, phase in degrees."""

TRIAL = ("107.7", "90", "0.562", "204")
"""Weight in g at an angle in degrees, and the reading with it."""


def first_balancing() -> tuple[float, ...]:
    """All readings of the first balancing, as ``effect`` takes them."""
    return tuple(map(float, (*FIRST, *TRIAL)))


def effect(*readings: float) -> complex:
    """Change of the reading per g at 0 degrees, from the first reading and the trial run."""
    amplitude, phase, weight, angle, with_amplitude, with_phase = readings
    run = TrialRun(polar(weight, angle), (polar(with_amplitude, with_phase),))
    return complex(balanced([polar(amplitude, phase)], [run]).coefficients[0, 0])


def correction(*readings: float) -> tuple[float, ...]:
    """The weight in g that cancels the first reading, and its angle in degrees."""
    weight = -polar(*readings[:2]) / effect(*readings)
    return abs(weight), phase_deg(weight)


def after_correction(*readings: float) -> tuple[float, ...]:
    """Amplitude and phase left by the 142.45 g at 120 degrees that were put on."""
    left = polar(*readings[:2]) + effect(*readings) * polar(142.45, 120.0)
    return abs(left), phase_deg(left)


def with_weight_added(*readings: float) -> tuple[float, ...]:
    """Phase of the reading once 58.8 g at 240 degrees are added to the residual; the last two readings are that."""
    *known, amplitude, phase = readings
    return (phase_deg(polar(amplitude, phase) + effect(*known) * polar(58.8, 240.0)),)


def finest_grade() -> Computed:
    """The finest grade that a speed of the centre of mass of 0.37 mm/s meets."""
    return of(next(grade for grade in GRADES_MM_S if grade >= 0.37))


RECORDS = "The records of the measurement."
MODEL = "The drum's geometry and its finite-element model."

ENTRIES = (
    Entry(
        ("Table 2",), "natural frequencies", Printed(NATURAL_HZ, "Hz"), Verdict.NEEDS_DATA, None,
        f"{MODEL} The sixth is printed below the fourth and the fifth.",
    ),
    Entry(
        ("Table 2",), "critical speeds", Printed(CRITICAL_RPM, "r/min"), Verdict.REPRODUCED,
        lambda: of(*(critical_speed_rpm(float(text)) for text in NATURAL_HZ)),
    ),
    Entry(
        ("section 3.2",), "first balancing: weight and its phase", Printed(("143.4", "115"), "g, deg"),
        Verdict.REPRODUCED, lambda: from_readings(correction, *FIRST, *TRIAL),
    ),
    Entry(
        ("section 3.2",), "reading left by 142.45 g at 120 deg", Printed(("0.37", "161"), "mm/s, deg"),
        Verdict.NEEDS_DATA, lambda: from_readings(after_correction, *FIRST, *TRIAL),
        f"{RECORDS} Computed is what the influence coefficient foretells.",
    ),
    Entry(
        ("section 3.2",), "reduction of the amplitude", Printed(("70",), "%"), Verdict.REPRODUCED,
        lambda: from_readings(lambda left, first: (100.0 * (1.0 - left / first),), "0.37", "1.234"),
    ),
    Entry(
        ("section 3.2",), "grade that 0.37 mm/s meets", Printed(("0.4",), "mm/s"), Verdict.UNDER_READING, finest_grade,
        "With the reading on the bearing taken for the speed of the drum's centre of mass, which it is not: a grade "
        "needs the unbalance by the mass.",
    ),
    Entry(
        ("section 3.2", "section 4"), "least phase to expect once 58.8 g at 240 deg are added",
        Printed(("161",), "deg"), Verdict.NOT_REPRODUCIBLE,
        lambda: from_readings(with_weight_added, *FIRST, *TRIAL, "0.37", "161"),
        "The paper adds the weight at its own phase. By its first balancing a weight shows at another phase than it is "
        "put at, and the phase to expect lies below 161 deg without any chain.",
    ),
    Entry(
        ("section 3.2", "Fig. 6"), "phase measured then", Printed(("108",), "deg"), Verdict.NEEDS_DATA,
        lambda: from_readings(with_weight_added, *FIRST, *TRIAL, "0.37", "161"),
        f"{RECORDS} Computed is what the influence coefficient foretells.",
    ),
    Entry(
        ("section 3.2",), "range of the trial weight", Printed(("82.03", "164"), "g"), Verdict.NEEDS_DATA, None,
        "The instrument's rule: the drum's mass and the radius of the weight.",
    ),
)  # fmt: skip
