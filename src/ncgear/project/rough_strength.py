"""The rough strength of a design, for a check: from its law, its pitch curves and its loads, without a tooth."""

from __future__ import annotations

from math import radians

import numpy as np

from ncgear.contact.placement import placed
from ncgear.errors import DesignError, WrongInput
from ncgear.frozen import dataclass
from ncgear.pitch.shape import Gear
from ncgear.project.drive import Drive
from ncgear.project.service import choices_of
from ncgear.project.tooth_form import tooth_form_of
from ncgear.project.tooth_load import asked_of
from ncgear.strength.endurance import materials_of
from ncgear.strength.iso6336 import RackTip
from ncgear.strength.materials import Plastic
from ncgear.strength.plastics import friction, temperatures_of
from ncgear.strength.without_teeth import (
    PER_TOOTH,
    RolledLoad,
    RoughSafety,
    ToothPlan,
    rough_safeties,
    shared_loads,
    slid_w,
    static_safeties,
)


@dataclass(frozen=True)
class RoughStrength:
    """Both gears' safeties, roughly.

    ``unjudged`` says why the wanted life is not judged, in words that follow "because"; the safeties are then those
    against breaking at once, or none where even these are not known.  It is empty where the life is judged.
    """

    safeties: tuple[RoughSafety, ...]
    unjudged: str = ""


def rough_strength(drive: Drive) -> RoughStrength | None:
    """The rough strength of a pair; None where there are no gears, no load, or two pairs of which none is meant."""
    design = drive.design
    if design.gears is None or (design.masses is None and design.resistance is None):
        return None
    if design.stages > 1 and drive.stage is None:
        return None
    try:
        load = _rolled(drive)
    except DesignError as error:
        return RoughStrength((), error.problem)
    if not load.force_n.any():
        return None
    if np.any(load.force_n < 0.0):
        return RoughStrength((), "the teeth cannot push the driven gear at every angle")
    plan, running, conditions, materials = _plan(drive), drive.running, drive.conditions, drive.materials
    sides = shared_loads(load, plan, running, materials)
    try:
        choices = choices_of(drive.gears)
        if any(isinstance(choice.entry, Plastic) for choice in choices):
            rubbed = friction(choices, conditions.lubrication)
            lost = slid_w(sides, load.phi1_rad.size, running.face_width_mm, rubbed)
            warm = temperatures_of(choices, conditions, running, lost)
            materials = materials_of(choices, conditions, running, warm)
        why = _no_life(drive)
        if not why:
            try:
                return RoughStrength(tuple(rough_safeties(sides, plan, running, materials, conditions)))
            except WrongInput as error:
                why = f"{error.key}: {error.problem}"
        return RoughStrength(tuple(static_safeties(sides, plan, running, materials, conditions)), why)
    except ArithmeticError as error:
        return RoughStrength((), str(error))


def _no_life(drive: Drive) -> str:
    """Why no life of these teeth is told, whatever they bear."""
    if drive.helix is not None:
        return "helical teeth are not followed under load"
    if drive.design.motion.is_open:
        return "gears that turn to and fro, less than once, are not followed under load"
    return ""


def _plan(drive: Drive) -> ToothPlan:
    rack, form = drive.gears.rack, tooth_form_of(drive.gears, drive.pitch.size.module_mm)
    module, (pushing, idle) = form.rack.module_mm, rack.angles_deg
    shifts = form.driving_shift_mm / module, form.driven_shift_mm / module
    tip = RackTip(rack.dedendum, rack.root_radius)
    return ToothPlan(tip, rack.addendum, shifts, (radians(pushing), radians(idle)), form.rack.relief)


def _rolled(drive: Drive) -> RolledLoad:
    asked, placement = asked_of(drive), placed(drive.pitch, PER_TOOTH)
    phi1 = placement.phi1_rad
    curvature = np.stack([drive.pitch.of(gear).at_angle(phi1).curvature for gear in Gear])
    urge = np.where(asked.torque_n_mm(phi1) < 0.0, -1.0, 1.0)
    turning = np.abs(drive.pair_speed_rad_s(phi1) * (1.0 - placement.mesh.sense * placement.speed))
    force = asked.mesh_force(phi1).size_n.value
    return RolledLoad(phi1, force, urge, curvature, turning, placement.toothed is None)
