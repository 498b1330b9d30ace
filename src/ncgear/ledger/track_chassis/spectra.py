"""Section 3.4: Table 5 and the frequencies that the text finds again in it."""

from __future__ import annotations

from ncgear.ledger.entry import Entry, Verdict
from ncgear.ledger.printed import Computed, Printed, of
from ncgear.ledger.track_chassis.frequencies import engine, of_kind

DRIVE_SHAFT_HZ = 1354.0 / 60.0

LINE_HZ = 2000.0 / 1024.0
"""Spacing of the spectrum's lines, of which all frequencies of Table 5 but one are whole multiples
(tests/test_ledger.py)."""


def on_a_line(frequency_hz: float) -> Computed:
    """A frequency as a spectrum shows it."""
    return Computed((frequency_hz,), (LINE_HZ / 2.0,))


NO_MULTIPLE = "No multiple of the shaft's frequency is within the spectrum's resolution."

ENTRIES = (
    Entry(
        ("Table 5",), "amplitudes and frequencies at nine points", Printed(("9.26", "17.53", "19.40"), "mm"),
        Verdict.NEEDS_DATA, None,
        "The records of the measurement; the text gives the same numbers in m/s2, the table in mm.",
    ),
    Entry(
        ("Table 5",), "frequency along x at the front of the chassis", Printed(("80.78",), "Hz"),
        Verdict.NOT_REPRODUCIBLE, lambda: of(round(80.78 / LINE_HZ) * LINE_HZ),
        "All other frequencies of the table are on lines of a spectrum of 1.95 Hz; this one is on none.",
    ),
    Entry(
        ("section 3.4",), "half the frequency of combustion", Printed(("39.06",), "Hz"), Verdict.UNDER_READING,
        lambda: on_a_line(engine("combustion") / 2.0), "The spectrum's lines are 1.95 Hz apart.",
    ),
    Entry(
        ("section 3.4",), "half the frequency of the rollers of the gear transmission", Printed(("48.83",), "Hz"),
        Verdict.UNDER_READING, lambda: on_a_line(of_kind("rollers")[5] / 2.0),
        "The spectrum's lines are 1.95 Hz apart.",
    ),
    Entry(
        ("section 3.4",), "4th multiple of the drive shaft's frequency", Printed(("87.89",), "Hz"),
        Verdict.NOT_REPRODUCIBLE, lambda: on_a_line(4.0 * DRIVE_SHAFT_HZ), NO_MULTIPLE,
    ),
    Entry(
        ("section 3.4",), "15th multiple of the drive shaft's frequency", Printed(("335.94",), "Hz"),
        Verdict.NOT_REPRODUCIBLE, lambda: on_a_line(15.0 * DRIVE_SHAFT_HZ), NO_MULTIPLE,
    ),
)  # fmt: skip
