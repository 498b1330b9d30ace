"""What else a design could be where something is wrong with its law or its teeth, as keys with other values.

A gentler law, more teeth, a profile shift, another rack, lower or helical teeth: each function finds the mildest such
change by trying the changed design or the condition it must meet, and says nothing about it; None and nothing stand for
no such change.  A key whose value is None is to be left out of the file.
"""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import replace
from math import atan, degrees, floor, radians
from typing import TYPE_CHECKING

from ncgear.design.keys.design import Design
from ncgear.errors import DesignError, WrongInput
from ncgear.project.drive import Drive
from ncgear.ratio.transmission import Transmission
from ncgear.teeth.form import BasicRack

if TYPE_CHECKING:
    from ncgear.teeth.gear import ToothedGear

Setting = float | int | bool | str | tuple[float, ...] | None
"""What a key of the design file is set to; None leaves the key out."""

Changes = dict[str, Setting]
"""Dotted keys of the design file with their other values."""

STEPS = 100
"""Hundredths of the law's swing in which a gentler one is sought: finer ones nobody would choose."""

LEAST_RACK_DEG = 14.5
"""The least pressure angle that racks are commonly made with: below it teeth are undercut and weak at the root."""

STEEPEST_RACK_DEG = 30.0
"""The greatest pressure angle that racks are commonly made with; their teeth are pointed beyond it."""

STEEPEST_HELIX_DEG = 30.0
"""Helix angle beyond which the thrust, its tangent, exceeds 0.58 of the tangential force; commonly not gone beyond."""

WIDER = 1.02
"""What the overlap of helical teeth shall be beyond the gap that they bridge: their sections differ a little."""

CLEAR = 0.995
"""Share of the least tip height that is taken as addendum: a hair lower, so that rounding the number does no harm."""

LEAST_ADDENDUM = 0.5
"""Least addendum in modules that is taken: teeth of half the standard's height hardly keep contact from pitch to
pitch."""

SHIFTS = ("driving", "driven")
"""Keys of given profile shifts, which one that is chosen takes the place of."""


# A gentler law: the logarithm of its ratio, or what else makes it uneven, made smaller by a factor.


def kept_percent(design: Design, harmful: Callable[[Transmission], bool]) -> int:
    """How much of the swing of a design's law can stay so that the law is no longer ``harmful``, in per cent.

    It is 0 where none can, or where ``gentler`` knows no way.  A lesser swing is taken to be no more harmful, so that
    halving finds the largest one of whole hundredths.
    """
    low, high = 0, STEPS
    while high - low > 1:
        middle = (low + high) // 2
        if _is_sound(design, middle / STEPS, harmful):
            low = middle
        else:
            high = middle
    return low


def _is_sound(design: Design, share: float, harmful: Callable[[Transmission], bool]) -> bool:
    changes = gentler(design, share)
    if not changes:
        return False
    values = {key.removeprefix("motion."): value for key, value in changes.items()}
    changed = design.model_copy(update={"motion": design.motion.model_copy(update=values)})
    try:
        return not harmful(Drive(changed).pair.transmission)
    except DesignError:
        return False


def gentler(design: Design, share: float) -> Changes:
    """The changes that leave ``share`` (0 to 1) of the swing of a law's ratio; none where it has no such measure.

    The logarithm of the ratio keeps that share, or the driven angle's deviation from an even turn, or the ellipse's
    eccentricity.
    """
    lobes = design.gears.lobes if design.gears else None
    # Gears that turn evenly turn the driven one by this much per driving angle.
    even_turn = f"{lobes.driving}/{lobes.driven}" if lobes else "1"
    values = design.motion.gentler(share, even_turn)
    return {f"motion.{key}": value for key, value in values.items() if value != ()}


# Other racks and other teeth.


def flatter_rack(drive: Drive, excess_deg: float) -> Changes:
    """A rack of so much less pressure angle, where such racks are made; none otherwise."""
    flatter = degrees(drive.rack.pressure_angle_rad) - excess_deg
    return {} if flatter < LEAST_RACK_DEG else {"gears.rack.pressure_angle_deg": int(flatter * 10.0) / 10.0}


def enough_teeth(drive: Drive) -> int:
    """Driving teeth from which on none is undercut at the same centre distance, wherever it stands on the curves."""
    return _enough(drive, drive.teeth.driving.flanks.rack, drive.teeth.driven.flanks.rack)


def _enough(drive: Drive, driving: BasicRack, driven: BasicRack) -> int:
    from ncgear.teeth.gear import teeth_free_of_undercut

    return teeth_free_of_undercut(drive.pitch, driving, driven)


