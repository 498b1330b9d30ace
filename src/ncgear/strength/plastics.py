"""Stresses that plastic teeth endure, and their running temperature: VDI 2736-2, from secondary sources.

The stresses of polyacetal and polyamide are the guideline's formulas as public calculation programs have them; the
guideline gives them for injection-moulded teeth with damage of one gear in ten.  The temperatures follow Hachmann and
Strickle as in the guideline, with the power that the loaded contacts lose by friction in place of its mean formula.
"""

from __future__ import annotations

import numpy as np

from ncgear.frozen import dataclass
from ncgear.numerics.arrays import Array
from ncgear.strength.conditions import Conditions, Running
from ncgear.strength.contacts import LoadedContacts
from ncgear.strength.materials import Choice, Plastic

COLDEST_C = 20.0
"""Below this temperature, the stresses of the guideline stay constant: the strength that cold adds does not count."""

FEWEST_CYCLES = 1e5
"""Number of cycles from which the formulas hold, to about 1e8.  Fewer cycles have the same stress, which is near
yielding; more cycles follow the formulas, since no better slope is known."""

LEAST_MPA = 0.1
"""Least endured stress, next to 0: hot and after many cycles a formula falls below it."""

NOTCH_OF_TEST_GEARS = 2.0
"""Y_St: the guideline's nominal stresses times this are local stresses."""


def flank_limit_mpa(temperature_c: float, cycles: Array) -> Array:
    """The pressure that flanks of POM and PA66 endure, sigma_HlimN, shape of ``cycles``.

    sigma_HlimN = 36 - 0.0012 T^2 + (1000 - 0.025 T^2) N^-0.21; secondary sources give it for both.
    """
    t, n = temperature_c, np.maximum(cycles, FEWEST_CYCLES)
    return _kept(36.0 - 0.0012 * t**2 + (1000.0 - 0.025 * t**2) * n**-0.21)


def root_limit_mpa(formula: str, temperature_c: float, cycles: Array) -> Array:
    """The local stress that roots endure, shape of ``cycles``.

    Twice sigma_FlimN = 26 - 0.0025 T^2 + 400 N^-0.2 of POM and 30 - 0.22 T + (4600 - 900 T^0.3) N^(-1/3) of PA66.  The
    stresses of prints fall in a line from 20 degrees Celsius to nothing where the plastic softens.
    """
    t, n = temperature_c, np.maximum(cycles, FEWEST_CYCLES)
    match formula:
        case "POM":
            return _kept(NOTCH_OF_TEST_GEARS * (26.0 - 0.0025 * t**2 + 400.0 * n**-0.2))
        case "PA66":
            nominal = 30.0 - 0.22 * t + (4600.0 - 900.0 * t**0.3) * n ** (-1.0 / 3.0)
            return _kept(NOTCH_OF_TEST_GEARS * nominal)
    softens_c, known_cycles, known_mpa = PRINTS[formula]
    cold = np.exp(np.interp(np.log(cycles), np.log(known_cycles), np.log(known_mpa)))
    return _kept(cold * (softens_c - t) / (softens_c - COLDEST_C))


def _kept(stress_mpa: Array) -> Array:
    return np.asarray(np.maximum(stress_mpa, LEAST_MPA))


PRINTS = {
    "PLA-print": (60.0, (1e3, 1e6, 1e8), (25.0, 10.0, 6.0)),
    "PETG-print": (80.0, (1e3, 1e6, 1e8), (20.0, 8.0, 5.0)),
}
"""Softening temperature of prints in degrees Celsius, and the stress in MPa at their roots for numbers of cycles.

A cautious guess without a source: half, a fifth and an eighth of the strength of printed bars in tension, about 50 and
40 MPa across the layers' plane, for a thousand, a million and more cycles."""


@dataclass(frozen=True)
class ToothTemperature:
    """Running temperature of a gear's teeth in degrees Celsius; ``too_hot`` above the range of the figures."""

    root_c: float
    flank_c: float
    too_hot: bool


