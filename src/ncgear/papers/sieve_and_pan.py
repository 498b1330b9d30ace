"""C. Wei, L. Xu, J. Wang, Y. Li: the sieve and the return pan of a combine harvester."""

from __future__ import annotations

from collections.abc import Callable
from math import degrees, radians

import numpy as np

from ncgear.balance.counterweights import TriedCounterweight, sweep
from ncgear.balance.frame import Crank, best_phase_rad, combined_counterweight_kg, reciprocating_share, rotating_share
from ncgear.balance.mechanism import (
    Carrier,
    Counterweight,
    DrivenCrank,
    JointMasses,
    joint_masses,
    partial_counterweight_kg,
)
from ncgear.frozen import dataclass
from ncgear.mechanisms.crank_slider import CrankSlider
from ncgear.mechanisms.forces import RodMasses
from ncgear.numerics.jet import Jet
from ncgear.numerics.units import RAD_S_PER_RPM
from ncgear.papers.entry import (
    Below,
    Computed,
    Entry,
    Finding,
    LeftOut,
    Paper,
    Printed,
    Reason,
    Relation,
    computed,
    counted,
    equations,
    from_readings,
    half_step,
    printed,
    texts,
)
from ncgear.papers.track_chassis.slider import two_term_stroke
from ncgear.ratio.laws.uniform import uniform_law
from ncgear.ratio.transmission import Lobes

# --- the data of the paper, and the two mechanisms made from them ----------------------------------------------------

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
"""Distance from the pin to the board's centre of mass that the printed masses at pin and roller give."""


def mechanism(linkage: CrankSlider, board_kg: float, center_mm: float) -> DrivenCrank:
    """Crank, board and roller, driven evenly at the printed speed; the board's inertia, not given, is left out."""
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
    """Eq.  2 against both linkages, relative to the stroke.

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
    Entry("eq. 2", "slider's place against crank angle", Relation(), Finding.UNDER_READING, place_residual,
          "With the sine of the rod's angle as crank by rod times that of the crank's; it is printed upside down."),
    Entry("eq. 3, eq. 4, eq. 5", "acceleration by two terms, of which the inertia forces are made", Relation(),
          Finding.UNDER_READING, acceleration_residual, "With the square of the crank's speed, and counted positive "
          "towards the crank axis."),
    Entry("section 2.2.1", "crank by connecting rod", printed("0.01 0.01"), Finding.REPRODUCED,
          lambda: (*(CRANK_MM / linkage.rod_mm for linkage in (PAN_LINKAGE, SIEVE_LINKAGE)),)),
    Entry("section 2.2", "connecting rod by crank, about", printed("100 100"), Finding.REPRODUCED,
          lambda: (*(linkage.rod_mm / CRANK_MM for linkage in (PAN_LINKAGE, SIEVE_LINKAGE)),),
          "To the one digit that counts; 70 for the pan and 92 for the sieve."),
    Entry("section 3.1", "speed of 350 r/min in the simulation", printed("2100 r/s"), Finding.UNDER_READING,
          lambda: SPEED_RPM * 6.0, "In degrees per second."),
    Entry("section 3.1", "time of one turn", printed("0.17 s"), Finding.REPRODUCED, lambda: 60.0 / SPEED_RPM),
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
    Entry("eq. 1, section 2.2.2", "pan: crank at the pin", printed("0.8 kg"), Finding.REPRODUCED,
          lambda: CRANK_KG * CRANK_CENTER_MM / CRANK_MM),
    Entry("eq. 1, section 2.2.2", "pan: board at pin and roller", printed("11.1 12.6 kg"), Finding.NOT_REPRODUCIBLE,
          pan_board, "The place printed for the board's centre is that of the crank's; the printed masses put it near "
          "the middle."),
    Entry("eq. 1, section 2.2.2", "pan: all at pin and roller", printed("11.9 12.86 kg"), Finding.REPRODUCED,
          lambda: from_readings(lambda *kg: (kg[0] + kg[1], kg[2] + ROLLER_KG), "0.8", "11.1", "12.6"),
          of_printed=True),
    Entry("eq. 6, eq. 7, eq. 8, section 2.2.2, section 4", "pan: counterweight", printed("5.4 6.1 kg"),
          Finding.REPRODUCED, lambda: from_masses(lambda masses: counterweights(PAN_LINKAGE, masses), *PAN_PRINTED)),
)  # fmt: skip

SIEVE_ALONE = (
    Entry("eq. 1, section 2.2.2", "sieve: all at the pin", printed("29.5 kg"), Finding.NOT_REPRODUCIBLE,
          lambda: SIEVE_OWN.rotating_kg, "Board and crank make more, the board alone less."),
    Entry("eq. 1, section 2.2.2", "sieve: all at the roller", printed("61.26 kg"), Finding.UNDER_READING,
          lambda: round(SIEVE_OWN.reciprocating_kg - ROLLER_KG, 1) + ROLLER_KG,
          "The board's part rounded to one decimal before the roller is added."),
    Entry("eq. 8, section 2.2.2", "sieve: counterweight, from the printed masses", printed("16.7 20.1 kg"),
          Finding.REPRODUCED,
          lambda: from_masses(lambda masses: counterweights(SIEVE_LINKAGE, masses), *SIEVE_PRINTED),
          "Only with the rounding of the 29.5 kg: from 29.50 kg both come out 0.06 kg less."),
    Entry("eq. 8", "sieve: counterweight, from its dimensions", printed("16.7 20.1 kg"), Finding.NOT_REPRODUCIBLE,
          lambda: (*counterweights(SIEVE_LINKAGE, SIEVE_OWN),), "The mass at the pin is another."),
    Entry("section 4", "sieve: counterweight, as concluded", printed("16.0 20.1 kg"), Finding.NOT_REPRODUCIBLE,
          lambda: from_masses(lambda masses: counterweights(SIEVE_LINKAGE, masses), *SIEVE_PRINTED),
          "The lower one is printed otherwise in section 2.2.2."),
)  # fmt: skip

# --- section 2.2.3, eqs.  9 to 16: the rest of the forces of both, and the counterweight for it ---------------------

PRINTED_SHARES = {45: ("0.72", "0.86"), 90: ("0.65", "0.71"), 0: ("0.74", "0.77")}
"""Printed eta1 and eta2, by the pan's phase in degrees."""


