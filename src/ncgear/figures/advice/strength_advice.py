"""The advice about teeth that do not hold the load that is known of them."""

from __future__ import annotations

from dataclasses import replace
from math import degrees

from ncgear.errors import DesignError
from ncgear.figures.advice.values import Advice, Kind, Remedy, Where, changed
from ncgear.figures.numbers import to_digits
from ncgear.project.drive import Drive
from ncgear.project.rough_strength import rough_strength
from ncgear.project.strengthening import (
    MOST_TEETH,
    SERIES_I_MM,
    WIDEST_MODULES,
    Verdict,
    known_verdict,
    large_enough,
    strong_enough,
    wide_enough,
)
from ncgear.strength.without_teeth import RoughSafety
from ncgear.strength.holding import Damage, Weakest, face_width_factor, module_factor, worst

SIZE = "ncgear size"


def strength(drive: Drive) -> Advice | None:
    """Teeth whose safety against breakage or pitting is under the wanted one; names the weakest of all.

    Where the strength is refused, as for loads that press teeth too deep to be followed, what a check says of it.  None
    where no load is known.
    """
    verdict = known_verdict(drive)
    if isinstance(verdict, DesignError):
        refused = rough(drive)
        return refused and replace(refused, meaning=f"this is not computed tooth by tooth: {verdict.problem}")
    if verdict is None or verdict.holds:
        return None
    weak = [one for one in verdict.weakest if not one.holds]
    first = worst(weak)
    at = degrees(first.phi1_rad)
    also = [_least(one) for one in weak if one is not first]
    load = "the machine with its masses" if verdict.strength.load == "masses" else "the resistance alone"
    return Advice(
        Kind.STRENGTH,
        (Where(first.gear.value, (first.tooth,), ((at, at),)),),
        f"the teeth do not hold {load}: tooth {first.tooth} of the {first.gear.value} gear has "
        f"{to_digits(first.stress_mpa, 3)} MPa at phi1 = {to_digits(at, 4)} deg and endures "
        f"{to_digits(first.endured_mpa, 3)} MPa, a safety of {to_digits(first.safety, 2)} against "
        f"{first.damage.words} where {first.wanted:g} is wanted" + (f" (also {'; '.join(also)})" if also else ""),
        f"{'teeth break' if first.damage is Damage.BENDING else 'flanks pit'} before the wanted life ends; "
        "ncgear strength computes what would do",
        _sizes(drive, face_width_factor(verdict.weakest), module_factor(verdict.weakest)),
        brief=f"the teeth do not hold: safety {to_digits(first.safety, 2)} against {first.damage.words}, "
        f"{first.wanted:g} wanted",
    )


def rough(drive: Drive) -> Advice | None:
    """The same without teeth, by a rough estimate at the pitch point; None where that finds nothing."""
    found = rough_strength(drive)
    weak = [one for one in found if one.safety < one.wanted]
    if not weak:
        return None
    first = min(weak, key=lambda one: one.safety / one.wanted)
    at, load = degrees(first.phi1_rad), "the resistance" if drive.design.masses is None else "the masses"
    stage = "" if drive.stage is None else f" of stage {drive.stage}"
    return Advice(
        Kind.STRENGTH,
        (Where(first.gear.value, angles_deg=((at, at),)),),
        f"the teeth{stage} will hardly hold the load of {load}: roughly, one pair at the pitch point has "
        f"{to_digits(first.stress_mpa, 2)} MPa at phi1 = {to_digits(at, 4)} deg, a safety of "
        f"{to_digits(first.safety, 2)} of the {first.gear.value} gear against {first.damage.words} where "
        f"{first.wanted:g} is wanted",
        "ncgear strength computes every tooth",
        _rough_remedies(drive, weak),
        brief=f"the teeth{stage} will hardly hold: safety about {to_digits(first.safety, 2)} against "
        f"{first.damage.words}, {first.wanted:g} wanted",
    )


def _rough_remedies(drive: Drive, weak: list[RoughSafety]) -> tuple[Remedy, ...]:
    wider = max((one.wanted / one.safety) ** (1.0 if one.damage is Damage.BENDING else 2.0) for one in weak)
    larger = max((one.wanted / one.safety) ** (0.5 if one.damage is Damage.BENDING else 1.0) for one in weak)
    return _sizes(drive, wider, larger)


def _sizes(drive: Drive, wider: float, larger: float) -> tuple[Remedy, ...]:
    """Sizes that would do by how stresses scale; they are not computed, so they are words and no changes."""
    size, face_width_mm = drive.pitch.size, drive.gears.face_width_mm
    width, module = wider * face_width_mm, larger * size.module_mm
    # The largest gears of ncgear size: roots gain with width, module and scale, flanks with width and twice with scale.
    coarsest = SERIES_I_MM[-1] / size.module_mm
    scale = coarsest * MOST_TEETH / size.driving_teeth
    if wider > WIDEST_MODULES * SERIES_I_MM[-1] / face_width_mm * scale * max(scale, coarsest):
        return (Remedy("take a stronger material or more pairs of gears: no usual size of these would do"),)
    found = [_together(drive)]
    if module <= SERIES_I_MM[-1]:
        about = f"about {to_digits(module, 2)} mm"
        found.insert(0, Remedy(f"take a module of {about} with as many teeth", short=f"module {about}"))
    if width <= WIDEST_MODULES * size.module_mm:
        about = f"about {to_digits(width, 2)} mm"
        found.insert(0, Remedy(f"make the gears {about} wide", short=f"face width {about}"))
    return tuple(found)


def _least(one: Weakest) -> str:
    return f"{one.gear.value} gear, {one.damage.words}: {to_digits(one.safety, 2)} at tooth {one.tooth}"


def remedies(drive: Drive, verdict: Verdict) -> tuple[Remedy, ...]:
    """What makes the teeth hold: a face width, a module, a material, or the search for sizes together."""
    if verdict.holds:
        return ()
    found = []
    if wide := wide_enough(drive, verdict):
        found.append(Remedy("make the gears wider", changed(wide)))
    if large := large_enough(drive, verdict):
        found.append(Remedy("take a larger module", changed(large)))
    if strong := strong_enough(drive, verdict):
        found.append(Remedy("take a stronger material", changed(strong)))
    return (*found, _together(drive))


def _together(drive: Drive) -> Remedy:
    """Several sizes at once; they are not searched for where two pairs of gears share them."""
    if drive.stage is None:
        return Remedy(f"let {SIZE} find module, teeth and face width together", short=SIZE)
    return Remedy("change material, module and face width together; both stages share them", short="larger module")
