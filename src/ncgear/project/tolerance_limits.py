"""From keys to values: the limits of a pair's deviations, and the backlash that its assemblies leave."""

from __future__ import annotations

from math import cos, degrees, radians

import numpy as np

from ncgear.design.keys.gears import Gears
from ncgear.design.keys.tolerances import AssemblyTolerances, GearTolerances
from ncgear.errors import WrongInput
from ncgear.numerics.arrays import Array
from ncgear.pitch.shape import Gear
from ncgear.project.drive import Drive
from ncgear.project.service import choices_of
from ncgear.project.tooth_form import thickness_limits_mm
from ncgear.teeth.backlash import idle_arms_mm
from ncgear.teeth.gear import ToothedGear
from ncgear.tolerances.drawn import Limits
from ncgear.tolerances.iso1328 import DIAMETERS_MM, MODULES_MM, TEETH, flank_tolerances, tooth_diameters_mm

TURNING = 0.999
"""Share of the assemblies that shall turn."""

MOST_JAMMED = 0.01
"""Share of the assemblies that may jam without a warning: the assembly gets other gears then.
"""


def limits_of(drive: Drive, given: AssemblyTolerances) -> Limits:
    """The limits in mm and rad; raises WrongInput where a grade does not hold for the gears."""
    # The grades of helical teeth go by the module across the flank.
    module = drive.pitch.size.module_mm * cos(drive.helix.angle_rad if drive.helix else 0.0)
    each = given.driving, given.driven
    pitch, profile = [], []
    for gear, own in zip(Gear, each, strict=True):
        one, other = _of_teeth(drive.teeth.of(gear), own, given.grade, module, f"tolerances.{gear.name.lower()}")
        pitch.append(one)
        profile.append(other)
    warm = given.temperature
    range_c = (warm.least_c, warm.largest_c) if warm else (20.0, 20.0)
    driving, driven = (one.entry.elastic.expansion_per_k for one in choices_of(drive.gears))
    return Limits(
        center_distance_mm=given.center_distance_mm,
        eccentricity_mm=(given.driving.eccentricity_mm, given.driven.eccentricity_mm),
        tilt_rad=(radians(given.driving.tilt_deg), radians(given.driven.tilt_deg)),
        index_rad=(radians(given.driving.index_deg), radians(given.driven.index_deg)),
        pitch_mm=np.concatenate(pitch),
        profile_mm=np.concatenate(profile),
        temperature_c=range_c,
        warmer_k=warm.warmer_k if warm else 0.0,
        expansions=(driving, driven, 1e-6 * given.housing_expansion_um_m_k),
        wear_mm=(given.driving.wear_mm, given.driven.wear_mm),
    )


def _of_teeth(
    gear: ToothedGear, own: GearTolerances, grade: int | None, module_mm: float, key: str
) -> tuple[Array, Array]:
    """Single pitch and total profile deviation of each flank of a gear, from its grade or as given."""
    grade = own.grade or grade
    told = own.single_pitch_mm is not None and own.profile_mm is not None
    pitch = profile = np.zeros(gear.flanks.count)
    if grade is not None and not told:
        _require_graded(gear, module_mm, f"{key}.grade" if own.grade else "tolerances.grade")
        limits = flank_tolerances(grade, tooth_diameters_mm(gear), module_mm)
        pitch, profile = limits.single_pitch_mm, limits.total_profile_mm
    if own.single_pitch_mm is not None:
        pitch = np.full(gear.flanks.count, own.single_pitch_mm)
    if own.profile_mm is not None:
        profile = np.full(gear.flanks.count, own.profile_mm)
    return pitch, profile


def _require_graded(gear: ToothedGear, module_mm: float, key: str) -> None:
    largest = 2.0 * float(np.linalg.norm(gear.outline_mm, axis=1).max())
    for name, value, (least, most) in (
        ("the module in mm is", module_mm, MODULES_MM),
        ("the teeth are", gear.teeth, TEETH),
        ("the diameter in mm is", largest, DIAMETERS_MM),
    ):
        if not least <= value <= most:
            raise WrongInput(
                f"{name} {value:g}, but ISO 1328-1 has grades from {least:g} to {most:g} only; give "
                "single_pitch_mm and profile_mm under tolerances.driving and tolerances.driven in place of a grade",
                key=key,
            )


def backlash_key(gears: Gears) -> str:
    """The key under ``gears`` by which a design gives its backlash."""
    return "backlash_mm" if gears.backlash_deg is None else "backlash_deg"


def left_of_backlash(pair: Drive, least_play_rad: Array) -> Array:
    """The backlash that assemblies with given least plays would leave of a backlash of 0, in the unit of its key.

    The plays are for teeth in the middle of their thickness, the result is for the thickest teeth that the file allows.
    Along the normal they count where its arm is least, as the key does.
    """
    least_arm_mm = idle_arms_mm(pair.pitch, pair.rack)[0].value
    unit = degrees(1.0) if pair.gears.backlash_deg is not None else least_arm_mm
    lower, upper = thickness_limits_mm(pair.gears) or (0.0, 0.0)
    thicker_rad = (upper - lower) * cos(pair.rack.angles_rad[1]) / least_arm_mm
    return np.asarray(unit * (least_play_rad - pair.play.driven_rad - thicker_rad))