def cranks(phase_deg: float, *masses_kg: float) -> tuple[Crank, Crank]:
    """The crank of the pan at a phase and the crank of the sieve, which turns against it; both masses of each."""
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
    Entry("eq. 9, eq. 10, eq. 11, section 2.2.3", "eta1 at 90 deg", printed("0.65"), Finding.UNDER_READING,
          eta(reciprocating_share, 90.0), SIZES),
    Entry("eq. 9, eq. 10, eq. 11, section 2.2.3", "eta1 at 45 deg", printed("0.72"), Finding.NOT_REPRODUCIBLE,
          eta(reciprocating_share, 45.0), f"{SIZES} It is rounded up."),
    Entry("eq. 9, eq. 10, eq. 11, section 2.2.3", "eta1 at 0 deg", printed("0.74"), Finding.NOT_REPRODUCIBLE,
          eta(reciprocating_share, 0.0), SIZES),
    *(
        Entry("eq. 12, eq. 13, eq. 14, eq. 15, eq. 16, section 2.2.3", f"eta2 at {phase:g} deg", Printed((text,)),
              Finding.NOT_REPRODUCIBLE, eta(rotating_share, phase), SAME_ELLIPSE)
        for phase, text in ((45.0, "0.86"), (90.0, "0.71"), (0.0, "0.77"))
    ),
    Entry("section 2.2.3, section 3.3, section 4", "best phase of the pan", printed("90 deg"), Finding.REPRODUCED,
          lambda: degrees(best_phase_rad(*cranks(0.0, *map(float, (*PAN_PRINTED, *SIEVE_PRINTED)))))),
    Entry("section 2.2.3", "sieve's counterweight at 90 deg", printed("11.4 13.7 kg"), Finding.UNDER_READING,
          combined(90), f"{BY_FORMULA} The upper one comes out only with the rounding of the shares."),
    Entry("section 2.2.3, section 3.3", "sieve's counterweight at 45 deg", printed("13.9 16.5 kg"),
          Finding.NOT_REPRODUCIBLE, combined(45), BY_FORMULA),
    Entry("section 2.2.3", "sieve's counterweight at 0 deg", printed("13.2 15.8 kg"), Finding.NOT_REPRODUCIBLE,
          combined(0), BY_FORMULA),
)  # fmt: skip


