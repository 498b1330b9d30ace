"""Section 2.2, eqs. 1 to 16: the motion of sieve and pan, their counterweights, and what both together leave."""

from __future__ import annotations

from collections.abc import Callable
from math import degrees, radians

import numpy as np

from ncgear.balance.frame import Crank, best_phase_rad, combined_counterweight_kg, reciprocating_share, rotating_share
from ncgear.balance.mechanism import DrivenCrank, JointMasses, joint_masses, partial_counterweight_kg
from ncgear.mechanisms.crank_slider import CrankSlider
from ncgear.mechanisms.masses import RodMasses
from ncgear.numerics.jet import Jet
from ncgear.numerics.units import RAD_S_PER_RPM
from ncgear.papers.entry import Computed, Entry, Printed, Relation, Verdict, computed, equations, from_readings
from ncgear.papers.track_chassis.slider import two_term_stroke
from ncgear.ratio.laws.uniform import uniform_law
from ncgear.ratio.transmission import Lobes

# --- what the paper gives, and the two mechanisms that this makes ----------------------------------------------------

SPEED_RPM = 350.0
SPEED_RAD_S = SPEED_RPM * RAD_S_PER_RPM
CRANK_MM, ARM_MM = 15.0, 45.0
CRANK_KG, CRANK_CENTER_MM, ROLLER_KG = 1.0, 12.3, 0.26
USUAL_SHARES = (1.0 / 3.0, 1.0 / 2.0)
"""Least and largest share of the reciprocating mass that a counterweight usually balances."""

PAN_LINKAGE = CrankSlider(CRANK_MM, 1045.0)
PAN_BOARD_KG, PAN_BOARD_PRINTED_MM = 23.7, 12.3
PAN_PRINTED = ("11.9", "12.86")
"""Masses of the pan in kg at the pin and at the roller, as printed."""

SIEVE_LINKAGE = CrankSlider(CRANK_MM, 1378.0)
SIEVE_BOARD_KG, SIEVE_BOARD_FROM_ROLLER_MM = 90.4, 448.0
SIEVE_PRINTED = ("29.5", "61.26")
"""Masses of the sieve in kg at the pin and at the roller, as printed."""

PAN_BOARD_FITTING_MM = PAN_LINKAGE.rod_mm * 12.6 / PAN_BOARD_KG
"""Distance from the pin at which the printed masses of the board at pin and roller put its centre."""


def mechanism(linkage: CrankSlider, board_kg: float, center_mm: float) -> DrivenCrank:
    """Crank, board and roller, driven evenly at the printed speed; the board's own inertia is not given: left out."""
    masses = RodMasses(
        slider_kg=ROLLER_KG,
        rod_kg=board_kg,
        rod_center_mm=center_mm,
        crank_kg=CRANK_KG,
        crank_center_mm=CRANK_CENTER_MM,
    )
    return DrivenCrank(linkage, uniform_law(Lobes()), SPEED_RAD_S, masses)


PAN = mechanism(PAN_LINKAGE, PAN_BOARD_KG, PAN_BOARD_FITTING_MM)
SIEVE = mechanism(SIEVE_LINKAGE, SIEVE_BOARD_KG, SIEVE_LINKAGE.rod_mm - SIEVE_BOARD_FROM_ROLLER_MM)

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
    Entry(equations("2"), "slider's place against crank angle", Relation(), Verdict.UNDER_READING, place_residual,
          "With the sine of the rod's angle as crank by rod times that of the crank's; it is printed upside down."),
    Entry(equations("3", "4", "5"), "acceleration by two terms, of which the inertia forces are made", Relation(),
          Verdict.UNDER_READING, acceleration_residual,
          "With the square of the crank's speed, and counted positive towards the crank axis."),
    Entry(("section 2.2.1",), "crank by connecting rod", Printed(("0.01", "0.01")), Verdict.REPRODUCED,
          lambda: computed(*(CRANK_MM / linkage.rod_mm for linkage in (PAN_LINKAGE, SIEVE_LINKAGE)))),
    Entry(("section 2.2",), "connecting rod by crank, about", Printed(("100", "100")), Verdict.REPRODUCED,
          lambda: computed(*(linkage.rod_mm / CRANK_MM for linkage in (PAN_LINKAGE, SIEVE_LINKAGE))),
          "To the one digit that counts; 70 for the pan and 92 for the sieve."),
    Entry(("section 3.1",), "speed of 350 r/min in the simulation", Printed(("2100",), "r/s"), Verdict.UNDER_READING,
          lambda: computed(SPEED_RPM * 6.0), "In degrees per second."),
    Entry(("section 3.1",), "time of one turn", Printed(("0.17",), "s"), Verdict.REPRODUCED,
          lambda: computed(60.0 / SPEED_RPM)),
)  # fmt: skip

