"""Advices about loaded teeth: strength, scuffing and wear of flanks, vibration of the mesh."""

from __future__ import annotations

from collections.abc import Iterator
from contextlib import suppress
from dataclasses import replace
from math import degrees
from typing import TYPE_CHECKING

from ncgear.figures.advice.tried_advice import ENOUGH, enough
from ncgear.figures.advice.values import Advice, Kind, NotJudged, Remedy, RemedySearch, in_file
from ncgear.figures.flanks import BAND, hours_words, place_words, stretches_words, vibration_of_rating
from ncgear.figures.numbers import fixed, placed, to_digits
from ncgear.interrupts import TimeIsOver, at_most
from ncgear.numerics.bounds import shown_above, shown_below
from ncgear.pitch.shape import Gear
from ncgear.project.alternatives import may_be_helical
from ncgear.project.drive import Drive
from ncgear.project.rough_strength import RoughStrength, beside_refusal, rough_damage, rough_strength
from ncgear.project.service import choices_of
from ncgear.project.strengthening import MOST_TEETH, SERIES_I_MM, WIDEST_MODULES, Rating, deciding_loads, known_rating
from ncgear.project.vibration import ToldVibration
from ncgear.strength.film import Regime
from ncgear.strength.holding import Damage, face_width_factor, module_factor, worst
from ncgear.strength.iso6336 import THINNEST_WEB
from ncgear.strength.materials import Ferrous

if TYPE_CHECKING:
    from ncgear.strength.surfaces import Film, Surfaces, Wear

SIZE = "ncgear size"

MOST_SECONDS = 30.0
"""Most processor time of the trials of ``remedies`` for one pair of gears."""

LOADS = {"masses": "the machine with its masses", "resistance": "the resistance alone", "jam": "a jam"}
"""The words for what teeth do not hold."""


def strength(drive: Drive) -> Advice | NotJudged | None:
    """Teeth whose safety against breakage or pitting is under the wanted one; names the weakest of all.

    None where the teeth hold, and where no load is known.  Where the strength is refused, as of loads that press teeth
    too deep to be followed, they are judged roughly, if only whether they break at once.
    """
    rating = known_rating(drive)
    if not isinstance(rating, Rating):
        return _roughly(drive, beside_refusal(drive, rating))
    if rating.holds:
        why = unfollowed_motion(rating) or _thin_body(drive)
        return NotJudged(why) if why else None
    weak = [weakest for weakest in rating.weakest if not weakest.holds]
    first = worst(weak)
    at = degrees(first.phi1_rad)
    also = "".join(
        f"; also {other.gear.value} gear, {other.damage.words}: {to_digits(other.safety, 2)} at tooth {other.tooth}"
        for other in weak
        if other is not first
    )
    load = LOADS["jam" if deciding_loads(drive, rating)[first.gear, first.damage] == "jam" else rating.strength.load]
    return Advice(
        Kind.STRENGTH,
        f"the teeth do not hold: safety {_under(first.safety, first.wanted)} against {first.damage.words}, "
        f"{first.wanted:g} wanted",
        f"under {load} tooth {first.tooth} of the {first.gear.value} gear has {to_digits(first.stress_mpa, 3)} MPa at "
        f"phi1 = {placed(at)} deg and endures {to_digits(first.endured_mpa, 3)} MPa{also}: "
        f"{'teeth break' if first.damage is Damage.BENDING else 'flanks pit'} before the wanted life ends",
        (
            # Shafts tell what crowned flanks help
            *((CROWNED,) if drive.face_loading.basis == "computed" else ()),
            *_sizes(drive, face_width_factor(rating.weakest), module_factor(rating.weakest)),
            *((HELICAL,) if may_be_helical(drive) else ()),
        ),
    )


