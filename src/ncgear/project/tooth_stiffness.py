"""How stiff the pairs of teeth of a design are under their load."""

from __future__ import annotations

from ncgear.errors import NoSuchMechanism
from ncgear.project.tooth_load import ToothLoad
from ncgear.strength.estimate import estimate_of
from ncgear.strength.material import Material
from ncgear.strength.method import ToothMethod
from ncgear.strength.stiffness import EvenTeeth, LinearTeeth
from ncgear.teeth.gear import ToothedGear, ToothedPair

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
