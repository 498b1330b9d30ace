"""Sections 2.5, 2.6, 3.4 and 3.5, Tables 5 to 7: settings of the measurements, spectra, and the track's movement."""

from __future__ import annotations

from functools import partial

from ncgear.frozen import dataclass
from ncgear.papers.entry import Below, Computed, Entry, Finding, Printed, computed, half_step, printed, texts
from ncgear.papers.track_chassis.slider import engine, of_kind

DRIVE_SHAFT_HZ = 1354.0 / 60.0

SAMPLING_HZ, ANALYSIS_HZ = 2000.0, 781.25

LINE_HZ = SAMPLING_HZ / 1024.0
"""Spacing of the spectrum's lines, inferred: all frequencies of Table 5 but one are whole multiples of it, and no wider
spacing has this property (tests/test_ledger.py).  The settings printed in sections 2.5 and 2.6 give other spacings."""

POINTS = ("1", "2", "3", "5", "6", "7", "10", "11", "12")
X = (
    texts("87.89 332.03 417.97 160.16 76.17 74.22 80.78 80.08 537.1"),
    texts("9.26 1.11 0.51 0.68 0.13 0.15 0.60 0.48 0.57"),
)
Y = (
    texts("87.89 5.86 27.34 80.08 80.08 78.13 80.08 80.08 80.08"),
    texts("17.53 1.59 2.10 2.83 0.90 0.58 0.94 0.84 0.53"),
)
Z = (
    texts("335.94 13.67 27.34 80.08 80.08 156.25 525.39 748.05 80.08"),
    texts("19.40 1.49 1.20 0.70 0.41 0.41 1.67 0.86 1.18"),
)
"""Table 5 along the three directions: frequencies in Hz and amplitudes at the points."""


def on_a_line(frequency_hz: float, spacing_hz: float = LINE_HZ) -> Computed:
    """A frequency, with half the spacing of the lines as its rounding."""
    return Computed((frequency_hz,), (spacing_hz / 2.0,))


def strongest() -> Computed:
    """The largest amplitude along each direction, and the number of its point."""
    largest = [max(zip(map(float, amplitudes), map(int, POINTS), strict=True)) for _, amplitudes in (X, Y, Z)]
    return computed(*(value for value, _ in largest), *(point for _, point in largest))


def near(wanted_hz: tuple[float, ...], points: tuple[str, ...]) -> Computed:
    """Number of frequencies at some points that are within half a line of one of the wanted frequencies."""
    found = [float(hz[POINTS.index(point)]) for hz, _ in (X, Y, Z) for point in points]
    return computed(sum(min(abs(one - other) for other in wanted_hz) <= LINE_HZ / 2.0 for one in found))


LINES = "The spectrum's lines are taken to be 1.95 Hz apart, which the frequencies of Table 5 tell and no setting does."
NO_MULTIPLE = "No multiple of the shaft's frequency is within the spectrum's resolution."

SETTINGS = (
    Entry("section 2.5", "points measured, 4 at a time in 22 batches", printed("88"), Finding.REPRODUCED,
          lambda: 4.0 * 22.0, of_printed=True),
    Entry("section 2.5", "channels of four sensors in three directions and of the hammer", printed("13"),
          Finding.REPRODUCED, lambda: 4.0 * 3.0 + 1.0, of_printed=True),
    Entry("section 2.5", "highest frequency of the analysis, from sampling at 2 kHz", printed("781.25 Hz"),
          Finding.UNDER_READING, lambda: SAMPLING_HZ / 2.56, "By the factor 2.56 that analysers use."),
    Entry("section 2.5", "lines to that frequency, from 512 points in time", printed("200"), Finding.REPRODUCED,
          lambda: ANALYSIS_HZ * 512.0 / SAMPLING_HZ, "Lines 3.91 Hz apart.", of_printed=True),
    Entry("section 2.6", "sampling at least twice as fast as the highest frequency", Below("at least twice"),
          Finding.REPRODUCED, lambda: (2.0 * ANALYSIS_HZ, SAMPLING_HZ), of_printed=True),
    Entry("section 2.6", "sampling at least five times as fast as the highest frequency", Below("5 to 10 times"),
          Finding.NOT_REPRODUCIBLE, lambda: (5.0 * ANALYSIS_HZ, SAMPLING_HZ),
          "Table 5 goes up to 748.05 Hz, which 2 kHz samples 2.7 times.", of_printed=True),
)  # fmt: skip

