"""Sections 2.3, 3.2 and 3.3, eqs. 9 to 13, Tables 1, 3 and 4: frequencies of shafts, engine and piston."""

from __future__ import annotations

from ncgear.balance.excitation import Engine, Shaft, margins, of_engine, of_shaft
from ncgear.papers.entry import Computed, Entry, Printed, Verdict, computed, equations, from_readings

SHAFTS = (
    Shaft("engine", 2400.0, 15),
    Shaft("engine drive shaft", 1354.0, 14, 32),
    Shaft("knotter shaft", 96.5, 13, 32),
    Shaft("mower shaft", 96.5, 13, 32),
    Shaft("bale transport shaft", 193.0, 13, 21),
    Shaft("gear transmission", 391.7, 15, 73),
    Shaft("feeding wheel I", 569.8, 13, 30),
    Shaft("feeding wheel II", 341.8, 13, 21),
    Shaft("feeding auger", 226.0, 14),
    Shaft("pick-up", 141.0, 13, 58),
)
ROTATION = ("40", "22.57", "1.61", "1.61", "3.22", "6.53", "9.50", "5.70", "3.77", "2.35")
ROLLERS = ("600", "315.98", "20.93", "20.93", "41.86", "97.95", "123.5", "74.1", "52.78", "30.55")
TEETH = ("722.24", "51.52", "51.52", "67.62", "476.69", "285", "119.7", "136.3")
ENGINE = Engine("engine", 2400.0, cylinders=4, strokes=4)
AUGER_HZ = 226.0 / 60.0

SIMULATED_HZ = ("4.62", "17.26", "29.82", "63.85", "83.73", "141.58")
NATURAL_HZ = tuple(map(float, SIMULATED_HZ))
MEASURED_HZ = ("4.39", "18.29", "29.41", "63.48", "82.03", "125.49")


def of_kind(kind: str) -> list[float]:
    """Frequencies of the shafts of one kind in Hz, in the table's order."""
    return [one.frequency_hz for shaft in SHAFTS for one in of_shaft(shaft) if one.kind == kind]


def from_printed(counts: list[int | None]) -> Computed:
    """Rollers or teeth times the printed frequencies of the shafts, in Hz; shafts without a count are left out."""
    known, printed = zip(*((count, text) for count, text in zip(counts, ROTATION, strict=True) if count), strict=True)
    return from_readings(lambda *rates: tuple(count * rate for count, rate in zip(known, rates, strict=True)), *printed)


def engine(kind: str) -> float:
    """One of the engine's frequencies in Hz."""
    return next(one.frequency_hz for one in of_engine(ENGINE) if one.kind == kind)


def errors(*orders: int) -> Computed:
    """Differences of simulated and measured natural frequencies in percent of the measured ones; orders from 1."""
    texts = [text for order in orders for text in (SIMULATED_HZ[order - 1], MEASURED_HZ[order - 1])]

    def percent(*readings: float) -> tuple[float, ...]:
        return tuple(100.0 * abs(one - other) / other for one, other in zip(readings[::2], readings[1::2], strict=True))

    return from_readings(percent, *texts)


def nearer_than_the_auger() -> Computed:
    """Number of other excitations as near to a natural frequency as the auger's rotation is to the first."""
    excitations = [*of_engine(ENGINE), *(one for shaft in SHAFTS for one in of_shaft(shaft))]
    found = margins(excitations, NATURAL_HZ, 1.0 - AUGER_HZ / NATURAL_HZ[0])
    return computed(sum(one.near and one.excitation.source != "feeding auger" for one in found))


GEOMETRY = "The part's geometry and its finite-element model."

SHAFTS_AND_ENGINE = (
    Entry((*equations("9"), "Table 1", "section 2.3"), "frequencies of the ten shafts", Printed(ROTATION, "Hz"),
          Verdict.REPRODUCED, lambda: computed(*of_kind("rotation"))),
    Entry((*equations("11"), "Table 1"), "rollers passing in their bearings", Printed(ROLLERS, "Hz"),
          Verdict.REPRODUCED, lambda: from_printed([shaft.rollers for shaft in SHAFTS]), of_printed=True),
    Entry(equations("11"), "frequencies at which rollers pass a place of either race", Printed(ROLLERS, "Hz"),
          Verdict.NEEDS_DATA, None,
          "Diameters of rollers and pitch circles: the cage turns at about 0.4 of the shaft's speed, not with it."),
    Entry((*equations("10"), "Table 1"), "teeth of sprockets and gears", Printed(TEETH, "Hz"), Verdict.REPRODUCED,
          lambda: from_printed([shaft.teeth for shaft in SHAFTS]), of_printed=True),
    Entry((*equations("12", "13"), "section 2.3"), "combustion and inertia of the engine", Printed(("80", "80"), "Hz"),
          Verdict.REPRODUCED, lambda: computed(engine("combustion"), engine("inertia"))),
)  # fmt: skip

NATURAL = (
    Entry(("Table 3", "Fig. 12", "Table 4", "section 3.2"), "natural frequencies by finite elements",
          Printed(SIMULATED_HZ, "Hz"), Verdict.NEEDS_DATA, None, GEOMETRY),
    Entry(("Table 4", "Fig. 14"), "natural frequencies measured", Printed(MEASURED_HZ, "Hz"), Verdict.NEEDS_DATA, None,
          "The records of the measurement."),
    Entry(("Table 4",), "differences of the 1st, 3rd, 4th and 5th", Printed(("5.2", "1.4", "0.6", "2"), "%"),
          Verdict.REPRODUCED, lambda: errors(1, 3, 4, 5), of_printed=True),
    Entry(("Table 4", "section 3.3"), "differences of the 2nd and the 6th, which is the largest",
          Printed(("5.9", "11.3"), "%"), Verdict.NOT_REPRODUCIBLE, lambda: errors(2, 6), "By the measured frequency, "
          "as the other four are; the printed ones are by the simulated frequency, cut off.", of_printed=True),
    Entry(("section 3.3",), "the auger's frequency by the first natural one", Printed(("0.8",)), Verdict.REPRODUCED,
          lambda: from_readings(lambda auger, first: (auger / first,), "3.77", "4.62"), of_printed=True),
    Entry(("section 3.3",), "other excitations as near to a natural frequency as that", Printed(("0",)),
          Verdict.NOT_REPRODUCIBLE, nearer_than_the_auger, "Rollers of the pick-up stand nearer to the third natural "
          "frequency, and combustion to the fifth, than the auger to the first."),
)  # fmt: skip