def pressed_in_time(drive: Drive, force_n: float) -> Advice | None:
    """Teeth that do not hold the largest force on a pair in a motion in time, N, if they bear it as often as any other.

    Root stresses grow with the force, and pressures with its square root.  None where the rating counts as much or
    holds, or is not known.
    """
    rating = known_rating(drive)
    if not isinstance(rating, Rating):
        return None
    if (vibrating := vibration_of_rating(drive, rating)) is None:
        return None
    rated_n = drive.conditions.application_factor * vibrating.peak_tooth_force_vibrating_n
    times = force_n / rated_n
    if times * OFTEN_MORE < 1.0 and rating.loading.still is not None:
        return Advice(
            Kind.STRENGTH,
            f"in this motion a pair of teeth bears {to_digits(force_n, 3)} N, and {to_digits(rated_n, 3)} N are rated "
            "with knocks: it may not repeat yet",
            "knocks grow from turn to turn until they repeat; more simulation.turns tell",
            matters=False,
        )
    powers = {Damage.BENDING: 1.0, Damage.CONTACT: 0.5}
    weakest = min(rating.weakest, key=lambda tooth: tooth.safety / tooth.wanted / times ** powers[tooth.damage])
    safety = weakest.safety / times ** powers[weakest.damage]
    if times <= AS_MUCH or safety >= weakest.wanted:
        return None
    return Advice(
        Kind.STRENGTH,
        f"in this motion a pair of teeth bears {to_digits(times, 3)} times what is rated: safety "
        f"{_under(safety, weakest.wanted)} against {weakest.damage.words}, {weakest.wanted:g} wanted",
        f"{to_digits(force_n, 5)} N beside {to_digits(rated_n, 5)} N of ncgear strength, which counts knocks at even "
        "speed, no start from rest and no course of a motor; as if the teeth bore it as often as the rated load",
    )


OFTEN_MORE = 1.5
"""Ratio of the rated force to that of a motion in time beyond which the motion may not repeat yet: it told at most 1.39
of forty machines whose motion does (benchmarks/knocks.md)."""

AS_MUCH = 1.03
"""Ratio of forces up to which the rating counts as much as the motion in time: the least share that it told of forty
machines is 0.97 (benchmarks/knocks.md)."""


def unfollowed_motion(rating: Rating) -> str:
    """Why teeth may bear more than is known; empty where they do not, or that is known."""
    loading = rating.loading
    if loading.borne is not None and loading.borne.slow_swings:
        return (
            f"the driven side swings slowly on its teeth, {to_digits(loading.borne.slow_swings, 2)} times a cycle, as "
            "with a flywheel, and the load may rouse that; ncgear simulate --level dynamic tells by how much"
        )
    if loading.borne is not None and loading.borne.fast_swings:
        return (
            f"the driven side swings {to_digits(loading.borne.fast_swings, 2)} times a cycle on its teeth, as in slow "
            "and light machines: too often for knocks to be followed"
        )
    if loading.knocks is not None or not loading.torque_n_mm.min() < 0.0 < loading.torque_n_mm.max():
        return ""
    return "the load changes flanks, where the teeth knock, which is followed only where every shaft has inertia"


def _thin_body(drive: Drive) -> str:
    """Why a gear whose teeth hold may break under its roots; empty where what its rim and web do is known."""
    face_mm = drive.gears.face_width_mm
    for gear, body in zip(Gear, (drive.gears.driving, drive.gears.driven), strict=True):
        if body.web and body.web.thickness_mm < THINNEST_WEB * face_mm:
            return (
                f"the web of the {gear.value} gear, of {body.web.thickness_mm:g} mm under {face_mm:g} mm of face "
                "width, is not followed"
            )
    return ""


def _under(safety: float, wanted: float) -> str:
    """A safety under the wanted one, in two digits or as many as tell that it is."""
    told = (to_digits(safety, digits) for digits in range(2, 10))
    return next((text for text in told if float(text) < wanted), f"just under {wanted:g}")


def rough(drive: Drive) -> Advice | NotJudged | None:
    """The same without teeth, by a rough estimate."""
    return _roughly(drive, rough_strength(drive))


def _roughly(drive: Drive, found: RoughStrength | None) -> Advice | NotJudged | None:
    if found is None:
        return None
    weak = found.weak
    if not weak:
        return _not_judged(drive, found)
    design, first = drive.design, weak[0]
    load = "the masses" if design.masses else "the resistance"
    load = "a jam" if first in found.jammed else load
    at, damage = degrees(first.phi1_rad), rough_damage(found, first)
    if needs_teeth := found.needs_teeth_for(first):
        said, stress = "the teeth will not hold", ""
        safety = f"under half the safety of {first.wanted:g} that is wanted against {damage}"
        more = f"; how much under is not told, since {needs_teeth}"
    else:
        said, stress = "the teeth will hardly hold", f" with {to_digits(first.stress_mpa, 2)} MPa"
        safety = f"safety about {_under(first.safety, first.wanted)} against {damage}, {first.wanted:g} wanted"
        more = ""
    meaning = "ncgear strength computes every tooth"
    if found.unjudged:
        meaning = f"{'their life is not judged' if found.at_once else 'the teeth are not followed'}: {found.unjudged}"
    where = f"roughly, under the load of {load} on the {first.gear.value} gear{stress} at phi1 = {placed(at)} deg{more}"
    return Advice(Kind.STRENGTH, f"{said}: {safety}", f"{where}; {meaning}", _rough_remedies(drive, found))