FOUND = (
    Entry("Table 5, section 3.4", "largest amplitudes along x, y and z, and their points",
          printed("9.26 17.53 19.40 1 1 1"), Finding.REPRODUCED, strongest, "The text gives in m/s2 what the table "
          "gives in mm.", of_printed=True),
    Entry("Table 5", "frequency along x at the front of the chassis", printed("80.78 Hz"), Finding.NOT_REPRODUCIBLE,
          lambda: round(80.78 / LINE_HZ) * LINE_HZ, "All other frequencies of the table are on lines 1.95 Hz apart; "
          f"this one is on none. {LINES}"),
    Entry("section 3.4", "half the frequency of combustion", printed("39.06 Hz"), Finding.FITTED,
          lambda: on_a_line(engine("combustion") / 2.0), LINES),
    Entry("section 3.4", "half the frequency of combustion, by the 8192 points of section 2.6", printed("39.06 Hz"),
          Finding.NOT_REPRODUCIBLE, lambda: on_a_line(engine("combustion") / 2.0, SAMPLING_HZ / 8192.0),
          "Lines 0.24 Hz apart tell both apart."),
    Entry("section 3.4", "frequency of combustion, said to be close", printed("74.22 Hz"), Finding.NOT_REPRODUCIBLE,
          lambda: on_a_line(engine("combustion")), f"Three lines off. {LINES}"),
    Entry("section 3.4", "half the frequency of the rollers of the gear transmission", printed("48.83 Hz"),
          Finding.FITTED, lambda: on_a_line(of_kind("rollers")[5] / 2.0), f"{LINES} Said to occur frequently; Table 5 "
          "does not have it."),
    Entry("section 3.4, Table 5", "4th multiple of the drive shaft's frequency", printed("87.89 Hz"),
          Finding.NOT_REPRODUCIBLE, lambda: on_a_line(4.0 * DRIVE_SHAFT_HZ), NO_MULTIPLE),
    Entry("section 3.4, Table 5", "15th multiple of the drive shaft's frequency", printed("335.94 Hz"),
          Finding.NOT_REPRODUCIBLE, lambda: on_a_line(15.0 * DRIVE_SHAFT_HZ), NO_MULTIPLE),
    Entry("section 3.4", "frequencies at points 5 to 7 that are 80 or 160 Hz", printed("9"), Finding.NOT_REPRODUCIBLE,
          lambda: near((80.0, 160.0), ("5", "6", "7")), "To half a line of 1.95 Hz; 74.22, 76.17, 78.13 and 156.25 Hz "
          "are farther off.", of_printed=True),
    Entry("section 3.4", "frequencies at the front of the chassis that are about 80 Hz", printed("3"),
          Finding.NOT_REPRODUCIBLE, lambda: near((80.0,), ("10",)), "Along z it is 525.39 Hz.", of_printed=True),
)  # fmt: skip

# --- section 3.5, Tables 6 and 7: the movement of the track beam --------------------------------------------------


@dataclass(frozen=True)
class Readings:
    """Largest displacements upwards and downwards in mm at the sixteen points, as printed."""

    up: tuple[str, ...]
    down: tuple[str, ...]

    def combined(self, up: float, down: float) -> Computed:
        """Sum of both columns with factors, and by how much their rounding may move it."""
        pairs = list(zip(self.up, self.down, strict=True))
        values = tuple(up * float(one) + down * float(other) for one, other in pairs)
        return Computed(values, tuple(abs(up) * half_step(one) + abs(down) * half_step(other) for one, other in pairs))

    @property
    def peaks(self) -> tuple[float, ...]:
        """Peak to peak in mm at the sixteen points."""
        return self.combined(1.0, -1.0).values

    def steadiest(self, count: int) -> Computed:
        """Numbers of the points that move least, in their order."""
        return computed(*sorted(sorted(range(1, 17), key=lambda point: self.peaks[point - 1])[:count]))

    @property
    def largest(self) -> Computed:
        """The largest displacement in mm, up or down."""
        return computed(max(abs(float(text)) for text in (*self.up, *self.down)))


