"""Section 3.2.1, Table 3, eqs. 1 to 7: the equivalent unbalance of the chain drive."""

from __future__ import annotations

from math import cos, radians, sin

from ncgear.papers.entry import Computed, Entry, Printed, Relation, Verdict, equations, of
from ncgear.papers.readings import polar
from ncgear.papers.threshing_drum.field import RECORDS, effect, first_balancing
from ncgear.papers.threshing_drum.published import PRINTED_RANGES, RUNS, ranges

WEIGHT_G = 161.3


def sides_residual() -> Computed:
    """Eqs. 3 to 6 against the sum of both sides at their phases, by the larger side."""
    worst = []
    for weight, amplitude, phase in RUNS:
        chain = polar(amplitude, phase) - polar(PRINTED_RANGES.weight.high, weight)
        tight = chain.real / -sin(radians(15.0))
        slack = -chain.imag + tight * cos(radians(15.0))
        both = tight * polar(1.0, 105.0) + slack * polar(1.0, 270.0)
        worst.append(abs(both - chain) / max(abs(tight), abs(slack)))
    return of(*worst)


def second_case_residual() -> Computed:
    """The second case of eq. 7 at 240 deg against the weight's vector, y counted downwards."""
    angle = radians(240.0)
    return of(abs(complex(sin(angle), -cos(angle)) - complex(cos(angle), -sin(angle))))


def vector(phase_deg: float) -> Computed:
    """A weight's vector of length 1."""
    along = polar(1.0, phase_deg)
    return of(along.real, along.imag)


ENTRIES = (
    Entry(
        ("Table 3", "Table 4", "Table 5"), "readings at 600 to 1000 r/min, for example with the weight at 60 deg",
        Printed(("0.426", "275"), "mm/s, deg"), Verdict.NEEDS_DATA, None, RECORDS,
    ),
    Entry(
        (*equations("1"), "Table 3", "Fig. 9"), "range of the weight's amplitude, at 700 r/min",
        Printed(("0.074", "0.214"), "mm/s"), Verdict.REPRODUCED,
        lambda: of(ranges().weight.low, ranges().weight.high),
    ),
    Entry(
        ("section 3.2.1",), "largest amplitude of the weight's 161.3 g, by the effect that the first balancing found",
        Printed(("0.214",), "mm/s"), Verdict.NEEDS_DATA, lambda: of(WEIGHT_G * abs(effect(*first_balancing()))),
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
        lambda: of(ranges().tight.high),
    ),
    Entry(
        equations("6"), "largest amplitude of the slack side", Printed(("2.58",), "mm/s"), Verdict.NOT_REPRODUCIBLE,
        lambda: of(ranges().slack.high), "The readings of Table 3 give less, at the same weight as the tight side's.",
    ),
)  # fmt: skip
