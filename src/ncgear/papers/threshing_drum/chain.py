"""Sections 3.2.1 and 3.3, Tables 3 to 6: the equivalent unbalance of the chain drive, and its predictions.

A reading with a weight is the sum of the chain's part and the weight's part, as complex numbers; the chain's part is
the sum of a tight and a slack side.  Each amplitude is known to lie within a range.
"""

from __future__ import annotations

from collections.abc import Callable
from itertools import chain
from math import cos, radians, sin

from ncgear.balance.rotor import (
    AmplitudeRange,
    ChainPhases,
    ChainUnbalance,
    Prediction,
    WeightRun,
    chain_unbalance,
    predicted,
)
from ncgear.papers.entry import (
    Computed,
    Entry,
    Finding,
    LeftOut,
    Reason,
    Relation,
    computed,
    from_readings,
    printed,
    texts,
)
from ncgear.papers.threshing_drum.first_balancing import BY_PHASE, SPEEDS_RPM, measured_effect, phase_deg, polar

PHASES = ChainPhases(wrap_rad=radians(180.0), tight_rad=radians(105.0), slack_rad=radians(270.0))

WEIGHTS_DEG = (60.0, 120.0, 180.0, 240.0, 300.0, 360.0)
"""Phases of the weight in degrees."""

AT_700 = BY_PHASE[SPEEDS_RPM.index(700)]
"""Amplitude in mm/s and phase in degrees of each reading of Table 3 at 700 r/min, as printed."""

RUNS = tuple(zip(WEIGHTS_DEG, map(float, AT_700[::2]), map(float, AT_700[1::2]), strict=True))
"""Phase of the weight, amplitude and phase of the reading."""

PRINTED_RANGES = ChainUnbalance(AmplitudeRange(0.074, 0.214), AmplitudeRange(0.0, 2.04), AmplitudeRange(0.0, 2.58))
"""Ranges of the amplitudes of weight, tight side and slack side in mm/s."""


def ranges(*readings: float) -> ChainUnbalance:
    """The ranges computed from amplitudes and phases in the order of ``AT_700``."""
    runs = zip(WEIGHTS_DEG, readings[::2], readings[1::2], strict=True)
    return chain_unbalance([WeightRun(radians(weight), polar(*reading)) for weight, *reading in runs], PHASES)


# --- section 3.2.1, eqs. 1 to 7: the ranges of weight, tight and slack side from the readings -----------------------

WEIGHT_G = 161.3


def sides_residual() -> Computed:
    """Eqs.  3 to 6: the sum of both sides at their phases against the chain's part, relative to the larger side."""
    worst = []
    for weight, amplitude, phase in RUNS:
        part = polar(amplitude, phase) - polar(PRINTED_RANGES.weight.high, weight)
        tight = part.real / -sin(radians(15.0))
        slack = -part.imag + tight * cos(radians(15.0))
        both = tight * polar(1.0, 105.0) + slack * polar(1.0, 270.0)
        worst.append(abs(both - part) / max(abs(tight), abs(slack)))
    return computed(*worst)


def second_case_residual() -> Computed:
    """The second case of eq. 7 at 240 deg against the weight's vector, y counted downwards."""
    angle = radians(240.0)
    return computed(abs(complex(sin(angle), -cos(angle)) - complex(cos(angle), -sin(angle))))


def vectors(*phases_deg: float) -> Computed:
    """Weights' vectors of length 1."""
    return computed(*(part for phase in phases_deg for part in (polar(1.0, phase).real, polar(1.0, phase).imag)))


def slack_with_two_slips(*readings: float) -> tuple[float]:
    """Eq.  6 for the slack side at 300 deg, with two slips: the absolute cosine in place of the sine of the reading's
    phase, and the weight's y with the opposite sign."""
    amplitude, phase = readings[8:10]
    weight, tight = ranges(*readings).weight.high, ranges(*readings).tight.high
    down = amplitude * abs(cos(radians(phase)))
    return (down + weight * sin(radians(60.0)) + tight * cos(radians(15.0)),)


