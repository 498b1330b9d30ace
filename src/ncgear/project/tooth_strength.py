"""From keys, teeth and loads to the stiffness and the strength of teeth, by either method."""

from __future__ import annotations

from dataclasses import replace
from math import pi
from typing import TYPE_CHECKING, Literal

from ncgear.design.keys.gears import Gears
from ncgear.errors import NoSuchMechanism
from ncgear.frozen import dataclass
from ncgear.numerics.arrays import Array
from ncgear.pitch.shape import Gear
from ncgear.project.service import choices_of
from ncgear.project.tooth_load import ToothLoad
from ncgear.project.vibration import mesh_stiffness
from ncgear.strength.conditions import Conditions, Running
from ncgear.strength.contacts import LoadedContacts
from ncgear.strength.endurance import materials_of
from ncgear.strength.estimate import estimate_of
from ncgear.strength.life import strength_of, stresses_of, worse_of
from ncgear.strength.material import Material
from ncgear.strength.materials import Choice, Plastic
from ncgear.strength.plastics import ToothTemperature, friction, lost_w, temperatures_of
from ncgear.strength.stiffness import EvenTeeth, LinearTeeth
from ncgear.strength.surfaces import Surfaces, surfaces_of
from ncgear.teeth.gear import ToothedGear, ToothedPair

if TYPE_CHECKING:
    from ncgear.project.face_load import FaceLoading
    from ncgear.strength.answer import Strength
    from ncgear.strength.loading import Loading
    from ncgear.strength.method import ToothMethod
    from ncgear.strength.vibration import Vibration

Method = Literal["estimate", "elements"]


@dataclass(frozen=True, eq=False)
class JudgedTeeth:
    """The load of every tooth, its stresses, and the methods by which both gears' teeth were known.

    ``warm`` are the temperatures of the driving and the driven gear's teeth, which matter of plastics.
    ``strength`` counts a jam where that is worse; ``jammed`` is the strength by the jam alone, if there is one.
    """

    loading: Loading
    strength: Strength
    methods: tuple[ToothMethod, ToothMethod]
    warm: tuple[ToothTemperature, ToothTemperature]
    jammed: Strength | None = None


def judged_teeth(
    method: Method,
    gears: Gears,
    methods: tuple[ToothMethod, ToothMethod],
    loading: Loading,
    conditions: Conditions,
    running: Running,
    load: Literal["masses", "resistance"],
    face_loading: FaceLoading,
    vibration: Vibration,
) -> JudgedTeeth:
    """The stresses of teeth under their loads.

    Plastics are as warm as the power lost between the teeth makes them, which follows from their loads; the loads are
    shared by the stiffness of the materials at the temperature about them.
    """
    choices = choices_of(gears)
    warm = temperatures_of(choices, conditions, running, _lost_w(choices, conditions, loading))
    materials = materials_of(choices, conditions, running, warm)
    cycle_rad = 2.0 * pi * loading.cycle_turns

    def found(loads: Loading, under: Conditions) -> Strength:
        shaken = vibration.of_contacts(loads.contacts, mesh_stiffness(loads, running), under)
        uneven = face_loading.of_contacts(loads.contacts, under.application_factor, shaken)
        stresses = stresses_of(loads.contacts, methods, materials, under, running, uneven, shaken)
        return strength_of(loads.contacts, stresses, materials, under, cycle_rad, running, method, load)

    strength = found(loading, conditions)
    if loading.still is not None:
        # A harder load may leave the rated places of flanks to their mates: of both loads, the worse one counts.
        strength = worse_of(strength, found(loading.still, conditions))
    if loading.jammed is None or conditions.overload is None:
        return JudgedTeeth(loading, strength, methods, warm)
    jams_h = conditions.overload.times * cycle_rad / running.speed_rad_s / 3600.0
    few = replace(conditions, application_factor=1.0, dynamic_factor=1.0, life_h=jams_h)
    jammed = found(loading.jammed, few)
    return JudgedTeeth(loading, worse_of(strength, jammed, lives=False), methods, warm, jammed)


def surfaces_of_teeth(
    judged: JudgedTeeth,
    gears: Gears,
    conditions: Conditions,
    running: Running,
    face_loading: FaceLoading,
    vibration: Vibration,
) -> Surfaces:
    """Film, heat and wear of the flanks of judged teeth, without jams, which are few."""
    materials = judged.strength.driving.material, judged.strength.driven.material
    mesh = mesh_stiffness(judged.loading, running)

    def uneven(contacts: LoadedContacts) -> Array:
        return face_loading.of_contacts(contacts, conditions.application_factor, shaken(contacts))

    def shaken(contacts: LoadedContacts) -> Array:
        return vibration.of_contacts(contacts, mesh, conditions)

    choices, warm = choices_of(gears), judged.warm
    return surfaces_of(judged.loading, choices, materials, warm, conditions, running, uneven, shaken)


def methods_of(
    method: Method, teeth: ToothedPair, materials: tuple[Material, Material]
) -> tuple[ToothMethod, ToothMethod]:
    """What a method knows of the teeth of both gears."""
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


LIGHTEST_N_MM = 1.0
"""Load per mm of face width at which contacts are taken to be flattened where the teeth bear less: next to nothing."""


def linear_teeth(
    load: ToothLoad,
    teeth: ToothedPair,
    face_width_mm: float,
    methods: tuple[ToothMethod, ToothMethod],
    materials: tuple[Material, Material],
) -> LinearTeeth:
    """The stiffness of pairs of teeth by methods for the driving and the driven gear, at their largest load."""
    line_load = max(load.peak_n / face_width_mm, LIGHTEST_N_MM)
    return LinearTeeth(teeth, methods, materials, face_width_mm, line_load)


def estimated(gear: ToothedGear, material: Material) -> ToothMethod:
    """The estimate of the teeth of a gear; where it does not reach, for want of a fillet, teeth that are all alike."""
    try:
        return estimate_of(gear, material)
    except NoSuchMechanism:
        return EvenTeeth(material.youngs_modulus_mpa)
