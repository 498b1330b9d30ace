"""The advice about teeth that do not hold the load that is known of them."""

from __future__ import annotations

from math import degrees

from ncgear.figures.advice.values import Advice, Kind, Remedy, Where, changed
from ncgear.figures.numbers import to_digits
from ncgear.project.drive import Drive
from ncgear.project.strengthening import Verdict, known_verdict, large_enough, strong_enough, wide_enough
from ncgear.strength.holding import Weakest, worst

SIZE = "ncgear size"


def strength(drive: Drive) -> Advice | None:
    """Teeth whose safety against breakage or pitting is under the wanted one; names the weakest of all.

    None where no load is known, and where the strength is refused.
    """
    verdict = known_verdict(drive)
    if not isinstance(verdict, Verdict) or verdict.holds:
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
        f"{'teeth break' if first.damage.value == 'bending' else 'flanks pit'} before the wanted life ends",
        remedies(drive, verdict),
    )


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
    return (*found, Remedy(f"let {SIZE} find module, teeth and face width together"))