# --- section 2.2.2, eqs. 1 and 6 to 8: masses at the joints, counterweights of each mechanism alone ---------------

SIEVE_OWN = joint_masses(SIEVE_LINKAGE, SIEVE.masses)


def pan_board() -> Computed:
    """The board's mass at the crank pin and at the roller, with its centre at the printed place."""
    found = joint_masses(PAN_LINKAGE, RodMasses(rod_kg=PAN_BOARD_KG, rod_center_mm=PAN_BOARD_PRINTED_MM))
    return computed(found.rotating_kg, found.reciprocating_kg)


def counterweights(linkage: CrankSlider, at_joints: JointMasses) -> tuple[float, ...]:
    """Counterweights in kg for the least and the largest usual share of the reciprocating mass."""
    return tuple(partial_counterweight_kg(linkage, at_joints, ARM_MM, share) for share in USUAL_SHARES)


def from_masses(function: Callable[[JointMasses], tuple[float, ...]], at_pin: str, at_roller: str) -> Computed:
    """Numbers from the printed masses at pin and roller, which are rounded."""
    return from_readings(lambda *masses: function(JointMasses(*masses)), at_pin, at_roller)


PAN_ALONE = (
    Entry((*equations("1"), "section 2.2.2"), "pan: crank at the pin", Printed(("0.8",), "kg"), Verdict.REPRODUCED,
          lambda: computed(CRANK_KG * CRANK_CENTER_MM / CRANK_MM)),
    Entry((*equations("1"), "section 2.2.2"), "pan: board at pin and roller", Printed(("11.1", "12.6"), "kg"),
          Verdict.NOT_REPRODUCIBLE, pan_board, "The place printed for the board's centre is that of the crank's; the "
          "printed masses put it near the middle."),
    Entry((*equations("1"), "section 2.2.2"), "pan: all at pin and roller", Printed(("11.9", "12.86"), "kg"),
          Verdict.REPRODUCED,
          lambda: from_readings(lambda *kg: (kg[0] + kg[1], kg[2] + ROLLER_KG), "0.8", "11.1", "12.6"),
          of_printed=True),
    Entry((*equations("6", "7", "8"), "section 2.2.2", "section 4"), "pan: counterweight",
          Printed(("5.4", "6.1"), "kg"), Verdict.REPRODUCED,
          lambda: from_masses(lambda masses: counterweights(PAN_LINKAGE, masses), *PAN_PRINTED)),
)  # fmt: skip

SIEVE_ALONE = (
    Entry((*equations("1"), "section 2.2.2"), "sieve: all at the pin", Printed(("29.5",), "kg"),
          Verdict.NOT_REPRODUCIBLE, lambda: computed(SIEVE_OWN.rotating_kg),
          "Board and crank make more, the board alone less."),
    Entry((*equations("1"), "section 2.2.2"), "sieve: all at the roller", Printed(("61.26",), "kg"),
          Verdict.UNDER_READING, lambda: computed(round(SIEVE_OWN.reciprocating_kg - ROLLER_KG, 1) + ROLLER_KG),
          "The board's part rounded to one decimal before the roller is added."),
    Entry((*equations("8"), "section 2.2.2"), "sieve: counterweight, from the printed masses",
          Printed(("16.7", "20.1"), "kg"), Verdict.REPRODUCED,
          lambda: from_masses(lambda masses: counterweights(SIEVE_LINKAGE, masses), *SIEVE_PRINTED),
          "Only with the rounding of the 29.5 kg: from 29.50 kg both come out 0.06 kg less."),
    Entry(equations("8"), "sieve: counterweight, from its dimensions", Printed(("16.7", "20.1"), "kg"),
          Verdict.NOT_REPRODUCIBLE, lambda: computed(*counterweights(SIEVE_LINKAGE, SIEVE_OWN)),
          "The mass at the pin is another."),
    Entry(("section 4",), "sieve: counterweight, as concluded", Printed(("16.0", "20.1"), "kg"),
          Verdict.NOT_REPRODUCIBLE,
          lambda: from_masses(lambda masses: counterweights(SIEVE_LINKAGE, masses), *SIEVE_PRINTED),
          "The lower one is printed otherwise in section 2.2.2."),
)  # fmt: skip

