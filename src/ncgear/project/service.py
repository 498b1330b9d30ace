"""From keys to values: materials and conditions of a pair of gears."""

from __future__ import annotations

from dataclasses import fields, replace
from typing import Any

from ncgear.design.keys.gears import Gears
from ncgear.design.keys.strength import AIR_C, USUAL_LIFE_H, WARM_OIL_C, GearMaterial, StrengthKeys
from ncgear.numerics.units import N_M_PER_N_MM
from ncgear.strength.classes import Quality
from ncgear.strength.conditions import Conditions, Overload, hours_of_strokes
from ncgear.strength.materials import TABLE, Choice, Ferrous, assumed_choice


def choices_of(gears: Gears) -> tuple[Choice, Choice]:
    """The materials of the driving and the driven gear; an assumed material where the design names none."""
    if gears.material is None:
        return assumed_choice(), assumed_choice()
    driving, driven = gears.material.each
    return _choice_of(driving), _choice_of(driven)


def _choice_of(given: GearMaterial) -> Choice:
    entry = TABLE[given.name]
    modulus_gpa, elastic = given.youngs_modulus_gpa, entry.elastic
    elastic = replace(
        elastic,
        youngs_modulus_mpa=elastic.youngs_modulus_mpa if modulus_gpa is None else 1000.0 * modulus_gpa,
        poisson=elastic.poisson if given.poisson is None else given.poisson,
        density_kg_m3=elastic.density_kg_m3 if given.density_kg_m3 is None else given.density_kg_m3,
        expansion_per_k=elastic.expansion_per_k if given.expansion_um_m_k is None else 1e-6 * given.expansion_um_m_k,
    )
    if isinstance(entry, Ferrous):
        hardness = entry.hardness if given.hardness is None else given.hardness
        entry = replace(entry, hardness=hardness, quality=Quality(given.quality))
    return Choice(replace(entry, elastic=elastic), given.contact_limit_mpa, given.bending_limit_mpa)


def densities_kg_m3(given: float | None, gears: Gears) -> tuple[float, float]:
    """The densities of the driving and the driven gear: given with the masses, or by their materials."""
    if given is not None:
        return given, given
    driving, driven = choices_of(gears)
    return driving.entry.elastic.density_kg_m3, driven.entry.elastic.density_kg_m3


def conditions_of(given: StrengthKeys, stroke_rad: float, speed_rad_s: float) -> Conditions:
    """The conditions of the section ``strength``.

    ``stroke_rad`` is the angle of the driving gear in one stroke of the slider, out and back, ``speed_rad_s`` its
    speed.
    """
    life_h = USUAL_LIFE_H if given.life_h is None else given.life_h
    if given.life_strokes is not None:
        life_h = hours_of_strokes(given.life_strokes, stroke_rad, speed_rad_s)
    jam, warm = given.overload, given.temperature_c
    changed: dict[str, Any] = {
        "life_h": life_h,
        "overload": Overload(jam.driving_torque_n_m / N_M_PER_N_MM, jam.times) if jam else None,
        "temperature_c": AIR_C if warm is None else warm,
        "oil_temperature_c": WARM_OIL_C if warm is None else warm,
    }
    alike = (field.name for field in fields(Conditions) if field.name not in changed)
    return Conditions(**{name: getattr(given, name) for name in alike}, **changed)
