"""Tables 1 to 3: counterweights tried in a simulation of rigid bodies, and what is concluded from them."""

from __future__ import annotations

from ncgear.balance.counterweights import Tried, sweep
from ncgear.balance.mechanism import Carrier, Counterweight, DrivenCrank
from ncgear.frozen import dataclass
from ncgear.papers.entry import Below, Computed, Entry, Printed, Verdict, computed, half_step, texts
from ncgear.papers.sieve_and_pan.formulas import ARM_MM, PAN, SIEVE


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
        """Largest minus least force, and how far their rounding to whole numbers may move it."""
        pairs = list(zip(self.least, self.most, strict=True))
        return Computed(tuple(float(b) - float(a) for a, b in pairs), (2.0 * half_step("1"),) * len(pairs))

    def steadiest(self) -> Computed:
        """Counterweight in kg with the least spread."""
        return computed(min(zip(map(float, self.spread), map(float, self.mass), strict=True))[1])

    def below_none(self) -> Computed:
        """Mean, r.m.s. and spread with each counterweight, and without one, which is the first row."""
        columns = [list(map(float, column)) for column in (self.mean, self.rms, self.spread)]
        return computed(*(value for column in columns for one in column[1:] for value in (one, column[0])))

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
    """Least, largest, mean and r.m.s. force in N on the crank's bearing, in the plane of the motion without weight."""
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
    """Extent in mm of the track of the common centre of mass, along the slider's line and across it, least to largest
    with some counterweights."""
    found = [_tried(mechanism, mass).track.extent_mm for mass in masses_kg]
    return computed(*(value for along in zip(*found, strict=True) for value in sorted(along)))


def _tried(mechanism: DrivenCrank, mass_kg: float) -> Tried:
    return sweep(mechanism, Counterweight(Carrier.CRANK, 0.0, ARM_MM), [mass_kg])[0]


def _force(place: str, what: str, table: SweepTable, mechanism: DrivenCrank | None, mass: str) -> Entry:
    with_mass = "without counterweight" if mass == "0" else f"with {mass} kg"
    compute = (lambda: bearing(mechanism, float(mass))) if mechanism else None
    printed, words = Printed(table.forces(mass), "N"), MODEL if mechanism else NO_MODEL
    what = f"{what} {with_mass}: least, largest, mean and r.m.s. force"
    return Entry((place,), what, printed, Verdict.NEEDS_DATA, compute, words)


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
    Entry(("Fig. 9", "Fig. 10", "section 3.1"), "way of the pan's centre without counterweight, along and across",
          Printed(("21.9", "11.1"), "mm"), Verdict.NEEDS_DATA, lambda: track_extent(PAN, 0.0), WHICH_MASSES),
    Entry(("section 3.1",), "ways of the pan's centre with counterweights, along and across, least and largest",
          Printed(("9", "11", "0.2", "0.6"), "mm"), Verdict.NEEDS_DATA, lambda: track_extent(PAN, 5.5, 6.1),
          WHICH_MASSES),
    Entry(("section 3.1",), "way of the pan's centre, along and across, against what is printed with counterweights",
          Printed(("14", "1.1"), "mm"), Verdict.NOT_REPRODUCIBLE, lambda: computed(11.0, 0.6),
          "The paragraph after it prints 9 to 11 and 0.2 to 0.6 mm with, 21.9 and 11.1 mm without a counterweight.",
          of_printed=True),
    Entry(("Fig. 11", "section 3.1"), "area of the pan's track with 5.9 kg", Printed(("1.7",), "mm2"),
          Verdict.NEEDS_DATA, lambda: computed(_tried(PAN, 5.9).track.area_mm2), WHICH_MASSES),
)  # fmt: skip

