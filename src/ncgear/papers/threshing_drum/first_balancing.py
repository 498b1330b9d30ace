"""Sections 2.2, 3.1 and 3.2, Tables 2 to 5: critical speeds, the first balancing, and readings with weights elsewhere.

Readings and weights are complex numbers: amplitude or mass times exp(i phase).
"""

from __future__ import annotations

from cmath import phase, rect
from itertools import pairwise
from math import degrees, radians

from ncgear.balance.excitation import critical_speed_rpm
from ncgear.balance.rotor import GRADES_MM_S, TrialRun, balanced
from ncgear.papers.entry import (
    Below,
    Computed,
    Entry,
    Finding,
    LeftOut,
    Printed,
    Reason,
    computed,
    from_readings,
    printed,
    texts,
)

NATURAL_HZ = texts("143.76 143.77 197.05 293.1 298.33 198.41")
CRITICAL_RPM = texts("8625.60 8626.20 11823 17586 17899.80 11904.60")

FIRST = ("1.234", "159")
"""Reading before balancing: amplitude in mm/s, phase in degrees."""

TRIAL = ("107.7", "90", "0.562", "204")
"""Trial weight in g and its angle in degrees, then the reading with it."""


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
    """Amplitude and phase that should remain with 142.45 g added at 120 degrees."""
    left = polar(*readings[:2]) + effect(*readings) * polar(142.45, 120.0)
    return abs(left), phase_deg(left)


def with_weight_added(*readings: float) -> tuple[float, ...]:
    """Phase of the reading once 58.8 g at 240 degrees are added; the last two readings are the reading before."""
    *known, amplitude, phase = readings
    return (phase_deg(polar(amplitude, phase) + effect(*known) * polar(58.8, 240.0)),)


RECORDS = "The records of the measurement."
MODEL = "The drum's geometry and its finite-element model."

ENTRIES = (
    Entry("Table 2, section 3.1", "natural frequencies", Printed(NATURAL_HZ, "Hz"), Finding.NEEDS_DATA, None,
          f"{MODEL} The sixth is printed below the fourth and the fifth."),
    Entry("Table 2, section 3.1", "critical speeds", Printed(CRITICAL_RPM, "r/min"), Finding.REPRODUCED,
          lambda: (*(critical_speed_rpm(float(text)) for text in NATURAL_HZ),), of_printed=True),
    Entry("section 3.1", "working speeds below the first critical speed", Below("much higher than working speeds"),
          Finding.REPRODUCED, lambda: (1000.0, 8625.6), of_printed=True),
    Entry("section 3.2", "first balancing: weight and its phase", printed("143.4 115 g, deg"), Finding.REPRODUCED,
          lambda: from_readings(correction, *FIRST, *TRIAL)),
    Entry("section 3.2", "reading left by 142.45 g at 120 deg", printed("0.37 161 mm/s, deg"), Finding.NEEDS_DATA,
          lambda: from_readings(after_correction, *FIRST, *TRIAL), f"{RECORDS} Computed is what the influence "
          "coefficient foretells."),
    Entry("section 3.2", "reduction of the amplitude", printed("70 %"), Finding.REPRODUCED,
          lambda: from_readings(lambda left, first: (100.0 * (1.0 - left / first),), "0.37", "1.234"), of_printed=True),
    Entry("section 3.2", "grade that 0.37 mm/s meets", printed("0.4 mm/s"), Finding.UNDER_READING,
          lambda: next(grade for grade in GRADES_MM_S if grade >= 0.37), "With the reading on the bearing taken for "
          "the speed of the drum's centre of mass, which it is not: a grade needs the unbalance by the mass."),
    Entry("section 3.2, section 4", "least phase to expect once 58.8 g at 240 deg are added", printed("161 deg"),
          Finding.NOT_REPRODUCIBLE, lambda: from_readings(with_weight_added, *FIRST, *TRIAL, "0.37", "161"),
          "The paper adds the weight at its own phase. By its first balancing a weight shows at another phase than it "
          "is put at, and the phase to expect lies below 161 deg without any chain."),
    Entry("section 3.2, Fig. 6", "phase measured then", printed("108 deg"), Finding.NEEDS_DATA,
          lambda: from_readings(with_weight_added, *FIRST, *TRIAL, "0.37", "161"),
          f"{RECORDS} Computed is what the influence coefficient foretells."),
    Entry("section 3.2", "range of the trial weight", printed("82.03 164 g"), Finding.NEEDS_DATA, None,
          "The instrument's rule: the drum's mass and the radius of the weight."),
)  # fmt: skip


SPEEDS_RPM = (600, 700, 800, 900, 1000)

BY_PHASE = (
    texts("0.532 222 0.431 146 0.220 135 0.383 181 0.631 186 0.618 214"),
    texts("0.426 275 0.502 135 0.382 124 0.513 173 0.483 209 0.465 256"),
    texts("0.486 319 0.735 127 0.538 102 0.972 161 0.661 219 0.622 268"),
    texts("1.160 27 1.869 121 2.028 114 1.487 159 1.271 180 0.861 341"),
    texts("1.716 35 2.662 112 2.868 123 2.725 149 1.863 163 1.094 30"),
)
"""Table 3: a row for each speed, amplitude and phase with the weight at 60, 120, ... 360 degrees."""

