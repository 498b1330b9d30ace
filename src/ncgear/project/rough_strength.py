"""The rough strength of a design, for a check: from its law, its pitch curves and its loads, without a tooth."""

from __future__ import annotations

from math import radians

import numpy as np

from ncgear.errors import DesignError
from ncgear.kinematics.motion import sample_angles
from ncgear.pitch.shape import Gear
from ncgear.project.drive import Drive
from ncgear.project.strengthening import unknown
from ncgear.project.tooth_load import asked_of
from ncgear.strength.at_pitch_point import PitchPointLoad, RoughSafety, rough_safeties
from ncgear.strength.iso6336 import RackTip


def rough_strength(drive: Drive) -> list[RoughSafety]:
    """Both gears' safeties, roughly; empty where no load is known, or where the formulas do not cover the gears."""
    if unknown(drive) is not None:
        return []
    try:
        load = _load(drive)
    except DesignError:
        # Pitch curves and forces may be refused; a check does not ask for them.
        return []
    gears = drive.gears
    if not load.force_n.any() or np.any(load.force_n < 0.0):
        return []
    pushing, idle = gears.rack.angles_deg
    # Roots and pressure are worse at the smaller angle.
    angle = radians(min(pushing, idle) if gears.drives == "both_ways" else pushing)
    tip = RackTip(gears.rack.dedendum, gears.rack.root_radius)
    try:
        return rough_safeties(load, tip, gears.rack.addendum, angle, drive.running, drive.materials, drive.conditions)
    except DesignError:
        return []


def _load(drive: Drive) -> PitchPointLoad:
    load, angle = asked_of(drive), sample_angles(drive.pair.transmission)
    curvature = np.stack([drive.pitch.of(gear).at_angle(angle).curvature for gear in Gear])
    return PitchPointLoad(angle, load.mesh_force(angle).size_n.value, curvature)