def _not_judged(drive: Drive, found: RoughStrength) -> NotJudged | None:
    """Why teeth that are not found too weak are not said to hold; None where they are."""
    least = min(found.safeties, key=lambda safety: safety.safety / safety.wanted, default=None)
    if found.unjudged and least is None:
        return NotJudged(found.unjudged)
    if found.unjudged and least is not None:
        near = "very roughly" if found.needs_teeth else "about"
        told = f"a safety of {near} {to_digits(least.safety, 2)} against {rough_damage(found, least)}"
        return NotJudged(f"{found.unjudged}; all that is known is {told}, {least.wanted:g} wanted")
    if found.holds:
        return None
    reason = found.needs_teeth or found.jam_needs_teeth
    if reason or least is None:
        return NotJudged(reason)
    about = f"a safety of about {_under(least.safety, least.wanted)} against {rough_damage(found, least)}"
    return NotJudged(
        f"{about}, {least.wanted:g} wanted, is too near for an estimate without teeth: ncgear strength tells"
    )


TOGETHER = Remedy("make teeth larger and gears wider together, or reduce their load")
"""What is said where neither size alone would do, and no search tells both."""

SAFE_SIDE = 1.1
"""The most by which rough safeties are over those of the teeth, but where curvatures leap or teeth knock (1.14): a size
that is told roughly is larger by what this takes."""


def _rough_remedies(drive: Drive, found: RoughStrength) -> tuple[Remedy, ...]:
    """Sizes by how stresses scale; `ncgear size` finds no sizes for teeth whose strength is not computed."""
    short = [
        (safety, SAFE_SIDE * safety.wanted / safety.safety)
        for safety in found.safeties
        if safety.safety < safety.wanted
    ]
    wider = max(times ** (1.0 if safety.damage is Damage.BENDING else 2.0) for safety, times in short)
    larger = max(times ** (0.5 if safety.damage is Damage.BENDING else 1.0) for safety, times in short)
    sizes = tuple(replace(remedy, search=None) for remedy in _sizes(drive, wider, larger))
    if not found.unjudged:
        return sizes
    return tuple(remedy for remedy in sizes if remedy.text != SIZE) or (TOGETHER,)


CROWNED = Remedy("crown the flanks along the width", search=RemedySearch.CROWNED)

HELICAL = Remedy("cut helical teeth", search=RemedySearch.HELICAL)


def _sizes(drive: Drive, wider: float, larger: float) -> tuple[Remedy, ...]:
    """Sizes that would do by how stresses scale; they are not computed, so they are words until trials tell them."""
    size, face_width_mm = drive.pitch.size, drive.gears.face_width_mm
    width, module = wider * face_width_mm, larger * size.module_mm
    # The largest gears of ncgear size: roots gain with width, module and scale, flanks with width and twice with scale.
    coarsest = SERIES_I_MM[-1] / size.module_mm
    scale = coarsest * MOST_TEETH / size.driving_teeth
    if wider > WIDEST_MODULES * SERIES_I_MM[-1] / face_width_mm * scale * max(scale, coarsest):
        return (
            Remedy("take a stronger material", search=RemedySearch.STRONGER),
            Remedy("take more pairs of gears: no usual size of these would do"),
        )
    found = [_together(drive)]
    if module <= SERIES_I_MM[-1]:
        found.insert(0, Remedy(f"module roughly {shown_above(module, 2)} mm", search=RemedySearch.LARGER))
    if width <= WIDEST_MODULES * size.module_mm:
        found.insert(0, Remedy(f"face width roughly {shown_above(width, 2)} mm", search=RemedySearch.WIDER))
    return tuple(found)


def remedies(drive: Drive, rating: Rating, seconds: float = MOST_SECONDS) -> tuple[Remedy, ...]:
    """What makes the teeth hold: a face width, a module, a material, or the search for sizes together.

    The trials take so many ``seconds`` of processor time at the most; those that are left are not made.
    """
    if rating.holds:
        return ()
    tried = list[Remedy | None]()
    with suppress(TimeIsOver), at_most(seconds):
        tried.extend(enough(search, drive, rating) for search in ENOUGH)
    found = (replace(remedy, changes=in_file(drive.design, remedy.changes)) for remedy in tried if remedy)
    left = (CUT.format(seconds=seconds),) if len(tried) < len(ENOUGH) else ()
    return (*found, _together(drive), *map(Remedy, left))


CUT = "other changes may do, too: trials end after {seconds:g} s of processor time"


