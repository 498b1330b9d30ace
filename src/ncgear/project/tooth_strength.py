"""From a drive to the strength of its teeth, by either method."""

from __future__ import annotations

from typing import TYPE_CHECKING, Literal

from ncgear.pitch.shape import Gear
from ncgear.project.service import choices_of, conditions_of
from ncgear.strength.conditions import Conditions, Running
from ncgear.strength.endurance import materials_of
from ncgear.strength.estimate import estimate_of
from ncgear.strength.life import strength_of, stresses_of
from ncgear.strength.materials import Choice, Plastic
from ncgear.strength.plastics import friction, lost_w, temperatures_of

if TYPE_CHECKING:
    from ncgear.project.drive import Drive
    from ncgear.strength.answer import Strength
    from ncgear.strength.loading import Loading
    from ncgear.strength.material import Material
    from ncgear.strength.method import ToothMethod

Method = Literal["estimate", "elements"]


def loading_and_strength(drive: Drive, method: Method) -> tuple[Loading, Strength]:
    """The load of every tooth and what it makes of them; raises WrongInput and NoSuchMechanism as the drive does."""
    speed, size = drive.machine.speed_rad_s, drive.pitch.size
    running = Running(size.module_mm, (size.driving_teeth, size.driven_teeth), drive.gears.face_width_mm, speed)
    conditions = conditions_of(drive.design.strength, drive.transmission.cycle_rad, speed)
    choices = choices_of(drive.gears)
    cold = materials_of(choices, conditions, running, temperatures_of(choices, conditions, running, 0.0))
    methods = _methods(drive, method, cold)
    loading = drive.loading(methods, cold)
    warm = temperatures_of(choices, conditions, running, _lost_w(choices, conditions, loading))
    materials = materials_of(choices, conditions, running, warm)
    with drive.stopwatch("strength"):
        stresses = stresses_of(loading.contacts, methods, materials, conditions, running)
        cycle = 2.0 * 3.141592653589793 * loading.cycle_turns
        load = drive.tooth_load.load
        found = strength_of(loading.contacts, stresses, materials, conditions, cycle, running, method, load)
    return loading, found


def _methods(drive: Drive, method: Method, materials: tuple[Material, Material]) -> tuple[ToothMethod, ToothMethod]:
    with drive.stopwatch("strength"):
        if method == "elements":
            raise NotImplementedError(method)
        driving, driven = (
            estimate_of(drive.teeth.of(gear), material) for gear, material in zip(Gear, materials, strict=True)
        )
        return driving, driven


def _lost_w(choices: tuple[Choice, Choice], conditions: Conditions, loading: Loading) -> float:
    """The power lost between teeth of which some are of plastic; 0 of metal, which it hardly warms."""
    if not any(isinstance(choice.entry, Plastic) for choice in choices):
        return 0.0
    return lost_w(loading.contacts, loading.phi1_rad.size, friction(choices, conditions.lubrication))
