"""Sections 3.2.1 and 3.3, Tables 3 to 6: the equivalent unbalance of the chain drive, and what it predicts.

A reading with a weight is the sum of the chain's part and the weight's part, as complex numbers; the chain's part is
the sum of a tight and a slack side.  Each amplitude is known to lie within a range.
"""

from __future__ import annotations

from functools import cache
from math import cos, radians, sin

from ncgear.balance.rotor import (
    ChainPhases,
    ChainUnbalance,
    Prediction,
    Range,
    WeightRun,
    chain_unbalance,
    predicted,
)
from ncgear.papers.entry import Computed, Entry, Printed, Relation, Verdict, computed, equations, from_readings
from ncgear.papers.threshing_drum.first_balancing import RECORDS, measured_effect, phase_deg, polar

PHASES = ChainPhases(wrap_rad=radians(180.0), tight_rad=radians(105.0), slack_rad=radians(270.0))

RUNS = (
    (60.0, 0.426, 275.0),
    (120.0, 0.502, 135.0),
    (180.0, 0.382, 124.0),
    (240.0, 0.513, 173.0),
    (300.0, 0.483, 209.0),
    (360.0, 0.465, 256.0),
)
"""Table 3 at 700 r/min: phase of the weight in degrees, amplitude in mm/s and phase in degrees of the reading."""

PRINTED_RANGES = ChainUnbalance(Range(0.074, 0.214), Range(0.0, 2.04), Range(0.0, 2.58))
"""Ranges of the amplitudes of weight, tight side and slack side in mm/s."""


@cache
def ranges() -> ChainUnbalance:
    """The ranges computed from the readings."""
    runs = [WeightRun(radians(weight), polar(amplitude, phase)) for weight, amplitude, phase in RUNS]
    return chain_unbalance(runs, PHASES)


# --- section 3.2.1, eqs. 1 to 7: the ranges of weight, tight and slack side from the readings -----------------------

WEIGHT_G = 161.3


def sides_residual() -> Computed:
    """Eqs. 3 to 6: what both sides at their phases add up to, against the chain's part, by the larger side."""
    worst = []
    for weight, amplitude, phase in RUNS:
        chain = polar(amplitude, phase) - polar(PRINTED_RANGES.weight.high, weight)
        tight = chain.real / -sin(radians(15.0))
        slack = -chain.imag + tight * cos(radians(15.0))
        both = tight * polar(1.0, 105.0) + slack * polar(1.0, 270.0)
        worst.append(abs(both - chain) / max(abs(tight), abs(slack)))
    return computed(*worst)


def second_case_residual() -> Computed:
    """The second case of eq. 7 at 240 deg against the weight's vector, y counted downwards."""
    angle = radians(240.0)
    return computed(abs(complex(sin(angle), -cos(angle)) - complex(cos(angle), -sin(angle))))


def vector(phase_deg: float) -> Computed:
    """A weight's vector of length 1."""
    along = polar(1.0, phase_deg)
    return computed(along.real, along.imag)


RANGES = (
    Entry(
        ("Table 3", "Table 4", "Table 5"), "readings at 600 to 1000 r/min, for example with the weight at 60 deg",
        Printed(("0.426", "275"), "mm/s, deg"), Verdict.NEEDS_DATA, None, RECORDS,
    ),
    Entry(
        (*equations("1"), "Table 3", "Fig. 9"), "range of the weight's amplitude, at 700 r/min",
        Printed(("0.074", "0.214"), "mm/s"), Verdict.REPRODUCED,
        lambda: computed(ranges().weight.low, ranges().weight.high),
    ),
    Entry(
        ("section 3.2.1",), "largest amplitude of the weight's 161.3 g, by the effect that the first balancing found",
        Printed(("0.214",), "mm/s"), Verdict.NEEDS_DATA, lambda: computed(WEIGHT_G * measured_effect()),
        "The radii of the weights. Computed for equal radii, at the same speed.",
    ),
    Entry(
        ("section 3.2.1",), "vector of the weight at 300 deg, by its length", Printed(("-0.5", "0.87")),
        Verdict.NOT_REPRODUCIBLE, lambda: vector(300.0), "Printed is the vector at 120 deg, of the opposite sense.",
    ),
    Entry(
        equations("3", "4", "5", "6"), "both sides of the chain from the chain's part", Relation(),
        Verdict.UNDER_READING, sides_residual, "With y counted downwards.",
    ),
    Entry(
        equations("7"), "vector of a weight between 180 and 270 deg", Relation(), Verdict.NOT_REPRODUCIBLE,
        second_case_residual, "Sine and cosine have changed places; the first case holds there as well.",
    ),
    Entry(
        equations("6"), "largest amplitude of the tight side", Printed(("2.04",), "mm/s"), Verdict.REPRODUCED,
        lambda: computed(ranges().tight.high),
    ),
    Entry(
        equations("6"), "largest amplitude of the slack side", Printed(("2.58",), "mm/s"), Verdict.NOT_REPRODUCIBLE,
        lambda: computed(ranges().slack.high),
        "The readings of Table 3 give less, at the same weight as the tight side's.",
    ),
)  # fmt: skip

