"""Section 2.2.3, eqs. 9 to 16: what is left of both mechanisms' forces, and the sieve's counterweight for it."""

from __future__ import annotations

from collections.abc import Callable
from math import degrees, radians

from ncgear.balance.frame import Crank, best_phase_rad, combined_counterweight_kg, reciprocating_share, rotating_share
from ncgear.papers.entry import Computed, Entry, Printed, Verdict, equations, of
from ncgear.papers.sieve_and_pan.published import (
    ARM_MM,
    CRANK_MM,
    LARGEST_SHARE,
    LEAST_SHARE,
    PAN_PRINTED,
    SIEVE_PRINTED,
)

SIEVE_CRANK = Crank(SIEVE_PRINTED, radians(90.0), 1)

PRINTED_SHARES = {45: (0.72, 0.86), 90: (0.65, 0.71), 0: (0.74, 0.77)}
"""eta1 and eta2 by the pan's phase in degrees."""


def pan(phase_deg: float) -> Crank:
    """The pan, which turns against the sieve."""
    return Crank(PAN_PRINTED, radians(phase_deg), -1)


def eta1(phase_deg: float) -> Callable[[], Computed]:
    """Eq. 11 at a phase."""
    return lambda: of(reciprocating_share(pan(phase_deg), SIEVE_CRANK))


def eta2(phase_deg: float) -> Callable[[], Computed]:
    """Eq. 16 at a phase."""
    return lambda: of(rotating_share(pan(phase_deg), SIEVE_CRANK))


def combined(phase_deg: int, *of_reciprocating: float) -> Callable[[], Computed]:
    """Counterweights of the sieve by the printed eta1 and eta2, for shares of the reciprocating mass."""
    shares = PRINTED_SHARES[phase_deg]
    ratio = CRANK_MM / ARM_MM
    return lambda: of(*(combined_counterweight_kg(SIEVE_PRINTED, shares, ratio, k) for k in of_reciprocating))


SIZES = "Means of sizes over a turn; with signs, as printed, every mean is nothing."
SAME_ELLIPSE = (
    "Two vectors that turn against each other add up to one and the same ellipse, turned by the phase: the mean size "
    "is that of every phase."
)
NOT_BY_FORMULA = "Not by eq. 8 with the printed eta1, eta2 and masses."
BOTH = (LEAST_SHARE, LARGEST_SHARE)

ENTRIES = (
    Entry(
        equations("9", "10", "11"), "eta1 at 90 deg", Printed(("0.65",)), Verdict.UNDER_READING, eta1(90.0), SIZES
    ),
    Entry(
        equations("9", "10", "11"), "eta1 at 45 deg", Printed(("0.72",)), Verdict.NOT_REPRODUCIBLE, eta1(45.0),
        f"{SIZES} It is rounded up.",
    ),
    Entry(
        equations("9", "10", "11"), "eta1 at 0 deg", Printed(("0.74",)), Verdict.NOT_REPRODUCIBLE, eta1(0.0), SIZES
    ),
    *(
        Entry(
            equations("12", "13", "14", "15", "16"), f"eta2 at {phase:g} deg", Printed((text,)),
            Verdict.NOT_REPRODUCIBLE, eta2(phase), SAME_ELLIPSE,
        )
        for phase, text in ((45.0, "0.86"), (90.0, "0.71"), (0.0, "0.77"))
    ),
    Entry(
        ("section 2.2.3", "section 3.3"), "best phase of the pan", Printed(("90",), "deg"), Verdict.REPRODUCED,
        lambda: of(degrees(best_phase_rad(pan(0.0), SIEVE_CRANK))),
    ),
    Entry(
        ("section 2.2.3",), "sieve's counterweight at 90 deg, lower", Printed(("11.4",), "kg"), Verdict.UNDER_READING,
        combined(90, LEAST_SHARE), "With the printed eta1 and eta2.",
    ),
    Entry(
        ("section 2.2.3",), "sieve's counterweight at 90 deg, upper", Printed(("13.7",), "kg"),
        Verdict.NOT_REPRODUCIBLE, combined(90, LARGEST_SHARE), NOT_BY_FORMULA,
    ),
    Entry(
        ("section 2.2.3",), "sieve's counterweight at 45 deg", Printed(("13.9", "16.5"), "kg"),
        Verdict.NOT_REPRODUCIBLE, combined(45, *BOTH), NOT_BY_FORMULA,
    ),
    Entry(
        ("section 2.2.3",), "sieve's counterweight at 0 deg", Printed(("13.2", "15.8"), "kg"),
        Verdict.NOT_REPRODUCIBLE, combined(0, *BOTH), NOT_BY_FORMULA,
    ),
)  # fmt: skip
