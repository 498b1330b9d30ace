"""What is said of flanks that scuff, that wear away within the wanted life, or that oil hardly parts."""

from __future__ import annotations

from collections.abc import Iterator
from math import degrees
from typing import TYPE_CHECKING

from ncgear.figures.advice.strength_advice import unfollowed_knocks
from ncgear.figures.advice.values import Advice, Kind, NotJudged, Remedy, Where
from ncgear.figures.flanks import hours_words, place_words
from ncgear.figures.numbers import fixed, to_digits
from ncgear.numerics.bounds import shown_below
from ncgear.pitch.shape import Gear
from ncgear.project.drive import Drive
from ncgear.project.rough_strength import beside_refusal
from ncgear.project.strengthening import Rating, known_rating
from ncgear.strength.film import Regime

if TYPE_CHECKING:
    from ncgear.strength.surfaces import Film, Place, Surfaces, Wear

LOADS_UNKNOWN = "the loads of the flanks are not followed"
"""Why flanks are not judged whose strength is not computed, where no other reason is known."""


def flanks(drive: Drive) -> Iterator[Advice | NotJudged]:
    """Flanks that scuff or wear away; that oil hardly parts them is a remark, since it is usual of slow gears.

    What follows from a thin film is that flanks wear, and that is judged by itself: a machine whose flanks lose next to
    nothing within the wanted life keeps the condition, though no film parts them.
    """
    rating = known_rating(drive)
    if not isinstance(rating, Rating):
        rough = beside_refusal(drive, rating)
        if rough is not None:
            yield NotJudged(rough.unjudged or rough.needs_teeth or LOADS_UNKNOWN)
        return
    from ncgear.strength.surfaces import LEAST_SCUFFING

    found = drive.surfaces_by(rating.strength.method)
    if found.film is not None and found.scuffing_safety is not None and found.scuffing_safety < LEAST_SCUFFING:
        yield _scuffing(found.film, found, found.scuffing_safety, LEAST_SCUFFING)
    if not found.wear.holds:
        yield _wear(found.wear, drive.conditions.lubrication)
    if found.film is not None and found.film.regime is Regime.BOUNDARY:
        yield _boundary(found.film, found)
    if why := unfollowed_knocks(rating):
        yield NotJudged(why)


def _where(place: Place, gear: Gear) -> Where:
    at = degrees(place.phi1_rad)
    return Where(gear.value, (place.tooth(gear),), ((at, at),))


def _scuffing(film: Film, found: Surfaces, safety: float, wanted: float) -> Advice:
    told = shown_below(safety, 2)
    return Advice(
        Kind.FLANKS,
        (_where(film.flash_k, Gear.DRIVING),),
        f"the flanks scuff: contacts reach {fixed(film.hottest_c, 0)} deg C at {place_words(film.flash_k)}, and the "
        f"oil fails at {fixed(found.scuffing_c or 0.0, 0)} deg C, a safety of {told} and {wanted:g} wanted",
        "flanks weld and tear where they slide under load, at once",
        (
            Remedy("take an oil of a higher FZG load stage", short="an oil of a higher FZG load stage"),
            Remedy("take larger gears, which press their flanks less", short="larger gears"),
        ),
        brief=f"the flanks scuff: safety {told}, {wanted:g} wanted",
    )


def _wear(wear: Wear, lubrication: str) -> Advice:
    gear, deepest = max(zip(Gear, wear.depth_mm, strict=True), key=lambda one: one[1].value)
    oil = [Remedy("let oil part the flanks", short="oil")] if lubrication == "dry" else []
    return Advice(
        Kind.FLANKS,
        (_where(deepest, gear),),
        f"the flanks wear away: in {hours_words(wear.wanted_h)} tooth {deepest.tooth(gear)} of the {gear.value} gear "
        f"loses {to_digits(deepest.value, 2)} mm, and a tenth of the module, {to_digits(wear.limit_mm, 3)} mm, after "
        f"{hours_words(wear.life_h)}",
        f"teeth get thin and the backlash grows by up to {to_digits(wear.play_mm, 2)} mm; wear is known to a factor of "
        "ten at best",
        (
            *oil,
            Remedy("harden the flanks", short="hardened flanks"),
            Remedy("take larger gears, which press their flanks less", short="larger gears"),
        ),
        brief=f"the flanks wear away: a tenth of the module in about {hours_words(wear.life_h)}, "
        f"{hours_words(wear.wanted_h)} wanted",
    )


def _boundary(film: Film, found: Surfaces) -> Advice:
    least = to_digits(film.thickness.value, 2)
    return Advice(
        Kind.FLANKS,
        (_where(film.thickness, Gear.DRIVING),),
        f"the oil hardly parts the flanks: its film is {least} of their roughness Ra at {place_words(film.thickness)}",
        "flanks touch and wear, as slow gears do; pitting is rated with Z_L Z_v Z_R = "
        f"{to_digits(min(found.pitting_factor), 2)} for oil, speed and roughness, which knows nothing of micropitting",
        matters=False,
        brief=f"boundary lubrication: a film of {least} of the roughness",
    )