RANGES = (
    Entry("eq. 1, Table 3, Fig. 9, section 3.2.1", "range of the weight's amplitude, at 700 r/min",
          printed("0.074 0.214 mm/s"), Finding.REPRODUCED,
          lambda: from_readings(lambda *r: (ranges(*r).weight.low, ranges(*r).weight.high), *AT_700)),
    Entry("section 3.2.1", "largest amplitude of the weight's 161.3 g, by the effect that the first balancing found",
          printed("0.214 mm/s"), Finding.NEEDS_DATA, lambda: WEIGHT_G * measured_effect(),
          "The radii of the weights. Computed for equal radii, at the same speed."),
    Entry("section 3.2.1", "vector of the weight at 300 deg, by its length", printed("-0.5 0.87"),
          Finding.NOT_REPRODUCIBLE, lambda: vectors(300.0), "Printed is the vector at 120 deg, of the opposite sense."),
    Entry("section 3.2.1", "vectors of the weight at 60, 120, 180, 240 and 360 deg, by its length",
          printed("0.5 0.87 -0.5 0.87 -1 0 -0.5 -0.87 1 0"), Finding.REPRODUCED,
          lambda: vectors(60.0, 120.0, 180.0, 240.0, 360.0)),
    Entry("eq. 3, eq. 4, eq. 5, eq. 6", "both sides of the chain from the chain's part", Relation(),
          Finding.UNDER_READING, sides_residual, "With y counted downwards."),
    Entry("eq. 7", "vector of a weight between 180 and 270 deg", Relation(), Finding.NOT_REPRODUCIBLE,
          second_case_residual, "Sine and cosine have changed places; the first case holds there as well."),
    Entry("eq. 6, section 3.2.1", "largest amplitude of the tight side", printed("2.04 mm/s"), Finding.REPRODUCED,
          lambda: from_readings(lambda *r: (ranges(*r).tight.high,), *AT_700)),
    Entry("eq. 6, section 3.2.1", "largest amplitude of the slack side", printed("2.58 mm/s"),
          Finding.NOT_REPRODUCIBLE, lambda: from_readings(lambda *r: (ranges(*r).slack.high,), *AT_700),
          "The readings of Table 3 give less, at the same weight as the tight side's."),
    Entry("eq. 6, section 3.2.1", "largest amplitude of the slack side, with two slips at 300 deg",
          printed("2.58 mm/s"), Finding.FITTED, lambda: from_readings(slack_with_two_slips, *AT_700),
          "With a cosine in place of the sine of the reading's phase, and with the sign of the weight's y that "
          "section 3.2.1 prints at 300 deg; either by itself gives another number."),
)  # fmt: skip

# --- section 3.3, eqs.  10 to 13, Table 6: the predictions of the ranges, and how good they are ---------------------

RANGES_PRINTED = texts("0.074 0.214 2.04 2.58")
"""Ends of the weight's range, largest amplitudes of tight and slack side, as printed."""


def prediction(weight_deg: float, *ends: float) -> Prediction:
    """Bounds of the reading with the weight at a phase in degrees, from the ends of the ranges."""
    low, high, tight, slack = ends
    found = ChainUnbalance(AmplitudeRange(low, high), AmplitudeRange(0.0, tight), AmplitudeRange(0.0, slack))
    return predicted(found, PHASES, radians(weight_deg))


def corners(weight_deg: float, *ends: float) -> tuple[float, float, float, float]:
    """Eqs.  10 to 13: least and largest x and y in mm/s, y downwards, each from the ends of the ranges on its own."""
    low, high, tight, slack = ends
    along, down = cos(radians(weight_deg)), -sin(radians(weight_deg))
    xs, ys = (sorted(share * end for end in (low, high)) for share in (along, down))
    return xs[0] - tight * sin(radians(15.0)), xs[1], ys[0] - tight * cos(radians(15.0)), ys[1] + slack