@dataclass(frozen=True)
class SweepTable:
    """Columns of a table as printed: counterweights in kg, forces in N."""

    mass: tuple[str, ...]
    least: tuple[str, ...]
    most: tuple[str, ...]
    mean: tuple[str, ...]
    rms: tuple[str, ...]
    spread: tuple[str, ...]

    def spreads(self) -> Computed:
        """Largest minus least force, and by how much their rounding to whole numbers may move it."""
        pairs = list(zip(self.least, self.most, strict=True))
        return Computed(tuple(float(b) - float(a) for a, b in pairs), (2.0 * half_step("1"),) * len(pairs))

    def steadiest(self) -> Computed:
        """Counterweight in kg with the least spread."""
        return computed(min(zip(map(float, self.spread), map(float, self.mass), strict=True))[1])

    def below_none(self) -> Computed:
        """Mean, r.m.s.  and spread with each counterweight, paired with the first row, which has no counterweight."""
        columns = [list(map(float, column)) for column in (self.mean, self.rms, self.spread)]
        return computed(*(value for column in columns for reading in column[1:] for value in (reading, column[0])))

    def forces(self, mass: str) -> tuple[str, ...]:
        """Least, largest, mean and r.m.s. force of one row."""
        row = self.mass.index(mass)
        return tuple(column[row] for column in (self.least, self.most, self.mean, self.rms))


PAN_TABLE = SweepTable(
    texts("0 5.5 5.7 5.9 6.1"), texts("159 524 535 546 542"), texts("968 681 676 678 682"),
    texts("699 612 611 610 608"), texts("737 614 613 611 609"), texts("809 157 141 132 140"),
)  # fmt: skip
SIEVE_TABLE = SweepTable(
    texts("0 16.8 17.4 18.0 18.6 19.2 19.8"), texts("350 941 911 881 851 822 792"),
    texts("2587 2044 2046 2044 2051 2059 2070"), texts("1811 1455 1448 1442 1435 1429 1424"),
    texts("1995 1495 1491 1487 1486 1484 1484"), texts("2237 1103 1132 1163 1200 1237 1278"),
)  # fmt: skip
BOTH_TABLE = SweepTable(
    texts("14.0 14.5 15 15.5 16 16.5"), texts("1580 1593 1604 1612 1592 1568"),
    texts("2510 2511 2513 2518 2523 2530"), texts("1941 1937 1934 1930 1927 1925"),
    texts("1965 1962 1959 1957 1956 1954"), texts("930 918 909 906 931 962"),
)  # fmt: skip


def bearing(mechanism: DrivenCrank, mass_kg: float) -> Computed:
    """Least, largest, mean and r.m.s.  force in N on the crank's bearing, in the plane of motion, without weight."""
    found = _tried(mechanism, mass_kg).bearing_n
    return computed(found.minimum, found.maximum, found.mean, found.rms)


MODEL = (
    "Inertias, slopes, weights, and what else the simulation's bearing carries. Computed for rigid bodies in line, "
    "without weight and without the board's inertia."
)
NO_MODEL = "The simulated assembly: inertias, slopes and what the frame's bearings carry."

WHICH_MASSES = (
    "Which parts the common centre is of. Computed for all that moves, with the board's centre where its printed "
    "masses put it."
)


def track_extent(mechanism: DrivenCrank, *masses_kg: float) -> Computed:
    """Extent in mm of the path of the common centre of mass, along the slider's line and across it; least and largest
    over some counterweights."""
    found = [_tried(mechanism, mass).track.extent_mm for mass in masses_kg]
    return computed(*(value for along in zip(*found, strict=True) for value in sorted(along)))


def _tried(mechanism: DrivenCrank, mass_kg: float) -> TriedCounterweight:
    return sweep(mechanism, Counterweight(Carrier.CRANK, 0.0, ARM_MM), [mass_kg])[0]