# --- section 2.2.3, eqs. 9 to 16: what is left of the forces of both, and the counterweight for it -----------------

PRINTED_SHARES = {45: ("0.72", "0.86"), 90: ("0.65", "0.71"), 0: ("0.74", "0.77")}
"""eta1 and eta2 by the pan's phase in degrees."""


def cranks(phase_deg: float, *masses_kg: float) -> tuple[Crank, Crank]:
    """The crank of the pan at a phase and that of the sieve, which turns against it; both masses of each."""
    own, other = JointMasses(*masses_kg[:2]), JointMasses(*masses_kg[2:])
    return Crank(own, radians(phase_deg), -1), Crank(other, radians(90.0), 1)


def eta(share: Callable[[Crank, Crank], float], phase_deg: float) -> Callable[[], Computed]:
    """The share that eq. 11 or eq. 16 gives with the pan at a phase in degrees."""
    return lambda: from_readings(lambda *kg: (share(*cranks(phase_deg, *kg)),), *PAN_PRINTED, *SIEVE_PRINTED)


def combined(phase_deg: int) -> Callable[[], Computed]:
    """Counterweights of the sieve in kg by the printed eta1, eta2 and masses, for both usual shares."""

    def found(*numbers: float) -> tuple[float, ...]:
        left, masses = (numbers[0], numbers[1]), JointMasses(*numbers[2:])
        return tuple(combined_counterweight_kg(masses, left, CRANK_MM / ARM_MM, share) for share in USUAL_SHARES)

    return lambda: from_readings(found, *PRINTED_SHARES[phase_deg], *SIEVE_PRINTED)


SIZES = "Means of sizes over a turn; with signs, as printed, every mean is nothing."
SAME_ELLIPSE = (
    "Two vectors that turn against each other add up to one and the same ellipse, turned by the phase: the mean size "
    "is that of every phase."
)
BY_FORMULA = "By eq. 8 with each printed share times its mass."

TOGETHER = (
    Entry((*equations("9", "10", "11"), "section 2.2.3"), "eta1 at 90 deg", Printed(("0.65",)), Verdict.UNDER_READING,
          eta(reciprocating_share, 90.0), SIZES),
    Entry((*equations("9", "10", "11"), "section 2.2.3"), "eta1 at 45 deg", Printed(("0.72",)),
          Verdict.NOT_REPRODUCIBLE, eta(reciprocating_share, 45.0), f"{SIZES} It is rounded up."),
    Entry((*equations("9", "10", "11"), "section 2.2.3"), "eta1 at 0 deg", Printed(("0.74",)),
          Verdict.NOT_REPRODUCIBLE, eta(reciprocating_share, 0.0), SIZES),
    *(
        Entry((*equations("12", "13", "14", "15", "16"), "section 2.2.3"), f"eta2 at {phase:g} deg", Printed((text,)),
              Verdict.NOT_REPRODUCIBLE, eta(rotating_share, phase), SAME_ELLIPSE)
        for phase, text in ((45.0, "0.86"), (90.0, "0.71"), (0.0, "0.77"))
    ),
    Entry(("section 2.2.3", "section 3.3", "section 4"), "best phase of the pan", Printed(("90",), "deg"),
          Verdict.REPRODUCED,
          lambda: computed(degrees(best_phase_rad(*cranks(0.0, *map(float, (*PAN_PRINTED, *SIEVE_PRINTED))))))),
    Entry(("section 2.2.3",), "sieve's counterweight at 90 deg", Printed(("11.4", "13.7"), "kg"),
          Verdict.UNDER_READING, combined(90),
          f"{BY_FORMULA} The upper one comes out only with the rounding of the shares."),
    Entry(("section 2.2.3", "section 3.3"), "sieve's counterweight at 45 deg", Printed(("13.9", "16.5"), "kg"),
          Verdict.NOT_REPRODUCIBLE, combined(45), BY_FORMULA),
    Entry(("section 2.2.3",), "sieve's counterweight at 0 deg", Printed(("13.2", "15.8"), "kg"),
          Verdict.NOT_REPRODUCIBLE, combined(0), BY_FORMULA),
)  # fmt: skip

ENTRIES = (*MOTION, *PAN_ALONE, *SIEVE_ALONE, *TOGETHER)