def lowest_corner(weight_deg: float, *ends: float) -> tuple[float, ...]:
    """Amplitude and phase of the corner where x and y are both least."""
    x, _, y, _ = corners(weight_deg, *ends)
    return abs(complex(x, -y)), phase_deg(complex(x, -y))


def by_slack(weight_deg: float, *ends: float) -> tuple[float, ...]:
    """Amplitude and phase with slack side and weight at their largest, without the tight side."""
    bound = prediction(weight_deg, *ends).by_slack
    return abs(bound), phase_deg(bound)


def from_ranges(function: Callable[..., tuple[float, ...]], *fixed: float) -> Computed:
    """Numbers from the printed ranges, which are rounded."""
    return from_readings(lambda *ends: function(*fixed, *ends), *RANGES_PRINTED)


def errors(*rows: tuple[str, str, str]) -> Computed:
    """For each row, the first reading minus the second, in percent of the third, which repeats one of them."""

    def percent(*readings: float) -> tuple[float, ...]:
        triplets = zip(readings[::3], readings[1::3], readings[2::3], strict=True)
        return tuple(100.0 * (one - other) / base for one, other, base in triplets)

    return from_readings(percent, *chain(*rows))


CORNER = "A corner of the ranges: x with the weight at one end of its range, y with it at the other."
NO_RULE = "A phase within the range is taken; the rule is not given."

PREDICTED = (
    Entry("eq. 10, eq. 11", "ends of x and y with the weight at 30 deg", printed("0.185 -2.08 2.543 mm/s"),
          Finding.REPRODUCED, lambda: from_ranges(lambda *r: corners(*r)[1:], 30.0)),
    Entry("eq. 11", "lower end of x", printed("-0.434 mm/s"), Finding.NOT_REPRODUCIBLE,
          lambda: from_ranges(lambda *r: corners(*r)[:1], 30.0), "The bound printed below it follows from the "
          "computed end, not from this one."),
    Entry("eq. 12, eq. 13", "ends of x and y with the weight at 270 deg", printed("-0.528 0 -1.9 2.794 mm/s"),
          Finding.FITTED, lambda: from_ranges(corners, 270.0), "With the weight's vector as eq. 7 has it; eq. 12 has "
          "its y of the other sign."),
    Entry("section 3.3", "weight at 30 deg: bound by the tight side", printed("2.13 103 mm/s, deg"), Finding.FITTED,
          lambda: from_ranges(lowest_corner, 30.0), CORNER),
    Entry("section 3.3", "weight at 270 deg: bound by the tight side", printed("1.97 106 mm/s, deg"), Finding.FITTED,
          lambda: from_ranges(lowest_corner, 270.0), CORNER),
    Entry("section 3.3", "weight at 30 deg: bound by the slack side", printed("2.48 274 mm/s, deg"),
          Finding.REPRODUCED, lambda: from_ranges(by_slack, 30.0)),
    Entry("section 3.3", "weight at 270 deg: bound by the slack side", printed("2.79 270 mm/s, deg"),
          Finding.REPRODUCED, lambda: from_ranges(by_slack, 270.0)),
    Entry("Table 6, section 3.3", "amplitudes foretold", printed("1.24 1.4 mm/s"), Finding.REPRODUCED,
          lambda: from_ranges(lambda *r: (prediction(30.0, *r).amplitude, prediction(270.0, *r).amplitude))),
    Entry("Table 6, section 3.3", "phases foretold", printed("270 120 deg"), Finding.NEEDS_DATA, None, NO_RULE),
    Entry("section 3.3", "angles of the corrections", printed("90 300 deg"), Finding.REPRODUCED,
          lambda: ((270.0 + 180.0) % 360.0, 120.0 + 180.0), of_printed=True),
    Entry("section 3.3", "correction of 1.24 mm/s", printed("152.3 g"), Finding.NEEDS_DATA,
          lambda: 1.24 / measured_effect(), "The effect of a weight at 500 r/min. Computed with that of the first "
          "balancing at 700 r/min."),
    Entry("section 3.3", "correction of 1.4 mm/s", printed("165.8 g"), Finding.NEEDS_DATA,
          lambda: 1.4 / measured_effect(), "The effect of a weight at 500 r/min. Computed with that of the first "
          "balancing at 700 r/min."),
)  # fmt: skip

