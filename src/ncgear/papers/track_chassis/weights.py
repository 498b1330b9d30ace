"""Section 3.1 and eqs. 16 to 20: counterweights of the mechanism and of the chassis."""

from __future__ import annotations

from functools import cache

from ncgear.balance.frame import static_counterweight_kg
from ncgear.balance.mechanism import CompleteBalance, complete_balance
from ncgear.papers.entry import Computed, Entry, Printed, Verdict, equations, of
from ncgear.papers.track_chassis.published import (
    CHASSIS,
    CRANK_ARM_MM,
    LINKAGE,
    MECHANISM,
    ROD_ARM_MM,
    SLIDER_KG,
    SPEED_RAD_S,
    WEIGHT_KG,
    WEIGHT_LEVER_MM,
    tail_weights,
)


@cache
def complete() -> CompleteBalance:
    """Counterweights that keep the common centre of mass on the crank axis."""
    return complete_balance(LINKAGE, MECHANISM.masses, ROD_ARM_MM, CRANK_ARM_MM)


def against_dead_weight_kg() -> float:
    """M2."""
    return static_counterweight_kg(CHASSIS, SLIDER_KG, WEIGHT_KG, WEIGHT_LEVER_MM)


def total() -> Computed:
    """M of the unrounded M1 and M2."""
    return of(tail_weights().retracted_kg + against_dead_weight_kg())


ENTRIES = (
    Entry(
        ("section 3.1",), "counterweight beyond the crank pin, and mass at the pin", Printed(("182", "247"), "kg"),
        Verdict.REPRODUCED, lambda: of(complete().rod_kg, complete().pin_kg),
    ),
    Entry(
        ("section 3.1",), "counterweight beyond the crank axis", Printed(("261.82",), "kg"), Verdict.UNDER_READING,
        lambda: of(complete().crank_kg), "At 250 mm from the axis; its place is not printed.",
    ),
    Entry(
        ("section 3.5",), "crank's speed from 96.5 r/min", Printed(("10.10",), "rad/s"), Verdict.NOT_REPRODUCIBLE,
        lambda: of(SPEED_RAD_S), "Cut off, not rounded.",
    ),
    Entry(
        equations("16", "17", "18"), "weight against the slider's inertia", Printed(("5",), "kg"),
        Verdict.UNDER_READING, lambda: of(tail_weights().retracted_kg),
        "With the inertia force at the retracted dead centre, which is the smaller of the two.",
    ),
    Entry(
        equations("16", "17", "18"), "weight against the slider's largest inertia force", Printed(("5",), "kg"),
        Verdict.NOT_REPRODUCIBLE, lambda: of(tail_weights().worst_kg.value),
        "The force is largest at the extended dead centre; the printed weight is not the safe one.",
    ),
    Entry(
        equations("19"), "weight against the dead weight", Printed(("260",), "kg"), Verdict.REPRODUCED,
        lambda: of(against_dead_weight_kg()),
    ),
    Entry(
        equations("20"), "both weights", Printed(("265",), "kg"), Verdict.NOT_REPRODUCIBLE, total,
        "The sum of the printed weights, each rounded up; unrounded they make less.",
    ),
)  # fmt: skip