SPREADS = (
    *(
        Entry((place,), "peak to peak", Printed(table.spread, "N"), Verdict.REPRODUCED, table.spreads, of_printed=True)
        for place, table in (("Table 1", PAN_TABLE), ("Table 3", BOTH_TABLE))
    ),
    Entry(("Table 2",), "peak to peak", Printed(SIEVE_TABLE.spread, "N"), Verdict.NOT_REPRODUCIBLE,
          SIEVE_TABLE.spreads, "The row of 17.4 kg contradicts itself; the others agree.", of_printed=True),
    *(
        Entry((place, section), "mean, r.m.s. and peak to peak fall with every counterweight", Below("all decreased"),
              Verdict.REPRODUCED, table.below_none, of_printed=True)
        for place, section, table in (("Table 1", "section 3.1", PAN_TABLE), ("Table 2", "section 3.2", SIEVE_TABLE))
    ),
    Entry(("section 3.1",), "peak to peak along the slider's line falls with counterweights", Below("850 N to 1408 N"),
          Verdict.NOT_REPRODUCIBLE, lambda: computed(1408.0, 850.0), "What is called a decrease is printed as a rise.",
          of_printed=True),
    Entry(("section 3.1",), "peak to peak without and with counterweights, along and across",
          Printed(("850", "1408", "586", "275"), "N"), Verdict.NEEDS_DATA, None, MODEL),
)  # fmt: skip

BEST = (
    Entry(("Table 1", "section 3.1", "section 4"), "pan's best counterweight", Printed(("5.9",), "kg"), Verdict.FITTED,
          PAN_TABLE.steadiest,
          "The one of least peak to peak in the table; mean and r.m.s., named beside it, are less with 6.1 kg.",
          of_printed=True),
    Entry(("Table 2", "section 3.2", "section 4"), "sieve's best counterweight", Printed(("18.0",), "kg"),
          Verdict.NOT_REPRODUCIBLE, SIEVE_TABLE.steadiest,
          "The one of least peak to peak in the table; by mean and r.m.s. it is 19.8 kg.", of_printed=True),
    Entry(("Table 3", "section 3.3", "section 4"), "best counterweight for both at 45 deg", Printed(("15.5",), "kg"),
          Verdict.REPRODUCED, BOTH_TABLE.steadiest, "By the peak to peak, as the text says.", of_printed=True),
    Entry(("section 3.3",), "counterweights tried for both", Printed(("7",)), Verdict.NOT_REPRODUCIBLE,
          lambda: computed(len(BOTH_TABLE.mass)),
          "The text names seven, from 13.5 to 16.6 kg; Table 3 has six, from 14.0 to 16.5 kg.", of_printed=True),
    Entry(("section 3.3",), "largest force at 45 deg, from Table 3", Printed(("2518",), "N"), Verdict.REPRODUCED,
          lambda: computed(float(BOTH_TABLE.forces("15.5")[1])), of_printed=True),
    Entry(("section 3.3",), "least force at 45 deg, from Table 3", Printed(("1611",), "N"), Verdict.NOT_REPRODUCIBLE,
          lambda: computed(float(BOTH_TABLE.forces("15.5")[0])), "Table 3 and text differ.", of_printed=True),
    Entry(("section 3.3",), "largest and least force at 90 deg and at 0 deg",
          Printed(("1604", "613", "1828", "697"), "N"), Verdict.NEEDS_DATA, None, NO_MODEL),
    Entry(("section 3.3",), "largest and least force are less at 90 deg than at 0 deg and at 45 deg",
          Below("significantly decreased"), Verdict.REPRODUCED,
          lambda: computed(1604.0, 1828.0, 1604.0, 2518.0, 613.0, 697.0, 613.0, 1611.0), of_printed=True),
    Entry(("section 3.3",), "less counterweight for both together than for the sieve alone", Below("reduced"),
          Verdict.REPRODUCED, lambda: computed(15.5, 18.0), of_printed=True),
    Entry(("abstract",), "best counterweight for both at 90 deg", Printed(("14.0",), "kg"), Verdict.NEEDS_DATA, None,
          NO_MODEL),
)  # fmt: skip

ENTRIES = (*TRACKS, *FORCES, *SPREADS, *BEST)
