"""Sections 2.5, 2.6 and 3.4, Table 5: the settings of the measurement, and the frequencies found in its spectra."""

from __future__ import annotations

from ncgear.papers.entry import Below, Computed, Entry, Printed, Verdict, computed, texts
from ncgear.papers.track_chassis.frequencies import engine, of_kind

DRIVE_SHAFT_HZ = 1354.0 / 60.0

SAMPLING_HZ, ANALYSIS_HZ = 2000.0, 781.25

LINE_HZ = SAMPLING_HZ / 1024.0
"""Spacing of the spectrum's lines, inferred: all frequencies of Table 5 but one are whole multiples of it, and of none
that is wider (tests/test_ledger.py).  The settings printed in sections 2.5 and 2.6 give other spacings."""

POINTS = ("1", "2", "3", "5", "6", "7", "10", "11", "12")
X, Y, Z = (
    (texts(frequencies), texts(amplitudes))
    for frequencies, amplitudes in (
        (
            "87.89 332.03 417.97 160.16 76.17 74.22 80.78 80.08 537.1",
            "9.26 1.11 0.51 0.68 0.13 0.15 0.60 0.48 0.57",
        ),
        ("87.89 5.86 27.34 80.08 80.08 78.13 80.08 80.08 80.08", "17.53 1.59 2.10 2.83 0.90 0.58 0.94 0.84 0.53"),
        (
            "335.94 13.67 27.34 80.08 80.08 156.25 525.39 748.05 80.08",
            "19.40 1.49 1.20 0.70 0.41 0.41 1.67 0.86 1.18",
        ),
    )
)
"""Table 5 along the three directions: frequencies in Hz and amplitudes at the points."""


def on_a_line(frequency_hz: float, spacing_hz: float = LINE_HZ) -> Computed:
    """A frequency, which a spectrum shows to half the spacing of its lines."""
    return Computed((frequency_hz,), (spacing_hz / 2.0,))


def strongest() -> Computed:
    """The largest amplitude along each direction, and the number of the point where it is."""
    largest = [max(zip(map(float, amplitudes), map(int, POINTS), strict=True)) for _, amplitudes in (X, Y, Z)]
    return computed(*(value for value, _ in largest), *(point for _, point in largest))


def near(wanted_hz: tuple[float, ...], points: tuple[str, ...]) -> Computed:
    """Number of frequencies at some points that are on the line of one of those wanted, or on the next half line."""
    found = [float(hz[POINTS.index(point)]) for hz, _ in (X, Y, Z) for point in points]
    return computed(sum(min(abs(one - other) for other in wanted_hz) <= LINE_HZ / 2.0 for one in found))


LINES = "The spectrum's lines are taken to be 1.95 Hz apart, which the frequencies of Table 5 tell and no setting does."
NO_MULTIPLE = "No multiple of the shaft's frequency is within the spectrum's resolution."

SETTINGS = (
    Entry(
        ("section 2.5",), "points measured, 4 at a time in 22 batches", Printed(("88",)), Verdict.REPRODUCED,
        lambda: computed(4.0 * 22.0), of_printed=True,
    ),
    Entry(
        ("section 2.5",), "channels of four sensors in three directions and of the hammer", Printed(("13",)),
        Verdict.REPRODUCED, lambda: computed(4.0 * 3.0 + 1.0), of_printed=True,
    ),
    Entry(
        ("section 2.5",), "highest frequency of the analysis, from sampling at 2 kHz", Printed(("781.25",), "Hz"),
        Verdict.UNDER_READING, lambda: computed(SAMPLING_HZ / 2.56), "By the factor 2.56 that analysers use.",
    ),
    Entry(
        ("section 2.5",), "lines to that frequency, from 512 points in time", Printed(("200",)), Verdict.REPRODUCED,
        lambda: computed(ANALYSIS_HZ * 512.0 / SAMPLING_HZ), "Lines 3.91 Hz apart.", of_printed=True,
    ),
    Entry(
        ("section 2.6",), "sampling at least twice as fast as the highest frequency", Below("at least twice"),
        Verdict.REPRODUCED, lambda: computed(2.0 * ANALYSIS_HZ, SAMPLING_HZ), of_printed=True,
    ),
    Entry(
        ("section 2.6",), "sampling at least five times as fast as the highest frequency", Below("5 to 10 times"),
        Verdict.NOT_REPRODUCIBLE, lambda: computed(5.0 * ANALYSIS_HZ, SAMPLING_HZ),
        "Table 5 goes up to 748.05 Hz, which 2 kHz samples 2.7 times.", of_printed=True,
    ),
)  # fmt: skip

