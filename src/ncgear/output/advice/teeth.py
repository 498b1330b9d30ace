"""Advices about undercut teeth and shortened tips."""

from __future__ import annotations

from collections.abc import Callable

import numpy as np

from ncgear.drive import Drive
from ncgear.output.advice.undercut import ways_out_of_undercut
from ncgear.output.advice.values import Advice, Change, Kind, Remedy, Where
from ncgear.teeth.gear import ToothedGear
from ncgear.teeth.tips import Limit

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
