"""From keys, teeth and loads to the strength of teeth, by either method."""

from __future__ import annotations

from collections.abc import Callable
from math import pi
from typing import TYPE_CHECKING, Literal

from ncgear.design.keys.gears import Gears
from ncgear.pitch.shape import Gear
from ncgear.project.service import choices_of
from ncgear.strength.conditions import Conditions, Running
from ncgear.strength.endurance import materials_of
from ncgear.strength.estimate import estimate_of
from ncgear.strength.life import strength_of, stresses_of
from ncgear.strength.material import Material
from ncgear.strength.materials import Choice, Plastic
from ncgear.strength.plastics import friction, lost_w, temperatures_of
from ncgear.teeth.gear import ToothedPair

if TYPE_CHECKING:
    from ncgear.strength.answer import Strength
    from ncgear.strength.loading import Loading
    from ncgear.strength.method import ToothMethod

Method = Literal["estimate", "elements"]
LoadedBy = Callable[["tuple[ToothMethod, ToothMethod]", tuple[Material, Material]], "Loading"]
"""The load of every tooth, shared by the stiffness that two methods give the teeth of two materials."""


def loading_and_strength(
    method: Method,
    gears: Gears,
    teeth: ToothedPair,
    conditions: Conditions,
    running: Running,
    loaded_by: LoadedBy,
    load: Literal["masses", "resistance"],
) -> tuple[Loading, Strength]:
    """The load of every tooth and what it makes of them.

    Plastics are as warm as the power lost between the teeth makes them, which follows from their loads; the loads are
    shared by the stiffness at the temperature about them.
    """
    choices = choices_of(gears)
    cold = materials_of(choices, conditions, running, temperatures_of(choices, conditions, running))
    methods = _methods(method, teeth, cold)
    loading = loaded_by(methods, cold)
    warm = temperatures_of(choices, conditions, running, _lost_w(choices, conditions, loading))
    materials = materials_of(choices, conditions, running, warm)
    stresses = stresses_of(loading.contacts, methods, materials, conditions, running)
    cycle_rad = 2.0 * pi * loading.cycle_turns
    found = strength_of(loading.contacts, stresses, materials, conditions, cycle_rad, running, method, load)
    return loading, found


def _methods(
    method: Method, teeth: ToothedPair, materials: tuple[Material, Material]
) -> tuple[ToothMethod, ToothMethod]:
    if method == "elements":
        # Loads slowly, and only where it is asked for.
        from ncgear.strength.elements.teeth import elements_of

        driving, driven = (elements_of(teeth.of(gear), one) for gear, one in zip(Gear, materials, strict=True))
        return driving, driven
    beams = tuple(estimate_of(teeth.of(gear), one) for gear, one in zip(Gear, materials, strict=True))
    return beams[0], beams[1]


def _lost_w(choices: tuple[Choice, Choice], conditions: Conditions, loading: Loading) -> float:
    """The power lost between teeth of which some are of plastic; 0 of metal, which it hardly warms."""
    if not any(isinstance(choice.entry, Plastic) for choice in choices):
        return 0.0
    even = loading.contacts.kept(loading.even[loading.contacts.position])
    return lost_w(even, int(loading.even.sum()), friction(choices, conditions.lubrication))
