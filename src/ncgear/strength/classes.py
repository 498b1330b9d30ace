"""Strength classes of steel and iron by hardness, and their life curves: ISO 6336-5 and the life factors of ISO 6336.

All values are from secondary sources: the constants of the lines of ISO 6336-5:2016, table 1, from two transcriptions
that agree, the life factors from transcriptions of ISO 6336-2, table 2, and ISO 6336-3, table 1.  This module is plain
Python, since the keys of design files read it.
"""

from __future__ import annotations

from enum import StrEnum
from typing import NamedTuple

from ncgear.frozen import dataclass


class Quality(StrEnum):
    """Grades of material and heat treatment: modest, normal for experienced makers, and high demands."""

    ML = "ML"
    MQ = "MQ"
    ME = "ME"


class HardnessLine(NamedTuple):
    """A stress in MPa that rises in a line with hardness: slope times hardness plus offset, between two hardnesses."""

    slope: float
    offset_mpa: float
    softest: float
    hardest: float

    def at(self, hardness: float) -> float:
        """The stress in MPa; beyond the line's ends that at its ends."""
        return self.slope * min(max(hardness, self.softest), self.hardest) + self.offset_mpa


class LifePoint(NamedTuple):
    """A number of load cycles and the life factor there; between two points, a line in logarithms."""

    cycles: float
    factor: float


Lines = dict[Quality, HardnessLine]


@dataclass(frozen=True)
class StrengthClass:
    """One group of materials of ISO 6336-5.

    ``abbreviation`` is the standard's and ``scale`` the scale of hardness (HBW or HV).  ``contact`` are the lines of
    the allowable stress number for contact, sigma_Hlim, and ``bending`` the lines of the nominal stress number for
    bending, sigma_Flim; the local stress that an unnotched root endures is twice sigma_Flim.  ``contact_life`` and
    ``bending_life`` are the life factors Z_NT and Y_NT: static, endurance, and 0.85 of it at 1e10 cycles.  ``hardened``
    marks a hardened surface, which hardens a soft mate.
    """

    abbreviation: str
    treatment: str
    scale: str
    contact: Lines
    bending: Lines
    contact_life: tuple[LifePoint, ...]
    bending_life: tuple[LifePoint, ...]
    hardened: bool

    @property
    def scuffing_structure(self) -> float:
        """The structural factor X_W of ISO/TS 6336-20: 1.5 of nitrided steel, else 1, with little austenite."""
        return 1.5 if self.abbreviation.startswith("N") else 1.0

    @property
    def hardnesses(self) -> tuple[float, float]:
        """The least and the greatest hardness with figures for contact in the normal quality of the class."""
        line = self.contact[Quality.MQ]
        return line.softest, line.hardest


LONG_LIFE = LifePoint(1e10, 0.85)
"""Both life factors at 1e10 cycles; 1.0 is allowed there only under best conditions and with experience."""

TOUGH_CONTACT = (LifePoint(1e5, 1.6), LifePoint(5e7, 1.0), LONG_LIFE)
"""Z_NT of structural, through-hardened, case- and induction-hardened steel and pearlitic nodular iron; no pits."""

BRITTLE_CONTACT = (LifePoint(1e5, 1.3), LifePoint(2e6, 1.0), LONG_LIFE)
"""Z_NT of nitrided steel and grey iron."""

SOFT_BENDING = (LifePoint(1e4, 2.5), LifePoint(3e6, 1.0), LONG_LIFE)
"""Y_NT of structural and through-hardened steel and pearlitic nodular iron."""

HARD_BENDING = (LifePoint(1e3, 2.5), LifePoint(3e6, 1.0), LONG_LIFE)
"""Y_NT of case- and induction-hardened steel."""

BRITTLE_BENDING = (LifePoint(1e3, 1.6), LifePoint(3e6, 1.0), LONG_LIFE)
"""Y_NT of nitrided steel and grey iron."""


def _lines(ml: tuple[float, ...], mq: tuple[float, ...], me: tuple[float, ...]) -> Lines:
    return {Quality.ML: HardnessLine(*ml), Quality.MQ: HardnessLine(*mq), Quality.ME: HardnessLine(*me)}


