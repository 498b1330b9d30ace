"""From the table of materials to the endured stresses of a gear: all factors of the material and its surface.

Flanks of steel and iron endure sigma_Hlim Z_NT Z_L Z_v Z_R Z_W Z_X (ISO 6336-2), roots the local stress
sigma_FE Y_NT Y_RrelT Y_X (ISO 6336-3) with sigma_FE = 2 sigma_Flim, since Y_ST = 2.  Y_deltarelT is 1, as for the test
gears, whose roots have usual notches; blunt notches have down to 0.95, sharp notches up to 1.05.  For few cycles only
the life factors count, as in the standard.  Quantities that vary along the flanks have one value: the speed of Z_v is
the mean along the pitch curves, the radius of Z_R that of circular gears of the same teeth; together they change the
result by some per cent.  All factors are from secondary sources.
"""

from __future__ import annotations

from collections.abc import Sequence
from math import inf, log, radians, sin

import numpy as np

from ncgear.errors import WrongInput
from ncgear.strength.classes import GREY, LifePoint, StrengthClass
from ncgear.strength.conditions import Conditions, Running
from ncgear.strength.iso6336 import lubricant_factor, roughness_factor, speed_factor
from ncgear.strength.material import EnduredStress, Material, MaterialFamily
from ncgear.strength.materials import Bronze, Choice, Entry, Ferrous, Plastic
from ncgear.strength.plastics import (
    COLDEST_C,
    LEAST_MPA,
    ToothTemperature,
    flank_limit_mpa,
    root_limit_mpa,
)


def materials_of(
    choices: tuple[Choice, Choice],
    conditions: Conditions,
    running: Running,
    temperatures: tuple[ToothTemperature, ToothTemperature],
) -> tuple[Material, Material]:
    """The stresses that the driving and the driven gear endure, each with the other as its mate.

    ``temperatures`` (of ``ncgear.strength.plastics.temperatures_of``) matter for plastics only.
    """
    driving, driven = choices
    warm_driving, warm_driven = temperatures
    return (
        _material_of(driving, driven, conditions, running, warm_driving),
        _material_of(driven, driving, conditions, running, warm_driven),
    )


def _material_of(
    choice: Choice, mate: Choice, conditions: Conditions, running: Running, warm: ToothTemperature
) -> Material:
    entry, elastic = choice.entry, choice.entry.elastic
    spread = 1.0 / reliability_factor(conditions.reliability)
    contact: EnduredStress | None
    match entry:
        case Ferrous():
            contact, bending = _ferrous(choice, entry, mate, conditions, running)
            family = MaterialFamily.CAST_IRON if entry.group.abbreviation.startswith("GG") else MaterialFamily.STEEL
        case Bronze():
            contact, bending = _bronze(choice, entry)
            family = MaterialFamily.BRONZE
        case Plastic():
            contact, bending = _plastic(choice, entry, warm)
            family = MaterialFamily.PLASTIC
    if conditions.lubrication == "dry" and not isinstance(mate.entry, Plastic) and family is not MaterialFamily.PLASTIC:
        contact = None
    return Material(
        name=entry.name,
        family=family,
        youngs_modulus_mpa=elastic.youngs_modulus_mpa,
        poisson=elastic.poisson,
        density_kg_m3=elastic.density_kg_m3,
        contact=_times(contact, spread),
        bending=EnduredStress(bending.cycles, bending.stress_mpa * spread),
        source=_source(choice),
        too_hot_c=max(warm.root_c, warm.flank_c) if warm.too_hot else None,
    )


def _times(endured: EnduredStress | None, factor: float) -> EnduredStress | None:
    return None if endured is None else EnduredStress(endured.cycles, endured.stress_mpa * factor)


def _source(choice: Choice) -> str:
    parts = [choice.entry.source]
    if choice.assumed:
        parts.insert(0, f"assumed: {choice.entry.name}, {choice.entry.meaning}")
    if choice.own:
        parts.append("with own stresses")
    return "; ".join(parts)


def _curve(points: Sequence[LifePoint], limit_mpa: float, factor: float) -> EnduredStress:
    """A limit times the life factors; beyond the first point, the static one, also times the factor of the surface."""
    stress = [limit_mpa * point.factor * (factor if place else 1.0) for place, point in enumerate(points)]
    # A smooth or rolled surface may raise a later point above an earlier one; endured stress never rises.
    return EnduredStress(np.array([point.cycles for point in points]), np.minimum.accumulate(stress))