HOLES = (("1.587", "286", "1.264", "148"), ("1.487", "283", "0.943", "150"))
"""Table 6 before balancing: for each hole, amplitude and phase with the weight at 30 deg and at 270 deg."""

LEFT = (("0.731", "329", "0.59", "157"), ("0.682", "335", "0.453", "152"))
"""Table 6 after balancing, in the same order."""


def all_errors() -> Computed:
    """The largest and the least of the printed errors."""
    printed = tuple(map(float, texts("21.87 5.6 9.7 18.9 16.6 4.6 32.64 20")))
    return computed(max(printed), min(printed))


COMPARED = (
    Entry("Table 6", "errors of the amplitude at 30 deg", printed("21.87 16.6 %"), Finding.REPRODUCED,
          lambda: errors(("1.587", "1.24", "1.587"), ("1.487", "1.24", "1.487")), of_printed=True),
    Entry("Table 6", "errors of the amplitude at 270 deg", printed("9.7 32.64 %"), Finding.FITTED,
          lambda: errors(("1.4", "1.264", "1.4"), ("1.4", "0.943", "1.4")), "By the foretold, not by the measured "
          "amplitude as at 30 deg.", of_printed=True),
    Entry("Table 6, section 4", "largest error of the amplitude, by the measured one as at 30 deg", printed("32.64 %"),
          Finding.NOT_REPRODUCIBLE, lambda: errors(("1.4", "0.943", "0.943")),
          "The divisor changes from one half of the table to the other.", of_printed=True),
    Entry("Table 6", "errors of the phase", printed("5.6 4.6 18.9 20 %"), Finding.REPRODUCED,
          lambda: errors(("286", "270", "286"), ("283", "270", "283"), ("148", "120", "148"), ("150", "120", "150")),
          "By the measured phase, so that they depend on where phases count from.", of_printed=True),
    Entry("section 4, Table 6", "largest and least error of the table", printed("32.64 4.6 %"), Finding.REPRODUCED,
          all_errors, "The largest is of an amplitude, the least of a phase.", of_printed=True),
    Entry("section 4", "amplitudes foretold that are not below the measured ones", printed("0"),
          Finding.NOT_REPRODUCIBLE, lambda: sum(measured < 1.4 for measured in (1.264, 0.943)),
          "At 270 deg both are above.", of_printed=True),
    Entry("section 4, section 3.3", "amplitudes that balancing took off", printed("0.856 0.674 mm/s"),
          Finding.REPRODUCED,
          lambda: from_readings(lambda *r: (r[0] - r[1], r[2] - r[3]), "1.587", "0.731", "1.264", "0.59"),
          of_printed=True),
)  # fmt: skip

LEFT_OUT = (
    LeftOut("section 3.2.1, section 3.2.2", "weights, places and wrap: 161.3 g; wrap from 90 to 270 deg; 105 deg for "
            "the tight and 270 deg for the slack side", Reason.GIVEN, texts("161.3 90 270 700 105 161.3")),
    LeftOut("section 3.2.1", "readings of Table 3 once more", Reason.MEASURED, AT_700),
    LeftOut("section 3.3", "speeds and weights of the second balancing", Reason.GIVEN, texts("700 500 161.3 161.3")),
    LeftOut("Table 6", "amplitudes and phases before and after balancing", Reason.MEASURED,
            tuple(text for rows in (HOLES, LEFT) for row in rows for text in row)),
    LeftOut("section 3.3", "distance of the weight along the axis, said to matter little", Reason.VAGUE),
)  # fmt: skip
