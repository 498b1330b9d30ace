"""What frees teeth of undercut: more of them, a profile shift, or a steeper rack, each with its number."""

from __future__ import annotations

from dataclasses import replace
from math import degrees, floor, radians

from ncgear.drive import Drive
from ncgear.errors import WrongInput
from ncgear.machine.rack import BasicRack
from ncgear.output.advice.curves import STEEPEST_DEG
from ncgear.output.advice.resized import resized
from ncgear.output.advice.values import Change, Remedy
from ncgear.teeth.shift import shift_against_undercut, teeth_free_of_undercut

STEEPEST_RACK_DEG = 30.0
"""The greatest pressure angle that racks are commonly made with; their teeth are pointed beyond it."""

SHIFTS = ("driving", "driven")
"""Keys of given profile shifts, which one that is chosen takes the place of."""


def ways_out_of_undercut(drive: Drive) -> tuple[Remedy, ...]:
    """Each of them by itself leaves no tooth undercut, wherever it stands on the curves."""
    return (*_more_teeth(drive), *_shift(drive), *_steeper_rack(drive))


def _more_teeth(drive: Drive) -> tuple[Remedy, ...]:
    enough = _enough(drive, drive.teeth.driving.flanks.rack, drive.teeth.driven.flanks.rack)
    changes = resized(drive.gears, drive.pitch.size, enough)
    return (Remedy(f"from {enough} driving teeth at this centre distance there is none", changes),)


def _enough(drive: Drive, driving: BasicRack, driven: BasicRack) -> int:
    return teeth_free_of_undercut(drive.pitch, driving, driven)


def _shift(drive: Drive) -> tuple[Remedy, ...]:
    """The shift that is chosen by itself, where it is enough."""
    given, rack = drive.gears.profile_shift, drive.rack
    shift = shift_against_undercut(drive.pitch, rack)
    teeth = drive.pitch.size.driving_teeth
    if given.against_undercut or _enough(drive, rack.shifted(shift), rack.shifted(-shift)) > teeth:
        return ()
    dropped = [Change(f"gears.profile_shift.{key}", None) for key in SHIFTS if getattr(given, key) is not None]
    changes = (*dropped, Change("gears.profile_shift.against_undercut", True))
    return (
        Remedy(f"shift the profiles, by {shift / rack.module_mm:.3g} modules outwards on the driving gear", changes),
    )


def _steeper_rack(drive: Drive) -> tuple[Remedy, ...]:
    """The least pressure angle in whole degrees that is enough, where the pair does not get too steep by it."""
    tangent = degrees(drive.pitch.largest_tangent_angle_rad.value)
    least = floor(degrees(drive.rack.pressure_angle_rad)) + 1
    most = floor(min(STEEPEST_RACK_DEG, STEEPEST_DEG - tangent))
    for angle in range(least, most + 1):
        rack = _rack(drive, float(angle))
        if rack is not None and _frees(drive, rack):
            return (Remedy("take a rack with a greater pressure angle", _changes(drive, rack, float(angle))),)
    return ()


def _rack(drive: Drive, angle_deg: float) -> BasicRack | None:
    """The design's rack at another pressure angle, its root radius no more than fits; None where none does."""
    rack, hundredth = drive.tooth_form.rack, drive.rack.module_mm / 100.0
    try:
        sharp = replace(rack, pressure_angle_rad=radians(angle_deg), root_radius_mm=0.0)
    except WrongInput:
        return None
    fitting = floor(sharp.largest_root_radius_mm / hundredth) * hundredth
    return replace(sharp, root_radius_mm=min(rack.root_radius_mm, fitting))


def _frees(drive: Drive, rack: BasicRack) -> bool:
    form = drive.tooth_form
    driving, driven = rack.shifted(form.driving_shift_mm), rack.shifted(form.driven_shift_mm)
    return _enough(drive, driving, driven) <= drive.pitch.size.driving_teeth


def _changes(drive: Drive, rack: BasicRack, angle_deg: float) -> tuple[Change, ...]:
    changed = [Change("gears.rack.pressure_angle_deg", angle_deg)]
    if rack.root_radius_mm < drive.rack.root_radius_mm:
        changed.append(Change("gears.rack.root_radius", rack.root_radius_mm / rack.module_mm))
    return tuple(changed)