def limit_contact_mpa(choice: Choice) -> float:
    """The stress sigma_Hlim in MPa that metal flanks endure, from the person or from the table.

    Raises WrongInput for a plastic, whose stress follows from temperature and cycles.
    """
    if choice.contact_limit_mpa is not None:
        return choice.contact_limit_mpa
    match choice.entry:
        case Ferrous(group=group, quality=quality, hardness=hardness):
            return group.contact[quality].at(hardness)
        case Bronze(contact_mpa=stress_mpa):
            return stress_mpa
    raise WrongInput(f"{choice.entry.name} has no single limit; it depends on temperature", key="gears.material")


def limit_bending_mpa(choice: Choice, entry: Ferrous) -> float:
    """The local stress sigma_FE in MPa that roots of steel and iron endure, a person's own or the table's."""
    if choice.bending_limit_mpa is not None:
        return choice.bending_limit_mpa
    return 2.0 * entry.group.bending[entry.quality].at(entry.hardness)


def _ferrous(
    choice: Choice, entry: Ferrous, mate: Choice, conditions: Conditions, running: Running
) -> tuple[EnduredStress, EnduredStress]:
    group, limit = entry.group, limit_contact_mpa(choice)
    factor = (
        film_factor(choice, mate, conditions, running)
        * hardening_factor(entry, mate.entry, conditions)
        * contact_size_factor(group, running.module_mm)
    )
    rough = root_roughness_factor(group, conditions.root_roughness_um) * root_size_factor(group, running.module_mm)
    bending = _curve(group.bending_life, limit_bending_mpa(choice, entry), rough)
    return _curve(group.contact_life, limit, factor), bending


def film_factor(choice: Choice, mate: Choice, conditions: Conditions, running: Running) -> float:
    """Z_L Z_v Z_R: the factor of oil, speed and roughness on the endured stress of steel and iron; 1 for others.

    Pitting depends on the film by this factor alone, which stays above 0 without a film: at no speed Z_v is still 0.85
    to 0.93.
    """
    if not isinstance(choice.entry, Ferrous) or isinstance(mate.entry, Plastic) or conditions.lubrication == "dry":
        return 1.0
    softer = min(limit_contact_mpa(choice), limit_contact_mpa(mate))
    return float(
        lubricant_factor(softer, conditions.oil_viscosity_mm2_s)
        * speed_factor(softer, running.pitch_speed_m_s)
        * roughness_factor(softer, conditions.flank_roughness_um, reduced_radius_mm(running))
    )


def _bronze(choice: Choice, entry: Bronze) -> tuple[EnduredStress, EnduredStress]:
    """Fewer cycles than 1e7 are given no more stress, since no figures are known."""
    life = LifePoint(1e7, 1.0), LifePoint(1e10, 0.85)
    bending = entry.bending_mpa if choice.bending_limit_mpa is None else choice.bending_limit_mpa
    return _curve(life, limit_contact_mpa(choice), 1.0), _curve(life, bending, 1.0)


PLASTIC_CYCLES = 1e3, 1e10, 71
"""Ends and number of the points of a curve of plastics: ten a decade join to within 0.1 % of the formulas."""


def _plastic(choice: Choice, entry: Plastic, warm: ToothTemperature) -> tuple[EnduredStress | None, EnduredStress]:
    """Above the highest temperature, without figures, a plastic endures next to nothing.  Own limits stay."""
    cycles = np.geomspace(*PLASTIC_CYCLES)
    root_c, flank_c = (max(temperature, COLDEST_C) for temperature in (warm.root_c, warm.flank_c))
    nothing = np.full_like(cycles, LEAST_MPA)
    contact: EnduredStress | None = None
    if choice.contact_limit_mpa is not None:
        contact = EnduredStress(cycles, np.full_like(cycles, choice.contact_limit_mpa))
    elif entry.pits:
        contact = EnduredStress(cycles, nothing if warm.too_hot else flank_limit_mpa(flank_c, cycles))
    if choice.bending_limit_mpa is not None:
        return contact, EnduredStress(cycles, np.full_like(cycles, choice.bending_limit_mpa))
    return contact, EnduredStress(cycles, nothing if warm.too_hot else root_limit_mpa(entry.root, root_c, cycles))