def _force(place: str, what: str, table: SweepTable, mechanism: DrivenCrank | None, mass: str) -> Entry:
    with_mass = "without counterweight" if mass == "0" else f"with {mass} kg"
    compute = (lambda: bearing(mechanism, float(mass))) if mechanism else None
    printed, words = Printed(table.forces(mass), "N"), MODEL if mechanism else NO_MODEL
    what = f"{what} {with_mass}: least, largest, mean and r.m.s. force"
    return Entry(place, what, printed, Finding.NEEDS_DATA, compute, words)


FORCES = tuple(
    _force(place, what, table, mechanism, mass)
    for place, what, table, mechanism in (
        ("Table 1", "pan", PAN_TABLE, PAN),
        ("Table 2", "sieve", SIEVE_TABLE, SIEVE),
        ("Table 3", "both", BOTH_TABLE, None),
    )
    for mass in table.mass
)

TRACKS = (
    Entry("Fig. 9, Fig. 10, section 3.1", "way of the pan's centre without counterweight, along and across",
          printed("21.9 11.1 mm"), Finding.NEEDS_DATA, lambda: track_extent(PAN, 0.0), WHICH_MASSES),
    Entry("section 3.1", "ways of the pan's centre with counterweights, along and across, least and largest",
          printed("9 11 0.2 0.6 mm"), Finding.NEEDS_DATA, lambda: track_extent(PAN, 5.5, 6.1), WHICH_MASSES),
    Entry("section 3.1", "way of the pan's centre, along and across, against what is printed with counterweights",
          printed("14 1.1 mm"), Finding.NOT_REPRODUCIBLE, lambda: (11.0, 0.6),
          "The paragraph after it prints 9 to 11 and 0.2 to 0.6 mm with, 21.9 and 11.1 mm without a counterweight.",
          of_printed=True),
    Entry("Fig. 11, section 3.1", "area of the pan's track with 5.9 kg", printed("1.7 mm2"), Finding.NEEDS_DATA,
          lambda: _tried(PAN, 5.9).track.area_mm2, WHICH_MASSES),
)  # fmt: skip

SPREADS = (
    *(
        Entry(place, "peak to peak", Printed(table.spread, "N"), Finding.REPRODUCED, table.spreads, of_printed=True)
        for place, table in (("Table 1", PAN_TABLE), ("Table 3", BOTH_TABLE))
    ),
    Entry("Table 2", "peak to peak", Printed(SIEVE_TABLE.spread, "N"), Finding.NOT_REPRODUCIBLE, SIEVE_TABLE.spreads,
          "The row of 17.4 kg contradicts itself; the others agree.", of_printed=True),
    *(
        Entry(f"{place}, {section}", "mean, r.m.s. and peak to peak fall with every counterweight",
              Below("all decreased"), Finding.REPRODUCED, table.below_none, of_printed=True)
        for place, section, table in (("Table 1", "section 3.1", PAN_TABLE), ("Table 2", "section 3.2", SIEVE_TABLE))
    ),
    Entry("section 3.1", "peak to peak along the slider's line falls with counterweights", Below("850 N to 1408 N"),
          Finding.NOT_REPRODUCIBLE, lambda: (1408.0, 850.0), "What is called a decrease is printed as a rise.",
          of_printed=True),
    Entry("section 3.1", "peak to peak without and with counterweights, along and across",
          printed("850 1408 586 275 N"), Finding.NEEDS_DATA, None, MODEL),
)  # fmt: skip