def resized(drive: Drive, teeth: int) -> Changes:
    """The changes that give the driving gear ``teeth`` teeth at the same centre distance, by a module that fits.

    A design that gives teeth and centre distance needs no other change; from one that gives the module it changes too,
    or is left out where the centre distance is given.
    """
    gears, size = drive.gears, drive.pitch.size
    changes: Changes = {"gears.teeth": teeth}
    if gears.module_mm is not None:
        fitting = size.module_mm * size.driving_teeth / teeth
        changes["gears.module_mm"] = fitting if gears.center_distance_mm is None else None
    return changes


def shift_free_of_undercut(drive: Drive) -> tuple[float, Changes] | None:
    """The profile shift of the driving gear in mm that is chosen by itself, where it leaves no tooth undercut."""
    from ncgear.teeth.gear import shift_against_undercut

    given, rack = drive.gears.profile_shift, drive.rack
    shift = shift_against_undercut(drive.pitch, rack)
    teeth = drive.pitch.size.driving_teeth
    if given.against_undercut or _enough(drive, rack.shifted(shift), rack.shifted(-shift)) > teeth:
        return None
    dropped: Changes = {f"gears.profile_shift.{key}": None for key in SHIFTS if getattr(given, key) is not None}
    return shift, {**dropped, "gears.profile_shift.against_undercut": True}


def steeper_rack(drive: Drive, steepest_deg: float) -> Changes:
    """The rack of the least pressure angle in whole degrees that leaves no tooth undercut.

    None where the pair's own pressure angle would get over ``steepest_deg`` by it.  The root radius becomes smaller
    where it does not fit.
    """
    tangent = degrees(drive.pitch.largest_tangent_angle_rad.value)
    least = floor(degrees(drive.rack.pressure_angle_rad)) + 1
    most = floor(min(STEEPEST_RACK_DEG, steepest_deg - tangent))
    form = drive.tooth_form
    for angle in range(least, most + 1):
        rack = _rack_at(drive, float(angle))
        if rack is None:
            continue
        driving, driven = rack.shifted(form.driving_shift_mm), rack.shifted(form.driven_shift_mm)
        if _enough(drive, driving, driven) <= drive.pitch.size.driving_teeth:
            changes: Changes = {"gears.rack.pressure_angle_deg": float(angle)}
            if rack.root_radius_mm < drive.rack.root_radius_mm:
                changes["gears.rack.root_radius"] = rack.root_radius_mm / rack.module_mm
            return changes
    return {}


def _rack_at(drive: Drive, angle_deg: float) -> BasicRack | None:
    """The design's rack at another pressure angle, its root radius no more than fits; None where none does."""
    rack, hundredth = drive.tooth_form.rack, drive.rack.module_mm / 100.0
    try:
        sharp = replace(rack, pressure_angle_rad=radians(angle_deg), root_radius_mm=0.0)
    except WrongInput:
        return None
    fitting = floor(sharp.largest_root_radius_mm / hundredth) * hundredth
    return replace(sharp, root_radius_mm=min(rack.root_radius_mm, fitting))


def blunt_addendum(drive: Drive) -> Changes:
    """The addendum at which no tooth is pointed, where a tooth of that height is still one."""
    least = min(_least_addendum(gear) for gear in (drive.teeth.driving, drive.teeth.driven))
    # Tips may stand higher than the addendum where the mate's are shortened: lowering it to theirs changes nothing.
    return {"gears.rack.addendum": least} if LEAST_ADDENDUM <= least < drive.gears.rack.addendum else {}


def _least_addendum(gear: ToothedGear) -> float:
    """Addendum in modules of the lowest tip that would be pointed; infinite where none would."""
    import numpy as np

    from ncgear.teeth.tips import Limit

    flanks, lowered = gear.flanks, gear.tips.limit == Limit.LAND
    height = float(np.min(flanks.tip_height_mm[lowered], initial=np.inf))
    return CLEAR * (height - flanks.rack.shift_mm) / flanks.rack.module_mm


def bridging_helix(drive: Drive) -> Changes:
    """Helical teeth whose overlap bridges the gap in the contact, where they can be made and are not too steep."""
    if drive.helix is not None or drive.pitch.driven.is_ring or drive.gears.method != "exact":
        return {}
    gap_mm = WIDER * drive.designed_contact.longest_gap_pitches * drive.rack.pitch_mm
    angle = degrees(atan(gap_mm / drive.gears.face_width_mm))
    if angle > STEEPEST_HELIX_DEG:
        return {}
    return {"gears.helix.angle_deg": angle, "gears.helix.kind": "helical", "gears.helix.hand": "right"}
