"""Section 2.2, eqs. 1 to 16: the motion of sieve and pan, their counterweights, and what both together leave."""

from __future__ import annotations

from collections.abc import Callable
from math import degrees, radians

import numpy as np

from ncgear.balance.frame import Crank, best_phase_rad, combined_counterweight_kg, reciprocating_share, rotating_share
from ncgear.balance.mechanism import JointMasses, joint_masses, partial_counterweight_kg
from ncgear.mechanisms.crank_slider import CrankSlider
from ncgear.mechanisms.masses import RodMasses
from ncgear.numerics.jet import Jet
from ncgear.papers.entry import Computed, Entry, Printed, Relation, Verdict, computed, equations
from ncgear.papers.sieve_and_pan.published import (
    ARM_MM,
    CRANK_CENTER_MM,
    CRANK_KG,
    CRANK_MM,
    PAN_BOARD_KG,
    PAN_BOARD_PRINTED_MM,
    PAN_LINKAGE,
    PAN_PRINTED,
    ROLLER_KG,
    SIEVE,
    SIEVE_LINKAGE,
    SIEVE_PRINTED,
    SPEED_RPM,
    USUAL_SHARES,
)
from ncgear.papers.track_chassis.slider import two_term_stroke

# --- section 2.2.1, eqs. 2 to 5: the slider by two terms; small figures of the text --------------------------------

ANGLES_RAD = np.linspace(0.0, 2.0 * np.pi, 73)


def place_residual() -> Computed:
    """Eq. 2 against both linkages, by the stroke.

    The slider's place counts from the crank axis, the crank angle from the extended dead centre.
    """
    worst = []
    for linkage in (PAN_LINKAGE, SIEVE_LINKAGE):
        exact = linkage.nearest_mm + linkage.displacement(Jet.variable(np.pi + ANGLES_RAD, 0)).value
        tilt = np.arcsin(linkage.crank_mm / linkage.rod_mm * np.sin(ANGLES_RAD))
        formula = linkage.crank_mm * np.cos(ANGLES_RAD) + linkage.rod_mm * np.cos(tilt)
        worst.append(float(np.abs(formula - exact).max() / linkage.stroke_mm))
    return computed(*worst)


def acceleration_residual() -> Computed:
    """Eq. 3 against the second derivative of the two-term stroke, positive towards the crank axis."""
    worst = []
    for linkage in (PAN_LINKAGE, SIEVE_LINKAGE):
        formula = np.cos(ANGLES_RAD) + linkage.crank_mm / linkage.rod_mm * np.cos(2.0 * ANGLES_RAD)
        exact = two_term_stroke(linkage, ANGLES_RAD, 2).derivative(2) / CRANK_MM
        worst.append(float(np.abs(formula - exact).max()))
    return computed(*worst)


MOTION = (
    Entry(
        equations("2"), "slider's place against crank angle", Relation(), Verdict.UNDER_READING, place_residual,
        "With the sine of the rod's angle as crank by rod times that of the crank's; it is printed upside down.",
    ),
    Entry(
        equations("3", "4", "5"), "acceleration by two terms, of which the inertia forces are made", Relation(),
        Verdict.UNDER_READING, acceleration_residual,
        "With the square of the crank's speed, and counted positive towards the crank axis.",
    ),
    Entry(
        ("section 2.2",), "crank by connecting rod", Printed(("0.01", "0.01")), Verdict.REPRODUCED,
        lambda: computed(*(CRANK_MM / linkage.rod_mm for linkage in (PAN_LINKAGE, SIEVE_LINKAGE))),
    ),
    Entry(
        ("section 3.1",), "speed of 350 r/min in the simulation", Printed(("2100",), "r/s"), Verdict.UNDER_READING,
        lambda: computed(SPEED_RPM * 6.0), "In degrees per second.",
    ),
    Entry(
        ("section 3.1",), "time of one turn", Printed(("0.17",), "s"), Verdict.REPRODUCED,
        lambda: computed(60.0 / SPEED_RPM),
    ),
)  # fmt: skip

# --- section 2.2.2, eqs. 1 and 6 to 8: masses at the joints, counterweights of each mechanism alone ---------------

SIEVE_OWN = joint_masses(SIEVE_LINKAGE, SIEVE.masses)


def pan_board() -> Computed:
    """The board's mass at the crank pin and at the roller, with its centre at the printed place."""
    found = joint_masses(PAN_LINKAGE, RodMasses(rod_kg=PAN_BOARD_KG, rod_center_mm=PAN_BOARD_PRINTED_MM))
    return computed(found.rotating_kg, found.reciprocating_kg)


def counterweights(linkage: CrankSlider, at_joints: JointMasses) -> Computed:
    """Counterweights in kg for the least and the largest usual share of the reciprocating mass."""
    return computed(*(partial_counterweight_kg(linkage, at_joints, ARM_MM, share) for share in USUAL_SHARES))


