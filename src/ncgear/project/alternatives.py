"""Changes to the keys of a design that cure a fault of its law or its teeth.

The changes are a gentler law, more teeth, a profile shift, another rack, lower or helical teeth.  Each function finds
the mildest change of its kind, by trying the changed design or the condition that it must meet.  It returns None or an
empty value where there is no such change.  The words about a change are not written here.
"""

from __future__ import annotations

from collections.abc import Callable
from contextlib import suppress
from math import atan, ceil, degrees, floor, inf, pi, radians
from typing import TYPE_CHECKING, TypeVar

import numpy as np
from pydantic import ValidationError

from ncgear.design.keys.base import Model
from ncgear.design.keys.design import Design
from ncgear.design.keys.drivetrain import widest_mm
from ncgear.design.keys.gears import Gears
from ncgear.design.keys.machine import Fit
from ncgear.design.keys.optimize import Optimize
from ncgear.design.reading.places import with_value
from ncgear.errors import DesignError, WrongInput
from ncgear.pitch.shape import Gear, Mesh
from ncgear.project.drive import Drive
from ncgear.project.opened import drive_like
from ncgear.ratio.transmission import Transmission
from ncgear.teeth.form import BasicRack
from ncgear.teeth.root_radius import fitting_root_radius, largest_root_radius

if TYPE_CHECKING:
    from ncgear.teeth.gear import ToothedGear

Setting = float | int | bool | str | tuple[float, ...] | None
"""A value of a key of the design file; None leaves the key out."""

Changes = dict[str, Setting]
"""Dotted keys of the design file with their new values."""

STEPS = 100
"""Number of steps in which a gentler law is searched: hundredths of the law's swing are fine enough."""

LEAST_RACK_DEG = 14.5
"""The least pressure angle of common racks; teeth with a smaller angle are undercut and weak at the root."""

STEEPEST_RACK_DEG = 30.0
"""The greatest pressure angle of common racks; teeth with a greater angle are pointed."""

STEEPEST_HELIX_DEG = 30.0
"""The greatest helix angle in common use.

The thrust is the tangential force times the tangent of this angle, so it stays below 0.58 of that force.
"""

WIDER = 1.02
"""Ratio of the overlap of helical teeth to the gap that it bridges: over 1, because the sections differ a little."""

CLEAR = 0.995
"""Share of the least tip height that the addendum takes: a little under 1, so that rounding does no harm."""

LEAST_ADDENDUM = 0.5
"""Least addendum in modules: teeth of half the standard height hardly keep contact from one pitch to the next."""

RACK_ANGLES = ("pressure_angle_deg", "idle_pressure_angle_deg")
"""Keys of the pressure angles of both flanks."""

SHIFTS = ("driving", "driven", "per_tooth")
"""Keys of profile shifts that a user gives; a shift that ncgear chooses replaces them."""


# A gentler law: a factor below 1 scales the logarithm of its ratio, or another measure of its unevenness.