# --- section 3.3, eqs. 10 to 13, Table 6: what the ranges predict, and how the predictions fare ---------------------

WEIGHT, TIGHT, SLACK = PRINTED_RANGES.weight, PRINTED_RANGES.tight, PRINTED_RANGES.slack


@cache
def prediction(weight_deg: float) -> Prediction:
    """Bounds of the reading with the weight at a phase in degrees, from the printed ranges."""
    return predicted(PRINTED_RANGES, PHASES, radians(weight_deg))


def corners(weight_deg: float) -> tuple[float, float, float, float]:
    """Eqs. 10 to 13: least and largest x and y in mm/s, y downwards, each by the printed ranges on its own."""
    along, down = cos(radians(weight_deg)), -sin(radians(weight_deg))
    xs = sorted(along * end for end in (WEIGHT.low, WEIGHT.high))
    ys = sorted(down * end for end in (WEIGHT.low, WEIGHT.high))
    tight = TIGHT.high * sin(radians(15.0)), TIGHT.high * cos(radians(15.0))
    return xs[0] - tight[0], xs[1], ys[0] - tight[1], ys[1] + SLACK.high


def lowest_corner(weight_deg: float) -> Computed:
    """Amplitude and phase of the corner where x and y are both least."""
    x, _, y, _ = corners(weight_deg)
    return computed(abs(complex(x, -y)), phase_deg(complex(x, -y)))


def by_slack(weight_deg: float) -> Computed:
    """Amplitude and phase with slack side and weight at their largest, without the tight side."""
    bound = prediction(weight_deg).by_slack
    return computed(abs(bound), phase_deg(bound))


def errors(*rows: tuple[str, str, str]) -> Computed:
    """Of each row, the first reading minus the second in percent of the third, which is one of them."""
    found = [from_readings(lambda one, other, base: (100.0 * (one - other) / base,), *row) for row in rows]
    return Computed(tuple(one.values[0] for one in found), tuple(one.leeway[0] for one in found))


CORNER = "A corner of the ranges: x with the weight at one end of its range, y with it at the other."
NO_RULE = "A phase within the range is taken; the rule is not given."

