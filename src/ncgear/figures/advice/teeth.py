"""The keys that say a design's size, for another number of teeth.

What frees teeth of undercut: more of them, a profile shift, or a steeper rack, each with its number.

Advices about undercut teeth and shortened tips.

Advices about the contact of the teeth and the thrust of helical ones.
"""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import replace
from math import atan, degrees, floor, radians

import numpy as np

from ncgear.contact.designed.as_designed import AsDesigned, SideContact
from ncgear.design.keys.gears import Gears
from ncgear.errors import WrongInput
from ncgear.figures.advice.law import STEEPEST_DEG
from ncgear.figures.advice.values import Advice, Change, Kind, Remedy, Where
from ncgear.pitch.pair import Size
from ncgear.project.drive import Drive
from ncgear.teeth.form import BasicRack
from ncgear.teeth.gear import ToothedGear, shift_against_undercut, teeth_free_of_undercut
from ncgear.teeth.tips import Limit


def resized(gears: Gears, size: Size, teeth: int) -> tuple[Change, ...]:
    """The changes that give the driving gear ``teeth`` teeth at the same centre distance, by a module that fits.

    A design that gives teeth and centre distance needs no other change; from one that gives the module it changes too,
    or is left out where the centre distance is given.
    """
    changes = [Change("gears.teeth", teeth)]
    if gears.module_mm is not None:
        fitting = size.module_mm * size.driving_teeth / teeth
        changes.append(Change("gears.module_mm", fitting if gears.center_distance_mm is None else None))
    return tuple(changes)


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


CLEAR = 0.995
"""Share of the least tip height that is advised as addendum: a hair lower, so that rounding the number does no harm."""

LEAST_ADDENDUM = 0.5
"""In modules: lower teeth, of half the height of the standard's, hardly keep contact from pitch to pitch."""

FINER = Remedy("take more teeth of a smaller module")

LESS_HELIX = Remedy("take a smaller helix angle or face width")

MEANINGS = {
    Limit.SLOPE: "would slope too much, the other edge of the tooth being lower",
    Limit.FILLET: "would reach into the mate's fillet",
    Limit.CUSP: "would end in a cusp, so concave is the pitch curve there",
    Limit.FOULING: "would run into the mate's tips, so concave is the pitch curve there",
    Limit.HELIX: "would jump between sections of the helical teeth",
}
"""Why tips are shortened, by reason; undercut and pointed tips have advices of their own."""


def undercut(drive: Drive) -> Advice | None:
    """Teeth that a tool of full depth would cut into."""
    places = _places(drive, lambda gear: gear.undercut)
    if not places:
        return None
    allowed = drive.gears.undercut == "allow"
    return Advice(
        Kind.UNDERCUT,
        places,
        f"undercut{'' if allowed else ' at full height'}: {_named(places)}",
        "the flanks are cut away near the root, which weakens the teeth and shortens the contact"
        if allowed
        else "the mating tips are shortened instead, so that all flanks are exact; the contact is shorter for it",
        ways_out_of_undercut(drive),
    )


def pointed(drive: Drive) -> Advice | None:
    """Teeth whose flanks meet, or nearly, below the full height."""
    places = _places(drive, lambda gear: gear.shortened(Limit.LAND))
    if not places:
        return None
    least = drive.gears.least_tip_land
    return Advice(
        Kind.POINTED,
        places,
        f"pointed teeth: tips shortened that would have a land under {least:g} modules: {_named(places)}",
        "a sharp tip chips when hardened and wears fast, so it ends lower; the contact is shorter for it",
        _lower(drive),
    )


def shortened(drive: Drive) -> list[Advice]:
    """Tips that are shortened for yet another reason, one advice for each reason."""
    found = ((reason, words, _of_reason(drive, reason)) for reason, words in MEANINGS.items())
    return [
        Advice(
            Kind.SHORTENED,
            places,
            f"tips shortened that {words}: {_named(places)}",
            "the contact of these teeth is shorter",
            (LESS_HELIX if reason is Limit.HELIX else FINER,),
        )
        for reason, words, places in found
        if places
    ]


def _of_reason(drive: Drive, reason: Limit) -> tuple[Where, ...]:
    return _places(drive, lambda gear: gear.shortened(reason))


