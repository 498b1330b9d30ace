"""All advices of a drive, in the order in which a person works out a design."""

from __future__ import annotations

from dataclasses import replace

from ncgear.design.keys.design import Design
from ncgear.figures.advice import law_advice, strength_advice, wish_advice
from ncgear.figures.advice.values import Advice, NotJudged, Remedy
from ncgear.pitch.shape import Gear
from ncgear.project.alternatives import is_given
from ncgear.project.drive import Drive

MEANS = ("motion", "gears")
"""Groups of keys that say by what means a machine does its work: these are what advices are about.  All others say what
it has to do, and what a person has given there is changed by no remedy."""


def check_advice(drive: Drive) -> tuple[Advice, ...]:
    """The advices that need no pitch curve."""
    ranges = [law_advice.ratio_range(pair) for pair in drive.by_stage]
    negative = [law_advice.negative_resistance(drive, returning) for returning in (False, True)]
    return _given(drive, *ranges, law_advice.speeds(drive), *negative, wish_advice.missed_wishes(drive))


def rough_advice(drive: Drive) -> tuple[Advice, ...]:
    """What a check says of teeth without making them, in the place of what a build knows better."""
    return _given(drive, *map(strength_advice.rough, drive.by_stage))


def build_advice(drive: Drive) -> tuple[Advice, ...]:
    """Advices about pitch curves, teeth and contact of one pair of gears; raises as the drive does."""
    # The modules that make teeth are slow to import, and a check does not need them.
    from ncgear.figures.advice import teeth_advice

    of_curves = [
        law_advice.pressure_angle(drive),
        law_advice.ring(drive),
        *(law_advice.concave(drive, gear) for gear in Gear),
        *law_advice.crank_pin(drive),
        *law_advice.rods(drive),
        law_advice.pin_beside_hub(drive),
    ]
    of_teeth = [teeth_advice.undercut(drive), teeth_advice.pointed(drive), *teeth_advice.shortened(drive)]
    of_contact = teeth_advice.contact_ratio(drive), teeth_advice.idle_flanks(drive)
    of_load = strength_advice.strength(drive), teeth_advice.thrust(drive)
    return _given(drive, *of_curves, *of_teeth, *of_contact, *of_load)


def _given(drive: Drive, *advices: Advice | NotJudged | None) -> tuple[Advice, ...]:
    return tuple(_within_what_is_asked(advice, drive.design) for advice in advices if isinstance(advice, Advice))


def _within_what_is_asked(advice: Advice, design: Design) -> Advice:
    """The advice without remedies that undo what is asked of the machine; first those that leave every given key."""
    kept = [remedy for remedy in advice.remedies if not any(map(_is_asked, _overwritten(remedy, design)))]
    kept.sort(key=lambda remedy: bool(_overwritten(remedy, design)))
    return replace(advice, remedies=tuple(kept))


def _is_asked(key: str) -> bool:
    return key.partition(".")[0] not in MEANS


def _overwritten(remedy: Remedy, design: Design) -> list[str]:
    """The keys of a remedy's changes that the file gives."""
    return [change.key for change in remedy.changes if is_given(design, change.key)]
