"""Tables 1 to 3: counterweights tried in a simulation of rigid bodies, and what is concluded from them."""

from __future__ import annotations

from dataclasses import dataclass

from ncgear.balance.counterweights import Tried, sweep
from ncgear.balance.mechanism import Carrier, Counterweight, DrivenCrank
from ncgear.papers.entry import Computed, Entry, Printed, Verdict, computed, half_step, texts
from ncgear.papers.sieve_and_pan.published import ARM_MM, PAN, SIEVE


@dataclass(frozen=True)
class SweepTable:
    """Columns of a table as printed: counterweights in kg, forces in N."""

    mass: tuple[str, ...]
    least: tuple[str, ...]
    most: tuple[str, ...]
    rms: tuple[str, ...]
    spread: tuple[str, ...]

    def spreads(self) -> Computed:
        """Largest minus least force, and how far their rounding to whole numbers may move it."""
        pairs = list(zip(self.least, self.most, strict=True))
        return Computed(tuple(float(b) - float(a) for a, b in pairs), (2.0 * half_step("1"),) * len(pairs))

    def steadiest(self) -> Computed:
        """Counterweight in kg with the least spread."""
        return computed(min(zip(map(float, self.spread), map(float, self.mass), strict=True))[1])


PAN_TABLE = SweepTable(
    texts("0 5.5 5.7 5.9 6.1"), texts("159 524 535 546 542"), texts("968 681 676 678 682"),
    texts("737 614 613 611 609"), texts("809 157 141 132 140"),
)  # fmt: skip
SIEVE_TABLE = SweepTable(
    texts("0 16.8 17.4 18.0 18.6 19.2 19.8"), texts("350 941 911 881 851 822 792"),
    texts("2587 2044 2046 2044 2051 2059 2070"), texts("1995 1495 1491 1487 1486 1484 1484"),
    texts("2237 1103 1132 1163 1200 1237 1278"),
)  # fmt: skip
BOTH_TABLE = SweepTable(
    texts("14.0 14.5 15 15.5 16 16.5"), texts("1580 1593 1604 1612 1592 1568"),
    texts("2510 2511 2513 2518 2523 2530"), texts("1965 1962 1959 1957 1956 1954"), texts("930 918 909 906 931 962"),
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


def track_extent(mechanism: DrivenCrank, mass_kg: float) -> Computed:
    """Extent in mm of the track of the common centre of mass, along the slider's line and across it."""
    return computed(*_tried(mechanism, mass_kg).track.extent_mm)


def track_area(mechanism: DrivenCrank, mass_kg: float) -> Computed:
    """Area in mm^2 that the track of the common centre of mass encloses."""
    return computed(_tried(mechanism, mass_kg).track.area_mm2)


def _tried(mechanism: DrivenCrank, mass_kg: float) -> Tried:
    return sweep(mechanism, Counterweight(Carrier.CRANK, 0.0, ARM_MM), [mass_kg])[0]


def _force(place: str, what: str, printed: tuple[str, ...], mechanism: DrivenCrank, mass_kg: float) -> Entry:
    return Entry(
        (place,), f"{what}: least, largest, mean and r.m.s. force", Printed(printed, "N"), Verdict.NEEDS_DATA,
        lambda: bearing(mechanism, mass_kg), MODEL,
    )  # fmt: skip


FORCES = (
    _force("Table 1", "pan without counterweight", ("159", "968", "699", "737"), PAN, 0.0),
    _force("Table 1", "pan with 5.9 kg", ("546", "678", "610", "611"), PAN, 5.9),
    _force("Table 2", "sieve without counterweight", ("350", "2587", "1811", "1995"), SIEVE, 0.0),
    _force("Table 2", "sieve with 18.0 kg", ("881", "2044", "1442", "1487"), SIEVE, 18.0),
)

TRACKS = (
    Entry(
        ("Fig. 9", "Fig. 10"), "way of the pan's centre without counterweight, along and across",
        Printed(("21.9", "11.1"), "mm"), Verdict.NEEDS_DATA, lambda: track_extent(PAN, 0.0), WHICH_MASSES,
    ),
    Entry(
        ("Fig. 11",), "area of the pan's track with 5.9 kg", Printed(("1.7",), "mm2"), Verdict.NEEDS_DATA,
        lambda: track_area(PAN, 5.9), WHICH_MASSES,
    ),
)  # fmt: skip

ENTRIES = (
    *TRACKS,
    *FORCES,
    Entry(
        ("Table 3",), "both with 15.5 kg: least, largest, mean and r.m.s. force",
        Printed(("1612", "2518", "1930", "1957"), "N"), Verdict.NEEDS_DATA, None, NO_MODEL,
    ),
    *(
        Entry(
            (place,), "peak to peak, from least and largest", Printed(table.spread, "N"), Verdict.REPRODUCED,
            table.spreads,
        )
        for place, table in (("Table 1", PAN_TABLE), ("Table 3", BOTH_TABLE))
    ),
    Entry(
        ("Table 2",), "peak to peak, from least and largest", Printed(SIEVE_TABLE.spread, "N"),
        Verdict.NOT_REPRODUCIBLE, SIEVE_TABLE.spreads, "The row of 17.4 kg contradicts itself; the others agree.",
    ),
    Entry(("Table 1",), "pan's best counterweight", Printed(("5.9",), "kg"), Verdict.UNDER_READING,
          PAN_TABLE.steadiest, "The one of least peak to peak in the table."),
    Entry(("Table 2",), "sieve's best counterweight", Printed(("18.0",), "kg"), Verdict.NOT_REPRODUCIBLE,
          SIEVE_TABLE.steadiest,
          "The one of least peak to peak in the table; the r.m.s. does not rise with any further mass."),
    Entry(("Table 3",), "best counterweight for both at 45 deg", Printed(("15.5",), "kg"), Verdict.UNDER_READING,
          BOTH_TABLE.steadiest, "The one of least peak to peak in the table."),
    Entry(("section 3.3",), "least force at 45 deg, from Table 3", Printed(("1611",), "N"), Verdict.NOT_REPRODUCIBLE,
          lambda: computed(max(map(float, BOTH_TABLE.least))), "Table 3 and text differ."),
    Entry(("section 3.3",), "largest and least force at 90 deg and at 0 deg",
          Printed(("1604", "613", "1828", "697"), "N"), Verdict.NEEDS_DATA, None, NO_MODEL),
    Entry(("section 3.3",), "best counterweight for both at 90 deg", Printed(("14.0",), "kg"), Verdict.NEEDS_DATA, None,
          NO_MODEL),
)  # fmt: skip