def _places(drive: Drive, teeth_of: Callable[[ToothedGear], list[int]]) -> tuple[Where, ...]:
    both = (("driving", drive.teeth.driving), ("driven", drive.teeth.driven))
    return tuple(Where(name, tuple(numbers)) for name, gear in both if (numbers := teeth_of(gear)))


def _lower(drive: Drive) -> tuple[Remedy, ...]:
    """The addendum at which no tooth is pointed, where a tooth of that height is still one."""
    least = min(_least_addendum(gear) for gear in (drive.teeth.driving, drive.teeth.driven))
    # Tips may stand higher than the addendum where the mate's are shortened: lowering it to theirs changes nothing.
    if not LEAST_ADDENDUM <= least < drive.gears.rack.addendum:
        return (FINER,)
    return (Remedy("make all teeth so low", (Change("gears.rack.addendum", least),)), FINER)


def _least_addendum(gear: ToothedGear) -> float:
    """In modules, that of the lowest of the tips that would be pointed; infinite where none would."""
    flanks, lowered = gear.flanks, gear.tips.limit == Limit.LAND
    height = float(np.min(flanks.tip_height_mm[lowered], initial=np.inf))
    return CLEAR * (height - flanks.rack.shift_mm) / flanks.rack.module_mm


def _named(places: tuple[Where, ...]) -> str:
    return "; ".join(map(str, places))


WIDER = 1.02
"""What the overlap of helical teeth shall be beyond the gap that they bridge: their sections differ a little."""

STEEPEST_HELIX_DEG = 30.0
"""Helix angle beyond which the thrust, its tangent, exceeds 0.58 of the tangential force; commonly not gone beyond."""


def contact_ratio(drive: Drive) -> Advice | None:
    """Flanks that lose contact, unless helical teeth overlap by more than that."""
    designed = drive.designed_contact
    sides = designed.pushing, designed.back
    if designed.longest_gap_pitches <= drive.overlap_ratio:
        return None
    error = max(side.transmission_error_rad for side in sides)
    return Advice(
        Kind.CONTACT_RATIO,
        (Where(angles_deg=tuple(_worst(designed, side) for side in sides if side.simultaneous.min() < 1)),),
        f"contact ratio: the shortest contact of a flank pair lasts {_shortest(designed):.3g} pitches, and at some "
        "positions no flanks touch",
        f"the driven gear is carried by an edge there, off the law by up to {error:.2g} rad; it knocks and wears",
        (*_helix(drive), Remedy("take more teeth of a smaller module")),
    )


def _shortest(designed: AsDesigned) -> float:
    return float(min(side.arcs.min() for side in (designed.pushing, designed.back)))


def _worst(designed: AsDesigned, side: SideContact) -> tuple[float, float]:
    """The first position without contact of flanks, in degrees of the driving gear."""
    at = degrees(float(designed.placement.phi1_rad[int(side.simultaneous.argmin())]))
    return at, at


def _helix(drive: Drive) -> tuple[Remedy, ...]:
    """Helical teeth whose overlap bridges the gap, where they need not be too steep for it."""
    if drive.helix is not None or drive.pitch.driven.is_ring or drive.gears.method != "exact":
        return ()
    gap_mm = WIDER * drive.designed_contact.longest_gap_pitches * drive.rack.pitch_mm
    angle = degrees(atan(gap_mm / drive.gears.face_width_mm))
    if angle > STEEPEST_HELIX_DEG:
        return ()
    changes = (
        Change("gears.helix.angle_deg", angle),
        Change("gears.helix.kind", "helical"),
        Change("gears.helix.hand", "right"),
    )
    return (Remedy("make the teeth helical, so that the next ones touch before these part", changes),)


def thrust(drive: Drive) -> Advice | None:
    """What helical teeth push along their axes."""
    helix = drive.helix
    if helix is None or not helix.thrust_share:
        return None
    towards, away = ("growing", "falling") if helix.hand == "right" else ("falling", "growing")
    return Advice(
        Kind.THRUST,
        (Where(),),
        f"axial thrust: {helix.thrust_share:.3g} of the tangential force at the pitch point pushes the driving gear "
        f"towards {towards} z and the driven one towards {away} z",
        "the bearings of both shafts must take it",
        (Remedy("herringbone teeth cancel it", (Change("gears.helix.kind", "herringbone"),)),),
    )
