"""Section 3.3, eqs. 10 to 13 and Table 6: what the ranges foretell, and how it fares."""

from __future__ import annotations

from math import cos, radians, sin

from ncgear.papers.entry import Computed, Entry, Printed, Verdict, equations, from_readings, of
from ncgear.papers.readings import phase_deg
from ncgear.papers.threshing_drum.field import RECORDS, effect, first_balancing
from ncgear.papers.threshing_drum.published import PRINTED_RANGES, prediction

WEIGHT, TIGHT, SLACK = PRINTED_RANGES.weight, PRINTED_RANGES.tight, PRINTED_RANGES.slack


def corners(weight_deg: float) -> tuple[float, float, float, float]:
    """Ends of x and of y, y downwards, by the printed ranges, each as if the others were free."""
    along, down = cos(radians(weight_deg)), -sin(radians(weight_deg))
    xs = sorted(along * end for end in (WEIGHT.low, WEIGHT.high))
    ys = sorted(down * end for end in (WEIGHT.low, WEIGHT.high))
    tight = TIGHT.high * sin(radians(15.0)), TIGHT.high * cos(radians(15.0))
    return xs[0] - tight[0], xs[1], ys[0] - tight[1], ys[1] + SLACK.high


def lowest_corner(weight_deg: float) -> Computed:
    """Amplitude and phase of the corner of both lower ends."""
    x, _, y, _ = corners(weight_deg)
    return of(abs(complex(x, -y)), phase_deg(complex(x, -y)))


def by_slack(weight_deg: float) -> Computed:
    """Amplitude and phase with all of the slack side and the weight at its largest."""
    bound = prediction(weight_deg).by_slack
    return of(abs(bound), phase_deg(bound))


def grams(amplitude: float) -> Computed:
    """Weight against an amplitude by the effect that the first balancing found."""
    return of(amplitude / abs(effect(*first_balancing())))


def error(larger: str, smaller: str, by: str) -> Computed:
    """Difference of two readings in percent of a third, which is one of them."""
    return from_readings(lambda one, other, base: (100.0 * (one - other) / base,), larger, smaller, by)


def errors(*rows: tuple[str, str, str]) -> Computed:
    """Several of them."""
    found = [error(*row) for row in rows]
    return Computed(tuple(one.values[0] for one in found), tuple(one.leeway[0] for one in found))


CORNER = "A corner of the ranges: x with the weight at one end of its range, y with it at the other."
NO_RULE = "A phase within the range is taken; the rule is not given."

FORETOLD = (
    Entry(
        equations("10", "11"), "ends of x and y with the weight at 30 deg",
        Printed(("0.185", "-2.08", "2.543"), "mm/s"), Verdict.REPRODUCED, lambda: of(*corners(30.0)[1:]),
    ),
    Entry(
        equations("11"), "lower end of x", Printed(("-0.434",), "mm/s"), Verdict.NOT_REPRODUCIBLE,
        lambda: of(corners(30.0)[0]), "The bound printed below it follows from the computed end, not from this one.",
    ),
    Entry(
        equations("12", "13"), "ends of x and y with the weight at 270 deg",
        Printed(("-0.528", "0", "-1.9", "2.794"), "mm/s"), Verdict.UNDER_READING, lambda: of(*corners(270.0)),
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
        lambda: of(prediction(30.0).amplitude, prediction(270.0).amplitude),
    ),
    Entry(
        ("Table 6", "section 3.3"), "phases foretold", Printed(("270", "120"), "deg"), Verdict.NEEDS_DATA, None, NO_RULE
    ),
    Entry(
        ("section 3.3",), "angles of the corrections", Printed(("90", "300"), "deg"), Verdict.REPRODUCED,
        lambda: of((270.0 + 180.0) % 360.0, 120.0 + 180.0),
    ),
    Entry(
        ("section 3.3",), "correction of 1.24 mm/s", Printed(("152.3",), "g"), Verdict.NEEDS_DATA, lambda: grams(1.24),
        "The effect of a weight at 500 r/min. Computed with that of the first balancing at 700 r/min.",
    ),
    Entry(
        ("section 3.3",), "correction of 1.4 mm/s", Printed(("165.8",), "g"), Verdict.NEEDS_DATA, lambda: grams(1.4),
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
        Verdict.NOT_REPRODUCIBLE, lambda: of(sum(measured < 1.4 for measured in (1.264, 0.943))),
        "At 270 deg both are above.",
    ),
    Entry(
        ("section 4",), "amplitudes that balancing took off", Printed(("0.856", "0.674"), "mm/s"), Verdict.REPRODUCED,
        lambda: from_readings(lambda *r: (r[0] - r[1], r[2] - r[3]), "1.587", "0.731", "1.264", "0.59"),
    ),
)  # fmt: skip