def _together(drive: Drive) -> Remedy:
    """Several sizes at once; they are not searched for where two pairs of gears share them."""
    return Remedy(SIZE if drive.stage is None else "material, module and face width together, of all stages")


LOADS_UNKNOWN = "the loads of the teeth are not followed"
"""Why flanks and a mesh are not judged whose strength is not computed, where no other reason is known."""


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
        yield _wear(found.wear, drive)
    if found.film is not None and found.film.regime is Regime.BOUNDARY:
        yield _boundary(found.film, found)
    if why := unfollowed_motion(rating):
        yield NotJudged(why)


LARGER_GEARS = Remedy("take larger gears, which press their flanks less")


def _scuffing(film: Film, found: Surfaces, safety: float, wanted: float) -> Advice:
    told = shown_below(safety, 2)
    return Advice(
        Kind.FLANKS,
        f"the flanks scuff: safety {told}, {wanted:g} wanted",
        f"contacts reach {fixed(film.hottest_c, 0)} deg C at {place_words(film.flash_k)}, and the oil fails at "
        f"{fixed(found.scuffing_c or 0.0, 0)} deg C: flanks weld and tear where they slide under load, at once",
        (Remedy("take an oil of a higher FZG load stage"), LARGER_GEARS),
    )


def _wear(wear: Wear, drive: Drive) -> Advice:
    gear, deepest = max(zip(Gear, wear.depth_mm, strict=True), key=lambda figure: figure[1].value)
    worn = dict(zip(Gear, choices_of(drive.gears), strict=True))[gear].entry
    cures = [Remedy("let oil part the flanks")] if drive.conditions.lubrication == "dry" else []
    if isinstance(worn, Ferrous) and not worn.group.hardened:
        cures.append(Remedy("harden the flanks"))
    return Advice(
        Kind.FLANKS,
        f"the flanks wear away: a tenth of the module in about {hours_words(wear.life_h)}, "
        f"{hours_words(wear.wanted_h)} wanted",
        f"tooth {deepest.tooth(gear)} of the {gear.value} gear loses {to_digits(deepest.value, 2)} mm in the wanted "
        f"life, and the tenth is {to_digits(wear.limit_mm, 3)} mm; teeth get thin and the backlash grows by up to "
        f"{to_digits(wear.play_mm, 2)} mm; wear is known to a factor of ten at best",
        (*cures, LARGER_GEARS),
    )


def _boundary(film: Film, found: Surfaces) -> Advice:
    return Advice(
        Kind.FLANKS,
        f"boundary lubrication: a film of {to_digits(film.thickness.value, 2)} of the roughness",
        f"flanks touch and wear, most at {place_words(film.thickness)}, as slow gears do; pitting is rated with Z_L "
        f"Z_v Z_R = {to_digits(min(found.pitting_factor), 2)} for oil, speed and roughness, which knows nothing of "
        "micropitting",
        matters=False,
    )


def vibration(drive: Drive) -> Iterator[Advice | NotJudged]:
    """Where the rated teeth resonate."""
    rating = known_rating(drive)
    if isinstance(rating, Rating):
        yield from _resonance(drive, vibration_of_rating(drive, rating))
    elif (found := beside_refusal(drive, rating)) is not None:
        yield NotJudged(found.unjudged or found.needs_teeth or LOADS_UNKNOWN)


def rough_vibration(drive: Drive) -> Iterator[Advice | NotJudged]:
    """The same without teeth: the resonance ratio goes as the root of a stiffness that is known without them, too."""
    found = rough_strength(drive)
    if found is None:
        return
    if found.unjudged:
        yield NotJudged(found.unjudged)
    yield from _resonance(drive, found.vibration)


def _resonance(drive: Drive, told: ToldVibration | None) -> Iterator[Advice]:
    if told is None or not told.resonates_between_deg or told.critical_rpm is None:
        return
    speed, (low, high) = f"{drive.design.operation.speed_rpm:g} r/min", told.critical_rpm
    where, factor = stretches_words(told), to_digits(told.dynamic_factor, 2)
    yield Advice(
        Kind.VIBRATION,
        f"the mesh resonates ({BAND}) {where} at {speed}",
        f"teeth part and hammer, and gears howl; K_V, {factor} at the largest load, is least sure there, and is for "
        "gears that stay in the resonance",
        (
            Remedy(f"run under {shown_below(low, 2)} r/min or over {shown_above(high, 2)} r/min"),
            Remedy("take lighter gears, or fewer and larger teeth, which pass more slowly"),
        ),
    )