BY_HOLE = {
    90: (
        texts("0.196 0.461 0.586 1.665 2.577"), texts("0.179 0.492 0.632 1.952 2.399"),
        texts("0.177 0.374 0.784 1.905 2.207"), texts("0.129 0.631 0.764 1.391 2.32"),
        texts("0.089 0.517 0.739 1.874 2.232"), texts("0.232 0.657 0.954 2.011 4.452"),
        texts("0.190 0.697 1.166 2.533 3.459"), texts("0.142 0.656 0.981 3.109 3.416"),
        texts("0.155 0.450 1.067 2.351 3.753"), texts("0.158 0.639 1.218 2.907 3.360"),
    ),
    150: (
        texts("0.545 0.903 1.98 1.476 2.489"), texts("0.619 1.222 1.844 3.030 4.337"),
        texts("0.407 1.518 2.356 3.969 4.911"), texts("0.416 1.728 1.825 3.782 4.367"),
        texts("0.782 1.478 2.704 4.157 4.760"), texts("0.601 1.314 2.212 3.225 3.992"),
        texts("0.287 1.33 2.478 3.886 7.084"), texts("0.477 1.543 1.778 3.475 4.615"),
        texts("0.467 1.807 2.343 3.527 4.456"), texts("0.366 0.757 2.814 3.419 4.980"),
    ),
    210: (
        texts("0.379 0.590 0.935 2.274 2.403"), texts("0.334 0.446 1.112 1.467 2.915"),
        texts("0.415 0.481 0.733 1.744 2.565"), texts("0.302 0.350 0.647 1.353 2.073"),
        texts("0.439 0.383 0.673 1.739 1.909"), texts("0.278 0.317 0.501 1.182 2.129"),
        texts("0.296 0.307 0.490 1.530 1.965"), texts("0.233 0.232 0.813 1.301 1.915"),
        texts("0.263 0.291 0.545 1.149 2.183"), texts("0.195 0.262 0.500 1.540 1.983"),
    ),
}  # fmt: skip
"""Table 4: by the phase of the rack bar in degrees, a row for each of the ten holes, a column for each speed."""

SPIRAL = (texts("0.216 163"), texts("0.234 20"), texts("3.378 59"), texts("4.122 67"), texts("5.624 102"))
"""Table 5: amplitude and phase at each speed."""


def at(bar_deg: int, speed_rpm: int) -> tuple[float, ...]:
    """Amplitudes of Table 4 on one rack bar at one speed, in the order of the holes."""
    column = SPEEDS_RPM.index(speed_rpm)
    return tuple(float(row[column]) for row in BY_HOLE[bar_deg])


def growth_with_speed() -> Computed:
    """For each hole, the amplitude at a speed and the amplitude at the next speed."""
    rows = [list(map(float, row)) for bar in BY_HOLE.values() for row in bar]
    return computed(*(value for row in rows for pair in pairwise(row) for value in pair))


def front_and_rear() -> Computed:
    """Mean amplitudes with the weight in holes 1 to 5 and in holes 6 to 10, on each bar at 900 and 1000 r/min."""
    found = [at(bar, speed) for bar in BY_HOLE for speed in (900, 1000)]
    return computed(*(mean for readings in found for mean in (sum(readings[:5]) / 5.0, sum(readings[5:]) / 5.0)))


def spread_of_holes() -> Computed:
    """For each bar, the largest ratio of largest to least amplitude of its holes, below 800 r/min and above."""

    def quotient(bar: int, *speeds_rpm: int) -> float:
        return max(max(at(bar, speed)) / min(at(bar, speed)) for speed in speeds_rpm)

    return computed(*(value for bar in BY_HOLE for value in (quotient(bar, 600, 700), quotient(bar, 900, 1000))))


def single_and_spiral() -> Computed:
    """The largest amplitude of a single weight in Tables 3 and 4 at each speed, and the spiral's amplitude."""
    pairs = []
    for row, speed in enumerate(SPEEDS_RPM):
        single = [max(map(float, BY_PHASE[row][::2])), *(max(at(bar, speed)) for bar in BY_HOLE)]
        pairs += [max(single), float(SPIRAL[row][0])]
    return computed(*pairs)


OF_READINGS = (
    Entry("Table 4, section 3.2.2", "amplitude grows with the speed, from each speed to the next",
          Below("the higher the speed the greater"), Finding.NOT_REPRODUCIBLE, growth_with_speed,
          "At a few holes it falls.", of_printed=True),
    Entry("Table 4, section 3.2.2", "weights in holes 6 to 10 show more than in holes 1 to 5, at 900 and 1000 r/min",
          Below("significant increase"), Finding.NOT_REPRODUCIBLE, front_and_rear,
          "Means of five holes. On the bar at 210 deg it is the other way round.", of_printed=True),
    Entry("Table 4, section 3.2.2", "hole matters less below 800 r/min than above: largest by least amplitude",
          Below("little effect"), Finding.NOT_REPRODUCIBLE, spread_of_holes,
          "As a share of the amplitude the holes differ no less below; in mm/s they do, since the amplitude is less.",
          of_printed=True),
    Entry("Table 5, section 3.2.3", "spiral of weights shows more than any single weight", Below("much larger"),
          Finding.NOT_REPRODUCIBLE, single_and_spiral, "Only at 800 r/min.", of_printed=True),
    Entry("Table 5, section 3.2.3", "amplitude of the spiral grows tenfold from 700 to 800 r/min",
          Below("increases rapidly"), Finding.REPRODUCED, lambda: (10.0 * 0.234, 3.378), of_printed=True),
)  # fmt: skip

LEFT_OUT = (
    LeftOut("Table 3", "amplitudes and phases at five speeds", Reason.MEASURED,
            tuple(text for row in BY_PHASE for text in row)),
    LeftOut("Table 4", "amplitudes for ten holes of three rack bars at five speeds", Reason.MEASURED,
            tuple(text for bar in BY_HOLE.values() for row in bar for text in row)),
    LeftOut("Table 5", "amplitudes and phases at five speeds", Reason.MEASURED,
            tuple(text for row in SPIRAL for text in row)),
)  # fmt: skip