def kept_percent(design: Design, harmful: Callable[[Transmission], bool]) -> int:
    """The largest part of the swing of a design's law that is not ``harmful``, in whole per cent.

    It is 0 where every part is harmful, and where ``gentler`` has no changes for the law.  The search halves an
    interval; it assumes that a smaller swing is never more harmful than a larger swing.
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
    try:
        return not harmful(Drive(changed_motion(design, changes)).pair.transmission)
    except DesignError:
        return False


def changed_motion(design: Design, changes: Changes) -> Design:
    """The design with other values of keys right under ``motion``."""
    values = {key.removeprefix("motion."): value for key, value in changes.items()}
    return design.model_copy(update={"motion": design.motion.model_copy(update=values)})


def gentler(design: Design, share: float) -> Changes:
    """The changes that leave ``share`` (0 to 1) of the swing of a law's ratio; empty where the law has no such measure.

    Depending on the law, it is a share of the logarithm of the ratio, of the driven angle's deviation from an even
    turn, or of the ellipse's eccentricity.
    """
    lobes = design.gears.lobes if design.gears else None
    # The driven angle per driving angle for gears that turn evenly.
    even_turn = f"{lobes.driving}/{lobes.driven}" if lobes else "1"
    values = design.motion.gentler(share, even_turn)
    return {f"motion.{key}": value for key, value in values.items() if value != ()}


# Values that a user has given, which no change may undo.


def is_given(design: Design, key: str) -> bool:
    """Whether the design file gives a value at a dotted key, even if the value is the default."""
    group: object = design
    for name in key.split("."):
        if not isinstance(group, Model) or name not in group.model_fields_set:
            return False
        group = getattr(group, name)
    return group is not None


def overstepped(design: Design) -> set[str]:
    """The keys of the hard wishes that a design's law does not keep, and of the limits of the best law.

    Only limits of the ratio and of the motion without masses count.  Raises DesignError where there is no such law.
    """
    drive = Drive(design)
    missed = {outcome.wish.key for outcome in drive.outcomes if outcome.wish.hard and not outcome.kept}
    low, high = drive.transmission.ratio_range
    limits = (design.optimize or Optimize()).limits
    least_ratio = {"ratio_min"} if low.value < limits.ratio_min else set()
    most = {
        "ratio_max": high.value,
        "peak_acceleration_mm_s2": drive.check.peak_acceleration_cycle.value,
        "peak_acceleration_rad_s2": drive.check.peak_acceleration_cycle.value,
        "peak_power_w": drive.check.peak_power_w.value,
    }
    over = {key for key, value in most.items() if (limit := getattr(limits, key)) is not None and value > limit}
    return missed | {f"optimize.limits.{key}" for key in over | least_ratio}


# Other racks and other teeth.


Part = TypeVar("Part", bound=Model)


def changed_part(part: Part, changes: Changes) -> Part:
    """A section of a design with changes of its keys; raises ValidationError where a value is not allowed."""
    data = part.model_dump(exclude_unset=True)
    for key, value in changes.items():
        data = with_value(data, key.partition(".")[2], value)
    return type(part).model_validate(data)


def changed_design(design: Design, changes: Changes) -> Design:
    """The design with changes below ``gears``, ``drivetrain`` and ``fit``; raises as ``changed_part``."""
    changed = dict[str, Model]()
    for name in ("gears", "drivetrain", "fit"):
        own = {key: value for key, value in changes.items() if key.startswith(f"{name}.")}
        if own:
            changed[name] = changed_part(getattr(design, name) or Fit(), own)
    return design.model_copy(update=changed)


def changed_drive(drive: Drive, changes: Changes) -> Drive:
    """The drive of the changed design."""
    return drive_like(drive, changed_design(drive.design, changes))


def with_width(design: Design, width_mm: float) -> Changes:
    """The changes that give a design another face width.

    Keys of shafts become no longer than their gears with hubs, and an end relief no longer than half the face.
    """
    gears, changes = design.gears, Changes({"gears.face_width_mm": width_mm})
    if gears is None:
        return changes
    for number, (_, name, shaft) in enumerate(design.shafts):
        given_mm = shaft.key.length_mm if shaft and shaft.key else None
        longest = width_mm + min((gears.hub_mm(gear) for gear in design.gears_on(number)), default=0.0)
        if given_mm is not None and given_mm > longest:
            changes[f"drivetrain.{name}.key.length_mm"] = longest
    if (gears.lead.end_relief_length_mm or 0.0) > width_mm / 2.0:
        changes["gears.lead.end_relief_length_mm"] = width_mm / 2.0
    return changes


def widths_mm(design: Design) -> tuple[float, float]:
    """The face widths over the first and up to the second of which webs have pockets and bearings stand clear."""
    gears = design.gears
    if gears is None:
        return 0.0, inf
    webs = [body.web.thickness_mm for body in (gears.driving, gears.driven) if body.web]
    return max([*webs, gears.first_layer_chamfer_mm]), widest_mm(design.shafts, gears, design.stages)


def is_accepted(design: Design, changes: Changes) -> bool:
    """Whether the file may have the changes: a row of gears, for one, has no helical teeth."""
    if any(design.key_in_file(key) is None for key in changes):
        return False
    if design.gears is None:
        return True
    try:
        type(design).model_validate(changed_design(design, changes).model_dump(by_alias=True, exclude_unset=True))
    except (ValidationError, DesignError):
        return False
    return True


def flatter_rack(drive: Drive, excess_deg: float) -> Changes:
    """A rack whose pressure angle is less by ``excess_deg``; empty where that is under LEAST_RACK_DEG."""
    gears = drive.gears
    flatter = gears.carrying_angle_deg - excess_deg
    if flatter < LEAST_RACK_DEG:
        return {}
    steeper = [key for key in RACK_ANGLES if (given := getattr(gears.rack, key)) is not None and given > flatter]
    return {f"gears.rack.{key}": int(flatter * 10.0) / 10.0 for key in steeper}


def enough_teeth(drive: Drive) -> int:
    """The least number of driving teeth at which no tooth is undercut, at the same centre distance.

    It holds at all places of the teeth on the pitch curves.
    """
    return _enough(drive, drive.teeth.driving.flanks.rack, drive.teeth.driven.flanks.rack)


def _enough(drive: Drive, driving: BasicRack, driven: BasicRack) -> int:
    from ncgear.teeth.gear import teeth_free_of_undercut

    return teeth_free_of_undercut(drive.pitch, driving, driven)


def resized(drive: Drive, teeth: int) -> Changes:
    """The changes that give a pair's driving gear ``teeth`` teeth at the same centre distance, by a module that fits.

    A design that gives teeth and centre distance needs no other change.  Where a design gives the module, the module
    changes too, or is left out if the centre distance is also given.
    """
    gears, size = drive.gears, drive.whole.by_stage[0].pitch.size
    teeth = ceil(teeth * size.driving_teeth / drive.pitch.size.driving_teeth)
    changes: Changes = {"gears.teeth": teeth}
    if gears.profile_shift.per_tooth is not None:
        # The shifts were given for other teeth.
        changes["gears.profile_shift.per_tooth"] = None
    if gears.module_mm is not None:
        fitting = size.module_mm * size.driving_teeth / teeth
        changes["gears.module_mm"] = fitting if gears.center_distance_mm is None else None
    return changes


def shift_free_of_undercut(drive: Drive) -> tuple[float, Changes] | None:
    """The profile shift in mm of the driving gear that ``against_undercut`` chooses, and the changes that ask for it.

    None where the design has this shift already, or where some tooth stays undercut with it.
    """
    from ncgear.teeth.gear import shift_against_undercut

    rack = drive.rack
    shift = shift_against_undercut(drive.pitch, rack)
    teeth = drive.pitch.size.driving_teeth
    has_it = drive.gears.profile_shift.against_undercut
    if has_it or _enough(drive, rack.shifted(shift), rack.shifted(-shift)) > teeth:
        return None
    return shift, shifted_against_undercut(drive.gears)


def shifted_against_undercut(gears: Gears) -> Changes:
    """The changes that ask for the profile shift chosen against undercut, in place of the given shifts."""
    given = gears.profile_shift
    dropped: Changes = {f"gears.profile_shift.{key}": None for key in SHIFTS if getattr(given, key) is not None}
    return {**dropped, "gears.profile_shift.against_undercut": True}


def steeper_rack(drive: Drive, steepest_deg: float) -> Changes:
    """The rack of the least pressure angle, in whole degrees, that leaves no tooth undercut.

    Empty where every rack would give the pair a pressure angle over ``steepest_deg``, and where single teeth have
    profile shifts.
    """
    if drive.gears.profile_shift.per_tooth is not None:
        return {}
    tangent, form = degrees(drive.pitch.largest_tangent_angle_rad.value), drive.tooth_form
    least = floor(degrees(min(drive.rack.angles_rad))) + 1
    most = floor(min(STEEPEST_RACK_DEG, steepest_deg - tangent))
    for angle in range(least, most + 1):
        changes = rack_at(drive.gears, float(angle))
        try:
            rack = changed_part(drive.gears, changes).rack.in_mm(drive.rack.module_mm)
        except WrongInput:
            continue
        driving, driven = rack.shifted(form.driving_shift_mm), rack.shifted(form.driven_shift_mm)
        if _enough(drive, driving, driven) <= drive.pitch.size.driving_teeth:
            return changes
    return {}


def rack_at(gears: Gears, angle_deg: float) -> Changes:
    """The rack at another pressure angle; a given root radius that does not fit there becomes smaller.

    If there are two angles, both become at least as great.
    """
    idle, changes = gears.rack.idle_pressure_angle_deg, fitted_root_radius(gears, angle_deg)
    if idle is None:
        return {"gears.rack.pressure_angle_deg": angle_deg, **changes}
    greater = {key: max(getattr(gears.rack, key), angle_deg) for key in RACK_ANGLES}
    return {**{f"gears.rack.{key}": value for key, value in greater.items()}, **changes}


def fitted_root_radius(gears: Gears, angle_deg: float) -> Changes:
    """The root radius that fits at a pressure angle; empty where the given radius fits, is left out, or none fits.

    A root radius that is left out always fits.
    """
    rack = gears.rack
    angles = radians(max(angle_deg, rack.pressure_angle_deg)), radians(max(angle_deg, rack.angles_deg[1]))
    if rack.idle_pressure_angle_deg is None:
        angles = radians(angle_deg), radians(angle_deg)
    largest = largest_root_radius(angles, rack.dedendum, pi / 4.0)
    if "root_radius" not in rack.model_fields_set or largest < 0.0 or rack.root_radius <= largest:
        return {}
    return {"gears.rack.root_radius": fitting_root_radius(rack.root_radius, largest)}


def blunt_addendum(drive: Drive) -> Changes:
    """The addendum at which no tooth is pointed; empty where it is under LEAST_ADDENDUM or not under the design's."""
    least = min(_least_addendum(gear) for gear in (drive.teeth.driving, drive.teeth.driven))
    # Tips may be higher than the addendum where the mate is shortened; an addendum at least as high changes nothing.
    return {"gears.rack.addendum": least} if LEAST_ADDENDUM <= least < drive.gears.rack.addendum else {}