PAN_ALONE = (
    Entry(
        equations("1"), "pan: crank at the pin", Printed(("0.8",), "kg"), Verdict.REPRODUCED,
        lambda: computed(CRANK_KG * CRANK_CENTER_MM / CRANK_MM),
    ),
    Entry(
        equations("1"), "pan: board at pin and roller", Printed(("11.1", "12.6"), "kg"), Verdict.NOT_REPRODUCIBLE,
        pan_board,
        "The place printed for the board's centre is that of the crank's; the printed masses put it near the middle.",
    ),
    Entry(
        equations("1"), "pan: all at pin and roller", Printed(("11.9", "12.86"), "kg"), Verdict.UNDER_READING,
        lambda: computed(0.8 + 11.1, 12.6 + ROLLER_KG), "Sums of the printed parts.",
    ),
    Entry(
        equations("6", "7", "8"), "pan: counterweight", Printed(("5.4", "6.1"), "kg"), Verdict.REPRODUCED,
        lambda: counterweights(PAN_LINKAGE, PAN_PRINTED),
    ),
)  # fmt: skip

SIEVE_ALONE = (
    Entry(
        equations("1"), "sieve: all at the pin", Printed(("29.5",), "kg"), Verdict.NOT_REPRODUCIBLE,
        lambda: computed(SIEVE_OWN.rotating_kg), "Board and crank make more, the board alone less.",
    ),
    Entry(
        equations("1"), "sieve: all at the roller", Printed(("61.26",), "kg"), Verdict.UNDER_READING,
        lambda: computed(round(SIEVE_OWN.reciprocating_kg - ROLLER_KG, 1) + ROLLER_KG),
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

# --- section 2.2.3, eqs. 9 to 16: what is left of the forces of both, and the counterweight for it -----------------

SIEVE_CRANK = Crank(SIEVE_PRINTED, radians(90.0), 1)

PRINTED_SHARES = {45: (0.72, 0.86), 90: (0.65, 0.71), 0: (0.74, 0.77)}
"""eta1 and eta2 by the pan's phase in degrees."""


def pan(phase_deg: float) -> Crank:
    """The crank of the pan, which turns against that of the sieve."""
    return Crank(PAN_PRINTED, radians(phase_deg), -1)


def eta1(phase_deg: float) -> Callable[[], Computed]:
    """Eq. 11 with the pan at a phase in degrees."""
    return lambda: computed(reciprocating_share(pan(phase_deg), SIEVE_CRANK))


def eta2(phase_deg: float) -> Callable[[], Computed]:
    """Eq. 16 with the pan at a phase in degrees."""
    return lambda: computed(rotating_share(pan(phase_deg), SIEVE_CRANK))


def combined(phase_deg: int, *of_reciprocating: float) -> Callable[[], Computed]:
    """Counterweights of the sieve in kg by the printed eta1 and eta2, for shares of the reciprocating mass."""
    left, arm_ratio = PRINTED_SHARES[phase_deg], CRANK_MM / ARM_MM
    return lambda: computed(*(combined_counterweight_kg(SIEVE_PRINTED, left, arm_ratio, k) for k in of_reciprocating))


SIZES = "Means of sizes over a turn; with signs, as printed, every mean is nothing."
SAME_ELLIPSE = (
    "Two vectors that turn against each other add up to one and the same ellipse, turned by the phase: the mean size "
    "is that of every phase."
)
NOT_BY_FORMULA = "Not by eq. 8 with the printed eta1, eta2 and masses."

TOGETHER = (
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
        lambda: computed(degrees(best_phase_rad(pan(0.0), SIEVE_CRANK))),
    ),
    Entry(
        ("section 2.2.3",), "sieve's counterweight at 90 deg, lower", Printed(("11.4",), "kg"), Verdict.UNDER_READING,
        combined(90, USUAL_SHARES[0]), "With the printed eta1 and eta2.",
    ),
    Entry(
        ("section 2.2.3",), "sieve's counterweight at 90 deg, upper", Printed(("13.7",), "kg"),
        Verdict.NOT_REPRODUCIBLE, combined(90, USUAL_SHARES[1]), NOT_BY_FORMULA,
    ),
    Entry(
        ("section 2.2.3",), "sieve's counterweight at 45 deg", Printed(("13.9", "16.5"), "kg"),
        Verdict.NOT_REPRODUCIBLE, combined(45, *USUAL_SHARES), NOT_BY_FORMULA,
    ),
    Entry(
        ("section 2.2.3",), "sieve's counterweight at 0 deg", Printed(("13.2", "15.8"), "kg"),
        Verdict.NOT_REPRODUCIBLE, combined(0, *USUAL_SHARES), NOT_BY_FORMULA,
    ),
)  # fmt: skip

ENTRIES = (*MOTION, *PAN_ALONE, *SIEVE_ALONE, *TOGETHER)