CREEP_MPA = {"POM": (2850.0, 2500.0, 1300.0), "PA66": (1400.0, 1190.0, 540.0)}
"""By material: modulus in tension at once, and creep modulus after 1 h and 1000 h, in MPa at 23 degrees Celsius (ISO
527 and ISO 899-1).  POM: Hostaform C 9021, data sheet of its maker, Ticona, of June 2008.  PA66, moist: Zytel 103HSL
NC010, data sheet of its maker, DuPont; Ultramid A3K of BASF, with 1100, 1100 and 700 MPa, creeps less.  Of others no
public figures were found."""

CREEP_C = 23.0
"""Degrees Celsius of these figures; warm plastics creep more."""


def creep_factor(material: str, hours: float) -> float | None:
    """Factor by which a plastic yields further under a load that rests on it for ``hours``; None where not known.

    The creep modulus falls as a power of time through its values at 1 and 1000 hours; tests by ISO 899 usually end
    there, so that longer times are an extrapolation.
    """
    if material not in CREEP_MPA:
        return None
    at_once, hour, thousand = CREEP_MPA[material]
    return float(max(at_once / hour * (hour / thousand) ** (np.log10(max(hours, 1e-9)) / 3.0), 1.0))


MIXED, ALIKE = (6300.0, 895.0), (9000.0, 2148.0)
"""Coefficients k of the temperatures of flank and root in K (m/s)^0.75 mm^1.75 / W: plastic on metal, on plastic."""

PAUSES = 0.64
"""Exponent of the share of ten minutes in which gears run (VDI 2736-2)."""

LUBRICATED_FRICTION = {"oil": 0.04, "grease": 0.09}
PLASTICS_FRICTION = {("POM", "POM"): 0.28, ("PA66", "PA66"): 0.4, ("PA66", "POM"): 0.18}
OTHER_FRICTION = 0.4
"""Coefficients of friction: lubricated, of dry plastics on each other by their formulas of strength (VDI 2736-2), and
of others: own choice, because it is the largest of these."""


def friction(choices: tuple[Choice, Choice], lubrication: str) -> float:
    """The coefficient of friction of a pair with at least one plastic gear."""
    if lubrication in LUBRICATED_FRICTION:
        return LUBRICATED_FRICTION[lubrication]
    plastics = [choice.entry for choice in choices if isinstance(choice.entry, Plastic)]
    if len(plastics) == 1:
        return plastics[0].friction
    first, second = sorted(entry.root for entry in plastics)
    return PLASTICS_FRICTION.get((first, second), OTHER_FRICTION)


def lost_w(contacts: LoadedContacts, positions: int, coefficient: float) -> float:
    """The mean power in W that friction takes over a cycle with ``positions`` evenly spread positions."""
    return float(np.sum(coefficient * contacts.force_n * contacts.sliding_mm_s)) / positions / 1000.0


def temperatures_of(
    choices: tuple[Choice, Choice], conditions: Conditions, running: Running, loss_w: float = 0.0
) -> tuple[ToothTemperature, ToothTemperature]:
    """Running temperatures of the teeth of both gears.

    T = T_0 + P k / (b z (v m)^0.75) ED^0.64, with the power lost P in W, width b and module m in mm, speed v in m/s,
    and the share ED of ten minutes in which the open gears run.  Oil takes the heat away, so that oiled teeth, and
    teeth of two metal gears, have the temperature of their surroundings.
    """
    plastics = [isinstance(choice.entry, Plastic) for choice in choices]
    warms = any(plastics) and conditions.lubrication != "oil" and loss_w > 0.0
    flank, root = ALIKE if all(plastics) else MIXED
    found = []
    for choice, teeth in zip(choices, running.teeth, strict=True):
        cooled = running.face_width_mm * teeth * (running.pitch_speed_m_s * running.module_mm) ** 0.75
        rise = loss_w / cooled * conditions.duty_cycle**PAUSES if warms else 0.0
        root_c, flank_c = (conditions.temperature_c + coefficient * rise for coefficient in (root, flank))
        hottest = choice.entry.hottest_c if isinstance(choice.entry, Plastic) else np.inf
        found.append(ToothTemperature(root_c, flank_c, max(root_c, flank_c) > hottest))
    driving, driven = found
    return driving, driven
