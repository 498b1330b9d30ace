"""From keys, teeth and loads to the stiffness and the strength of teeth, by either method."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import replace
from functools import partial
from typing import TYPE_CHECKING, Literal

import numpy as np

from ncgear.design.keys.gears import Gears
from ncgear.errors import NoSuchMechanism, WrongInput
from ncgear.frozen import dataclass
from ncgear.numerics.arrays import Array
from ncgear.numerics.bounds import shown_above
from ncgear.pitch.shape import Gear
from ncgear.project.service import choices_of
from ncgear.project.tooth_load import ToothLoad
from ncgear.project.vibration import mesh_stiffness
from ncgear.strength.conditions import Conditions, Running
from ncgear.strength.endurance import materials_of
from ncgear.strength.estimate import estimate_of
from ncgear.strength.iso6336 import rim_factor, thinnest_rim_mm
from ncgear.strength.life import strength_of, stresses_of, worse_of
from ncgear.strength.material import Material
from ncgear.strength.materials import Choice, Plastic
from ncgear.strength.plastics import ToothTemperature, friction, lost_w, temperatures_of
from ncgear.strength.sections import FaceSections, InSections
from ncgear.strength.stiffness import EvenTeeth, LinearTeeth
from ncgear.strength.surfaces import Surfaces, surfaces_of
from ncgear.teeth.gear import ToothedGear

if TYPE_CHECKING:
    from ncgear.project.face_load import FaceLoading
    from ncgear.solids.plan.body import BodyPlan
    from ncgear.strength.answer import LoadBy, Strength
    from ncgear.strength.contacts import LoadedContacts
    from ncgear.strength.loading import Loading
    from ncgear.strength.method import ToothMethod
    from ncgear.strength.vibration import Vibration

Method = Literal["estimate", "elements"]


@dataclass(frozen=True, eq=False)
class JudgedTeeth:
    """The load of every tooth, its stresses, and the methods that describe both gears' teeth.

    ``warm`` are the temperatures of the driving and the driven gear's teeth, which matter for plastics.  ``strength``
    includes a jam where that is worse; ``jammed`` is the strength by the jam alone, if there is one.
    """

    loading: Loading
    strength: Strength
    methods: tuple[InSections, InSections]
    warm: tuple[ToothTemperature, ToothTemperature]
    jammed: Strength | None = None


def judged_teeth(
    method: Method,
    gears: Gears,
    methods: tuple[InSections, InSections],
    loading: Loading,
    conditions: Conditions,
    running: Running,
    load: LoadBy,
    face_loading: FaceLoading,
    vibration: Vibration,
) -> JudgedTeeth:
    """The stresses of teeth under their loads.

    The power lost between the teeth, which follows from their loads, warms plastics.  The stiffness of the materials at
    the ambient temperature shares the loads.
    """
    choices = choices_of(gears)
    warm = temperatures_of(choices, conditions, running, _lost_w(choices, conditions, loading))
    materials = materials_of(choices, conditions, running, warm)
    cycle_rad = loading.cycle_rad

    def found(loads: Loading, under: Conditions) -> Strength:
        mesh = mesh_stiffness(loads, running)
        shaken = vibration.of_contacts(loads.contacts, mesh, under, loads.still is not None)
        uneven = face_loading.of_contacts(loads.contacts, under.application_factor, shaken)
        stresses = stresses_of(loads.contacts, methods, materials, under, running, uneven, shaken)
        return strength_of(loads.contacts, stresses, materials, under, cycle_rad, running, method, load)

    strength = found(loading, conditions)
    if loading.still is not None:
        # A larger load may move flanks beyond the rated places: the worse of both loads counts.
        strength = worse_of(strength, found(loading.still, conditions))
    if loading.jammed is None or conditions.overload is None:
        return JudgedTeeth(loading, strength, methods, warm)
    jams_h = conditions.overload.times * cycle_rad / running.speed_rad_s / 3600.0
    few = replace(conditions, application_factor=1.0, dynamic_factor=1.0, life_h=jams_h)
    jammed = found(loading.jammed, few)
    strength = worse_of(strength, jammed, lives=False)
    if load == "jam":
        strength = replace(strength, contacts=jammed.contacts, stresses=jammed.stresses)
    return JudgedTeeth(loading, strength, methods, warm, jammed)


def judged_in_row(
    judged: JudgedTeeth, elsewhere_mpa: tuple[Array | None, Array | None], conditions: Conditions, running: Running
) -> JudgedTeeth:
    """Teeth that other meshes bend the other way, by compressions of their roots as ``strength_of`` takes them."""
    strength = judged.strength
    materials = strength.driving.material, strength.driven.material
    asked = (
        strength.contacts,
        strength.stresses,
        materials,
        conditions,
        judged.loading.cycle_rad,
        running,
        strength.method,
        strength.load,
    )
    return replace(judged, strength=strength_of(*asked, elsewhere_mpa))


def surfaces_of_teeth(
    judged: JudgedTeeth,
    gears: Gears,
    conditions: Conditions,
    running: Running,
    face_loading: FaceLoading,
    vibration: Vibration,
) -> Surfaces:
    """Film, heat and wear of the flanks of judged teeth, without jams, which are rare."""
    materials = judged.strength.driving.material, judged.strength.driven.material
    mesh, followed = mesh_stiffness(judged.loading, running), judged.loading.still is not None

    def factors(contacts: LoadedContacts) -> tuple[Array, Array]:
        if contacts is judged.strength.contacts:
            return judged.strength.stresses.dynamic_factor, judged.strength.stresses.face_load_factor
        shaken = vibration.of_contacts(contacts, mesh, conditions, followed)
        return shaken, face_loading.of_contacts(contacts, conditions.application_factor, shaken)

    return surfaces_of(judged.loading, choices_of(gears), materials, judged.warm, conditions, running, factors)


def methods_of(
    method: Method, sections: FaceSections, materials: tuple[Material, Material], rims: tuple[Rim, Rim]
) -> tuple[InSections, InSections]:
    """The methods for the teeth of both gears; raises WrongInput for elements of helical teeth."""
    pairs, helix_rad = [section.teeth for section in sections.each], sections.helix_rad
    if method == "elements":
        # Loads slowly, and only if asked for.
        from ncgear.strength.elements.teeth import elements_of

        if helix_rad:
            raise WrongInput(
                "elements given, but they are plane, and helical teeth bend across the plane; estimate is right",
                key="strength.method",
            )
        made: Callable[[ToothedGear, Material], ToothMethod] = elements_of
    else:
        made = partial(estimate_of, helix_rad=helix_rad)
    driving, driven = (
        InSections(tuple(made(pair.of(gear), material) for pair in pairs), rim.factor)
        for gear, material, rim in zip(Gear, materials, rims, strict=True)
    )
    return driving, driven


def _lost_w(choices: tuple[Choice, Choice], conditions: Conditions, loading: Loading) -> float:
    """The power lost between teeth if some are of plastic; 0 for metal, which it hardly warms."""
    if not any(isinstance(choice.entry, Plastic) for choice in choices):
        return 0.0
    even = loading.contacts.kept(loading.even[loading.contacts.position])
    return lost_w(even, int(loading.even.sum()), friction(choices, conditions.lubrication))


LIGHTEST_N_MM = 1.0
"""Load per mm of face width for the flattening of contacts where the teeth carry less: almost nothing."""


@dataclass(frozen=True, eq=False)
class Rim:
    """The walls under the roots of a gear's teeth in mm and Y_B by them, shape (z,) each; infinite where not known.

    ``thinnest_mm`` is the thinnest wall for which Y_B is known.
    """

    wall_mm: Array
    factor: Array
    thinnest_mm: float

    @property
    def worst(self) -> int:
        """The row of the tooth with the thinnest wall."""
        return int(self.wall_mm.argmin())


def rim_of(gear: ToothedGear, plan: BodyPlan, *, helical: bool) -> Rim:
    """The walls under the teeth of a gear in its body; all helical teeth count as the tooth with the thinnest wall."""
    from ncgear.solids.plan.plan import walls_mm

    walls, rack = walls_mm(gear, plan), gear.flanks.rack
    if helical:
        walls = np.full_like(walls, walls.min())
    height_mm = rack.addendum_mm + rack.dedendum_mm
    ring, module = plan.is_ring, rack.module_mm
    return Rim(
        walls, rim_factor(walls, height_mm, module, internal=ring), thinnest_rim_mm(height_mm, module, internal=ring)
    )


def require_known_rims(rims: tuple[Rim, Rim], gears: Gears) -> None:
    """Raises WrongInput where the wall under a tooth is so thin that its root stress is unknown."""
    for gear, rim in zip(Gear, rims, strict=True):
        if np.isfinite(rim.factor).all():
            continue
        body = gears.driving if gear is Gear.DRIVING else gears.driven
        given = ("web", "web.rim_mm"), ("rim_mm", "rim_mm"), ("lightening_holes", "lightening_holes.least_wall_mm")
        key = next((key for name, key in given if getattr(body, name, None) is not None), "bore_mm")
        raise WrongInput(
            f"the wall of {float(rim.wall_mm[rim.worst]):.2g} mm under tooth {rim.worst + 1} of the {gear.value} "
            f"gear is thinner than ISO 6336-3 has a factor for; {shown_above(rim.thinnest_mm)} mm or over are right",
            key=f"gears.{gear.value}.{key}",
        )


def stiffnesses(
    load: ToothLoad,
    sections: FaceSections,
    face_width_mm: float,
    methods: tuple[InSections, InSections],
    materials: tuple[Material, Material],
) -> list[LinearTeeth]:
    """The stiffness of pairs of teeth in each section of the face width, at their largest load."""
    line_load = max(load.peak_n / face_width_mm, LIGHTEST_N_MM)
    each = zip(sections.each, methods[0].each, methods[1].each, strict=True)
    return [
        LinearTeeth(section.teeth, (driving, driven), materials, section.share * face_width_mm, line_load)
        for section, driving, driven in each
    ]


def estimated(gear: ToothedGear, material: Material, helix_rad: float = 0.0) -> ToothMethod:
    """The estimate of the teeth of a gear; where it fails for lack of a fillet, teeth that are all alike."""
    try:
        return estimate_of(gear, material, helix_rad)
    except NoSuchMechanism:
        return EvenTeeth(material.youngs_modulus_mpa)