BEST = (
    Entry("Table 1, section 3.1, section 4", "pan's best counterweight", printed("5.9 kg"), Finding.FITTED,
          PAN_TABLE.steadiest, "The one of least peak to peak in the table; mean and r.m.s., named beside it, are "
          "less with 6.1 kg.", of_printed=True),
    Entry("Table 2, section 3.2, section 4", "sieve's best counterweight", printed("18.0 kg"),
          Finding.NOT_REPRODUCIBLE, SIEVE_TABLE.steadiest, "The one of least peak to peak in the table; by mean and "
          "r.m.s. it is 19.8 kg.", of_printed=True),
    Entry("Table 3, section 3.3, section 4", "best counterweight for both at 45 deg", printed("15.5 kg"),
          Finding.REPRODUCED, BOTH_TABLE.steadiest, "By the peak to peak, as the text says.", of_printed=True),
    Entry("section 3.3", "counterweights tried for both", printed("7"), Finding.NOT_REPRODUCIBLE,
          lambda: len(BOTH_TABLE.mass), "The text names seven, from 13.5 to 16.6 kg; Table 3 has six, from 14.0 to "
          "16.5 kg.", of_printed=True),
    Entry("section 3.3", "largest force at 45 deg, from Table 3", printed("2518 N"), Finding.REPRODUCED,
          lambda: float(BOTH_TABLE.forces("15.5")[1]), of_printed=True),
    Entry("section 3.3", "least force at 45 deg, from Table 3", printed("1611 N"), Finding.NOT_REPRODUCIBLE,
          lambda: float(BOTH_TABLE.forces("15.5")[0]), "Table 3 and text differ.", of_printed=True),
    Entry("section 3.3", "largest and least force at 90 deg and at 0 deg", printed("1604 613 1828 697 N"),
          Finding.NEEDS_DATA, None, NO_MODEL),
    Entry("section 3.3", "largest and least force are less at 90 deg than at 0 deg and at 45 deg",
          Below("significantly decreased"), Finding.REPRODUCED,
          lambda: (1604.0, 1828.0, 1604.0, 2518.0, 613.0, 697.0, 613.0, 1611.0), of_printed=True),
    Entry("section 3.3", "less counterweight for both together than for the sieve alone", Below("reduced"),
          Finding.REPRODUCED, lambda: (15.5, 18.0), of_printed=True),
    Entry("abstract", "best counterweight for both at 90 deg", printed("14.0 kg"), Finding.NEEDS_DATA, None, NO_MODEL),
)  # fmt: skip


PAPER = Paper(
    "Sieve and return pan of a combine harvester",
    "C. Wei, L. Xu, J. Wang, Y. Li, Inertial force balance and ADAMS simulation of the oscillating sieve and return "
    "pan of a rice combine harvester, Int. J. Agric. & Biol. Eng. 11(1), 2018",
    promised=(*counted("Table", 3), *equations(*range(1, 17))),
    entries=(*MOTION, *PAN_ALONE, *SIEVE_ALONE, *TOGETHER, *TRACKS, *FORCES, *SPREADS, *BEST),
    left_out=(
        LeftOut("section 2.2.2", "cranks of 15 mm and 1.0 kg, centre at 12.3 mm; boards of 1045 mm and 23.7 kg, 1378 "
                "mm and 90.4 kg; rollers of 0.26 kg; counterweights at 45 mm; 350 r/min", Reason.GIVEN,
                texts("15 1.0 12.3 350 1045 12.3 23.7 0.26 45 15 1.0 12.3 350 1378 448 90.4 0.26 45")),
        LeftOut("section 2.2.1, section 2.2.2", "shares of the reciprocating mass, in parts", Reason.GIVEN,
                texts("1 3 1 2")),
        LeftOut("section 2.2.3", "phases of sieve and pan", Reason.GIVEN, texts("90 45 90 0")),
        LeftOut("section 3.1", "counterweights tried, time and steps of the simulation", Reason.GIVEN,
                texts("350 5.4 6.1 5.5 5.7 5.9 6.1 0.5 0.01")),
        LeftOut("section 3.2", "counterweights tried, time and steps of the simulation", Reason.GIVEN,
                texts("16.7 20.1 16.8 17.4 18.0 18.6 19.2 19.8 1.0 0.01")),
        LeftOut("section 3.3", "counterweights tried, phases, time and steps of the simulation", Reason.GIVEN,
                texts("45 13.5 14.0 14.5 15 15.5 16 16.6 1.0 0.01 18.0 0 45 90")),
        LeftOut("Table 1, Table 2, Table 3", "counterweights tried", Reason.GIVEN,
                (*PAN_TABLE.mass, *SIEVE_TABLE.mass, *BOTH_TABLE.mass)),
        LeftOut("Fig. 12, Fig. 17, Fig. 25", "tracks and forces of the simulation, as curves", Reason.DRAWN),
        LeftOut("section 3.1, section 3.2, section 3.3", "tracks that are shorter with one counterweight than with "
                "another", Reason.VAGUE),
    ),
)  # fmt: skip