PREDICTED = (
    Entry(
        equations("10", "11"), "ends of x and y with the weight at 30 deg",
        Printed(("0.185", "-2.08", "2.543"), "mm/s"), Verdict.REPRODUCED, lambda: computed(*corners(30.0)[1:]),
    ),
    Entry(
        equations("11"), "lower end of x", Printed(("-0.434",), "mm/s"), Verdict.NOT_REPRODUCIBLE,
        lambda: computed(corners(30.0)[0]),
        "The bound printed below it follows from the computed end, not from this one.",
    ),
    Entry(
        equations("12", "13"), "ends of x and y with the weight at 270 deg",
        Printed(("-0.528", "0", "-1.9", "2.794"), "mm/s"), Verdict.UNDER_READING, lambda: computed(*corners(270.0)),
        "With the weight's vector as eq. 7 has it; eq. 12 has its y of the other sign.",
    ),
    Entry(
        ("section 3.3",), "weight at 30 deg: bound by the tight side", Printed(("2.13", "103"), "mm/s, deg"),
        Verdict.UNDER_READING, lambda: lowest_corner(30.0), CORNER,
    ),
    Entry(
        ("section 3.3",), "weight at 270 deg: bound by the tight side", Printed(("1.97", "106"), "mm/s, deg"),
        Verdict.UNDER_READING, lambda: lowest_corner(270.0), CORNER,
    ),
    Entry(
        ("section 3.3",), "weight at 30 deg: bound by the slack side", Printed(("2.48", "274"), "mm/s, deg"),
        Verdict.REPRODUCED, lambda: by_slack(30.0),
    ),
    Entry(
        ("section 3.3",), "weight at 270 deg: bound by the slack side", Printed(("2.79", "270"), "mm/s, deg"),
        Verdict.REPRODUCED, lambda: by_slack(270.0),
    ),
    Entry(
        ("Table 6", "section 3.3"), "amplitudes foretold", Printed(("1.24", "1.4"), "mm/s"), Verdict.REPRODUCED,
        lambda: computed(prediction(30.0).amplitude, prediction(270.0).amplitude),
    ),
    Entry(
        ("Table 6", "section 3.3"), "phases foretold", Printed(("270", "120"), "deg"), Verdict.NEEDS_DATA, None, NO_RULE
    ),
    Entry(
        ("section 3.3",), "angles of the corrections", Printed(("90", "300"), "deg"), Verdict.REPRODUCED,
        lambda: computed((270.0 + 180.0) % 360.0, 120.0 + 180.0),
    ),
    Entry(
        ("section 3.3",), "correction of 1.24 mm/s", Printed(("152.3",), "g"), Verdict.NEEDS_DATA,
        lambda: computed(1.24 / measured_effect()),
        "The effect of a weight at 500 r/min. Computed with that of the first balancing at 700 r/min.",
    ),
    Entry(
        ("section 3.3",), "correction of 1.4 mm/s", Printed(("165.8",), "g"), Verdict.NEEDS_DATA,
        lambda: computed(1.4 / measured_effect()),
        "The effect of a weight at 500 r/min. Computed with that of the first balancing at 700 r/min.",
    ),
)  # fmt: skip

COMPARED = (
    Entry(
        ("Table 6",), "readings before and after balancing, hole 1 and 30 deg",
        Printed(("1.587", "286", "0.731", "329"), "mm/s, deg"), Verdict.NEEDS_DATA, None, RECORDS,
    ),
    Entry(
        ("Table 6",), "errors of the amplitude at 30 deg", Printed(("21.87", "16.6"), "%"), Verdict.REPRODUCED,
        lambda: errors(("1.587", "1.24", "1.587"), ("1.487", "1.24", "1.487")),
    ),
    Entry(
        ("Table 6",), "errors of the amplitude at 270 deg", Printed(("9.7", "32.64"), "%"), Verdict.UNDER_READING,
        lambda: errors(("1.4", "1.264", "1.4"), ("1.4", "0.943", "1.4")),
        "By the foretold, not by the measured amplitude.",
    ),
    Entry(
        ("Table 6", "section 4"), "largest error of the amplitude, by the measured one as at 30 deg",
        Printed(("32.64",), "%"), Verdict.NOT_REPRODUCIBLE, lambda: errors(("1.4", "0.943", "0.943")),
        "The divisor changes from one half of the table to the other.",
    ),
    Entry(
        ("Table 6",), "errors of the phase", Printed(("5.6", "4.6", "18.9", "20"), "%"), Verdict.UNDER_READING,
        lambda: errors(("286", "270", "286"), ("283", "270", "283"), ("148", "120", "148"), ("150", "120", "150")),
        "By the measured phase, so that they depend on where phases count from.",
    ),
    Entry(
        ("section 4",), "amplitudes foretold that are not below the measured ones", Printed(("0",)),
        Verdict.NOT_REPRODUCIBLE, lambda: computed(sum(measured < 1.4 for measured in (1.264, 0.943))),
        "At 270 deg both are above.",
    ),
    Entry(
        ("section 4",), "amplitudes that balancing took off", Printed(("0.856", "0.674"), "mm/s"), Verdict.REPRODUCED,
        lambda: from_readings(lambda *r: (r[0] - r[1], r[2] - r[3]), "1.587", "0.731", "1.264", "0.59"),
    ),
)  # fmt: skip

ENTRIES = (*RANGES, *PREDICTED, *COMPARED)