FOUND = (
    Entry(
        ("Table 5", "section 3.4"), "largest amplitudes along x, y and z, and their points",
        Printed(("9.26", "17.53", "19.40", "1", "1", "1")), Verdict.REPRODUCED, strongest,
        "The text gives in m/s2 what the table gives in mm.", of_printed=True,
    ),
    Entry(
        ("Table 5",), "frequency along x at the front of the chassis", Printed(("80.78",), "Hz"),
        Verdict.NOT_REPRODUCIBLE, lambda: computed(round(80.78 / LINE_HZ) * LINE_HZ),
        f"All other frequencies of the table are on lines 1.95 Hz apart; this one is on none. {LINES}",
    ),
    Entry(
        ("section 3.4",), "half the frequency of combustion", Printed(("39.06",), "Hz"), Verdict.FITTED,
        lambda: on_a_line(engine("combustion") / 2.0), LINES,
    ),
    Entry(
        ("section 3.4",), "half the frequency of combustion, by the 8192 points of section 2.6",
        Printed(("39.06",), "Hz"), Verdict.NOT_REPRODUCIBLE,
        lambda: on_a_line(engine("combustion") / 2.0, SAMPLING_HZ / 8192.0), "Lines 0.24 Hz apart tell both apart.",
    ),
    Entry(
        ("section 3.4",), "frequency of combustion, said to be close", Printed(("74.22",), "Hz"),
        Verdict.NOT_REPRODUCIBLE, lambda: on_a_line(engine("combustion")), f"Three lines off. {LINES}",
    ),
    Entry(
        ("section 3.4",), "half the frequency of the rollers of the gear transmission", Printed(("48.83",), "Hz"),
        Verdict.FITTED, lambda: on_a_line(of_kind("rollers")[5] / 2.0),
        f"{LINES} Said to occur frequently; Table 5 does not have it.",
    ),
    Entry(
        ("section 3.4", "Table 5"), "4th multiple of the drive shaft's frequency", Printed(("87.89",), "Hz"),
        Verdict.NOT_REPRODUCIBLE, lambda: on_a_line(4.0 * DRIVE_SHAFT_HZ), NO_MULTIPLE,
    ),
    Entry(
        ("section 3.4", "Table 5"), "15th multiple of the drive shaft's frequency", Printed(("335.94",), "Hz"),
        Verdict.NOT_REPRODUCIBLE, lambda: on_a_line(15.0 * DRIVE_SHAFT_HZ), NO_MULTIPLE,
    ),
    Entry(
        ("section 3.4",), "frequencies at points 5 to 7 that are 80 or 160 Hz", Printed(("9",)),
        Verdict.NOT_REPRODUCIBLE, lambda: near((80.0, 160.0), ("5", "6", "7")),
        "To half a line of 1.95 Hz; 74.22, 76.17, 78.13 and 156.25 Hz are farther off.", of_printed=True,
    ),
    Entry(
        ("section 3.4",), "frequencies at the front of the chassis that are about 80 Hz", Printed(("3",)),
        Verdict.NOT_REPRODUCIBLE, lambda: near((80.0,), ("10",)), "Along z it is 525.39 Hz.", of_printed=True,
    ),
)  # fmt: skip