SHARES = 0.5, 0.9, 0.99, 0.999, 0.9999
RELIABILITY_FACTORS = 0.7, 0.85, 1.0, 1.25, 1.5


def reliability_factor(share: float) -> float:
    """The divisor of endured stresses with which a share of all gears survives: 1 at 0.99.

    Y_Z is 0.7 at 0.5, 0.85 at 0.9, 1.25 at 0.999 and 1.5 at 0.9999 (table of AGMA 2101, secondary source), and linear
    between them over the logarithm of the failing share.
    """
    return float(np.interp(-log(1.0 - share), [-log(1.0 - known) for known in SHARES], RELIABILITY_FACTORS))


def reduced_radius_mm(running: Running) -> float:
    """The radius of relative curvature at the pitch point of circular gears of the same teeth and 20 degrees, in mm."""
    z1, z2 = running.whole
    return running.module_mm * sin(radians(20.0)) / 2.0 * z1 * z2 / (z1 + z2)


SMOOTH_UM = 6.0
"""Roughness Rz up to which a hard flank hardens a soft flank by rolling."""


def hardening_factor(entry: Entry, mate: Entry, conditions: Conditions) -> float:
    """Z_W: the gain of soft flanks from a smooth hardened mate, 1.2 - (HB - 130) / 1700."""
    if not (isinstance(entry, Ferrous) and isinstance(mate, Ferrous) and mate.group.hardened):
        return 1.0
    if entry.group.hardened or entry.group is GREY or conditions.flank_roughness_um > SMOOTH_UM:
        return 1.0
    return 1.2 - (min(max(entry.hardness, 130.0), 470.0) - 130.0) / 1700.0


SLOW_M_S, FAST_M_S = 5.0, 10.0


def running_in(choice: Choice, running: Running, askew_mm: float) -> float:
    """y_beta in mm: the part of a misalignment of flanks that running in wears off.

    It is 320 / sigma_Hlim times F_beta for structural, tempered and nodular cast steel and iron, 0.55 F_beta for grey
    iron, 0.15 F_beta, at most 6 um, for hardened surfaces; the others have above 5 m/s at most the value at F_beta = 80
    um, above 10 m/s that at 40 um (ISO 6336-1, secondary source).  It is unknown, and 0, for bronze and plastics.
    """
    entry, speed = choice.entry, running.pitch_speed_m_s
    if not isinstance(entry, Ferrous):
        return 0.0
    if entry.group.hardened:
        return min(0.15 * askew_mm, 6e-3)
    share = 0.55 if entry.group is GREY else min(320.0 / limit_contact_mpa(choice), 1.0)
    most_mm = inf if speed <= SLOW_M_S else 0.08 if speed <= FAST_M_S else 0.04
    return share * min(askew_mm, most_mm)


def contact_size_factor(group: StrengthClass, module_mm: float) -> float:
    """Z_X of flanks: 1 up to module 10, or up to 7.5 for nitrided flanks."""
    match group.abbreviation:
        case "Eh" | "IF":
            return min(1.0, max(0.9, 1.05 - 0.005 * module_mm))
        case "NT" | "NV":
            return min(1.0, max(0.75, 1.08 - 0.011 * module_mm))
    return 1.0


def root_size_factor(group: StrengthClass, module_mm: float) -> float:
    """Y_X of roots, 1 up to module 5."""
    match group.abbreviation:
        case "St" | "V" | "GGG":
            return min(1.0, max(0.85, 1.03 - 0.006 * module_mm))
        case "GG":
            return min(1.0, max(0.7, 1.075 - 0.015 * module_mm))
    return min(1.0, max(0.8, 1.05 - 0.01 * module_mm))


def root_roughness_factor(group: StrengthClass, roughness_um: float) -> float:
    """Y_RrelT of roots for Rz from 1 to 40 um, constant beyond: 1 at 10 um, the roughness of the test gears."""
    peaks = min(max(roughness_um, 1.0), 40.0) + 1.0
    match group.abbreviation:
        case "St":
            return float(5.306 - 4.203 * peaks**0.01)
        case "GG" | "NT" | "NV":
            return float(4.299 - 3.259 * peaks**0.0058)
    return float(1.674 - 0.529 * peaks**0.1)