STRUCTURAL = StrengthClass(
    "St",
    "normalized low-carbon steel",
    "HBW",
    _lines((1.0, 190.0, 110.0, 210.0), (1.0, 190.0, 110.0, 210.0), (1.52, 250.0, 110.0, 210.0)),
    _lines((0.455, 69.0, 110.0, 210.0), (0.455, 69.0, 110.0, 210.0), (0.386, 147.0, 110.0, 210.0)),
    TOUGH_CONTACT,
    SOFT_BENDING,
    hardened=False,
)
CARBON = StrengthClass(
    "V",
    "through-hardened carbon steel",
    "HV",
    _lines((0.963, 283.0, 135.0, 210.0), (0.925, 360.0, 135.0, 210.0), (0.838, 432.0, 135.0, 210.0)),
    _lines((0.25, 108.0, 115.0, 215.0), (0.24, 163.0, 115.0, 215.0), (0.283, 202.0, 115.0, 215.0)),
    TOUGH_CONTACT,
    SOFT_BENDING,
    hardened=False,
)
ALLOY = StrengthClass(
    "V",
    "through-hardened alloy steel",
    "HV",
    _lines((1.313, 188.0, 200.0, 360.0), (1.313, 373.0, 200.0, 360.0), (2.213, 260.0, 200.0, 390.0)),
    _lines((0.423, 104.0, 200.0, 360.0), (0.425, 187.0, 200.0, 360.0), (0.358, 231.0, 200.0, 390.0)),
    TOUGH_CONTACT,
    SOFT_BENDING,
    hardened=False,
)
CASE_CONTACT = _lines((0.0, 1300.0, 600.0, 800.0), (0.0, 1500.0, 660.0, 800.0), (0.0, 1650.0, 660.0, 800.0))
CASE = StrengthClass(
    "Eh",
    "case-hardened, core of 25 HRC or over",
    "HV",
    CASE_CONTACT,
    _lines((0.0, 312.0, 600.0, 800.0), (0.0, 425.0, 660.0, 800.0), (0.0, 525.0, 660.0, 800.0)),
    TOUGH_CONTACT,
    HARD_BENDING,
    hardened=True,
)
CASE_HARD_CORE = StrengthClass(
    "Eh",
    "case-hardened, core of 30 HRC or over",
    "HV",
    CASE_CONTACT,
    _lines((0.0, 312.0, 600.0, 800.0), (0.0, 500.0, 660.0, 800.0), (0.0, 525.0, 660.0, 800.0)),
    TOUGH_CONTACT,
    HARD_BENDING,
    hardened=True,
)
INDUCTION = StrengthClass(
    "IF",
    "induction- or flame-hardened, roots as well",
    "HV",
    _lines((0.74, 602.0, 485.0, 615.0), (0.541, 882.0, 500.0, 615.0), (0.505, 1013.0, 500.0, 615.0)),
    _lines((0.305, 76.0, 485.0, 615.0), (0.138, 290.0, 500.0, 570.0), (0.271, 237.0, 500.0, 615.0)),
    TOUGH_CONTACT,
    HARD_BENDING,
    hardened=True,
)
NITRIDING = StrengthClass(
    "NT",
    "nitriding steel, gas-nitrided",
    "HV",
    _lines((0.0, 1125.0, 650.0, 900.0), (0.0, 1250.0, 650.0, 900.0), (0.0, 1450.0, 650.0, 900.0)),
    _lines((0.0, 270.0, 650.0, 900.0), (0.0, 420.0, 650.0, 900.0), (0.0, 468.0, 650.0, 900.0)),
    BRITTLE_CONTACT,
    BRITTLE_BENDING,
    hardened=True,
)
NITRIDED = StrengthClass(
    "NV",
    "through-hardening steel, gas-nitrided",
    "HV",
    _lines((0.0, 788.0, 450.0, 650.0), (0.0, 998.0, 450.0, 650.0), (0.0, 1217.0, 450.0, 650.0)),
    _lines((0.0, 258.0, 450.0, 650.0), (0.0, 363.0, 450.0, 650.0), (0.0, 432.0, 450.0, 650.0)),
    BRITTLE_CONTACT,
    BRITTLE_BENDING,
    hardened=True,
)
NODULAR = StrengthClass(
    "GGG",
    "nodular cast iron, pearlitic",
    "HBW",
    _lines((1.434, 211.0, 175.0, 300.0), (1.434, 211.0, 175.0, 300.0), (1.5, 250.0, 200.0, 300.0)),
    _lines((0.35, 119.0, 175.0, 300.0), (0.35, 119.0, 175.0, 300.0), (0.38, 134.0, 200.0, 300.0)),
    TOUGH_CONTACT,
    SOFT_BENDING,
    hardened=False,
)
GREY = StrengthClass(
    "GG",
    "grey cast iron",
    "HBW",
    _lines((1.033, 132.0, 150.0, 240.0), (1.033, 132.0, 150.0, 240.0), (1.465, 122.0, 175.0, 275.0)),
    _lines((0.256, 8.0, 150.0, 240.0), (0.256, 8.0, 150.0, 240.0), (0.2, 53.0, 175.0, 275.0)),
    BRITTLE_CONTACT,
    BRITTLE_BENDING,
    hardened=False,
)