WITHOUT = Readings(
    texts("4.9 1.85 1.43 1.34 0.97 0.85 1.04 1.77 2.14 3.27 4.81 4.78 5.54 6.62 6.4 7.4"),
    texts("-3.86 -2.77 -2.42 -2.12 -1.4 -1.2 -1.42 -2.81 -2.51 -3.7 -4.67 -4.97 -5.74 -6.69 -6.32 -7.56"),
)
MADE_WITHOUT = (
    texts("8.76 4.62 3.85 3.46 2.37 2.05 2.46 4.58 4.65 6.97 9.48 9.75 11.28 13.31 12.72 14.96"),
    texts("4.38 2.31 1.925 1.73 1.185 1.025 1.23 2.29 2.325 3.485 4.74 4.875 5.64 6.655 6.36 7.48"),
    texts("1.04 -0.92 -0.99 -0.78 -0.43 -0.35 -0.38 -1.04 -0.37 -0.43 0.14 -0.19 -0.2 -0.07 0.08 -0.16"),
)

WITH = Readings(
    texts("0.09 0.05 0.07 0.11 0.07 0.07 0.06 0.25 0.42 0.44 0.18 0.56 0.23 0.14 0.09 0.12"),
    texts("-0.07 -0.07 -0.05 -0.09 -0.07 -0.07 -0.08 -0.18 -0.47 -0.47 -0.17 -0.55 -0.30 -0.21 -0.11 -0.17"),
)
MADE_WITH = (
    texts("0.16 0.13 0.12 0.20 0.14 0.14 0.13 0.43 0.88 0.91 0.35 1.11 0.53 0.35 0.20 0.30"),
    texts("0.08 0.06 0.06 0.10 0.07 0.07 0.07 0.21 0.44 0.46 0.17 0.56 0.27 0.17 0.10 0.15"),
    texts("0.02 -0.02 0.02 0.02 0.00 0.01 -0.02 0.07 -0.05 -0.03 0.00 0.00 -0.08 -0.07 -0.03 -0.05"),
)
MADE = {"peak to peak": (1.0, -1.0), "means of up and down": (0.5, -0.5), "differences of up and down": (1.0, 1.0)}
"""The columns that the paper makes from the readings, with the factors of up and down."""


MOVEMENT = (
    *(
        Entry(place, what, Printed(column, "mm"), Finding.REPRODUCED, partial(readings.combined, *factors),
              of_printed=True)
        for place, readings, columns in (("Table 6", WITHOUT, MADE_WITHOUT), ("Table 7", WITH, MADE_WITH))
        for (what, factors), column in zip(MADE.items(), columns, strict=True)
    ),
    Entry("Fig. 16, section 3.5", "point that moves least", printed("6"), Finding.REPRODUCED,
          lambda: WITHOUT.steadiest(1), of_printed=True),
    Entry("Fig. 16, section 3.5, section 4", "points that move least", printed("4 5 6"), Finding.NOT_REPRODUCIBLE,
          lambda: WITHOUT.steadiest(3), "Point 7 with 2.46 mm moves less than point 4 with 3.46 mm.", of_printed=True),
    Entry("section 3.5", "both ends move more than the points 4 to 6", Below("much larger at the ends"),
          Finding.REPRODUCED,
          lambda: (*(value for end in (0, 15) for value in (max(WITHOUT.peaks[3:6]), WITHOUT.peaks[end])),),
          of_printed=True),
    Entry("section 3.5", "largest amplitude without the weight", printed("7.40 mm"), Finding.NOT_REPRODUCIBLE,
          lambda: WITHOUT.largest, "7.4 mm is the largest upwards; downwards Table 6 has 7.56 mm.", of_printed=True),
    Entry("section 3.5", "largest amplitude with the weight", printed("0.56 mm"), Finding.REPRODUCED,
          lambda: WITH.largest, of_printed=True),
    Entry("section 3.5", "less movement with the weight than without, at every point", Below("obviously decreased"),
          Finding.REPRODUCED,
          lambda: (*(peak for pair in zip(WITH.peaks, WITHOUT.peaks, strict=True) for peak in pair),), of_printed=True),
    Entry("section 3.5", "points 1 to 7 move less than points 8 to 14 with the weight", Below("grounded at 1 to 7"),
          Finding.REPRODUCED, lambda: (max(WITH.peaks[:7]), min(WITH.peaks[7:14])),
          "What is called tiny at points 8 to 14 is the largest that is left.", of_printed=True),
    Entry("section 4", "vibration left at the point that moves most", printed("0 mm"), Finding.NOT_REPRODUCIBLE,
          lambda: max(WITH.peaks), "Said to be gone completely; Table 7 says otherwise.", of_printed=True),
)  # fmt: skip