def _least_addendum(gear: ToothedGear) -> float:
    """Addendum in modules just under the lowest tip that was cut to keep its land; infinite where no tip was cut."""
    from ncgear.teeth.tips import Limit

    flanks, lowered = gear.flanks, gear.tips.limit == Limit.LAND
    own_shift = flanks.full_tip_mm - flanks.rack.tip_height_mm
    height = float(np.min((flanks.tip_height_mm - own_shift)[lowered], initial=np.inf))
    return CLEAR * (height - flanks.rack.shift_mm) / flanks.rack.module_mm


def room_for_index_hole(drive: Drive, gear: Gear) -> Changes:
    """The largest hub or else bore, in twentieths of the given one, that leaves room for an index hole of a gear.

    For a ring it is a rim that is thicker by quarters of a module.  Empty where none is found, and for helical teeth,
    whose sections take long.
    """
    from ncgear.project.gear_solids import finished_plans, rim_mm_of
    from ncgear.solids.plan.areas import floored, raised

    if drive.helix is not None:
        return {}
    gears, pitch, name = drive.gears, drive.pitch, f"gears.{gear.value}"
    body = gears.driving if gear is Gear.DRIVING else gears.driven
    if pitch.mesh is Mesh.INTERNAL and gear is Gear.DRIVEN:
        module_mm = pitch.size.module_mm
        rims_mm = [rim_mm_of(gears, module_mm) + step * module_mm / 4.0 for step in range(1, 25)]
        key, sizes = f"{name}.rim_mm", list(map(raised, rims_mm))
    else:
        key = f"{name}.hub.diameter_mm" if body.hub else f"{name}.bore_mm"
        given = body.hub.diameter_mm if body.hub else body.bore_mm or 0.0
        sizes = [floored(given * step / 20.0) for step in range(19, 0, -1)]
    for size in sizes:
        with suppress(DesignError, ValidationError):
            changed = changed_part(gears, {key: size})
            plans = finished_plans(changed, pitch, drive.teeth, drive.chord_tolerance_mm, drive.crank_pin)
            if dict(zip(Gear, plans, strict=True))[gear].index_hole:
                return {key: size}
    return {}


