"""Section 2.2.2, eqs. 1 and 6 to 8: masses at the joints and the counterweights of each mechanism alone."""

from __future__ import annotations

from ncgear.balance.mechanism import JointMasses, joint_masses, partial_counterweight_kg
from ncgear.mechanisms.crank_slider import CrankSlider
from ncgear.mechanisms.masses import RodMasses
from ncgear.papers.entry import Computed, Entry, Printed, Verdict, equations, of
from ncgear.papers.sieve_and_pan.published import (
    ARM_MM,
    CRANK_CENTER_MM,
    CRANK_KG,
    CRANK_MM,
    LARGEST_SHARE,
    LEAST_SHARE,
    PAN_BOARD_KG,
    PAN_BOARD_PRINTED_MM,
    PAN_LINKAGE,
    PAN_PRINTED,
    ROLLER_KG,
    SIEVE,
    SIEVE_LINKAGE,
    SIEVE_PRINTED,
)

SIEVE_OWN = joint_masses(SIEVE_LINKAGE, SIEVE.masses)


def pan_board() -> Computed:
    """The board's mass at the crank pin and at the roller, its centre where it is printed."""
    found = joint_masses(PAN_LINKAGE, RodMasses(rod_kg=PAN_BOARD_KG, rod_center_mm=PAN_BOARD_PRINTED_MM))
    return of(found.rotating_kg, found.reciprocating_kg)


def counterweights(linkage: CrankSlider, at_joints: JointMasses) -> Computed:
    """From the least to the largest usual share."""
    shares = (LEAST_SHARE, LARGEST_SHARE)
    return of(*(partial_counterweight_kg(linkage, at_joints, ARM_MM, share) for share in shares))


PAN_ENTRIES = (
    Entry(
        equations("1"), "pan: crank at the pin", Printed(("0.8",), "kg"), Verdict.REPRODUCED,
        lambda: of(CRANK_KG * CRANK_CENTER_MM / CRANK_MM),
    ),
    Entry(
        equations("1"), "pan: board at pin and roller", Printed(("11.1", "12.6"), "kg"), Verdict.NOT_REPRODUCIBLE,
        pan_board,
        "The place printed for the board's centre is that of the crank's; the printed masses put it near the middle.",
    ),
    Entry(
        equations("1"), "pan: all at pin and roller", Printed(("11.9", "12.86"), "kg"), Verdict.UNDER_READING,
        lambda: of(0.8 + 11.1, 12.6 + ROLLER_KG), "Sums of the printed parts.",
    ),
    Entry(
        equations("6", "7", "8"), "pan: counterweight", Printed(("5.4", "6.1"), "kg"), Verdict.REPRODUCED,
        lambda: counterweights(PAN_LINKAGE, PAN_PRINTED),
    ),
)  # fmt: skip

SIEVE_ENTRIES = (
    Entry(
        equations("1"), "sieve: all at the pin", Printed(("29.5",), "kg"), Verdict.NOT_REPRODUCIBLE,
        lambda: of(SIEVE_OWN.rotating_kg), "Board and crank make more, the board alone less.",
    ),
    Entry(
        equations("1"), "sieve: all at the roller", Printed(("61.26",), "kg"), Verdict.UNDER_READING,
        lambda: of(round(SIEVE_OWN.reciprocating_kg - ROLLER_KG, 1) + ROLLER_KG),
        "The board's part rounded to one decimal before the roller is added.",
    ),
    Entry(
        equations("8"), "sieve: counterweight, from the printed masses", Printed(("16.7", "20.1"), "kg"),
        Verdict.NOT_REPRODUCIBLE, lambda: counterweights(SIEVE_LINKAGE, SIEVE_PRINTED),
        "Both are rounded up by more than half a step.",
    ),
    Entry(
        equations("8"), "sieve: counterweight, from its dimensions", Printed(("16.7", "20.1"), "kg"),
        Verdict.NOT_REPRODUCIBLE, lambda: counterweights(SIEVE_LINKAGE, SIEVE_OWN),
        "The mass at the pin is another.",
    ),
    Entry(
        ("section 4",), "sieve: counterweight, as concluded", Printed(("16.0", "20.1"), "kg"),
        Verdict.NOT_REPRODUCIBLE, lambda: counterweights(SIEVE_LINKAGE, SIEVE_PRINTED),
        "The lower one is printed otherwise in section 2.2.2.",
    ),
)  # fmt: skip
