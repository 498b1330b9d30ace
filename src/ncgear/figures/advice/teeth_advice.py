"""Advices about the teeth of a pair: undercut, shortened tips, contact, and the thrust of helical teeth."""

from __future__ import annotations

from collections.abc import Callable
from functools import partial
from math import degrees

from ncgear.contact.designed.as_designed import AsDesigned, SideContact
from ncgear.figures.advice.law_advice import STEEPEST_DEG
from ncgear.figures.advice.values import Advice, Change, Kind, Remedy, Where, changed
from ncgear.figures.numbers import MICRORAD, to_digits
from ncgear.project.alternatives import (
    blunt_addendum,
    bridging_helix,
    enough_teeth,
    resized,
    shift_free_of_undercut,
    steeper_rack,
)
from ncgear.project.drive import Drive
from ncgear.teeth.gear import ToothedGear
from ncgear.teeth.tips import Limit

FINER = Remedy("take more teeth of a smaller module")

LESS_HELIX = Remedy("take a smaller helix angle or face width")

MEANINGS = {
    Limit.SLOPE: "would slope too much, the other edge of the tooth being lower",
    Limit.FILLET: "would reach into the mate's fillet",
    Limit.CUSP: "would end in a cusp, so concave is the pitch curve there",
    Limit.FOULING: "would run into the mate's tips, so concave is the pitch curve there",
    Limit.HELIX: "would jump between sections of the helical teeth",
}
"""The words for each reason to shorten tips; undercut and pointed tips have advices of their own."""


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
        _ways_out_of_undercut(drive),
    )


def _ways_out_of_undercut(drive: Drive) -> tuple[Remedy, ...]:
    """The remedies; each alone leaves no tooth undercut, wherever the teeth stand on the pitch curves."""
    enough = enough_teeth(drive)
    remedies = [
        Remedy(f"from {enough} driving teeth at this centre distance there is none", changed(resized(drive, enough)))
    ]
    if (found := shift_free_of_undercut(drive)) is not None:
        modules = found[0] / drive.rack.module_mm
        words = f"shift the profiles, by {to_digits(modules, 3)} modules outwards on the driving gear"
        remedies.append(Remedy(words, changed(found[1])))
    if steeper := steeper_rack(drive, STEEPEST_DEG):
        remedies.append(Remedy("take a rack with a greater pressure angle", changed(steeper)))
    return tuple(remedies)


def pointed(drive: Drive) -> Advice | None:
    """Teeth whose flanks meet, or nearly, below the full height."""
    places = _places(drive, lambda gear: gear.shortened(Limit.LAND))
    if not places:
        return None
    least, blunt = drive.gears.least_tip_land, blunt_addendum(drive)
    lower = (Remedy("make all teeth so low", changed(blunt)),) if blunt else ()
    return Advice(
        Kind.POINTED,
        places,
        f"pointed teeth: tips shortened that would have a land under {least:g} modules: {_named(places)}",
        "a sharp tip chips when hardened and wears fast, so it ends lower; the contact is shorter for it",
        (*lower, FINER),
    )


def shortened(drive: Drive) -> list[Advice]:
    """Tips that are shortened for another reason than their point, one advice for each reason."""
    advices = []
    for reason, words in MEANINGS.items():
        places = _places(drive, partial(ToothedGear.shortened, reason=reason))
        if places:
            what = f"tips shortened that {words}: {_named(places)}"
            remedy = LESS_HELIX if reason is Limit.HELIX else FINER
            advices.append(Advice(Kind.SHORTENED, places, what, "the contact of these teeth is shorter", (remedy,)))
    return advices


def _places(drive: Drive, teeth_of: Callable[[ToothedGear], list[int]]) -> tuple[Where, ...]:
    both = (("driving", drive.teeth.driving), ("driven", drive.teeth.driven))
    return tuple(Where(name, tuple(numbers)) for name, gear in both if (numbers := teeth_of(gear)))


def _named(places: tuple[Where, ...]) -> str:
    return "; ".join(map(str, places))


def contact_ratio(drive: Drive) -> Advice | None:
    """Flanks that lose contact, unless the overlap of helical teeth bridges the gap; idle ones if they are to hold."""
    designed = drive.designed_contact
    judged = (designed.pushing, designed.back) if drive.gears.drives == "both_ways" else (designed.pushing,)
    sides = [side for side in judged if _parts(drive, side)]
    if not sides:
        return None
    error = max(side.transmission_error_rad for side in sides)
    helix, words = bridging_helix(drive), "make the teeth helical, so that the next ones touch before these part"
    helical = (Remedy(words, changed(helix)),) if helix else ()
    return Advice(
        Kind.CONTACT_RATIO,
        (Where(angles_deg=tuple(_worst(designed, side) for side in sides)),),
        f"contact ratio: the shortest contact of a flank pair lasts "
        f"{to_digits(min(side.pairs.least_arc for side in sides), 3)} pitches, "
        "and at some positions no flanks touch",
        f"the driven gear is carried by an edge there, off the law by up to {to_digits(1e6 * error, 2)} {MICRORAD}; it "
        "knocks and wears",
        (*helical, FINER),
    )


def idle_flanks(drive: Drive) -> Advice | None:
    """Idle flanks that would not hold as pushing ones must, where the driving gear is said to push only."""
    designed, (_, short) = drive.designed_contact, drive.short_contacts
    parts = _parts(drive, designed.back)
    if drive.gears.drives == "both_ways" or (short is None and not parts):
        return None
    return Advice(
        Kind.IDLE_FLANKS,
        (Where(angles_deg=(_worst(designed, designed.back),) if parts else ()),),
        f"idle flanks: {short or 'at some positions none touch'}",
        "nothing while the driving gear pushes; where masses or a weight turn the torque round, the teeth knock there; "
        "drives: both_ways refuses such teeth",
        (FINER,),
    )


def _parts(drive: Drive, side: SideContact) -> bool:
    """Whether flanks lose contact that a helix does not bridge."""
    return side.pairs.longest_gap > drive.overlap_ratio * drive.designed_contact.placement.per_tooth


def _worst(designed: AsDesigned, side: SideContact) -> tuple[float, float]:
    """The middle of the longest way without contact of flanks, in degrees of the driving gear."""
    at = degrees(float(designed.placement.phi1_rad[side.pairs.parted_at]))
    return at, at


def thrust(drive: Drive) -> Advice | None:
    """The thrust of helical teeth along their axes."""
    helix = drive.helix
    if helix is None or not helix.thrust_share:
        return None
    towards, away = ("growing", "falling") if helix.hand == "right" else ("falling", "growing")
    return Advice(
        Kind.THRUST,
        (Where(),),
        f"axial thrust: {to_digits(helix.thrust_share, 3)} of the tangential force at the pitch point pushes the "
        f"driving gear towards {towards} z and the driven one towards {away} z",
        "the bearings of both shafts must take it",
        (Remedy("herringbone teeth cancel it", (Change("gears.helix.kind", "herringbone"),)),),
    )