def bridging_helix(drive: Drive) -> Changes:
    """Helical teeth whose overlap bridges the gap in the contact.

    Empty where helical teeth cannot be made, or where they would be steeper than STEEPEST_HELIX_DEG.
    """
    if not may_be_helical(drive):
        return {}
    gap_mm = WIDER * drive.designed_contact.longest_gap_pitches * drive.rack.pitch_mm
    angle = degrees(atan(gap_mm / drive.gears.face_width_mm))
    if angle > STEEPEST_HELIX_DEG:
        return {}
    return with_helix(angle, "helical")


def may_be_helical(drive: Drive) -> bool:
    """Whether teeth are straight and helical ones can be made in their place.

    They cannot on rings, in rows and trains, on gears that turn less than once, by other methods, and with keys of the
    process.
    """
    from ncgear.project.gear_solids import PROCESS

    may_say_so = drive.design.key_in_file("gears.helix.kind") is not None
    straight = drive.helix is None and drive.gears.method == "exact" and may_say_so
    kept_from = drive.pitch.driven.is_ring or drive.design.motion.is_open or drive.gears.idlers is not None
    return straight and not kept_from and not any(getattr(drive.gears, key) for key in PROCESS)


def with_helix(angle_deg: float, kind: str) -> Changes:
    """The changes that make straight teeth helical or herringbone ones."""
    return {"gears.helix.angle_deg": angle_deg, "gears.helix.kind": kind, "gears.helix.hand": "right"}
