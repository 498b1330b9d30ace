"""The table of materials by name: strength class, hardness, elastic constants and density, each with its source.

This module is plain Python, since the keys of design files read it.  ``ncgear.strength.endurance`` computes from a row
of this table the stresses that a gear endures.
"""

from __future__ import annotations

from difflib import get_close_matches

from ncgear.frozen import dataclass
from ncgear.strength.classes import (
    ALLOY,
    CARBON,
    CASE,
    CASE_HARD_CORE,
    GREY,
    INDUCTION,
    NITRIDED,
    NITRIDING,
    NODULAR,
    STRUCTURAL,
    Quality,
    StrengthClass,
)


@dataclass(frozen=True)
class Elastic:
    """Young's modulus in MPa, Poisson's ratio and density in kg/m3 at 20 degrees C, linear expansion per K from there.

    Expansions are rounded: of steel from EN 1993-1-1 and EN 10088-1, of iron from EN 1561 and EN 1563, of bronzes and
    plastics from the data sheets of their makers, which differ by a tenth or more.
    """

    youngs_modulus_mpa: float
    poisson: float
    density_kg_m3: float
    expansion_per_k: float


@dataclass(frozen=True)
class Ferrous:
    """Steel or iron of a strength class of ISO 6336-5, with the hardness and the quality that it usually has."""

    name: str
    meaning: str
    group: StrengthClass
    hardness: float
    elastic: Elastic
    quality: Quality = Quality.MQ

    @property
    def source(self) -> str:
        """Where the strength comes from."""
        return (
            f"ISO 6336-5:2016, table 1, class {self.group.abbreviation}, {self.quality} at {self.hardness:g} "
            f"{self.group.scale} (secondary source)"
        )


@dataclass(frozen=True)
class Bronze:
    """A bronze: stresses in MPa that flanks and roots endure for 1e7 cycles."""

    name: str
    meaning: str
    contact_mpa: float
    bending_mpa: float
    elastic: Elastic

    @property
    def source(self) -> str:
        """Where the strength comes from."""
        return "AGMA 2001-D04, tables 3 and 4, at 1e7 cycles (secondary source)"


@dataclass(frozen=True)
class Plastic:
    """A plastic whose strength falls with temperature and cycles.

    ``root`` names a formula of ``ncgear.strength.plastics``; ``pits`` tells whether its formula for flanks holds, since
    some materials have no figures.  ``hottest_c`` is the highest temperature at which the figures hold.  ``friction``
    is the coefficient on steel when dry.
    """

    name: str
    meaning: str
    pits: bool
    root: str
    hottest_c: float
    friction: float
    elastic: Elastic
    source: str


Entry = Ferrous | Bronze | Plastic

STEEL = Elastic(206_000.0, 0.3, 7850.0, 11.5e-6)
VDI = "VDI 2736-2:2014 (secondary source)"
ROUGH = "rough: a cautious guess from the strength of printed bars, not from tests of gears; no figures for pitting"

ROWS: tuple[Entry, ...] = (
    Ferrous("S235", "structural steel", STRUCTURAL, 120.0, STEEL),
    Ferrous("E335", "structural steel", STRUCTURAL, 190.0, STEEL),
    Ferrous("C45", "carbon steel, normalized", CARBON, 190.0, STEEL),
    Ferrous("42CrMo4", "alloy steel, quenched and tempered", ALLOY, 300.0, STEEL),
    Ferrous("34CrNiMo6", "alloy steel, quenched and tempered", ALLOY, 310.0, STEEL),
    Ferrous("16MnCr5", "case-hardening steel", CASE, 720.0, STEEL),
    Ferrous("18CrNiMo7-6", "case-hardening steel", CASE_HARD_CORE, 740.0, STEEL),
    Ferrous("42CrMo4-induction", "alloy steel, flanks and roots induction-hardened", INDUCTION, 560.0, STEEL),
    Ferrous("42CrMo4-nitrided", "alloy steel, quenched, tempered and gas-nitrided", NITRIDED, 550.0, STEEL),
    Ferrous("31CrMoV9", "nitriding steel, gas-nitrided", NITRIDING, 700.0, STEEL),
    Ferrous("GJS-600-3", "nodular cast iron", NODULAR, 230.0, Elastic(174_000.0, 0.275, 7200.0, 12.5e-6)),
    Ferrous("GJL-250", "grey cast iron", GREY, 200.0, Elastic(110_000.0, 0.26, 7200.0, 11.7e-6)),
    Bronze("CuSn12", "tin bronze, sand-cast", 207.0, 39.0, Elastic(95_000.0, 0.34, 8700.0, 18.5e-6)),
    Bronze("CuAl10Fe", "aluminium bronze, heat-treated", 448.0, 163.0, Elastic(115_000.0, 0.33, 7600.0, 17e-6)),
    Plastic("POM", "polyacetal", True, "POM", 120.0, 0.2, Elastic(2800.0, 0.35, 1410.0, 110e-6), VDI),
    Plastic("PA66", "polyamide 66, moist", True, "PA66", 120.0, 0.2, Elastic(1600.0, 0.4, 1140.0, 80e-6), VDI),
    Plastic("PA66-dry", "polyamide 66, as moulded", True, "PA66", 120.0, 0.2, Elastic(3100.0, 0.4, 1140.0, 80e-6), VDI),
    Plastic(
        "PA66-GF30",
        "polyamide 66 with 30 % glass fibre, moist",
        False,
        "PA66",
        120.0,
        0.3,
        Elastic(7200.0, 0.4, 1370.0, 50e-6),
        f"root as unfilled polyamide by {VDI}, which glass fibre surpasses; no figures for pitting",
    ),
    Plastic(
        "PLA-print", "polylactide, printed", False, "PLA-print", 50.0, 0.4, Elastic(2800.0, 0.36, 1240.0, 68e-6), ROUGH
    ),
    Plastic("PETG-print", "PETG, printed", False, "PETG-print", 65.0, 0.4, Elastic(1800.0, 0.4, 1270.0, 60e-6), ROUGH),
)

TABLE: dict[str, Entry] = {entry.name: entry for entry in ROWS}
"""All materials by name."""


def near_materials(name: str) -> list[str]:
    """The materials of the table whose names begin as a name that is not in it, or else the nearest name, if any."""
    begun = [material for material in TABLE if material.casefold().startswith(name.casefold())]
    return begun or get_close_matches(name, TABLE, n=1, cutoff=0.5)


ASSUMED = "42CrMo4"
"""Material where a design names none: the most usual steel of gears without hardened flanks.  All results that depend
on it say that it is assumed."""


@dataclass(frozen=True)
class Choice:
    """The material of one gear: a row of the table, and a person's own values in place of the row's.

    ``contact_limit_mpa`` and ``bending_limit_mpa`` are the stresses of endurance sigma_Hlim and sigma_FE; sigma_FE is
    the local stress at the root, twice sigma_Flim.  For plastics they hold at every temperature and number of cycles.
    ``assumed`` is true where the design names none.
    """

    entry: Entry
    contact_limit_mpa: float | None = None
    bending_limit_mpa: float | None = None
    assumed: bool = False

    @property
    def own(self) -> bool:
        """Whether any strength is a person's own."""
        return self.contact_limit_mpa is not None or self.bending_limit_mpa is not None


def assumed_choice() -> Choice:
    """The material where a design names none."""
    return Choice(TABLE[ASSUMED], assumed=True)
